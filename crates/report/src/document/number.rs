//! Numbers in sentences and cells.

use super::{Run, Tone};
use serde_json::Value;

pub use files::digits;

/// A cell with a number of five digits.
pub fn number(value: impl Into<Option<f64>>) -> Run {
    precise(value, 5)
}

/// A cell with a number of at most so many digits.
pub fn precise(value: impl Into<Option<f64>>, significant: usize) -> Run {
    Run::plain(value.into().map_or_else(|| "–".to_owned(), |value| digits(value, significant)))
}

/// A cell of JSON; that of nothing is empty.
pub(super) fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        number => number.to_string(),
    }
}

/// A cell: holds, or not.
pub fn held(holds: bool) -> Run {
    if holds { Run::of("holds", Tone::Pass) } else { Run::of("does not hold", Tone::Miss) }
}

/// Two sides of a relation that fails.
pub fn sides(left: f64, right: f64) -> String {
    let side = |value: f64| match value.is_nan() {
        true => "no number".to_owned(),
        false => format!("{value:.9e}"),
    };
    format!("{} against {}", side(left), side(right))
}
