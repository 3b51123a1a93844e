//! What a study says: the text of its command, a file beside its numbers, and a section of a report.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Block, Figure, Run, Table, Tone, terminal};
use crate::ReportError;
use files::{read_text, replace_file};

/// The chapter of a report to which a study belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Chapter {
    /// The step-size bound (3.4).
    Bound,
    /// Gronwall's inequality (3.24).
    Gronwall,
    /// The proofs of Theorems 10 and 11.
    Audit,
    /// What runs say of the claims of the paper.
    Ledger,
    /// Speed against accuracy.
    Trade,
    /// Ladders of extreme parameters.
    Extremes,
}

impl Chapter {
    /// How file names and links call it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Bound => "bound",
            Self::Gronwall => "gronwall",
            Self::Audit => "audit",
            Self::Ledger => "ledger",
            Self::Trade => "trade",
            Self::Extremes => "extremes",
        }
    }

    /// The command that makes such a study.
    pub(crate) fn command(self) -> &'static str {
        match self {
            Self::Bound => "bound SCENE",
            Self::Gronwall => "gronwall SCENE",
            Self::Audit => "audit SCENE",
            Self::Ledger => "audit --ledger",
            Self::Trade => "trade SCENE",
            Self::Extremes => "extremes",
        }
    }

    /// The chapter of a file, by its name.
    fn of_file(name: &str) -> Option<Self> {
        let all =
            [Self::Bound, Self::Gronwall, Self::Audit, Self::Ledger, Self::Trade, Self::Extremes];
        let stem = name.strip_suffix(ENDING)?;
        let last = stem.rsplit('-').next()?;
        all.into_iter().find(|chapter| chapter.name() == last)
    }
}

/// A longer table is for those who look something up; the files of the study have its numbers.
const MOST_ROWS: usize = 40;

/// Files with documents of studies end so.
const ENDING: &str = ".document.json";

/// What a study says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyDocument {
    /// The chapter where it belongs.
    pub chapter: Chapter,
    /// Its scene, where it is about one.
    pub scene: Option<String>,
    /// The fingerprint of the scene's text.
    pub fingerprint: Option<String>,
    /// Its title.
    pub title: String,
    /// Whether everything is as it should be.
    pub holds: bool,
    /// The k at which Λ stops contracting, for the table of all scenes.
    pub threshold: Option<String>,
    pub(crate) blocks: Vec<Block>,
}

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

    /// Of a scene whose text has this fingerprint.
    pub fn of_scene(self, scene: &str, fingerprint: &str) -> Self {
        Self { scene: Some(scene.into()), fingerprint: Some(fingerprint.into()), ..self }
    }

    /// File names begin so: SCENE-bound, or extremes.
    pub fn stem(&self) -> String {
        let chapter = self.chapter.name();
        self.scene.as_ref().map_or(chapter.into(), |scene| format!("{scene}-{chapter}"))
    }

    /// A paragraph.
    pub fn words(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(vec![Run::plain(text)]));
    }

    /// A paragraph before all others: the answer to what was asked.
    pub fn answer(&mut self, text: impl Into<String>) {
        self.blocks.insert(0, Block::Text(vec![Run::plain(text)]));
    }

    /// A paragraph below the answer: what bears it out.
    pub fn below_answer(&mut self, text: impl Into<String>) {
        self.blocks.insert(1.min(self.blocks.len()), Block::Text(vec![Run::plain(text)]));
    }

    /// A table, where it has rows. Heads of columns whose numbers end at the right begin with `>`.
    pub fn table(&mut self, caption: impl Into<String>, heads: &[&str], rows: Vec<Vec<Run>>) {
        if !rows.is_empty() {
            let evidence = rows.len() > MOST_ROWS;
            let table = Table { evidence, ..Table::new(caption, heads, rows) };
            self.blocks.push(Block::Table(table));
        }
    }

    /// A picture, where there is one: `SCENE-` and the rest of its file name, without ending.
    pub fn figure(&mut self, rest: &str, caption: &str, svg: Option<String>) {
        let Some(svg) = svg else { return };
        let scene = self.scene.as_ref();
        let file = scene.map_or(format!("{rest}.svg"), |scene| format!("{scene}-{rest}.svg"));
        let caption = scene.map_or(caption.into(), |scene| format!("{scene}: {caption}"));
        self.blocks.push(Block::Figure(Figure::new((file, caption, svg))));
    }

    /// Lines to be typed.
    pub fn code(&mut self, lines: String) {
        self.blocks.push(Block::Code(lines));
    }

    /// The verdict: what holds in words, or each failure.
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

    /// Columns of its text where nothing else is known.
    pub const WIDTH: u16 = 132;

    /// The study on a terminal of so many columns.
    pub fn text(&self, width: u16) -> String {
        terminal::text(&self.title, &self.blocks, width)
    }

    /// Writes the document and its pictures into a directory.
    ///
    /// # Errors
    /// The file system's.
    pub fn write(&self, dir: &Path) -> Result<(), ReportError> {
        let put = |name: String, text: &str| {
            let path = dir.join(name);
            replace_file(&path, text.as_bytes()).map_err(|source| ReportError::Io { path, source })
        };
        for block in &self.blocks {
            if let Block::Figure(figure) = block {
                put(figure.file.clone(), &figure.svg)?;
            }
        }
        let text = serde_json::json!(self);
        put(format!("{}{ENDING}", self.stem()), &format!("{text:#}\n"))
    }

    /// The studies in a directory, in the order of file names.
    ///
    /// # Errors
    /// A file that cannot be read, and one that is no document of a study.
    pub(crate) fn read_all(dir: &Path) -> Result<Vec<Self>, ReportError> {
        let failed = |path: &Path, source| ReportError::Io { path: path.into(), source };
        let mut names: Vec<String> = Vec::new();
        for entry in fs::read_dir(dir).map_err(|source| failed(dir, source))? {
            let name = entry.map_err(|source| failed(dir, source))?.file_name();
            names.extend(name.into_string().ok());
        }
        names.sort();
        let mut found = Vec::new();
        for (name, chapter) in names.iter().filter_map(|name| Some((name, Chapter::of_file(name)?)))
        {
            let path = dir.join(name);
            let text = read_text(&path).map_err(|source| failed(&path, source))?;
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
    /// Reads the picture beside its document; false where it is no longer there, or no picture.
    fn read(&mut self, dir: &Path) -> bool {
        // A name that leads out of the directory is not one of ours.
        let own = Path::new(&self.file).file_name().is_some_and(|name| name == &*self.file);
        let svg: io::Result<String> = read_text(&dir.join(&self.file));
        self.svg = svg.unwrap_or_default();
        own && self.svg.trim_start().starts_with("<svg")
    }
}

/// The message of the parser without " at line … column …", which stands before it.
fn without_place(message: &str) -> String {
    message.rsplit_once(" at line ").map_or(message, |(what, _)| what).to_owned()
}
