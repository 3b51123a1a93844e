//! A point of a cell: the shape functions there, and tensors between the strain points.

use super::pointwise::Plane;
use fem::contact::Discretization;
use fem::space::StrainShapes;

/// A point of the cells of a plane mesh, put from cell to cell.
pub(crate) struct CellPoint<'a> {
    space: &'a Discretization,
    strains: StrainShapes,
    cell: usize,
    barycentric: [f64; 3],
    /// Values of the cell's functions there.
    pub shape: Vec<f64>,
}

impl<'a> CellPoint<'a> {
    pub(crate) fn new(space: &'a Discretization) -> Self {
        let strains = StrainShapes::new(space.element, 2);
        Self { space, strains, cell: 0, barycentric: [0.0; 3], shape: Vec::new() }
    }

    /// Moves to x in cell c.
    pub(crate) fn at(&mut self, c: usize, x: &[f64; 3]) {
        self.cell = c;
        self.barycentric = self.barycentric(c, x);
        self.shape = self.space.element.values(&self.barycentric);
    }

    /// Whether tensors are constant on a cell.
    pub(crate) fn is_constant(&self) -> bool {
        self.space.geometry.shares.len() == 1
    }

    /// A tensor there, by its values at the strain points.
    pub(crate) fn tensor(&self, field: &[Plane]) -> Plane {
        let count = self.space.geometry.shares.len();
        self.strains.tensor(&self.barycentric, &field[count * self.cell..count * (self.cell + 1)])
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
