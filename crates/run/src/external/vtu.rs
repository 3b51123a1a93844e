//! Displacements in a `.vtu` file of any writer: text, base64 or raw, inline or appended, plain or packed by zlib.
//!
//! The published crates for the format take a raw byte `<` for markup and drop arrays that they cannot decode; here the
//! XML is read by one crate, base64 and zlib by others.

mod array;

use std::borrow::Cow;
use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use self::array::{Binary, numbers};
use super::bounded::{Until, is_below, most_bytes, read_bounded};
use super::error::VtuReadError;

/// Accepted names of the point data, in order of preference.
const NAMES: [&str; 2] = ["displacement", "u"];

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Snapshot {
    pub points: Vec<[f64; 3]>,
    /// d numbers per point.
    pub u: Vec<f64>,
}

/// A point and the cells around it take some 60 numbers with connectivity; as text of 25 letters each, with another 600
/// numbers of a solver's additional fields, they stay below this.
const BYTES_A_POINT: [u64; 2] = [1 << 20, 1 << 14];
/// Limit of XML elements: a piece with its arrays has a few dozen.
const MOST_NODES: u32 = 1 << 16;

/// Reads the displacement of `vertices` points in `dimension`. An index with a single piece is followed, since some
/// programs write one from one process too.
pub(crate) fn read_vtu(
    path: &Path,
    [vertices, dimension]: [usize; 2],
    until: Until,
) -> Result<Snapshot, VtuReadError> {
    let read = |path: &Path| {
        let bytes = read_bounded(path, most_bytes(BYTES_A_POINT, vertices), until)
            .map_err(VtuReadError::Unreadable)?;
        snapshot(&bytes, vertices, dimension)
    };
    match read(path) {
        Err(VtuReadError::Pieces(files)) => match &files[..] {
            [only] if is_below(only) => read(&path.with_file_name(only)),
            _ => Err(VtuReadError::Pieces(files)),
        },
        other => other,
    }
}

fn snapshot(bytes: &[u8], vertices: usize, dimension: usize) -> Result<Snapshot, VtuReadError> {
    let (text, appended) = apart(bytes)?;
    let document = xml(&text)?;
    let root = document.root_element();
    let kind = root.attribute("type").unwrap_or_default();
    if kind == "PUnstructuredGrid" {
        let pieces = root.descendants().filter(|node| node.has_tag_name("Piece"));
        let files = pieces.filter_map(|piece| piece.attribute("Source")).map(str::to_owned);
        return Err(VtuReadError::Pieces(files.collect()));
    }
    if root.tag_name().name() != "VTKFile" || kind != "UnstructuredGrid" {
        return Err(VtuReadError::Kind(format!("a file of type `{kind}`")));
    }
    let binary = binary(root, appended)?;
    let pieces: Vec<(Node<'_, '_>, usize)> = root
        .children()
        .filter(|node| node.has_tag_name("UnstructuredGrid"))
        .flat_map(|grid| grid.children().filter(|node| node.has_tag_name("Piece")))
        .map(|piece| {
            let count = piece.attribute("NumberOfPoints").and_then(|text| text.trim().parse().ok());
            Ok((piece, count.ok_or_else(|| VtuReadError::Kind("a piece without points".into()))?))
        })
        .collect::<Result<_, VtuReadError>>()?;
    let found = pieces.iter().fold(0usize, |sum, &(_, count)| sum.saturating_add(count));
    if found != vertices {
        return Err(VtuReadError::Points { found, wanted: vertices });
    }
    let mut all = Snapshot { points: Vec::new(), u: Vec::new() };
    for (piece, count) in pieces.into_iter().filter(|&(_, count)| count > 0) {
        let points = child(piece, "Points").and_then(|points| child(points, "DataArray"));
        let points = points.ok_or_else(|| VtuReadError::Kind("a piece without points".into()))?;
        let coordinates = numbers(points, &binary, 3 * count)?;
        all.points.extend(coordinates.as_chunks::<3>().0);
        all.u.extend(displacement(piece, &binary, count, dimension)?);
    }
    Ok(all)
}

/// Splits the XML from the bytes after the underscore of `AppendedData`, which need not be text.
fn apart(bytes: &[u8]) -> Result<(Cow<'_, str>, Option<&[u8]>), VtuReadError> {
    let text =
        |part| std::str::from_utf8(part).map_err(|error| VtuReadError::Xml(error.to_string()));
    const TAG: &[u8] = b"<AppendedData";
    let Some(tag) = bytes.windows(TAG.len()).position(|window| window == TAG) else {
        return Ok((Cow::Borrowed(text(bytes)?), None));
    };
    let early = || VtuReadError::Xml("the file ends early".into());
    let head = tag + bytes[tag..].iter().position(|&byte| byte == b'>').ok_or_else(early)? + 1;
    let underscore = bytes[head..].iter().position(|&byte| byte == b'_').ok_or_else(early)?;
    let document = format!("{}</AppendedData></VTKFile>", text(&bytes[..head])?);
    Ok((Cow::Owned(document), Some(&bytes[head + underscore + 1..])))
}

pub(super) fn xml(text: &str) -> Result<Document<'_>, VtuReadError> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options)
        .map_err(|error| VtuReadError::Xml(error.to_string()))
}

fn binary<'a>(root: Node<'_, '_>, appended: Option<&'a [u8]>) -> Result<Binary<'a>, VtuReadError> {
    let stated = |name: &str, usual: &str, other: &'static str| {
        let found = root.attribute(name).unwrap_or(usual);
        if found != usual && found != other {
            let (name, found) = (name.to_owned(), found.to_owned());
            return Err(VtuReadError::Form { name, found, known: other });
        }
        Ok(found == other)
    };
    let encoding = child(root, "AppendedData").and_then(|node| node.attribute("encoding"));
    Ok(Binary {
        big_endian: stated("byte_order", "LittleEndian", "BigEndian")?,
        header: if stated("header_type", "UInt32", "UInt64")? { 8 } else { 4 },
        packed: stated("compressor", "", "vtkZLibDataCompressor")?,
        appended: appended.map(|bytes| (bytes, encoding.is_none_or(|name| name == "base64"))),
    })
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// d numbers per point.
fn displacement(
    piece: Node<'_, '_>,
    binary: &Binary<'_>,
    count: usize,
    dimension: usize,
) -> Result<Vec<f64>, VtuReadError> {
    let data = child(piece, "PointData");
    let named = |node: &Node<'_, '_>| node.attribute("Name").unwrap_or_default().to_owned();
    let arrays: Vec<(String, Node<'_, '_>)> = data
        .iter()
        .flat_map(|data| data.children().filter(|node| node.has_tag_name("DataArray")))
        .map(|node| (named(&node), node))
        .collect();
    let found = NAMES.iter().find_map(|name| arrays.iter().find(|(found, _)| found == name));
    let Some((name, node)) = found else {
        let there: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
        let there = if there.is_empty() { "none".to_owned() } else { there.join(", ") };
        return Err(VtuReadError::NoArray(there));
    };
    let stated =
        node.attribute("NumberOfComponents").map_or(Some(1), |text| text.trim().parse().ok());
    let components = stated.unwrap_or(0);
    if components != 3 && components != dimension {
        let wanted = if dimension == 2 { "2 or 3" } else { "3" };
        return Err(VtuReadError::Components { name: name.clone(), found: components, wanted });
    }
    if node.attribute("type") == Some("Float32") {
        return Err(VtuReadError::Single(name.clone()));
    }
    let values = numbers(*node, binary, components * count)?;
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(VtuReadError::NotFinite { value: values[at], point: at / components });
    }
    for (point, u) in values.chunks_exact(components).enumerate() {
        if let Some(&value) = u[dimension..].iter().find(|&&value| value != 0.0) {
            return Err(VtuReadError::OutOfPlane { value, point });
        }
    }
    Ok(values.chunks_exact(components).flat_map(|u| u[..dimension].iter().copied()).collect())
}

#[cfg(test)]
mod tests;
