//! Sides by number, and their plane pieces.

use fem::mesh::Piece;
use formula::{Effort, Extreme, Graph, Interval, Node, Place, Variable, largest};

/// A side by its position in [`super::Domain::sides`] and in `Mesh::sides`; those of a rectangle or box in the order x =
/// 0, x = size\[0\], y = 0, and so on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side(pub u32);

impl Side {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Names of the sides of a box; a rectangle has the first four.
pub(super) const OF_A_BOX: [&str; 6] = ["left", "right", "bottom", "top", "front", "back"];

/// A plane piece of a side: a segment, a rectangle of a box, or a triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Outward unit normal, padded with zeros.
    pub normal: [f64; 3],
    pub corner: [f64; 3],
    /// The one or two edges from the corner; at right angles for a rectangle.
    pub edges: Vec<[f64; 3]>,
    /// Whether it is half of the parallelogram spanned by the edges.
    pub triangle: bool,
}

impl Face {
    pub(super) fn of_box(size: &[f64], side: Side) -> Self {
        let (axis, far) = (side.index() / 2, side.index() % 2 == 1);
        let mut face = Self::whole(size);
        face.normal[axis] = if far { 1.0 } else { -1.0 };
        face.corner[axis] = if far { size[axis] } else { 0.0 };
        face.edges.remove(axis);
        face
    }

    /// All of a rectangle or box, for its points.
    pub(super) fn whole(size: &[f64]) -> Self {
        let edge = |a: usize| [0, 1, 2].map(|i| if i == a { size[a] } else { 0.0 });
        let edges = (0..size.len()).map(edge).collect();
        Self { normal: [0.0; 3], corner: [0.0; 3], edges, triangle: false }
    }

    pub(super) fn simplex(piece: &Piece) -> Self {
        let (corner, others) = (piece.corners[0], &piece.corners[1..]);
        let edges: Vec<[f64; 3]> =
            others.iter().map(|end| [0, 1, 2].map(|i| end[i] - corner[i])).collect();
        Self { normal: piece.normal, corner, triangle: edges.len() == 2, edges }
    }

    /// The places with these shares of the edges, rounded outward; all of the piece for [0, 1] and [0, 1].
    fn part(&self, [a, b]: [Interval; 2]) -> [Interval; 3] {
        [0, 1, 2].map(|i| {
            let edge = |e: usize| self.edges.get(e).map_or(0.0, |edge| edge[i]);
            let along = a * Interval::point(edge(0));
            // A triangle is spanned by its first edge and the way from its end to that of the second.
            let across = match self.triangle {
                true => a * b * Interval::point(edge(1) - edge(0)),
                false => b * Interval::point(edge(1)),
            };
            Interval::point(self.corner[i]) + along + across
        })
    }

    /// A proved bound of `sign`·f on the piece, for f independent of time, and the place of the largest value met.
    pub(crate) fn largest(&self, graph: &Graph, f: Node, sign: f64) -> (Extreme<2>, [f64; 3]) {
        let mut f = graph.enclosing(f);
        let unit = Interval::new(0.0, 1.0);
        let second = if self.edges.len() == 2 { unit } else { Interval::point(0.0) };
        let sign = Interval::point(sign);
        let found = largest([unit, second], Effort::FORMULA, |&part| {
            let axes = [Variable::X, Variable::Y, Variable::Z].into_iter().zip(self.part(part));
            let place = axes.fold(Place::origin(), |place, (axis, range)| place.with(axis, range));
            let found = f.over(&place);
            if found.undefined { Interval::ALL } else { sign * found.range }
        });
        (found, self.part(found.at.map(Interval::point)).map(Interval::middle))
    }

    pub(crate) fn lengths(&self) -> Vec<f64> {
        self.edges.iter().map(|&edge| length(edge)).collect()
    }

    /// The longest edge, including that across a triangle.
    pub(crate) fn longest(&self) -> f64 {
        let across = match (&self.edges[..], self.triangle) {
            ([a, b], true) => length([0, 1, 2].map(|i| a[i] - b[i])),
            _ => 0.0,
        };
        self.lengths().into_iter().fold(across, f64::max)
    }

    /// Length or area.
    pub fn measure(&self) -> f64 {
        match (&self.edges[..], self.triangle) {
            ([a, b], true) => {
                let doubled =
                    |i: usize| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
                0.5 * length([0, 1, 2].map(doubled))
            }
            _ => self.lengths().into_iter().product(),
        }
    }

    /// Unit vectors in the piece: along each axis of a segment or rectangle; for a triangle along its first edge and
    /// across it.
    pub fn tangents(&self) -> Vec<[f64; 3]> {
        let unit = |edge: [f64; 3]| edge.map(|e| e / length(edge));
        let mut tangents: Vec<[f64; 3]> = self.edges.iter().map(|&edge| unit(edge)).collect();
        if self.triangle {
            let (first, second) = (tangents[0], self.edges[1]);
            let along: f64 = first.iter().zip(second).map(|(a, b)| a * b).sum();
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
    pub(crate) fn grid(&self, intervals: u32) -> Vec<([u32; 3], [f64; 3])> {
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

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|e| e * e).sum::<f64>().sqrt()
}
