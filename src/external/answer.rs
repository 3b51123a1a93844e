//! What a solver wrote: displacements of all levels, as `.npy` or `.csv`, and pressures if they were asked for.

use std::path::{Path, PathBuf};

use super::npy::{NpyError, decode};

/// The displacements, (N + 1) × vertices × d.
pub const DISPLACEMENT: &str = "displacement.npy";
/// The same as a table with columns n, vertex, ux, uy (and uz).
pub const DISPLACEMENT_TABLE: &str = "displacement.csv";
/// ξ + λ at the rows of contact.csv, (N + 1) × rows.
pub const PRESSURE: &str = "pressure.npy";

/// Why an answer cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnswerError {
    /// Nothing is there.
    #[error("there is neither {DISPLACEMENT} nor {DISPLACEMENT_TABLE} in {}", .0.display())]
    Missing(PathBuf),
    /// A file that cannot be read.
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    /// A file that is no array of doubles.
    #[error("{}: {source}", path.display())]
    Npy { path: PathBuf, source: NpyError },
    /// An array of another shape.
    #[error("{}: shape {found:?} where {wanted:?} ({axes}) is wanted", path.display())]
    Shape { path: PathBuf, found: Vec<usize>, wanted: Vec<usize>, axes: &'static str },
    /// A number that is none.
    #[error("{}: {value} at level {n}, row {row}", path.display())]
    NotFinite { path: PathBuf, value: f64, n: usize, row: usize },
    /// A row of the table that is not understood.
    #[error("{}, line {line}: {reason}", path.display())]
    Row { path: PathBuf, line: u64, reason: String },
}

/// The displacements of all levels, level by level, d numbers a vertex.
///
/// # Errors
/// [`AnswerError`].
pub fn read_displacements(dir: &Path, shape: [usize; 3]) -> Result<Vec<f64>, AnswerError> {
    let (array, table) = (dir.join(DISPLACEMENT), dir.join(DISPLACEMENT_TABLE));
    if array.exists() {
        return read_array(array, &shape, "levels N + 1, vertices, components");
    }
    if !table.exists() {
        return Err(AnswerError::Missing(dir.to_owned()));
    }
    let numbers = read_table(&table, shape)?;
    finite(&table, &numbers, shape[0])?;
    Ok(numbers)
}

/// The pressures of all levels, level by level.
///
/// # Errors
/// [`AnswerError`].
pub fn read_pressures(dir: &Path, levels: usize, points: usize) -> Result<Vec<f64>, AnswerError> {
    read_array(dir.join(PRESSURE), &[levels, points], "levels N + 1, rows of contact.csv")
}

fn read_array(
    path: PathBuf,
    wanted: &[usize],
    axes: &'static str,
) -> Result<Vec<f64>, AnswerError> {
    let unreadable = |error: std::io::Error| AnswerError::Unreadable {
        path: path.clone(),
        reason: error.to_string(),
    };
    let bytes = std::fs::read(&path).map_err(unreadable)?;
    let array = decode(&bytes).map_err(|source| AnswerError::Npy { path: path.clone(), source })?;
    if array.shape != wanted {
        let (found, wanted) = (array.shape, wanted.to_vec());
        return Err(AnswerError::Shape { path, found, wanted, axes });
    }
    finite(&path, &array.numbers, wanted[0])?;
    Ok(array.numbers)
}

fn finite(path: &Path, numbers: &[f64], levels: usize) -> Result<(), AnswerError> {
    let row = numbers.len() / levels.max(1);
    match numbers.iter().position(|number| !number.is_finite()) {
        None => Ok(()),
        Some(at) => {
            let (value, path) = (numbers[at], path.to_owned());
            Err(AnswerError::NotFinite { path, value, n: at / row, row: at % row })
        }
    }
}

/// Rows n, vertex, components in any order; each pair once.
fn read_table(path: &Path, [levels, vertices, d]: [usize; 3]) -> Result<Vec<f64>, AnswerError> {
    let fault =
        |line: u64, reason: String| AnswerError::Row { path: path.to_owned(), line, reason };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|error| fault(1, error.to_string()))?;
    let names = ["n", "vertex", "ux", "uy", "uz"];
    let header = reader.headers().map_err(|error| fault(1, error.to_string()))?;
    if header.iter().ne(names[..2 + d].iter().copied()) {
        return Err(fault(1, format!("the columns are {}", names[..2 + d].join(","))));
    }
    let mut numbers = vec![f64::NAN; levels * vertices * d];
    let mut seen = vec![false; levels * vertices];
    for record in reader.records() {
        let record = record.map_err(|error| {
            fault(error.position().map_or(0, csv::Position::line), error.to_string())
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let index = |column: usize, below: usize| {
            let text = &record[column];
            text.parse().ok().filter(|&value: &usize| value < below).ok_or_else(|| {
                fault(
                    line,
                    format!(
                        "`{text}` is no {} from 0 to {}",
                        names[column],
                        below.saturating_sub(1)
                    ),
                )
            })
        };
        let at = index(0, levels)? * vertices + index(1, vertices)?;
        if std::mem::replace(&mut seen[at], true) {
            return Err(fault(line, "this level and vertex have stood before".into()));
        }
        for c in 0..d {
            let text = &record[2 + c];
            numbers[at * d + c] =
                text.parse().map_err(|_| fault(line, format!("`{text}` is no number")))?;
        }
    }
    if let Some(at) = seen.iter().position(|seen| !seen) {
        let (n, vertex) = (at / vertices, at % vertices);
        return Err(fault(0, format!("level {n}, vertex {vertex} is missing")));
    }
    Ok(numbers)
}
