//! Numbers in sentences and cells.

use super::{Run, Tone};

/// At most so many significant digits, without trailing zeros.
pub fn digits(value: f64, significant: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let exponent = value.abs().log10().floor();
    if !(-3.0..significant as f64).contains(&exponent) {
        let mantissa = significant.clamp(1, 5) - 1;
        return if value.is_finite() { format!("{value:.mantissa$e}") } else { "–".into() };
    }
    let text = format!("{value:.*}", (significant as f64 - 1.0 - exponent).max(0.0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A cell with a number of five digits.
pub fn number(value: impl Into<Option<f64>>) -> Run {
    precise(value, 5)
}

/// A cell with a number of at most so many digits.
pub fn precise(value: impl Into<Option<f64>>, significant: usize) -> Run {
    Run::plain(value.into().map_or_else(|| "–".to_owned(), |value| digits(value, significant)))
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
