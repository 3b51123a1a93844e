//! VTK files: a grid with its fields as `.vtu` (XML `UnstructuredGrid`, appended raw binary data)
//! and a `.pvd` index of time steps.

mod appended;
mod grid;

use std::path::Path;

use self::appended::{Appended, escape};
pub use self::grid::{Field, VtuError, VtuGrid};
use files::replace_file;

/// Writes `grid` with its fields to `path`, replacing the file as a whole. Values need not be
/// finite: NaN and ±∞ are kept bit by bit, and viewers leave such points or cells blank.
///
/// # Errors
/// A grid or field of inconsistent lengths, before anything is written; or what the file system
/// reports.
pub fn write_vtu(
    path: &Path,
    grid: &VtuGrid<'_>,
    point_fields: &[Field<'_>],
    cell_fields: &[Field<'_>],
) -> Result<(), VtuError> {
    let cell_type = cell_type(grid)?;
    let cells = grid.cells.len() / grid.vertices_per_cell;
    let mut arrays = Appended::default();
    arrays.open("PointData");
    arrays.fields(point_fields, grid.points.len())?;
    arrays.close("PointData");
    arrays.open("CellData");
    arrays.fields(cell_fields, cells)?;
    arrays.close("CellData");
    arrays.open("Points");
    arrays.array("Float64", "Points", 3, grid.points.iter().flatten().map(|x| x.to_le_bytes()));
    arrays.close("Points");
    arrays.open("Cells");
    let vertices = grid.cells.iter().map(|&vertex| i64::from(vertex).to_le_bytes());
    arrays.array("Int64", "connectivity", 1, vertices);
    let ends = (1..=cells).map(|cell| ((cell * grid.vertices_per_cell) as u64).to_le_bytes());
    arrays.array("Int64", "offsets", 1, ends);
    arrays.array("UInt8", "types", 1, (0..cells).map(|_| [cell_type]));
    arrays.close("Cells");
    replace(path, &arrays.document(grid.points.len(), cells))
}

/// Writes the index of a time series: for each step its time and the `.vtu` file, relative to the
/// folder of `path`. Times are written with all their digits.
///
/// # Errors
/// What the file system reports.
pub fn write_pvd(path: &Path, steps: &[(f64, String)]) -> Result<(), VtuError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n",
    );
    for (time, file) in steps {
        let file = escape(file);
        text += &format!("    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n");
    }
    text += "  </Collection>\n</VTKFile>\n";
    replace(path, text.as_bytes())
}

/// The VTK number of the grid's cells, once its indices are known to be sound.
fn cell_type(grid: &VtuGrid<'_>) -> Result<u8, VtuError> {
    let fault = |text: String| Err(VtuError::Inconsistent(text));
    let (a_cell, found, points) = (grid.vertices_per_cell, grid.cells.len(), grid.points.len());
    let cell_type = match a_cell {
        3 => 5,
        4 => 10,
        6 => 22,
        other => {
            return fault(format!(
                "cells of {other} vertices are neither triangles (3, or 6 with midpoints) nor tetrahedra (4)"
            ));
        }
    };
    if !found.is_multiple_of(a_cell) {
        return fault(format!("{found} cell vertices are no multiple of {a_cell}"));
    }
    match grid.cells.iter().find(|&&vertex| vertex as usize >= points) {
        Some(vertex) => fault(format!("a cell has vertex {vertex}, but there are {points} points")),
        None => Ok(cell_type),
    }
}

fn replace(path: &Path, bytes: &[u8]) -> Result<(), VtuError> {
    replace_file(path, bytes).map_err(|source| VtuError::Io { path: path.to_owned(), source })
}

#[cfg(test)]
mod tests;
