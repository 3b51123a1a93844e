//! The distance of a run to the exact solution in the energy norm, by a rule that is not the assembly's.

use std::sync::Arc;

use exact::Exact;
use fem::contact::Discretization;
use fem::space::StrainShapes;
use fem::space::quadrature::{Rule, triangle_degree_8};
use formula::BoundProgram;
use vhi::law::TensorField;

/// ε of the exact solution at the points of a mesh.
pub(super) struct Strains {
    rule: Rule,
    fields: BoundProgram,
}

impl Strains {
    /// Binds the formulas.
    pub(super) fn new(exact: &Arc<Exact>, space: &Discretization) -> Self {
        let (rule, mesh) = (triangle_degree_8(), &space.mesh);
        let cells = (0..mesh.cell_count()).map(|c| mesh.cell(c));
        let points: Vec<[f64; 3]> =
            cells.flat_map(|cell| rule.points.iter().map(|b| mesh.point(cell, b))).collect();
        Self { rule, fields: exact.interior.bind(&points) }
    }

    /// (𝒜ε(u - u^h), ε(u - u^h))^{1/2} at t.
    pub(super) fn distance(
        &mut self,
        space: &Discretization,
        elasticity: &TensorField,
        u: &[f64],
        t: f64,
    ) -> f64 {
        let values = self.fields.values_at(t, 0.0);
        let count = self.rule.weights.len();
        let mut sum = 0.0;
        let shapes = StrainShapes::new(space.element, 2);
        for c in 0..space.mesh.cell_count() {
            let strains: Vec<[f64; 3]> = space.points_of(c).map(|at| at.strain(u)).collect();
            let tensor = elasticity.on(space.region(c));
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let at = count * c + q;
                let [xx, xy, yy] = [2, 3, 4].map(|output| values[output][at]);
                let exact = [xx, yy, std::f64::consts::SQRT_2 * xy];
                let computed = shapes.tensor(&self.rule.points[q], &strains);
                let off: [f64; 3] = std::array::from_fn(|i| exact[i] - computed[i]);
                sum += weight
                    * space.geometry.measure[c]
                    * algebra::tensor::contract(&tensor.apply(&off), &off);
            }
        }
        sum.max(0.0).sqrt()
    }
}
