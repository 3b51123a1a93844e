//! The document for Typst: a fixed template and the content as JSON, so that no word of a scene is ever read as markup.

use super::Document;

/// Name of the content beside the template.
pub(crate) const DATA: &str = "report.json";

/// Reads [`DATA`] and sets it: `typst compile report.typ` in the directory of a report gives the PDF as well.
pub(crate) const TEMPLATE: &str = include_str!("report.typ");

/// The content; `date` stands below the title.
pub(crate) fn data(document: &Document, date: Option<&str>) -> String {
    let mut value = serde_json::json!(document);
    value["date"] = serde_json::json!(date);
    value.to_string() + "\n"
}
