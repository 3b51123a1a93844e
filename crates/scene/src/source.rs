//! The text of a scene file, its path and hash.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::diagnostic::{Result, SceneError};
use files::{FileError, fnv_1a, read_file_up_to};

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
        let bytes = read_file_up_to(path, LARGEST_FILE).map_err(unread)?;
        match String::from_utf8(bytes) {
            Ok(text) => Ok(Source::from_text(path, text)),
            Err(error) => Err(not_utf8(path, &error)),
        }
    }
}

fn unread(FileError { path, source }: FileError) -> SceneError {
    match source.kind() {
        ErrorKind::FileTooLarge => SceneError::TooLarge { path },
        _ => SceneError::Unreadable { path, reason: source.to_string() },
    }
}

fn not_utf8(path: &Path, error: &std::string::FromUtf8Error) -> SceneError {
    let bytes = error.as_bytes();
    let valid = &bytes[..error.utf8_error().valid_up_to()];
    let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
    let line_start = valid.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    let column = 1 + String::from_utf8_lossy(&valid[line_start..]).chars().count();
    SceneError::NotUtf8 { path: path.to_path_buf(), line, column, byte: bytes[valid.len()] }
}

fn hash(texts: &[&str]) -> String {
    format!("{:016x}", fnv_1a(texts.iter().flat_map(|text| text.bytes())))
}

#[cfg(test)]
mod tests {
    use super::Source;

    /// Records of different meshes must differ.
    #[test]
    fn the_mesh_is_part_of_the_hash() {
        let of = |mesh: &str| Source::from_text("a.toml", "text").with_mesh(mesh.into()).hash;
        let plain = Source::from_text("a.toml", "text").hash;
        assert!(of("one") == of("one") && of("one") != of("two") && of("one") != plain);
    }
}
