//! Output of a solver: displacements of all levels as `.npy` or `.csv`, and optionally pressures.

use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use super::bounded::{Timed, Until, most_bytes, open_bounded};
use super::error::AnswerError;
use super::npy::{NpyError, head, length, numbers};
use super::wanted::{DISPLACEMENT, DISPLACEMENT_TABLE, PRESSURE, Wanted};

/// The displacements of all levels, level by level, d numbers per vertex, from the array, or else from the table.
pub fn read_displacements(dir: &Path, wanted: &Wanted) -> Result<Vec<f64>, AnswerError> {
    read_until(dir, wanted, None)
}

/// [`read_displacements`] under a time limit.
pub(super) fn read_until(
    dir: &Path,
    wanted: &Wanted,
    until: Until,
) -> Result<Vec<f64>, AnswerError> {
    let shape = [wanted.levels, wanted.vertices, wanted.dimension];
    let [array, table] = [DISPLACEMENT, DISPLACEMENT_TABLE].map(|name| dir.join(name));
    if array.exists() {
        return read_array(array, &shape, "levels N + 1, vertices, components", until);
    }
    if !table.exists() {
        return Err(AnswerError::Missing(dir.to_owned()));
    }
    let numbers = read_table(&table, shape, until)?;
    finite(&table, &numbers, shape[0])?;
    Ok(numbers)
}

pub(super) fn read_pressures(
    dir: &Path,
    [levels, points]: [usize; 2],
    until: Until,
) -> Result<Vec<f64>, AnswerError> {
    read_array(dir.join(PRESSURE), &[levels, points], "levels N + 1, rows of contact.csv", until)
}

/// Shape and length are checked before a number is read.
fn read_array(
    path: PathBuf,
    wanted: &[usize],
    axes: &'static str,
    until: Until,
) -> Result<Vec<f64>, AnswerError> {
    let no_array = |source| AnswerError::Npy { path: path.clone(), source };
    let mut file = Timed::open(&path, until).map_err(AnswerError::at(&path))?;
    let shape = head(&mut file).map_err(no_array)?;
    if shape != wanted {
        let wanted = wanted.to_vec();
        return Err(AnswerError::Shape { path, found: shape, wanted, axes });
    }
    let bytes = length(&shape).map_err(no_array)?;
    let found = file.length.saturating_sub(file.place) as usize;
    if found != bytes {
        return Err(no_array(NpyError::Length { shape, wanted: bytes, found }));
    }
    let mut data = Vec::with_capacity(bytes);
    // The file may grow meanwhile.
    file.take(bytes as u64).read_to_end(&mut data).map_err(AnswerError::at(&path))?;
    let array = numbers(shape, &data).map_err(no_array)?;
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

/// Two counters and three numbers of 25 letters take 95 bytes; the rest is for blanks.
const BYTES_A_ROW: [u64; 2] = [1 << 12, 1 << 8];

/// Rows n, vertex, components in any order; each pair once.
fn read_table(
    path: &Path,
    [levels, vertices, d]: [usize; 3],
    until: Until,
) -> Result<Vec<f64>, AnswerError> {
    let fault =
        |line: u64, reason: String| AnswerError::Row { path: path.to_owned(), line, reason };
    let file = open_bounded(path, most_bytes(BYTES_A_ROW, levels * vertices), until)
        .map_err(AnswerError::at(path))?;
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(BufReader::new(file));
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
            let (text, name, last) = (&record[column], names[column], below.saturating_sub(1));
            text.parse()
                .ok()
                .filter(|&value: &usize| value < below)
                .ok_or_else(|| fault(line, format!("`{text}` is no {name} from 0 to {last}")))
        };
        let at = index(0, levels)? * vertices + index(1, vertices)?;
        if std::mem::replace(&mut seen[at], true) {
            return Err(fault(line, "this level and vertex occur twice".into()));
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
