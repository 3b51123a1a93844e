//! Errors in a scene file: place, reason and the way out.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use codespan_reporting::diagnostic::{Diagnostic, Label};
use codespan_reporting::files::SimpleFile;
use codespan_reporting::term::{self, Chars, Config};
use thiserror::Error;

use super::source::Source;

/// What a scene, or a part of one, is read as.
pub type Result<T, E = SceneError> = std::result::Result<T, E>;

/// Why a scene could not be read. Every message names the file and the way out.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SceneError {
    /// A fault in the text, to be underlined.
    #[error("{0}")]
    Text(Box<TextFault>),
    #[error("cannot read {}: {reason}\n  = give the path of a TOML file or the name of a scene (`sweep list` prints them)", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error(
        "{} is empty\n  = a scene has the parts [scene], [domain], [time], [material], and [exact] or [loads]\n  = start from a shipped one: `sweep list affine --text > mine.toml` (exact solution), or punch (loads)",
        path.display()
    )]
    Empty { path: PathBuf },
    #[error("{} is larger than 1 MiB\n  = a scene is a few kilobytes of TOML: is this the right file?", path.display())]
    TooLarge { path: PathBuf },
    #[error("{}:{line}:{column}: byte 0x{byte:02x} is not UTF-8\n  = save the file as UTF-8 text", path.display())]
    NotUtf8 { path: PathBuf, line: usize, column: usize, byte: u8 },
    #[error("no scene is called `{name}` {}\n  = {way_out}", super::registry::place(folder))]
    Unknown { name: String, folder: PathBuf, way_out: String },
    #[error(
        "two scenes are called `{name}`: {} and {}\n  = rename one of them: records are kept by name",
        first.display(),
        second.display()
    )]
    Duplicate { name: String, first: PathBuf, second: PathBuf },
}

impl SceneError {
    /// An error at `span` (bytes) of the text; `hint` is the way out.
    pub(crate) fn at(
        source: &Source,
        span: Range<usize>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> SceneError {
        SceneError::Text(Box::new(TextFault {
            path: source.path.clone(),
            text: source.text.clone(),
            span: clamp(&source.text, span),
            message: message.into(),
            notes: Vec::new(),
            hint: hint.into(),
        }))
    }
}

/// One fault in the text of a scene; `Display` shows file:line:column, the text underlined, notes and hint.
#[derive(Debug, Clone, PartialEq)]
pub struct TextFault {
    pub path: PathBuf,
    pub text: String,
    /// Bytes of `text` at fault, on character boundaries.
    pub span: Range<usize>,
    pub message: String,
    /// Printed before the way out.
    pub notes: Vec<String>,
    pub hint: String,
}

impl TextFault {
    /// Line of the fault, from 1.
    pub fn line(&self) -> usize {
        1 + self.text[..self.span.start].matches('\n').count()
    }

    /// Column of the fault, from 1, in characters.
    pub fn column(&self) -> usize {
        let before = &self.text[..self.span.start];
        1 + before.chars().rev().take_while(|&c| c != '\n').count()
    }
}

impl fmt::Display for TextFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = SimpleFile::new(self.path.display().to_string(), &self.text);
        let mut notes = self.notes.clone();
        notes.push(self.hint.clone());
        let diagnostic = Diagnostic::error()
            .with_message(&self.message)
            .with_label(Label::primary((), self.span.clone()))
            .with_notes(notes);
        let config = Config { chars: Chars::ascii(), ..Config::default() };
        let rendered = term::emit_into_string(&config, &file, &diagnostic)
            .unwrap_or_else(|_| self.message.clone());
        f.write_str(rendered.trim_end())
    }
}

/// Restricts `span` to the text, widened to character boundaries.
fn clamp(text: &str, span: Range<usize>) -> Range<usize> {
    let start = text.floor_char_boundary(span.start.min(text.len()));
    let end = text.ceil_char_boundary(span.end.clamp(start, text.len()));
    start..end
}
