//! The document of a study: text of its command, a file beside its numbers, and a section of a report.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::number::{precise, text};
use super::{Block, Figure, Run, Table, Tone, terminal};
use crate::ReportError;
use crate::pictures::names;
use files::{read_text, replace_file};

/// The chapter of a study; they stand in this order in a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Chapter {
    /// The step-size bound (3.4).
    Bound,
    /// Gronwall's inequality (3.24).
    Gronwall,
    /// The proofs of Theorems 10 and 11.
    Audit,
    Trade,
    /// Which term is at fault.
    Diagnose,
    /// Ladders of extreme parameters.
    Extremes,
}

// The last one tells how many there are: a chapter that is not in the list does not compile.
const _: () = assert!(Chapter::ALL.len() == Chapter::Extremes as usize + 1);

impl Chapter {
    pub(crate) const ALL: [Self; 6] =
        [Self::Bound, Self::Gronwall, Self::Audit, Self::Trade, Self::Diagnose, Self::Extremes];

    /// Its name in files and links.
    pub(crate) fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Its command, and what may fail in it.
    fn about(self) -> [&'static str; 2] {
        match self {
            Self::Bound => ["bound SCENE", "(3.4)"],
            Self::Gronwall => ["gronwall SCENE", "Gronwall's inequality"],
            Self::Audit => ["audit SCENE", "the inequalities of the proof"],
            Self::Trade => ["trade SCENE", "trade"],
            Self::Diagnose => ["diagnose SCENE", "which term is at fault"],
            Self::Extremes => ["extremes", "extremes"],
        }
    }

    pub(crate) fn command(self) -> &'static str {
        self.about()[0]
    }

    /// What may fail in it, for a sentence.
    pub(crate) fn subject(self) -> &'static str {
        self.about()[1]
    }

    /// The chapter of a file, by its name.
    fn of_file(name: &str) -> Option<Self> {
        let stem = name.strip_suffix(ENDING)?;
        serde_json::from_value(stem.rsplit('-').next()?.into()).ok()
    }
}

/// Longer tables count as evidence; the study's files have the numbers.
const MOST_ROWS: usize = 40;

/// Ending of document files.
const ENDING: &str = ".document.json";

/// What a study says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyDocument {
    pub chapter: Chapter,
    /// None if it concerns no single scene.
    pub scene: Option<String>,
    /// Fingerprint of the scene's text.
    pub fingerprint: Option<String>,
    pub title: String,
    /// Whether everything is as it should be.
    pub holds: bool,
    /// The k at which Λ stops contracting, for the table of all scenes.
    pub threshold: Option<String>,
    pub(crate) blocks: Vec<Block>,
}

/// A row of a table: each cell with the head of its column, which begins with `>` where the column holds numbers.
pub type Row<'a, const N: usize> = [(&'a str, Run); N];

impl StudyDocument {
    /// A study that has said nothing yet.
    pub fn new(chapter: Chapter, title: impl Into<String>) -> Self {
        Self {
            chapter,
            scene: None,
            fingerprint: None,
            title: title.into(),
            holds: true,
            threshold: None,
            blocks: Vec::new(),
        }
    }

    /// For a scene whose text has this fingerprint.
    pub fn of_scene(self, scene: &str, fingerprint: &str) -> Self {
        Self { scene: Some(scene.into()), fingerprint: Some(fingerprint.into()), ..self }
    }

    /// Prefix of file names: SCENE-bound, or extremes.
    pub fn stem(&self) -> String {
        let chapter = self.chapter.name();
        match &self.scene {
            Some(scene) => format!("{scene}-{chapter}"),
            None => chapter,
        }
    }

    /// A paragraph.
    pub fn words(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(vec![Run::plain(text)]));
    }

    /// The first paragraph: the answer to the question.
    pub fn answer(&mut self, text: impl Into<String>) {
        self.blocks.insert(0, Block::Text(vec![Run::plain(text)]));
    }

    /// A table; omitted without rows.
    pub fn table<'a, const N: usize>(
        &mut self,
        caption: impl Into<String>,
        rows: impl IntoIterator<Item = Row<'a, N>>,
    ) {
        let mut heads = [""; N];
        let row = |row: Row<'a, N>| {
            heads = row.each_ref().map(|(head, _)| *head);
            row.map(|(_, cell)| cell).into()
        };
        let rows: Vec<Vec<Run>> = rows.into_iter().map(row).collect();
        self.set(caption, &heads, rows);
    }

    /// A table of rows of JSON. A column is its head, the place of its value in a row, and its digits if they are not five:
    /// `head = a/b 3; …`.
    pub fn rows(&mut self, caption: impl Into<String>, rows: &Value, columns: &str) {
        let column = |column: &'_ str| -> (String, String, usize) {
            let (head, place) = column.split_once(" = ").unwrap_or((column, ""));
            let (place, digits) = place.trim().split_once(' ').unwrap_or((place.trim(), "5"));
            (head.trim().into(), format!("/{place}"), digits.parse().unwrap_or(5))
        };
        let columns: Vec<_> = columns.split(';').map(column).collect();
        let heads: Vec<&str> = columns.iter().map(|(head, ..)| &**head).collect();
        let cell = |value: Option<&Value>, digits| match value {
            Some(value @ (Value::String(_) | Value::Bool(_))) => Run::plain(text(value)),
            Some(value) if value.is_u64() => Run::plain(text(value)),
            value => precise(value.and_then(Value::as_f64), digits),
        };
        let row = |row: &Value| -> Vec<Run> {
            columns.iter().map(|(_, place, digits)| cell(row.pointer(place), *digits)).collect()
        };
        let rows = rows.as_array().into_iter().flatten().map(row).collect();
        self.set(caption, &heads, rows);
    }

    fn set(&mut self, caption: impl Into<String>, heads: &[&str], rows: Vec<Vec<Run>>) {
        if !rows.is_empty() {
            let evidence = rows.len() > MOST_ROWS;
            let table = Table { evidence, ..Table::new(caption, heads, rows) };
            self.blocks.push(Block::Table(table));
        }
    }

    /// A picture, if any; `rest` is its file name without `SCENE-` and ending.
    pub fn figure(&mut self, rest: &str, caption: &str, svg: Option<String>) {
        let Some(svg) = svg else { return };
        let scene = self.scene.as_ref();
        let file = scene.map_or(format!("{rest}.svg"), |scene| format!("{scene}-{rest}.svg"));
        let caption = scene.map_or(caption.into(), |scene| format!("{scene}: {caption}"));
        self.blocks.push(Block::Figure(Figure::new(file, caption, svg)));
    }

    /// Lines to be typed.
    pub fn code(&mut self, lines: String) {
        self.blocks.push(Block::Code(lines));
    }

    /// The verdict: `all` if it holds, else each failure.
    pub fn verdict(&mut self, holds: bool, all: &str, failures: Vec<String>) {
        self.holds &= holds;
        if holds {
            return self.blocks.push(Block::Text(vec![Run::of(all, Tone::Pass)]));
        }
        let silent = vec!["nothing was compared".to_owned()];
        for failure in if failures.is_empty() { silent } else { failures } {
            let head = Run::of("Does not hold: ", Tone::Miss);
            self.blocks.push(Block::Text(vec![head, Run::plain(failure)]));
        }
    }

    /// Default width.
    pub const WIDTH: u16 = 132;

    /// The study on a terminal of so many columns.
    pub fn text(&self, width: u16) -> String {
        terminal::text(&self.title, &self.blocks, width)
    }

    /// Writes the document and its pictures into a directory.
    pub fn write(&self, dir: &Path) -> Result<(), ReportError> {
        let put = |name: String, text: &str| replace_file(&dir.join(name), text.as_bytes());
        for block in &self.blocks {
            if let Block::Figure(figure) = block {
                put(figure.file.clone(), &figure.svg)?;
            }
        }
        let text = serde_json::json!(self);
        Ok(put(format!("{}{ENDING}", self.stem()), &format!("{text:#}\n"))?)
    }

    /// The studies in a directory, in the order of file names.
    ///
    /// # Errors
    /// A file that cannot be read, or is not the document of a study.
    pub(crate) fn read_all(dir: &Path) -> Result<Vec<Self>, ReportError> {
        let names = names(dir)?;
        let mut found = Vec::new();
        for (name, chapter) in names.iter().filter_map(|name| Some((name, Chapter::of_file(name)?)))
        {
            let path = dir.join(name);
            let text = read_text(&path)?;
            let refused = |line: usize, reason: String| ReportError::Study {
                path: path.clone(),
                line,
                reason,
                command: chapter.command().into(),
            };
            let mut study: Self = serde_json::from_str(&text)
                .map_err(|error| refused(error.line(), without_place(&error.to_string())))?;
            let torn = |block: &Block| matches!(block, Block::Table(table) if !table.is_whole());
            if study.chapter != chapter || study.blocks.iter().any(torn) {
                let reason = "not what its name says, or a table with rows of several lengths";
                return Err(refused(1, reason.into()));
            }
            study.blocks.retain_mut(|block| match block {
                Block::Figure(figure) => figure.read(dir),
                _ => true,
            });
            found.push(study);
        }
        Ok(found)
    }
}

impl Figure {
    /// Reads the picture beside its document; false if it is missing or not a picture.
    fn read(&mut self, dir: &Path) -> bool {
        // Only names within the directory are followed.
        let is_plain_name =
            Path::new(&self.file).file_name().is_some_and(|name| name == &*self.file);
        self.svg = read_text(&dir.join(&self.file)).unwrap_or_default();
        is_plain_name && self.svg.trim_start().starts_with("<svg")
    }
}

/// The parser's message without " at line … column …", which precedes it.
fn without_place(message: &str) -> String {
    message.rsplit_once(" at line ").map_or(message, |(what, _)| what).to_owned()
}
