//! Output of a solver: displacements of all levels as `.npy` or `.csv`, and optionally pressures.

use super::process::{Timed, Until};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// The displacements of all levels, level by level, d numbers per vertex, from the array, or else from the table; `shape` is
/// N + 1, the vertices of the mesh, further nodes included, and d.
pub fn read_displacements(
    dir: &Path,
    shape: [usize; 3],
    until: Until,
) -> Result<Vec<f64>, AnswerError> {
    let [levels, vertices, d] = shape;
    let [array, path] = [DISPLACEMENT, DISPLACEMENT_TABLE].map(|name| dir.join(name));
    if array.exists() {
        return read_array(array, &shape, "levels N + 1, vertices, components", until);
    }
    if !path.exists() {
        return Err(AnswerError::Missing(dir.to_owned()));
    }
    // Rows n, vertex, components in any order; each pair once.
    let fault = |line: u64, reason: String| AnswerError::Row { path: path.clone(), line, reason };
    let file = Timed::open(&path, until).map_err(AnswerError::at(&path))?;
    let [first, each] = BYTES_A_ROW;
    let most = first.saturating_add(each.saturating_mul((levels * vertices) as u64));
    if file.length > most {
        let reason = format!("{} bytes, but at most {most} can be needed", file.length);
        return Err(AnswerError::at(&path)(reason));
    }
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
            text.parse().ok().filter(|&value: &usize| value < below).ok_or_else(|| {
                fault(line, format!("`{text}` is no {name} from 0 to {last}, counted from 0"))
            })
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
        let reason = format!("level {n}, vertex {vertex} is missing");
        return Err(AnswerError::Unreadable { path: path.clone(), reason });
    }
    Ok(numbers)
}

/// Shape and length are checked before a number is read; `axes` are those of the shape.
pub(super) fn read_array(
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
    numbers(shape, &data).map(|array| array.numbers).map_err(no_array)
}

/// Two counters and three numbers of 25 letters take 95 bytes; the rest is for blanks.
const BYTES_A_ROW: [u64; 2] = [1 << 12, 1 << 8];

// NumPy's `.npy` files: arrays of doubles in C order.  Source: NumPy enhancement proposal 1, "A simple file format
// for NumPy arrays". The published crates include a parser of Python literals for the header, of which three keys
// are needed here.

/// An array of doubles.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub shape: Vec<usize>,
    /// The last axis fastest.
    pub numbers: Vec<f64>,
}

/// What makes a file no array of doubles.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NpyError {
    #[error("no .npy file: write it with numpy.save")]
    Magic,
    /// A version of the format after 3.
    #[error("version {0} of the .npy format is not read")]
    Version(u8),
    /// The header ends early, or a key is missing or invalid.
    #[error("the header of the .npy file has no {0} that is understood")]
    Header(&'static str),
    #[error("numbers of type `{0}`: save little-endian doubles, numpy.asarray(u, dtype='<f8')")]
    Kind(String),
    #[error("an array in Fortran order: save numpy.ascontiguousarray(u)")]
    Order,
    #[error("shape {shape:?} wants {wanted} bytes, {found} follow the header")]
    Length { shape: Vec<usize>, wanted: usize, found: usize },
}

const MAGIC: &[u8] = b"\x93NUMPY";
/// Alignment of the data in a file.
const ALIGNED: usize = 64;
/// Longest header that NumPy reads.
const LONGEST: u32 = 10_000;

/// Encodes a file, version 1.0.
pub fn encode(shape: &[usize], numbers: &[f64]) -> Vec<u8> {
    assert_eq!(shape.iter().product::<usize>(), numbers.len(), "an array has its shape");
    let axes: String = shape.iter().map(|length| format!("{length},")).collect();
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({axes}), }}");
    let before = MAGIC.len() + 2 + 2;
    let padded = (before + header.len() + 1).next_multiple_of(ALIGNED) - before;
    header.extend(std::iter::repeat_n(' ', padded - 1 - header.len()));
    header.push('\n');
    let mut bytes = Vec::with_capacity(before + header.len() + 8 * numbers.len());
    bytes.extend(MAGIC);
    bytes.extend([1, 0]);
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

/// Decodes a file.
pub fn decode(bytes: &[u8]) -> Result<Array, NpyError> {
    let mut rest = bytes;
    let shape = head(&mut rest)?;
    numbers(shape, rest)
}

/// Reads the header of a file; returns the shape.
pub(crate) fn head(file: &mut impl Read) -> Result<Vec<usize>, NpyError> {
    let mut magic = [0; MAGIC.len()];
    file.read_exact(&mut magic).map_err(|_| NpyError::Magic)?;
    if magic != MAGIC {
        return Err(NpyError::Magic);
    }
    let [major, _] = part(file, NpyError::Header("version"))?;
    let ended = NpyError::Header("length");
    let length = match major {
        1 => u32::from(u16::from_le_bytes(part(file, ended)?)),
        2 | 3 => u32::from_le_bytes(part(file, ended)?),
        other => return Err(NpyError::Version(other)),
    };
    if length > LONGEST {
        return Err(NpyError::Header("length"));
    }
    let mut header = vec![0; length as usize];
    file.read_exact(&mut header).map_err(|_| NpyError::Header("end"))?;
    let header = std::str::from_utf8(&header).map_err(|_| NpyError::Header("text"))?;
    let kind = value(header, "descr").ok_or(NpyError::Header("descr"))?;
    let kind = kind.split(['\'', '"']).nth(1).ok_or(NpyError::Header("descr"))?;
    if kind != "<f8" {
        return Err(NpyError::Kind(kind.to_owned()));
    }
    let order = value(header, "fortran_order").ok_or(NpyError::Header("fortran_order"))?;
    let shape = shape(header).ok_or(NpyError::Header("shape"))?;
    if !order.starts_with("False") && shape.len() > 1 {
        return Err(NpyError::Order);
    }
    Ok(shape)
}

fn part<const BYTES: usize>(
    file: &mut impl Read,
    ended: NpyError,
) -> Result<[u8; BYTES], NpyError> {
    let mut bytes = [0; BYTES];
    file.read_exact(&mut bytes).map_err(|_| ended)?;
    Ok(bytes)
}

/// Bytes of an array of this shape.
///
/// # Errors
/// [`NpyError::Header`] if there are too many to count.
pub(crate) fn length(shape: &[usize]) -> Result<usize, NpyError> {
    let count = shape.iter().try_fold(8usize, |product, &axis| product.checked_mul(axis));
    count.ok_or(NpyError::Header("shape"))
}

/// The array of a shape from the bytes behind the header.
pub(crate) fn numbers(shape: Vec<usize>, data: &[u8]) -> Result<Array, NpyError> {
    let wanted = length(&shape)?;
    if wanted != data.len() {
        return Err(NpyError::Length { shape, wanted, found: data.len() });
    }
    let (chunks, _) = data.as_chunks::<8>();
    Ok(Array { shape, numbers: chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect() })
}

/// The text after `'key':` in the header.
fn value<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let quoted = ['\'', '"'].iter().find_map(|quote| {
        let name = format!("{quote}{key}{quote}");
        header.find(&name).map(|at| at + name.len())
    })?;
    header[quoted..].trim_start().strip_prefix(':').map(str::trim_start)
}

fn shape(header: &str) -> Option<Vec<usize>> {
    let inner = value(header, "shape")?.strip_prefix('(')?.split(')').next()?;
    let axes = inner.split(',').map(str::trim).filter(|axis| !axis.is_empty());
    axes.map(|axis| axis.parse().ok()).collect()
}

//

/// Why an answer cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AnswerError {
    #[error("there is neither {DISPLACEMENT} nor {DISPLACEMENT_TABLE} in {}, the last argument of the command", .0.display())]
    Missing(PathBuf),
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    #[error("{}: {source}", path.display())]
    Npy { path: PathBuf, source: NpyError },
    #[error("{}: shape {found:?} where {wanted:?} ({axes}) is wanted", path.display())]
    Shape { path: PathBuf, found: Vec<usize>, wanted: Vec<usize>, axes: &'static str },
    #[error("{}, line {line}: {reason}", path.display())]
    Row { path: PathBuf, line: u64, reason: String },
}

impl AnswerError {
    /// What becomes of an error in reading a path.
    pub(super) fn at<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> Self + '_ {
        |error| Self::Unreadable { path: path.to_owned(), reason: error.to_string() }
    }
}

// The names of its files.

/// (N + 1) × vertices × d.
pub(crate) const DISPLACEMENT: &str = "displacement.npy";
/// A table with columns n, vertex, ux, uy (and uz).
pub(crate) const DISPLACEMENT_TABLE: &str = "displacement.csv";
/// ξ + λ at the rows of contact.csv, (N + 1) × rows.
pub(crate) const PRESSURE: &str = "pressure.npy";
#[cfg(test)]
mod tests {
    use super::*;

    /// As `numpy.save` writes numpy.arange(6.0).reshape(1, 3, 2), byte for byte.
    #[test]
    fn a_file_of_numpy_is_read_and_written() {
        let mut bytes =
            b"\x93NUMPY\x01\x00v\x00{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3, 2), }"
                .to_vec();
        bytes.resize(127, b' ');
        bytes.push(b'\n');
        bytes.extend((0..6).flat_map(|i| f64::from(i).to_le_bytes()));
        let array = decode(&bytes).unwrap();
        assert_eq!((array.shape.clone(), array.numbers[5]), (vec![1, 3, 2], 5.0));
        let encoded = encode(&array.shape, &array.numbers);
        assert_eq!(encoded.len(), bytes.len());
        assert_eq!(decode(&encoded).unwrap(), array);
        assert_eq!(decode(&encode(&[0, 2], &[])).unwrap().shape, [0, 2]);
        assert_eq!(decode(&encode(&[3], &[1.0, -0.0, f64::MAX])).unwrap().numbers.len(), 3);
    }

    #[test]
    fn other_files_are_refused_with_the_way_out() {
        let good = encode(&[2, 2], &[1.0; 4]);
        let with = |from: &str, to: &str| {
            let text: String = good.iter().map(|&b| char::from(b)).collect();
            let edited = text.replace(from, to);
            assert_ne!(edited, text);
            decode(&edited.chars().map(|c| c as u8).collect::<Vec<u8>>()).unwrap_err()
        };
        assert_eq!(decode(b"n,x\n0,1\n"), Err(NpyError::Magic));
        assert_eq!(with("'<f8'", "'<f4'"), NpyError::Kind("<f4".into()));
        assert_eq!(with("False", "True "), NpyError::Order);
        assert_eq!(with("(2,2,)", "(2,-2)"), NpyError::Header("shape"));
        assert_eq!(with("descr", "dtype"), NpyError::Header("descr"));
        let ends = NpyError::Length { shape: vec![2, 2], wanted: 32, found: 31 };
        assert_eq!(decode(&good[..good.len() - 1]), Err(ends));
        assert_eq!(decode(&good[..20]), Err(NpyError::Header("end")));
        assert_eq!(with("(2,2,)", "(9999999999999,9999999999)"), NpyError::Header("shape"));
    }
}
