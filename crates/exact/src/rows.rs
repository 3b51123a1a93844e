//! Meshes of triangles in rows: squares cut alike, in columns and rows of any widths.

use std::ops::Range;

use fem::mesh::Mesh;

/// Triangles of a square.
pub const HALVES: usize = 2;

/// Corners of a triangle.
pub const CORNERS: usize = 3;

/// A mesh whose triangles come row by row, and in a row square by square: the abscissae of their corners depend on the
/// column and the half of the square, the ordinates on the row and the half.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows {
    pub columns: usize,
    pub rows: usize,
    /// Of each half the abscissae of its corners in each column.
    pub x: [Vec<[f64; CORNERS]>; HALVES],
    /// Of each half the ordinates of its corners in each row.
    pub y: [Vec<[f64; CORNERS]>; HALVES],
}

/// How far the area of a cell may be from half of its square, relative to that: rounding.
const SAME_AREA: f64 = 1e-9;

impl Rows {
    /// Cells of a row.
    pub(crate) fn length(&self) -> usize {
        HALVES * self.columns
    }

    /// Some of the rows alone.
    pub(crate) fn some(&self, rows: Range<usize>) -> Self {
        let y = self.y.each_ref().map(|y| y[rows.clone()].to_vec());
        Self { columns: self.columns, rows: rows.len(), x: self.x.clone(), y }
    }

    /// The rows of a mesh; none if it has none.
    pub(crate) fn of(mesh: &Mesh) -> Option<Self> {
        let cells = mesh.cell_count();
        if mesh.dimension != 2 || cells < HALVES {
            return None;
        }
        let along = |c: usize, axis: usize| -> [f64; CORNERS] {
            std::array::from_fn(|a| mesh.vertex(mesh.cell(c)[a])[axis])
        };
        let first = along(0, 0);
        let again = (HALVES..cells).step_by(HALVES).find(|&c| along(c, 0) == first);
        let length = again.unwrap_or(cells);
        if !cells.is_multiple_of(length) || !length.is_multiple_of(HALVES) {
            return None;
        }
        let (columns, rows) = (length / HALVES, cells / length);
        let x = [0, 1].map(|o| (0..columns).map(|i| along(HALVES * i + o, 0)).collect::<Vec<_>>());
        let y = [0, 1].map(|o| (0..rows).map(|j| along(length * j + o, 1)).collect::<Vec<_>>());
        let found = Self { columns, rows, x, y };
        let fits = |c: usize| {
            let (j, i, o) = (c / length, c % length / HALVES, c % HALVES);
            let area = 0.5 * width(&found.x[o][i]) * width(&found.y[o][j]);
            let [p, q, r] = [0, 1, 2].map(|a| mesh.vertex(mesh.cell(c)[a]));
            let twice = (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
            along(c, 0) == found.x[o][i]
                && along(c, 1) == found.y[o][j]
                && (0.5 * twice - area).abs() <= SAME_AREA * area
        };
        (0..cells).all(fits).then_some(found)
    }
}

/// The length that the corners of a half cover along an axis.
pub(crate) fn width(corners: &[f64; CORNERS]) -> f64 {
    let [a, b, c] = *corners;
    a.max(b).max(c) - a.min(b).min(c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::{Family, rectangle};

    #[test]
    fn structured_meshes_have_rows_and_others_none() {
        let mut mesh = rectangle([2.0, 1.0], 3, Family::Structured);
        let rows = Rows::of(&mesh).expect("rows");
        assert_eq!(HALVES * rows.columns * rows.rows, mesh.cell_count());
        for c in 0..mesh.cell_count() {
            let (o, square) = (c % HALVES, c / HALVES);
            let (i, j) = (square % rows.columns, square / rows.columns);
            for (a, &vertex) in mesh.cell(c).iter().enumerate() {
                let [x, y] = [rows.x[o][i][a], rows.y[o][j][a]];
                assert_eq!(mesh.vertex(vertex)[..2], [x, y], "cell {c}");
            }
        }
        let family = Family::Perturbed { amplitude: 0.2, seed: 5, axes: [true; 3] };
        assert_eq!(Rows::of(&rectangle([2.0, 1.0], 3, family)), None);
        // One cell turned, one out of its place.
        mesh.cells.swap(6, 7);
        assert_eq!(Rows::of(&mesh), None);
        mesh.cells.swap(6, 7);
        (0..3).for_each(|a| mesh.cells.swap(6 + a, 9 + a));
        assert_eq!(Rows::of(&mesh), None);
    }
}
