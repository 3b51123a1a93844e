//! The space error of the stress: ‖σ(u) - σ(I_h u)‖ on a mesh.
//!
//! I_h u is superclose to u_h, so σ_h is the stress of I_h u with its memory, up to higher orders. Both use ζ of u:
//! with f = ε(u)/‖ε(u)‖, integration by parts gives (f, ε(u - I_h u)) = O(h²).

use algebra::in_dimension;
use std::sync::Arc;

use super::cells::{Mandel, strains};
use super::tangent::stress_of;
use exact::constitutive::{Tensor, mandel, stress};
use exact::{ComplianceRule, Exact, InterpolatedOnMesh};
use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::{Rule, tetrahedron_degree_5, triangle_degree_4};
use formula::BoundProgram;

/// ‖σ(u(t)) - σ(I_h u(t))‖ on one mesh.
pub(crate) struct StressInterpolationError {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    /// I_h u and its histories.
    interpolant: InterpolatedOnMesh,
    /// ε(u) and its histories at the points of the cells.
    fields: BoundProgram,
    rule: Rule,
    regions: Vec<usize>,
}

impl StressInterpolationError {
    pub(crate) fn new(exact: Arc<Exact>, space: Arc<Discretization>) -> Self {
        let mesh = &space.mesh;
        let rule = if mesh.dimension == 2 { triangle_degree_4() } else { tetrahedron_degree_5() };
        let points: Vec<[f64; 3]> = (0..mesh.cell_count())
            .flat_map(|c| rule.points.iter().map(move |b| mesh.point(mesh.cell(c), b)))
            .collect();
        let fields = exact.interior.bind(&points);
        let regions = exact.cell_regions(mesh);
        // The rule affects loads only.
        let interpolant =
            InterpolatedOnMesh::new(exact.clone(), space.clone(), ComplianceRule::Vertex);
        Self { exact, space, interpolant, fields, rule, regions }
    }

    /// The error at time t.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub(crate) fn at(&mut self, t: f64) -> Result<f64, LoadError> {
        in_dimension!(self.space.mesh.dimension, D, S => self.at_in::<D, S>(t))
    }

    fn at_in<const D: usize, const S: usize>(&mut self, t: f64) -> Result<f64, LoadError> {
        let (u, histories) = self.interpolant.displacements(t)?;
        let strain: Vec<Mandel<S>> = strains(&self.space, &u);
        let histories: Vec<Vec<Mandel<S>>> =
            histories.iter().map(|history| strains(&self.space, history)).collect();
        let mut out = vec![Vec::new(); D + self.exact.strain.len() + self.exact.memory.len()];
        self.fields.evaluate(t, 0.0, &mut out);
        let kappa = self.exact.kappa(t);
        let (mut sum, mut remembered): (f64, Vec<Tensor<D>>) = (0.0, Vec::new());
        for c in 0..self.space.mesh.cell_count() {
            let material = self.exact.material_in(self.regions[c]);
            let memory: Vec<Mandel<S>> = histories.iter().map(|history| history[c]).collect();
            let of_interpolant = stress_of(material, &strain[c], &memory, kappa);
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let p = c * self.rule.weights.len() + q;
                let present: Tensor<D> = self.exact.tensors(|k| out[k][p], &mut remembered);
                let of_exact: Mandel<S> = mandel(&stress(material, &present, &remembered, kappa));
                let pairs = of_exact.iter().zip(&of_interpolant);
                let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
                sum += weight * self.space.geometry.measure[c] * squares;
            }
        }
        Ok(sum.sqrt())
    }
}
