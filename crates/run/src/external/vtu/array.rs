//! The numbers of one `DataArray`: text, base64 or raw bytes, plain or in zlib blocks.
//!
//! Source: VTK's description of its XML formats. Plain data are preceded by their number of bytes; packed ones by the
//! number of blocks, the block size, the size of the last one (0: full), and the packed size of each.

use std::borrow::Cow;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use roxmltree::Node;

use crate::external::VtuReadError;

/// Binary encoding of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Binary<'a> {
    /// Most significant byte first.
    pub big_endian: bool,
    /// Bytes of the numbers in headers: 4 or 8.
    pub header: usize,
    pub packed: bool,
    /// The bytes after the underscore of `AppendedData`, and whether they are base64.
    pub appended: Option<(&'a [u8], bool)>,
}

/// `count` numbers of the array `node`.
///
/// # Errors
/// [`VtuReadError`]: another length or kind, or data that cannot be decoded.
pub(crate) fn numbers(
    node: Node<'_, '_>,
    binary: &Binary<'_>,
    count: usize,
) -> Result<Vec<f64>, VtuReadError> {
    let name = node.attribute("Name").unwrap_or("Points");
    let fault = |reason: String| VtuReadError::Array { name: name.to_owned(), reason };
    let kind = node.attribute("type").unwrap_or_default();
    let width = match kind {
        "Float64" => 8,
        "Float32" => 4,
        other => return Err(fault(format!("numbers of type `{other}` where Float64 is wanted"))),
    };
    let texts = || node.children().filter(Node::is_text).filter_map(|text| text.text());
    let encoded = match node.attribute("format").unwrap_or("ascii") {
        "ascii" => return from_text(texts(), count).map_err(fault),
        "binary" => {
            let letters = texts().flat_map(str::bytes).filter(|byte| !byte.is_ascii_whitespace());
            Encoded::Base64(Cow::Owned(letters.collect()))
        }
        "appended" => {
            let (bytes, is_base64) =
                binary.appended.ok_or_else(|| fault("no AppendedData in the file".into()))?;
            let offset = node.attribute("offset").and_then(|text| text.trim().parse().ok());
            let bytes = offset
                .and_then(|offset: usize| bytes.get(offset..))
                .ok_or_else(|| fault("an offset beyond the end of AppendedData".into()))?;
            if is_base64 { Encoded::Base64(Cow::Borrowed(bytes)) } else { Encoded::Raw(bytes) }
        }
        other => return Err(fault(format!("format `{other}` is not read"))),
    };
    let wanted = count.checked_mul(width).ok_or_else(|| fault("too many numbers".into()))?;
    let bytes = match binary.packed {
        true => encoded.unpacked(binary, wanted),
        false => encoded.plain(binary, wanted),
    }
    .map_err(fault)?;
    Ok(match width {
        8 => bytes.as_chunks().0.iter().map(|&chunk| double(chunk, binary.big_endian)).collect(),
        _ => bytes.as_chunks().0.iter().map(|&chunk| single(chunk, binary.big_endian)).collect(),
    })
}

fn double(bytes: [u8; 8], big_endian: bool) -> f64 {
    if big_endian { f64::from_be_bytes(bytes) } else { f64::from_le_bytes(bytes) }
}

fn single(bytes: [u8; 4], big_endian: bool) -> f64 {
    f64::from(if big_endian { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) })
}

fn from_text<'a>(texts: impl Iterator<Item = &'a str>, count: usize) -> Result<Vec<f64>, String> {
    let mut numbers = Vec::with_capacity(count);
    for word in texts.flat_map(str::split_ascii_whitespace) {
        if numbers.len() == count {
            return Err(format!("more than {count} numbers"));
        }
        numbers.push(word.parse().map_err(|_| format!("`{word}` is no number"))?);
    }
    match numbers.len() {
        found if found < count => Err(format!("{found} numbers where {count} are wanted")),
        _ => Ok(numbers),
    }
}

enum Encoded<'a> {
    Raw(&'a [u8]),
    Base64(Cow<'a, [u8]>),
}

/// Length of `bytes` bytes in base64.
fn letters(bytes: usize) -> Option<usize> {
    bytes.div_ceil(3).checked_mul(4)
}

impl Encoded<'_> {
    /// `bytes` bytes from `at`, and their end; positions count letters in base64.
    fn get(&self, at: usize, bytes: usize) -> Result<(Cow<'_, [u8]>, usize), String> {
        let ended = || "the data end early".to_owned();
        let part = |all: &'_ [u8], length: Option<usize>| {
            let end = length.and_then(|length| at.checked_add(length)).ok_or_else(ended)?;
            if end <= all.len() { Ok(end) } else { Err(ended()) }
        };
        match self {
            Self::Raw(all) => {
                let end = part(all, Some(bytes))?;
                Ok((Cow::Borrowed(&all[at..end]), end))
            }
            Self::Base64(all) => {
                let end = part(all, letters(bytes))?;
                let mut decoded = STANDARD
                    .decode(&all[at..end])
                    .map_err(|error| format!("the base64 text cannot be decoded: {error}"))?;
                if decoded.len() < bytes {
                    return Err(ended());
                }
                decoded.truncate(bytes);
                Ok((Cow::Owned(decoded), end))
            }
        }
    }

    fn plain(&self, binary: &Binary<'_>, wanted: usize) -> Result<Vec<u8>, String> {
        let header = binary.header;
        let (first, end) = self.get(0, header)?;
        let found = whole(&first, binary.big_endian);
        if found != wanted as u64 {
            return Err(format!("{found} bytes where {wanted} are wanted"));
        }
        // Writers encode the length separately, which ends in padding, or together with the data.
        match self {
            Self::Base64(all) if all[end - 1] != b'=' => {
                let together = header.checked_add(wanted).ok_or("too many numbers")?;
                Ok(self.get(0, together)?.0[header..].to_vec())
            }
            _ => Ok(self.get(end, wanted)?.0.into_owned()),
        }
    }

    fn unpacked(&self, binary: &Binary<'_>, wanted: usize) -> Result<Vec<u8>, String> {
        let (first, _) = self.get(0, binary.header)?;
        let blocks = whole(&first, binary.big_endian);
        // Each block holds at least one byte.
        let blocks = usize::try_from(blocks).ok().filter(|&blocks| blocks <= wanted);
        let blocks = blocks.ok_or("more blocks than bytes are wanted")?;
        let header = blocks.checked_add(3).and_then(|words| words.checked_mul(binary.header));
        let (sizes, start) = self.get(0, header.ok_or("too many blocks")?)?;
        let sizes: Vec<u64> = sizes
            .chunks_exact(binary.header)
            .map(|bytes| whole(bytes, binary.big_endian))
            .collect();
        let (full, last) = (sizes[1], if sizes[2] == 0 { sizes[1] } else { sizes[2] });
        let total = (blocks as u64)
            .checked_sub(1)
            .map_or(Some(0), |before| before.checked_mul(full)?.checked_add(last));
        if total != Some(wanted as u64) {
            return Err(format!("blocks of another length than the {wanted} bytes wanted"));
        }
        let packed = sizes[3..].iter().try_fold(0u64, |sum, &size| sum.checked_add(size));
        let packed = packed.and_then(|sum| usize::try_from(sum).ok()).ok_or("too long blocks")?;
        let (data, _) = self.get(start, packed)?;
        let mut at = 0;
        let mut out = Vec::with_capacity(wanted);
        for (i, &size) in sizes[3..].iter().enumerate() {
            let end = at + size as usize;
            let length = if i + 1 == blocks { last } else { full };
            let before = out.len();
            let unpacked = ZlibDecoder::new(&data[at..end]).take(length + 1).read_to_end(&mut out);
            let sound = unpacked.is_ok() && (out.len() - before) as u64 == length;
            if !sound {
                return Err(format!("block {i} cannot be unpacked"));
            }
            at = end;
        }
        Ok(out)
    }
}

/// An integer of 4 or 8 bytes.
fn whole(bytes: &[u8], big_endian: bool) -> u64 {
    let sum = |sum: u64, &byte: &u8| (sum << 8) | u64::from(byte);
    if big_endian { bytes.iter().fold(0, sum) } else { bytes.iter().rev().fold(0, sum) }
}
