use std::path::{Path, PathBuf};

use super::npy::NpyError;
use super::wanted::{COLLECTION, DISPLACEMENT, DISPLACEMENT_TABLE};
use files::counted;

/// Why an answer cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnswerError {
    #[error(
        "there is neither {DISPLACEMENT} nor {DISPLACEMENT_TABLE} in {}, nor {COLLECTION} or displacement_0000.vtu …",
        .0.display()
    )]
    Missing(PathBuf),
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error("{}: {source}", path.display())]
    Npy { path: PathBuf, source: NpyError },
    #[error("{}: shape {found:?} where {wanted:?} ({axes}) is wanted", path.display())]
    Shape { path: PathBuf, found: Vec<usize>, wanted: Vec<usize>, axes: &'static str },
    #[error("{}: {value} at level {n}, row {row}", path.display())]
    NotFinite { path: PathBuf, value: f64, n: usize, row: usize },
    /// A series that does not match the levels.
    #[error("{}: {source}", path.display())]
    Series { path: PathBuf, source: SeriesError },
    #[error("{}: {source}", path.display())]
    Vtu { path: PathBuf, source: VtuReadError },
    #[error("{}, line {line}: {reason}", path.display())]
    Row { path: PathBuf, line: u64, reason: String },
}

impl AnswerError {
    /// What becomes of an error in reading a path.
    pub(super) fn at<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Self + '_ {
        |error| Self::Unreadable { path: path.to_owned(), reason: error.to_string() }
    }
}

/// Why files are not those of the levels.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SeriesError {
    #[error("{0}")]
    Index(VtuReadError),
    #[error("DataSet {0} has no number as timestep, or no file")]
    Entry(usize),
    #[error("timestep {found} is no time of times.npy; the nearest is t_{n} = {nearest}")]
    Time { found: f64, n: usize, nearest: f64 },
    #[error(
        "two files of level {n}: {first} and {second}; write each level by one process into one file"
    )]
    Twice { n: usize, first: String, second: String },
    #[error("a file of level {n}, where the last is {last}: {file}")]
    Beyond { n: usize, last: usize, file: String },
    #[error("level {n} of 0 to {last} has no file; t_0 belongs to them")]
    Level { n: usize, last: usize },
    #[error("the file `{0}` is not below the directory of the case")]
    Outside(String),
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VtuReadError {
    #[error("{0}")]
    Unreadable(String),
    #[error("no XML that can be read: {0}")]
    Xml(String),
    #[error("{0}: write an UnstructuredGrid (.vtu), by one process")]
    Kind(String),
    /// An index of pieces; followed if it has exactly one.
    #[error(
        "a parallel file of {}: one below the directory of the case is read; write it by one process",
        counted(.0.len(), "piece")
    )]
    Pieces(Vec<String>),
    #[error("{name} `{found}` is not read: write the file with `{known}`, or without {name}")]
    Form { name: String, found: String, known: &'static str },
    /// The number of points differs from that of vertices.
    #[error(
        "{found} points where the mesh has {wanted} vertices (rows of vertices.csv): write each of them once; interpolate \
         elements of another order and discontinuous ones to the continuous element of the case first"
    )]
    Points { found: usize, wanted: usize },
    #[error("no point data `displacement` or `u`; there are: {0}")]
    NoArray(String),
    #[error("`{name}` has {found} components where {wanted} are wanted")]
    Components { name: String, found: usize, wanted: &'static str },
    #[error("`{0}` is of type Float32, seven digits, which would pass for an error: write Float64")]
    Single(String),
    /// An array of another length or kind, or that cannot be decoded.
    #[error("array `{name}`: {reason}")]
    Array { name: String, reason: String },
    #[error("{value} at point {point}")]
    NotFinite { value: f64, point: usize },
    #[error("a third component of {value} at point {point}: in the plane it is 0")]
    OutOfPlane { value: f64, point: usize },
    #[error(
        "point {point} at {at:?} is no vertex of the mesh: points are those of the body at rest, as in vertices.csv, to \
         {near:e}"
    )]
    Elsewhere { point: usize, at: [f64; 3], near: f64 },
    #[error(
        "points {first} and {point} are both vertex {vertex}: write each vertex once; interpolate discontinuous elements \
         to continuous ones first"
    )]
    Twice { first: usize, point: usize, vertex: usize },
}
