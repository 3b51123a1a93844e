//! The document for Typst: a fixed template with the content as JSON, so that no word of a scene is read as markup.

use super::Document;

pub(crate) const DATA: &str = "report.json";

/// Reads [`DATA`]: `typst compile report.typ` in the directory of a report also gives the PDF.
pub(crate) const TEMPLATE: &str = include_str!("report.typ");

/// The content, without a date.
pub(crate) fn data(document: &Document) -> String {
    let mut value = serde_json::json!(document);
    value["date"] = serde_json::Value::Null;
    value.to_string() + "\n"
}
