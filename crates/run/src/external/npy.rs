//! NumPy's `.npy` files: arrays of doubles in C order.
//!
//! Source: NumPy enhancement proposal 1, "A simple file format for NumPy arrays". The published crates include a parser
//! of Python literals for the header, of which three keys are needed here.

use std::io::Read;

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
