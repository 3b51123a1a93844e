//! Reads a file back by what it declares: XML before the data, each array at its offset. That another program reads the
//! files is a test of the Python package, with meshio.

use std::collections::BTreeMap;

/// An array: the element it stands in, its numbers per point or cell, its bytes.
pub struct Array<'a> {
    pub of: String,
    pub components: usize,
    pub bytes: &'a [u8],
}

/// What is in a file.
pub struct ReadBack<'a> {
    pub points: usize,
    pub cells: usize,
    pub arrays: BTreeMap<String, Array<'a>>,
}

/// Arrays have the length that is declared, follow each other and fill the data; anything else is refused.
pub fn read(file: &[u8]) -> Result<ReadBack<'_>, String> {
    let start = file.windows(2).position(|pair| pair == b"\n_").ok_or("no data")? + 2;
    let head = std::str::from_utf8(&file[..start]).map_err(|error| error.to_string())?;
    let (declared, _) = head.split_once("<AppendedData").ok_or("no data declared")?;
    let text = format!("{declared}</VTKFile>");
    let document = roxmltree::Document::parse(&text).map_err(|error| error.to_string())?;
    let number = |node: roxmltree::Node<'_, '_>, name: &str| -> Result<usize, String> {
        node.attribute(name).and_then(|text| text.parse().ok()).ok_or(format!("no {name}"))
    };
    let piece = document.descendants().find(|node| node.has_tag_name("Piece")).ok_or("no piece")?;
    let (points, cells) = (number(piece, "NumberOfPoints")?, number(piece, "NumberOfCells")?);
    let (mut at, mut arrays) = (start, BTreeMap::new());
    for node in piece.descendants().filter(|node| node.has_tag_name("DataArray")) {
        let name = node.attribute("Name").ok_or("no name")?.to_owned();
        let of = node.parent_element().ok_or("no parent")?.tag_name().name().to_owned();
        let components = number(node, "NumberOfComponents").unwrap_or(1);
        if start + number(node, "offset")? != at {
            return Err(format!("{name} does not follow the array before it"));
        }
        let count = file.get(at..at + 8).ok_or("no byte count")?;
        let count = u64::from_le_bytes(count.try_into().map_err(|_| "eight bytes")?) as usize;
        let bytes = file.get(at + 8..at + 8 + count).ok_or(format!("{name} is cut off"))?;
        let size = if node.attribute("type") == Some("UInt8") { 1 } else { 8 };
        let tuples = if of == "Points" || of == "PointData" { points } else { cells };
        if name != "connectivity" && count != tuples * components * size {
            return Err(format!("{name} has {count} bytes"));
        }
        at += 8 + count;
        arrays.insert(name, Array { of, components, bytes });
    }
    let ends = file[at..] == *b"\n  </AppendedData>\n</VTKFile>\n";
    if ends { Ok(ReadBack { points, cells, arrays }) } else { Err("bytes of no array".into()) }
}

/// Floating-point numbers.
pub fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("eight"))).collect()
}

/// Whole numbers.
pub fn integers(bytes: &[u8]) -> Vec<i64> {
    bytes.chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().expect("eight"))).collect()
}
