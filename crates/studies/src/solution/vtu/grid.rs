//! What a `.vtu` file shows, and why it could not be written.

use std::io;
use std::path::PathBuf;

/// Values at the points or in the cells of a grid.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// Name that a viewer shows.
    pub name: &'a str,
    /// Values per point or cell; two are written as three, (v_x, v_y, 0).
    pub components: usize,
    /// All values, those of one point or cell next to each other.
    pub values: &'a [f64],
}

/// A mesh of triangles, of quadratic triangles or of tetrahedra.
#[derive(Debug, Clone, Copy)]
pub struct VtuGrid<'a> {
    /// Coordinates; z = 0 in the plane.
    pub points: &'a [[f64; 3]],
    /// Vertices of all cells, as positions in `points`.
    pub cells: &'a [u32],
    /// 3 for triangles, 4 for tetrahedra, 6 for triangles with the midpoints of their edges.
    pub vertices_per_cell: usize,
}

/// Why a file could not be written.
#[derive(Debug, thiserror::Error)]
pub enum VtuError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    /// A field has no components or does not cover its points or cells, or cells are no triangles or tetrahedra of the
    /// points.
    #[error("{0}")]
    Inconsistent(String),
}
