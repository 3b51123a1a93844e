//! All encodings, generated here, and damage to each.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::*;

const POINTS: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
/// A value with the bytes `<` and `_`, which are not markup in raw data.
const ODD: f64 = f64::from_bits(0x3c3c_5f26_2d5d_0a3e);
const U: [f64; 12] = [0.25, -0.5, 0.0, ODD, 1e-300, 0.0, -0.1, 0.0, 0.0, 7.0, 0.125, 0.0];

fn bytes(values: &[f64], big_endian: bool) -> Vec<u8> {
    values.iter().flat_map(|x| if big_endian { x.to_be_bytes() } else { x.to_le_bytes() }).collect()
}

fn word(value: usize, header: usize, big_endian: bool) -> Vec<u8> {
    let all = (value as u64).to_be_bytes();
    let mut word = all[8 - header..].to_vec();
    if !big_endian {
        word.reverse();
    }
    word
}

/// Blocks of 40 bytes, the last shorter.
fn packed(data: &[u8], header: usize, big_endian: bool) -> [Vec<u8>; 2] {
    let blocks: Vec<Vec<u8>> = data
        .chunks(40)
        .map(|block| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        })
        .collect();
    let sizes = [blocks.len(), 40, data.len() % 40];
    let words = sizes.into_iter().chain(blocks.iter().map(Vec::len));
    [words.flat_map(|size| word(size, header, big_endian)).collect(), blocks.concat()]
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Inline,
    Base64,
    Raw,
}

#[derive(Debug, Clone, Copy)]
struct Form {
    place: Place,
    header: usize,
    big_endian: bool,
    packed: bool,
    /// The number of bytes is encoded separately.
    alone: bool,
}

impl Form {
    fn all() -> impl Iterator<Item = Self> {
        (0..48).map(|i| Self {
            place: [Place::Inline, Place::Base64, Place::Raw][i % 3],
            header: if i / 3 % 2 == 0 { 4 } else { 8 },
            big_endian: i / 6 % 2 == 1,
            packed: i / 12 % 2 == 1,
            alone: i / 24 == 1,
        })
    }

    fn array(self, values: &[f64]) -> Vec<u8> {
        let data = bytes(values, self.big_endian);
        let [head, data] = match self.packed {
            true => packed(&data, self.header, self.big_endian),
            false => [word(data.len(), self.header, self.big_endian), data],
        };
        match self.place {
            Place::Raw => [head, data].concat(),
            _ if self.alone || self.packed => {
                [STANDARD.encode(head), STANDARD.encode(data)].concat().into_bytes()
            }
            _ => STANDARD.encode([head, data].concat()).into_bytes(),
        }
    }

    fn file(self) -> Vec<u8> {
        let arrays = [self.array(&POINTS), self.array(&U)];
        let order = if self.big_endian { "BigEndian" } else { "LittleEndian" };
        let kind = if self.header == 4 { "UInt32" } else { "UInt64" };
        let packed = if self.packed { "compressor=\"vtkZLibDataCompressor\"" } else { "" };
        let head = format!("byte_order=\"{order}\" header_type=\"{kind}\" {packed}");
        if self.place == Place::Inline {
            let texts = arrays.map(|text| format!("\n  {}\n", String::from_utf8(text).unwrap()));
            return document(&head, "format=\"binary\"", [&texts[0], &texts[1]]).into_bytes();
        }
        let mut text = document(&head, "format=\"appended\" offset=\"0\"", ["", ""]);
        let second = text.rfind("offset=\"0\"").unwrap();
        text.replace_range(second..second + 10, &format!("offset=\"{}\"", arrays[1].len()));
        let encoding = if self.place == Place::Raw { "raw" } else { "base64" };
        let end = text.find("</VTKFile>").unwrap();
        text.truncate(end);
        text += &format!("<AppendedData encoding=\"{encoding}\">\n  _");
        [text.as_bytes(), &arrays[1], &arrays[0], b"\n</AppendedData></VTKFile>"].concat()
    }
}

fn document(head: &str, format: &str, [points, u]: [&str; 2]) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<!-- a comment --><VTKFile type=\"UnstructuredGrid\" version=\"1.0\" {head}>\n\
         <UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"0\">\n\
         <PointData><DataArray type=\"Float32\" Name=\"zeta\" format=\"ascii\">no</DataArray>\
         <DataArray type=\"Float64\" Name=\"u\" NumberOfComponents=\"3\" {format}>\
         <InformationKey name=\"a\"><Value>1</Value></InformationKey>{u}</DataArray></PointData>\n\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" {format}>{points}</DataArray>\
         </Points></Piece></UnstructuredGrid></VTKFile>"
    )
}

fn plain(values: &[f64]) -> String {
    values.iter().map(|x| format!("{x:e} ")).collect()
}

fn ascii() -> String {
    document("", "format=\"ascii\"", [&plain(&POINTS), &plain(&U)])
}

fn check(file: &[u8], form: &str) {
    let found = snapshot(file, 4, 2).unwrap_or_else(|error| panic!("{form}: {error}"));
    let points: Vec<[f64; 3]> = POINTS.as_chunks().0.to_vec();
    assert_eq!(found.points, points, "{form}");
    let flat: Vec<f64> = U.chunks(3).flat_map(|u| [u[0], u[1]]).collect();
    assert_eq!(found.u, flat, "{form}");
}

#[test]
fn every_way_of_writing_numbers_is_read() {
    check(ascii().as_bytes(), "text");
    for form in Form::all() {
        check(&form.file(), &format!("{form:?}"));
    }
}

#[test]
fn a_length_or_block_that_is_wrong_is_refused_in_every_form() {
    for form in Form::all() {
        let file = form.file();
        // Four points of which one is missing, or a fifth.
        for (count, wrong) in [(3, "\"3\""), (5, "\"5\"")] {
            let at = file.windows(3).position(|window| window == b"\"4\"").unwrap();
            let mut other = file.clone();
            other[at..at + 3].copy_from_slice(wrong.as_bytes());
            assert!(
                matches!(snapshot(&other, count, 2), Err(VtuReadError::Array { .. })),
                "{form:?}"
            );
            assert_eq!(
                snapshot(&other, 4, 2),
                Err(VtuReadError::Points { found: count, wanted: 4 })
            );
        }
        let short = &file[..file.len() - 80];
        assert!(snapshot(short, 4, 2).is_err(), "{form:?}");
    }
}

fn said(text: &str, dimension: usize) -> String {
    snapshot(text.as_bytes(), 4, dimension).unwrap_err().to_string()
}

#[test]
fn other_files_are_refused_with_the_way_out() {
    let good = ascii();
    let with = |from: &str, to: &str| {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good);
        said(&text, 2)
    };
    assert!(said("n,vertex", 2).starts_with("no XML"));
    assert!(
        with("\"UnstructuredGrid\"", "\"PUnstructuredGrid\"").contains("parallel file of 0 pieces")
    );
    assert!(with("\"UnstructuredGrid\"", "\"PolyData\"").contains("type `PolyData`: write an Uns"));
    assert!(
        with("VTKFile type", "VTKFile  compressor=\"vtkLZ4DataCompressor\" type")
            .contains("write the file with `vtkZLibDataCompressor`, or without compressor")
    );
    assert!(with("Name=\"u\"", "Name=\"f\"").ends_with("there are: zeta, f"));
    assert!(with("\"Float64\" Name=\"u\"", "\"Float32\" Name=\"u\"").contains("seven digits"));
    assert!(with("NumberOfComponents=\"3\"", "").contains("`u` has 1 components where 2 or 3"));
    assert!(with("7e0", "nan").contains("NaN at point 3"));
    assert!(with("7e0", "-inf").contains("-inf at point 3"));
    assert!(with("7e0", "x").contains("array `u`: `x` is no number"));
    assert!(with("7e0", "7 7").contains("more than 12 numbers"));
    assert!(with("7e0", "").contains("11 numbers where 12 are wanted"));
    assert!(
        with("7e0 1.25e-1 0e0", "7 0.125 1e-9").contains("0.000000001 at point 3: in the plane")
    );
    assert!(said(&good.replace("format=\"ascii\"", "format=\"gzip\""), 2).contains("`gzip`"));
    // In space two components are too few.
    let plane = good.replace(
        "NumberOfComponents=\"3\" format=\"ascii\"><I",
        "NumberOfComponents=\"2\" format=\"ascii\"><I",
    );
    assert!(said(&plane, 3).contains("2 components where 3"));
}

#[test]
fn sizes_in_the_data_cost_nothing_until_they_are_known_to_be_right() {
    // A block count and block lengths near the integer limit.
    let form = Form { place: Place::Raw, header: 8, big_endian: false, packed: true, alone: false };
    let file = form.file();
    let at = file.windows(4).position(|window| window == b"\n  _").unwrap() + 4;
    for word in 0..4 {
        for value in [u64::MAX, u64::MAX / 8, 1 << 40] {
            let mut other = file.clone();
            other[at + 8 * word..at + 8 * word + 8].copy_from_slice(&value.to_le_bytes());
            assert!(matches!(snapshot(&other, 4, 2), Err(VtuReadError::Array { .. })), "{word}");
        }
    }
    // A number of points near the integer limit.
    let many = ascii().replace("NumberOfPoints=\"4\"", "NumberOfPoints=\"18446744073709551615\"");
    assert!(said(&many, 2).contains("points where the mesh has 4 vertices"));
}
