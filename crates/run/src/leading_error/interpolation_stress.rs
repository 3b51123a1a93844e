//! The space error of the stress: ‖σ(u) - σ(I_h u)‖ on a mesh.
//!
//! I_h u is superclose to u_h, so σ_h is the stress of I_h u with its memory, up to higher orders. Both use ζ of u:
//! with f = ε(u)/‖ε(u)‖, integration by parts gives (f, ε(u - I_h u)) = O(h²).

use algebra::in_dimension;
use std::sync::Arc;

use super::measures::square_apart;
use super::own_history::points_of_cells;
use exact::constitutive::{Tensor, stress};
use exact::{ComplianceRule, Exact, InterpolatedOnMesh, NodalStrain};
use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::Rule;
use formula::BoundProgram;

/// ‖σ(u(t)) - σ(I_h u(t))‖ on one mesh.
pub(crate) struct StressInterpolationError {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    /// I_h u and its histories.
    interpolant: InterpolatedOnMesh,
    strains: NodalStrain,
    /// ε(u) and its histories at the points of the cells.
    fields: BoundProgram,
    rule: Rule,
    regions: Vec<usize>,
}

impl StressInterpolationError {
    pub(crate) fn new(exact: Arc<Exact>, space: Arc<Discretization>) -> Self {
        let (mesh, element) = (&space.mesh, space.element);
        let rule = element.square_rule(mesh.dimension + 1);
        let fields = exact.interior.bind(&points_of_cells(mesh, &rule));
        let regions = exact.cell_regions(mesh);
        let strains = NodalStrain::new(space.clone(), &element.strain_rule(mesh.dimension));
        // The rule affects loads only.
        let interpolant =
            InterpolatedOnMesh::new(exact.clone(), space.clone(), ComplianceRule::Vertex);
        Self { exact, space, interpolant, strains, fields, rule, regions }
    }

    /// The error at time t.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub(crate) fn at(&mut self, t: f64) -> Result<f64, LoadError> {
        in_dimension!(self.space.mesh.dimension, D => self.at_in::<D>(t))
    }

    fn at_in<const D: usize>(&mut self, t: f64) -> Result<f64, LoadError> {
        let (u, histories) = self.interpolant.displacements(t)?;
        let mut out = vec![Vec::new(); D + self.exact.strain.len() + self.exact.memory.len()];
        self.fields.evaluate(t, 0.0, &mut out);
        let kappa = self.exact.kappa(t);
        let (mut sum, mut remembered): (f64, Vec<Tensor<D>>) = (0.0, Vec::new());
        for c in 0..self.space.mesh.cell_count() {
            let material = self.exact.material_in(self.regions[c]);
            let of_cell = |nodal: &Vec<f64>| -> Tensor<D> { self.strains.at(nodal, c, 0) };
            let memory: Vec<Tensor<D>> = histories.iter().map(of_cell).collect();
            let of_interpolant = stress(material, &of_cell(&u), &memory, kappa);
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let p = c * self.rule.weights.len() + q;
                let present: Tensor<D> = self.exact.tensors(|k| out[k][p], &mut remembered);
                let of_exact = stress(material, &present, &remembered, kappa);
                let square = square_apart(&of_exact, &of_interpolant);
                sum += weight * self.space.geometry.measure[c] * square;
            }
        }
        Ok(sum.sqrt())
    }
}
