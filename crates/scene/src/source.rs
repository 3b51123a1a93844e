//! The text of a scene file, its path and hash.

use super::reading::by_distance;
use super::validated::Scene;
use codespan_reporting::diagnostic::{Diagnostic, Label};
use codespan_reporting::files::SimpleFile;
use codespan_reporting::term;
use codespan_reporting::term::{Chars, Config};
use files::{FileError, fnv_1a, read_file_up_to};
use std::collections::BTreeMap;
use std::fmt;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use thiserror::Error;

const LARGEST_FILE: u64 = 1 << 20;

/// A scene file as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    pub path: PathBuf,
    pub text: String,
    /// 64-bit FNV-1a hash of the text and then the mesh file, 16 hexadecimal digits; identical on every machine.
    pub hash: String,
    /// The text of the mesh file that the scene names.
    pub mesh: Option<String>,
    /// Searched first for a mesh file: files inside the program.
    pub(crate) beside: Inside,
}

/// Files inside the program: names and texts.
pub type Inside = &'static [(&'static str, &'static str)];

impl Source {
    /// A text that did not come from a file; `path` is for messages.
    pub fn from_text(path: impl Into<PathBuf>, text: impl Into<String>) -> Source {
        let text = text.into();
        let hash = hash(&[&text]);
        Source { path: path.into(), text, hash, mesh: None, beside: &[] }
    }

    /// Adds the text of the mesh file, which enters the hash.
    #[must_use]
    pub fn with_mesh(self, mesh: String) -> Source {
        Source { hash: hash(&[&self.text, &mesh]), mesh: Some(mesh), ..self }
    }

    /// Reads a file of at most 1 MiB of UTF-8.
    ///
    /// # Errors
    /// The file is missing or unreadable, too large, or not UTF-8 (the first wrong byte is named).
    pub(crate) fn read(path: &Path) -> Result<Source> {
        let read = read_file_up_to(path, LARGEST_FILE);
        let bytes = read.map_err(|FileError { path, source }| match source.kind() {
            ErrorKind::FileTooLarge => SceneError::TooLarge { path },
            _ => SceneError::Unreadable { path, reason: source.to_string() },
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let (bytes, at) = (error.as_bytes(), error.utf8_error().valid_up_to());
            let message = format!("byte 0x{:02x} is not UTF-8", bytes[at]);
            let readable = Source::from_text(path, String::from_utf8_lossy(bytes));
            SceneError::at(&readable, at..at + 1, message, "save the file as UTF-8 text")
        })?;
        Ok(Source::from_text(path, text))
    }
}

fn hash(texts: &[&str]) -> String {
    format!("{:016x}", fnv_1a(texts.iter().flat_map(|text| text.bytes())))
}

// Errors in a scene file: place, reason and the way out.

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
    #[error("no scene is called `{name}` {}\n  = {way_out}", place(folder))]
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
        message: impl ToString,
        hint: impl ToString,
    ) -> SceneError {
        SceneError::Text(Box::new(TextFault {
            path: source.path.clone(),
            text: source.text.clone(),
            span: clamp(&source.text, span),
            message: message.to_string(),
            notes: Vec::new(),
            hint: hint.to_string(),
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

// The scenes of a folder or inside a program, found by name; any other scene, by path.

/// Depth of the search in subfolders.
const DEEPEST: usize = 8;

/// Folder shown in messages for files inside the program.
const INSIDE: &str = "<sweep>";

pub(super) fn place(folder: &Path) -> String {
    if folder == Path::new(INSIDE) {
        return "inside the program".into();
    }
    format!("under {}", folder.display())
}

/// Scene files by name.
#[derive(Debug, Clone)]
pub struct Registry {
    folder: PathBuf,
    files: BTreeMap<String, PathBuf>,
    /// Texts in place of files; empty for a folder.
    inside: Inside,
}

impl Registry {
    /// Lists the TOML files below a folder without reading them.
    ///
    /// # Errors
    /// The folder cannot be read, or two files have one name.
    pub fn open(folder: &Path) -> Result<Registry> {
        let (folder, files) = (folder.to_path_buf(), BTreeMap::new());
        let mut registry = Registry { folder, files, inside: &[] };
        registry.enter(&registry.folder.clone(), DEEPEST)?;
        Ok(registry)
    }

    /// The scenes among texts inside the program, with their meshes.
    pub fn inside(texts: Inside) -> Registry {
        let folder = PathBuf::from(INSIDE);
        let scenes = texts.iter().filter(|(name, _)| name.ends_with(".toml"));
        let files = scenes.map(|(name, _)| (stem(Path::new(name)), folder.join(name))).collect();
        Registry { folder, files, inside: texts }
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// The file of a scene given by name, or by a path, which has a `/` or ends in `.toml`.
    ///
    /// # Errors
    /// No scene has that name; the nearest names are given.
    pub(crate) fn find(&self, scene: &str) -> Result<PathBuf> {
        if let Some(path) = self.files.get(scene) {
            return Ok(path.clone());
        }
        if scene.contains('/') || scene.ends_with(".toml") {
            return Ok(PathBuf::from(scene));
        }
        Err(self.unknown(scene))
    }

    /// Reads a scene given by name or by path.
    ///
    /// # Errors
    /// The scene is unknown or invalid, or a file of the folder holds a scene of another name.
    pub fn load(&self, scene: &str) -> Result<Scene> {
        let path = self.find(scene)?;
        let below = path.strip_prefix(&self.folder).ok();
        let mut inside = self.inside.iter();
        let loaded = match inside.find(|(name, _)| below == Some(Path::new(name))) {
            Some((_, text)) => Scene::from_source(Source {
                beside: self.inside,
                ..Source::from_text(&path, *text)
            })?,
            None => Scene::read(&path)?,
        };
        let expected = stem(&path);
        let other = self.files.contains_key(scene) && loaded.name != expected;
        let message = format!("the scene is called `{}`, its file `{expected}.toml`", loaded.name);
        let hint = format!("write name = \"{expected}\", or rename the file");
        loaded.refuse_if(other, "scene.name", message, hint).map(|()| loaded)
    }

    fn unknown(&self, name: &str) -> SceneError {
        let near = by_distance(name, self.names()).into_iter().take(3);
        let near: Vec<String> = near.map(|name| format!("`{name}`")).collect();
        let way_out = if !near.is_empty() {
            format!("did you mean {}?", near.join(" or "))
        } else if self.files.is_empty() {
            "the folder holds no scene; give the path of a TOML file".to_string()
        } else {
            let known = self.names().collect::<Vec<_>>().join(", ");
            format!("known: {known}; or give the path of a TOML file")
        };
        SceneError::Unknown { name: name.to_string(), folder: self.folder.clone(), way_out }
    }

    fn enter(&mut self, folder: &Path, deeper: usize) -> Result<()> {
        let unreadable = |error: std::io::Error| SceneError::Unreadable {
            path: folder.to_path_buf(),
            reason: error.to_string(),
        };
        let mut paths = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(unreadable)? {
            paths.push(entry.map_err(unreadable)?.path());
        }
        paths.sort();
        for path in paths {
            if path.is_dir() && deeper > 0 {
                self.enter(&path, deeper - 1)?;
            } else if path.extension().is_some_and(|ending| ending == "toml") {
                let name = stem(&path);
                if let Some(first) = self.files.insert(name.clone(), path.clone()) {
                    return Err(SceneError::Duplicate { name, first, second: path });
                }
            }
        }
        Ok(())
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
