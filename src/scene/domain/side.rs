//! Sides by number, and their plane pieces.

/// A side by its position in [`super::Domain::sides`] and in `Mesh::sides`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Side(pub u32);

impl Side {
    /// x = 0 of a rectangle or box.
    pub const LEFT: Side = Side(0);
    /// x = size\[0\].
    pub const RIGHT: Side = Side(1);
    /// y = 0.
    pub const BOTTOM: Side = Side(2);
    /// y = size\[1\].
    pub const TOP: Side = Side(3);
    /// z = 0 of a box.
    pub const FRONT: Side = Side(4);
    /// z = size\[2\].
    pub const BACK: Side = Side(5);

    /// Its position.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The names of the sides of a rectangle, the first four, and of a box.
pub(super) const OF_A_BOX: [&str; 6] = ["left", "right", "bottom", "top", "front", "back"];

/// A plane piece of a side: a segment, or a parallelogram of a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// Outward unit normal, padded with zeros.
    pub normal: [f64; 3],
    /// A corner.
    pub corner: [f64; 3],
    /// The edges that leave the corner, one or two, at right angles.
    pub edges: Vec<[f64; 3]>,
}

impl Face {
    /// The face of a side of a box.
    pub(super) fn of_box(size: &[f64], side: Side) -> Self {
        let (axis, far) = (side.index() / 2, side.index() % 2 == 1);
        let (mut normal, mut corner) = ([0.0; 3], [0.0; 3]);
        normal[axis] = if far { 1.0 } else { -1.0 };
        corner[axis] = if far { size[axis] } else { 0.0 };
        let edge = |a: usize| {
            let mut edge = [0.0; 3];
            edge[a] = size[a];
            edge
        };
        let edges = (0..size.len()).filter(|&a| a != axis).map(edge).collect();
        Self { normal, corner, edges }
    }

    /// The segment from p to q.
    pub(super) fn segment([p, q]: [[f64; 2]; 2], normal: [f64; 2]) -> Self {
        let edges = vec![[q[0] - p[0], q[1] - p[1], 0.0]];
        Self { normal: [normal[0], normal[1], 0.0], corner: [p[0], p[1], 0.0], edges }
    }

    /// The lengths of the edges.
    pub fn lengths(&self) -> Vec<f64> {
        self.edges.iter().map(|edge| edge.iter().map(|e| e * e).sum::<f64>().sqrt()).collect()
    }

    /// Length or area.
    pub fn measure(&self) -> f64 {
        self.lengths().into_iter().product()
    }

    /// Unit vectors along the edges.
    pub fn tangents(&self) -> Vec<[f64; 3]> {
        self.edges.iter().zip(self.lengths()).map(|(edge, l)| edge.map(|e| e / l)).collect()
    }

    /// The points of a grid with `intervals` steps along each edge, ends included; the first edge
    /// varies fastest.
    pub fn points(&self, intervals: u32) -> Vec<[f64; 3]> {
        self.edges.iter().fold(vec![self.corner], |points, edge| {
            (0..=intervals)
                .flat_map(|i| {
                    let step = edge.map(|e| e * f64::from(i) / f64::from(intervals));
                    points.iter().map(move |p| [p[0] + step[0], p[1] + step[1], p[2] + step[2]])
                })
                .collect()
        })
    }
}
