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
    /// A field has no components, or does not cover its points or cells.
    #[error("field `{name}`: {found} values, expected {count} × {components}")]
    FieldLength {
        name: String,
        /// Number of points or cells.
        count: usize,
        /// Values per point or cell.
        components: usize,
        /// Number of values given.
        found: usize,
    },
    #[error(
        "cells of {0} vertices are neither triangles (3, or 6 with midpoints) nor tetrahedra (4)"
    )]
    CellShape(usize),
    #[error("{found} cell vertices are no multiple of {vertices_per_cell}")]
    IncompleteCell {
        /// 3, 4 or 6.
        vertices_per_cell: usize,
        /// Number of entries in `cells`.
        found: usize,
    },
    /// A cell names a point that does not exist.
    #[error("a cell has vertex {vertex}, but there are {points} points")]
    UnknownVertex {
        vertex: u32,
        /// Number of points.
        points: usize,
    },
}
