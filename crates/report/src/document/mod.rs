//! The content of a report, independent of its rendering: paragraphs, formulas, numbered tables and figures.
//!
//! [`document`] builds it once from the records; page, Markdown, LaTeX and Typst render it.

mod chapter;
mod content;
mod equation;
mod html;
mod markup;
#[cfg(feature = "pdf")]
mod pdf;
mod study;
mod terminal;

use crate::symbols::symbols;
use serde::{Deserialize, Serialize};

pub use content::answers;
pub(super) use content::{Drawn, Report, by_verify, document};
pub use equation::{Equation, Group, Terms, equations};
pub use files::digits;
pub(super) use html::page;
pub(super) use markup::{markdown, tables, verdict_rows};
#[cfg(all(test, feature = "pdf"))]
pub(super) use pdf::paged;
#[cfg(feature = "pdf")]
pub use pdf::pdf;
pub(super) use study::of_cases;
pub use study::{Chapter, Findings, StudyDocument, json_table};
pub(super) use study::{number, precise};
pub(super) use terminal::outcome;
pub use terminal::{beside, verdict_table};

/// The content for Typst, as JSON, so that no word of a scene is read as markup.
pub(crate) const DATA: &str = "report.json";

/// Reads [`DATA`]: `typst compile report.typ` in the directory of a report also gives the PDF.
pub(crate) const TEMPLATE: &str = include_str!("report.typ");

/// The content, without a date.
pub(crate) fn data(document: &Document) -> String {
    let mut value = serde_json::json!(document);
    value["date"] = serde_json::Value::Null;
    value.to_string() + "\n"
}

/// A report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Document {
    pub(super) title: String,
    pub(super) outcome: String,
    pub(super) made_by: String,
    pub(super) sections: Vec<Section>,
}

/// A section: of level 1, or below one of level 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Section {
    pub(super) level: usize,
    /// Target of links.
    pub(super) id: String,
    pub(super) title: String,
    /// Summary, for a scene's section.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) card: Option<Card>,
    pub(super) blocks: Vec<Block>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Card {
    /// Its verdicts in a sentence.
    pub(super) verdict: Vec<Run>,
    /// Its body and its errors, without numbers.
    pub(super) pictures: Vec<Figure>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", tag = "kind", content = "of")]
pub(super) enum Block {
    Text(Vec<Run>),
    Formulas(Vec<Equation>),
    Table(Table),
    Figure(Figure),
    /// Lines to be typed.
    Code(String),
    /// The text of a scene file.
    Scene(String),
}

/// Words of one style.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    pub(super) text: String,
    pub(super) tone: Tone,
    /// Linked section or file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) target: Option<String>,
}

/// Emphasis; never the only carrier of meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    Plain,
    Strong,
    /// To be typed.
    Code,
    /// `_` and `^` precede low and high signs.
    Formula,
    Pass,
    Miss,
}

/// A numbered table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Table {
    pub(super) number: usize,
    pub(super) caption: String,
    pub(super) head: Vec<String>,
    /// Right-aligned columns.
    pub(super) numeric: Vec<bool>,
    pub(super) rows: Vec<Vec<Run>>,
    /// Evidence of a verdict: folded, since the files have its numbers as well.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) evidence: bool,
}

/// A numbered picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Figure {
    pub(super) number: usize,
    /// File name in the directory of the report.
    pub(crate) file: String,
    pub(super) caption: String,
    #[serde(skip)]
    pub(crate) svg: String,
    /// The picture in pieces, for a page that arranges them by its width.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) pieces: Vec<Figure>,
}

impl Figure {
    pub(crate) fn new(file: impl Into<String>, caption: impl Into<String>, svg: String) -> Self {
        Self { number: 0, file: file.into(), caption: caption.into(), svg, pieces: Vec::new() }
    }
}

impl Run {
    /// Words that stand out by `tone`.
    pub fn of(text: impl Into<String>, tone: Tone) -> Self {
        Self { text: text.into(), tone, target: None }
    }

    /// Words that do not stand out.
    pub fn plain(text: impl Into<String>) -> Self {
        Self::of(text, Tone::Plain)
    }

    /// A formula spelt in ASCII.
    pub fn formula(ascii: &str) -> Self {
        Self::of(symbols(ascii), Tone::Formula)
    }

    pub(super) fn code(text: impl Into<String>) -> Self {
        Self::of(text, Tone::Code)
    }

    pub(super) fn to(self, target: impl Into<String>) -> Self {
        Self { target: Some(target.into()), ..self }
    }
}

impl Table {
    /// Heads of numeric columns begin with `>`.
    fn new(caption: impl Into<String>, heads: &[&str], rows: Vec<Vec<Run>>) -> Self {
        Self {
            number: 0,
            caption: caption.into(),
            head: heads.iter().map(|head| head.trim_start_matches('>').to_owned()).collect(),
            numeric: heads.iter().map(|head| head.starts_with('>')).collect(),
            rows,
            evidence: false,
        }
    }

    fn evidence(self) -> Self {
        Self { evidence: true, ..self }
    }
}

impl Section {
    fn new(level: usize, id: &str, title: &str) -> Self {
        Self { level, id: id.into(), title: title.into(), card: None, blocks: Vec::new() }
    }

    /// A chapter that begins with these words.
    fn opening(id: &str, title: &str, words: &str) -> Self {
        let mut section = Self::new(1, id, title);
        section.words(words);
        section
    }

    fn text(&mut self, runs: Vec<Run>) {
        self.blocks.push(Block::Text(runs));
    }

    fn words(&mut self, text: impl Into<String>) {
        self.text(vec![Run::plain(text)]);
    }

    fn figures(&mut self, figures: &[Figure]) {
        self.blocks.extend(figures.iter().cloned().map(Block::Figure));
    }

    /// A table; omitted without rows.
    fn table(&mut self, table: Table) {
        if !table.rows.is_empty() {
            self.blocks.push(Block::Table(table));
        }
    }
}

impl Document {
    pub(super) fn tables(&self) -> impl Iterator<Item = &Table> {
        let blocks = self.sections.iter().flat_map(|section| &section.blocks);
        blocks.filter_map(|block| match block {
            Block::Table(table) => Some(table),
            _ => None,
        })
    }
}
