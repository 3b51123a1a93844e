//! A point of a cell: the functions of displacements there, and tensors by their values at the strain points.

use super::pointwise::Plane;
use fem::contact::Discretization;
use fem::space::StrainShapes;

/// The most strain points of a triangle.
const MOST: usize = 3;

/// A point of a cell.
pub(crate) struct CellPoint<'a> {
    space: &'a Discretization,
    strains: StrainShapes,
    /// Strain points a cell.
    count: usize,
    cell: usize,
    /// Values of the functions of tensors.
    weights: [f64; MOST],
    /// Values of the shape functions of the cell.
    pub shape: Vec<f64>,
}

impl<'a> CellPoint<'a> {
    /// No point yet.
    pub(crate) fn new(space: &'a Discretization) -> Self {
        let count = space.geometry.shares.len();
        let strains = StrainShapes::new(space.element, 2);
        Self { space, strains, count, cell: 0, weights: [1.0; MOST], shape: vec![0.0; 3] }
    }

    /// Moves to x in cell c.
    pub(crate) fn at(&mut self, c: usize, x: &[f64; 3]) {
        self.cell = c;
        let b = self.barycentric(c, x);
        self.shape = self.space.element.values(&b);
        self.strains.at(&b, &mut self.weights[..self.count]);
    }

    pub(crate) fn is_constant(&self) -> bool {
        self.count == 1
    }

    /// A tensor by its values at all strain points.
    pub(crate) fn tensor(&self, field: &[Plane]) -> Plane {
        let of_cell = &field[self.count * self.cell..self.count * (self.cell + 1)];
        let sum = |i: usize| of_cell.iter().zip(&self.weights).map(|(at, w)| w * at[i]).sum();
        [sum(0), sum(1), sum(2)]
    }

    fn barycentric(&self, c: usize, x: &[f64; 3]) -> [f64; 3] {
        let mesh = &self.space.mesh;
        let [origin, p, q] = [0, 1, 2].map(|a| mesh.vertex(mesh.cell(c)[a]));
        let from_origin = |to: &[f64]| [to[0] - origin[0], to[1] - origin[1]];
        let ([dx, dy], [px, py], [qx, qy]) = (from_origin(x), from_origin(p), from_origin(q));
        let twice = px * qy - py * qx;
        let [b, c] = [(dx * qy - dy * qx) / twice, (px * dy - py * dx) / twice];
        [1.0 - b - c, b, c]
    }
}
