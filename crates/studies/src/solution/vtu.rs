//! VTK files: a grid with its fields as `.vtu` (XML `UnstructuredGrid`, appended raw binary data)
//! and a `.pvd` index of time steps.
//!
//! The appended part is an underscore, then for each array its length in bytes (`u64`) and its values, everything little
//! endian. Offsets in the XML count from behind the underscore.

use std::path::Path;

use files::{FileError, replace_file};
use report::escaped;

/// Numbers at points or in cells, `components` each.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    pub name: &'a str,
    pub components: usize,
    pub values: &'a [f64],
}

/// Points, and cells by their points: triangles of 3, or 6 with midpoints, or tetrahedra of 4.
#[derive(Debug, Clone, Copy)]
pub struct VtuGrid<'a> {
    pub points: &'a [[f64; 3]],
    pub cells: &'a [u32],
    pub vertices_per_cell: usize,
}

/// Writes `grid` with its fields to `path`, replacing the file as a whole. Values need not be
/// finite: NaN and ±∞ are kept bit by bit, and viewers leave such points or cells blank.
///
/// # Errors
/// What the file system reports.
pub fn write_vtu(
    path: &Path,
    grid: &VtuGrid<'_>,
    point_fields: &[Field<'_>],
    cell_fields: &[Field<'_>],
) -> Result<(), FileError> {
    let (points, a_cell) = (grid.points.len(), grid.vertices_per_cell);
    let cells = grid.cells.len() / a_cell;
    let kind: u8 = match a_cell {
        3 => 5,
        4 => 10,
        _ => 22,
    };
    let mut arrays = Appended::default();
    arrays.section("PointData", |arrays| point_fields.iter().for_each(|field| arrays.field(field)));
    arrays.section("CellData", |arrays| cell_fields.iter().for_each(|field| arrays.field(field)));
    arrays.section("Points", |arrays| {
        arrays.array("Float64", "Points", 3, grid.points.iter().flatten().map(|x| x.to_le_bytes()));
    });
    arrays.section("Cells", |arrays| {
        let vertices = grid.cells.iter().map(|&vertex| i64::from(vertex).to_le_bytes());
        arrays.array("Int64", "connectivity", 1, vertices);
        let ends = (1..=cells).map(|cell| ((cell * a_cell) as u64).to_le_bytes());
        arrays.array("Int64", "offsets", 1, ends);
        arrays.array("UInt8", "types", 1, (0..cells).map(|_| [kind]));
    });
    let declarations = &arrays.declarations;
    let head = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n  <UnstructuredGrid>\n    \
         <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n{declarations}    \
         </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_"
    );
    let end = b"\n  </AppendedData>\n</VTKFile>\n";
    replace_file(path, &[head.as_bytes(), &arrays.bytes, end].concat())
}

/// Writes the index of a time series: for each step its time and the `.vtu` file, relative to the
/// folder of `path`. Times are written with all their digits.
///
/// # Errors
/// What the file system reports.
pub fn write_pvd(path: &Path, steps: &[(f64, String)]) -> Result<(), FileError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n",
    );
    for (time, file) in steps {
        let file = escape(file);
        text += &format!("    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
    }
    text += "  </Collection>\n</VTKFile>\n";
    replace_file(path, text.as_bytes())
}

/// The XML declarations of the arrays, and the bytes that they point to.
#[derive(Default)]
struct Appended {
    declarations: String,
    bytes: Vec<u8>,
}

impl Appended {
    /// An XML element that groups arrays.
    fn section(&mut self, element: &str, arrays: impl FnOnce(&mut Self)) {
        self.declarations += &format!("      <{element}>\n");
        arrays(self);
        self.declarations += &format!("      </{element}>\n");
    }

    /// Declares an array and appends its values, with their number of bytes in front.
    fn array<const BYTES: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: impl Iterator<Item = [u8; BYTES]>,
    ) {
        let offset = self.bytes.len();
        let name = escape(name);
        // One is the default, and readers make a flat array of it only if it is not stated.
        let shape = match components {
            1 => String::new(),
            components => format!(" NumberOfComponents=\"{components}\""),
        };
        self.declarations += &format!(
            "        <DataArray type=\"{kind}\" Name=\"{name}\"{shape} \
             format=\"appended\" offset=\"{offset}\"/>\n"
        );
        let start = offset + size_of::<u64>();
        self.bytes.resize(start, 0);
        values.for_each(|value| self.bytes.extend_from_slice(&value));
        let length = (self.bytes.len() - start) as u64;
        self.bytes[offset..start].copy_from_slice(&length.to_le_bytes());
    }

    /// Plane vectors get a third component, which viewers expect.
    fn field(&mut self, &Field { name, components, values }: &Field<'_>) {
        let written = if components == 2 { 3 } else { components };
        let padding = std::iter::repeat_n(0.0, written - components);
        let padded = values
            .chunks_exact(components)
            .flat_map(|value| value.iter().copied().chain(padding.clone()));
        self.array("Float64", name, written, padded.map(f64::to_le_bytes));
    }
}

/// XML, without control characters.
fn escape(text: &str) -> String {
    escaped(&text.replace(char::is_control, " "))
}

#[cfg(test)]
mod tests;
