//! Tables of a study: as CSV, and of its JSON in its document.

use report::{Row, Run, precise};
use serde_json::Value;

/// Rows of JSON as rows of a document: each column with its head, the place of its value in a row and its digits.
pub(crate) fn rows<'a, const N: usize>(
    rows: &'a [Value],
    columns: [(&'static str, &'static str, usize); N],
) -> impl Iterator<Item = Row<'static, N>> + 'a {
    let cell = |value: Option<&Value>, digits| match value {
        Some(value @ (Value::String(_) | Value::Bool(_))) => Run::plain(text(value)),
        Some(value) if value.is_u64() => Run::plain(text(value)),
        value => precise(value.and_then(Value::as_f64), digits),
    };
    rows.iter().map(move |row| {
        columns.map(|(head, place, digits)| (head, cell(row.pointer(place), digits)))
    })
}

/// A cell; that of nothing is empty.
pub(crate) fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        number => number.to_string(),
    }
}

/// Rows of named cells as CSV, below the names of the cells.
///
/// # Errors
/// The writer's.
pub(crate) fn csv<K: AsRef<[u8]>, R: AsRef<[(K, String)]>>(
    rows: impl IntoIterator<Item = R>,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (i, row) in rows.into_iter().enumerate() {
        let row = row.as_ref();
        if i == 0 {
            writer.write_record(row.iter().map(|(name, _)| name))?;
        }
        writer.write_record(row.iter().map(|(_, cell)| cell))?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}
