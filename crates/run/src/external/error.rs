use std::path::{Path, PathBuf};

use super::npy::NpyError;
use super::wanted::{DISPLACEMENT, DISPLACEMENT_TABLE};

/// Why an answer cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnswerError {
    #[error("there is neither {DISPLACEMENT} nor {DISPLACEMENT_TABLE} in {}", .0.display())]
    Missing(PathBuf),
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error("{}: {source}", path.display())]
    Npy { path: PathBuf, source: NpyError },
    #[error("{}: shape {found:?} where {wanted:?} ({axes}) is wanted", path.display())]
    Shape { path: PathBuf, found: Vec<usize>, wanted: Vec<usize>, axes: &'static str },
    #[error("{}: {value} at level {n}, row {row}", path.display())]
    NotFinite { path: PathBuf, value: f64, n: usize, row: usize },
    #[error("{}, line {line}: {reason}", path.display())]
    Row { path: PathBuf, line: u64, reason: String },
}

impl AnswerError {
    /// What becomes of an error in reading a path.
    pub(super) fn at<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Self + '_ {
        |error| Self::Unreadable { path: path.to_owned(), reason: error.to_string() }
    }
}
