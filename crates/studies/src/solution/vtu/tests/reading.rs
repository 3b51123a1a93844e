//! Reads a file back: with vtkio, or one array of it by its declared offset.

use vtkio::model::{Attribute, Attributes, CellType, DataSet, Piece, VertexNumbers};

/// What vtkio finds in a file.
pub struct ReadBack {
    pub points: Vec<f64>,
    pub connectivity: Vec<u64>,
    pub offsets: Vec<u64>,
    pub types: Vec<CellType>,
    pub attributes: Attributes,
}

/// Reads the bytes of a file with vtkio.
pub fn read(bytes: &[u8]) -> Result<ReadBack, String> {
    let vtk = vtkio::Vtk::parse_xml(bytes).map_err(|error| error.to_string())?;
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else {
        return Err("kind".into());
    };
    let [Piece::Inline(piece)] = &pieces[..] else {
        return Err("pieces".into());
    };
    let points = piece.points.clone().into_vec().ok_or("points are no f64")?;
    match piece.cells.cell_verts.clone() {
        VertexNumbers::XML { connectivity, offsets } => {
            let (types, attributes) = (piece.cells.types.clone(), piece.data.clone());
            Ok(ReadBack { points, connectivity, offsets, types, attributes })
        }
        VertexNumbers::Legacy { .. } => Err("legacy cells".into()),
    }
}

/// The values and the number of components of the attribute `name`.
pub fn attribute(attributes: &[Attribute], name: &str) -> Option<(Vec<f64>, u32)> {
    attributes.iter().find_map(|attribute| match attribute {
        Attribute::DataArray(array) if array.name == name => {
            Some((array.data.clone().into_vec()?, array.num_comp() as u32))
        }
        _ => None,
    })
}

/// The bytes of the array `name`, found by its declared offset and its byte count.
pub fn block<'a>(file: &'a [u8], name: &str) -> &'a [u8] {
    let start = file.windows(2).position(|pair| pair == b"\n_").expect("appended data") + 2;
    let head = std::str::from_utf8(&file[..start]).expect("text before the data");
    let (_, declared) = head.split_once(&format!("Name=\"{name}\"")).expect("declared");
    let (_, offset) = declared.split_once("offset=\"").expect("offset");
    let (offset, _) = offset.split_once('"').expect("number");
    let at = start + offset.parse::<usize>().expect("number");
    let count = u64::from_le_bytes(file[at..at + 8].try_into().expect("eight bytes"));
    &file[at + 8..at + 8 + count as usize]
}

/// The numbers of an array.
pub fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("eight"))).collect()
}
