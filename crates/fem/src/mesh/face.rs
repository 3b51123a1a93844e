//! Plane pieces of the boundary of a domain.

use super::Piece;
use super::geometry::{cross, dot, minus, norm};

/// Distance below which corners are one, over the longest edge.
const SAME_PLACE: f64 = 1e-9;

/// A plane piece of a side: a segment, a rectangle of a box, or a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Outward unit normal, padded with zeros.
    pub normal: [f64; 3],
    /// One of its corners.
    pub corner: [f64; 3],
    /// The one or two edges from the corner; at right angles for a rectangle.
    pub edges: Vec<[f64; 3]>,
    /// Whether it is half of the parallelogram spanned by the edges.
    pub triangle: bool,
}

impl Face {
    /// A side of the box from the origin with this size: x = 0, x = size\[0\], y = 0, and so on.
    pub fn of_box(size: &[f64], side: u32) -> Self {
        let (axis, far) = (side as usize / 2, side % 2 == 1);
        let mut face = Self::whole(size);
        face.normal[axis] = if far { 1.0 } else { -1.0 };
        face.corner[axis] = if far { size[axis] } else { 0.0 };
        face.edges.remove(axis);
        face
    }

    /// All of a rectangle or box, for its points.
    pub fn whole(size: &[f64]) -> Self {
        let edge = |a: usize| [0, 1, 2].map(|i| if i == a { size[a] } else { 0.0 });
        let edges = (0..size.len()).map(edge).collect();
        Self { normal: [0.0; 3], corner: [0.0; 3], edges, triangle: false }
    }

    /// A segment or triangle of the boundary.
    pub fn simplex(piece: &Piece) -> Self {
        let (corner, others) = (piece.corners[0], &piece.corners[1..]);
        let edges: Vec<[f64; 3]> = others.iter().map(|end| minus(*end, corner)).collect();
        Self { normal: piece.normal, corner, triangle: edges.len() == 2, edges }
    }

    /// Its corners.
    pub fn corners(&self) -> Vec<[f64; 3]> {
        self.points(1)
    }

    /// Whether a place is one of its corners, but for rounding.
    pub fn has_corner(&self, p: [f64; 3]) -> bool {
        let near = |q: [f64; 3]| norm(minus(p, q)) <= SAME_PLACE * self.longest();
        self.corners().into_iter().any(near)
    }

    /// The lengths of its edges from the corner.
    pub fn lengths(&self) -> Vec<f64> {
        self.edges.iter().map(|&edge| norm(edge)).collect()
    }

    /// The longest edge, including that across a triangle.
    pub fn longest(&self) -> f64 {
        let across = match (&self.edges[..], self.triangle) {
            ([a, b], true) => norm(minus(*a, *b)),
            _ => 0.0,
        };
        self.lengths().into_iter().fold(across, f64::max)
    }

    /// Length or area.
    pub fn measure(&self) -> f64 {
        match (&self.edges[..], self.triangle) {
            ([a, b], true) => 0.5 * norm(cross(*a, *b)),
            _ => self.lengths().into_iter().product(),
        }
    }

    /// Unit vectors in the piece: along each axis of a segment or rectangle; for a triangle along its first edge and
    /// across it.
    pub fn tangents(&self) -> Vec<[f64; 3]> {
        let unit = |edge: [f64; 3]| edge.map(|e| e / norm(edge));
        let mut tangents: Vec<[f64; 3]> = self.edges.iter().map(|&edge| unit(edge)).collect();
        if self.triangle {
            let (first, second) = (tangents[0], self.edges[1]);
            let along = dot(first, second);
            tangents[1] = unit([0, 1, 2].map(|i| second[i] - along * first[i]));
        }
        tangents
    }

    /// A grid with `intervals` steps along each edge, ends included; the first edge varies fastest, and a triangle has
    /// the points with i + j ≤ `intervals`.
    pub fn points(&self, intervals: u32) -> Vec<[f64; 3]> {
        self.grid(intervals).into_iter().map(|(_, point)| point).collect()
    }

    /// These points with their steps (i, j) along the edges; those of a box have a third one.
    pub fn grid(&self, intervals: u32) -> Vec<([u32; 3], [f64; 3])> {
        let start = vec![([0; 3], self.corner)];
        let grid = self.edges.iter().enumerate().fold(start, |points, (axis, edge)| {
            (0..=intervals)
                .flat_map(|i| {
                    let step = edge.map(|e| e * f64::from(i) / f64::from(intervals));
                    points.iter().map(move |(at, p)| {
                        let mut at = *at;
                        at[axis] = i;
                        (at, [p[0] + step[0], p[1] + step[1], p[2] + step[2]])
                    })
                })
                .collect()
        });
        let inside = |at: &[u32; 3]| !self.triangle || at[0] + at[1] <= intervals;
        grid.into_iter().filter(|(at, _)| inside(at)).collect()
    }
}
