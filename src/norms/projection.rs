//! The A-projection of a field: P_h u ∈ V^h with (A ε(P_h u), ε(v)) = (A ε(u), ε(v)) for all v,
//! A = 𝒜 + μ as in the paper's operator. The distance u_h - P_h u shows the time error, and what
//! contact and projection do, without most of the interpolation error.

use super::Moments;
use crate::contact::{Discretization, stress_force};
use crate::law::{Isotropic, TensorField};
use crate::linalg::{Factor, FactorError, Workspace};
use crate::space::strain_of;

/// A on one mesh, factorized.
pub struct ElasticProjection<'a> {
    space: &'a Discretization,
    operator: TensorField,
    factor: Factor,
    workspace: Workspace,
}

impl<'a> ElasticProjection<'a> {
    /// Factorizes A = 𝒜 + μ I.
    ///
    /// # Errors
    /// The factorization's.
    pub fn new(
        space: &'a Discretization,
        elasticity: &TensorField,
        mu: f64,
    ) -> Result<Self, FactorError> {
        // 2 μ_L ε + μ ε: the identity has ½ as its second Lamé number.
        let identity = TensorField::from(Isotropic { lambda: 0.0, mu: 0.5 });
        let operator = elasticity.plus(mu, &identity, space.mesh.dimension);
        let values = space.stiffness(&operator);
        let (mut factor, mut workspace) = (space.analysis.factor(), space.analysis.workspace(1));
        space.analysis.factorize(&space.pattern, &values, &mut factor, &mut workspace)?;
        Ok(Self { space, operator, factor, workspace })
    }

    /// A⁻¹F for a force over the unknowns, as a nodal vector: one solve.
    pub fn response(&mut self, force: &[f64]) -> Vec<f64> {
        let mut nodal = vec![0.0; self.space.nodes.len()];
        let unknowns = &mut nodal[..self.space.dofs()];
        unknowns.copy_from_slice(force);
        self.space.analysis.solve(&self.factor, unknowns, &mut self.workspace);
        nodal
    }

    /// ‖ε(P_h u - u_h)‖ for the truth `moments` of u and the nodal vector `u_h`: one solve.
    pub fn distance(&mut self, moments: &Moments, u_h: &[f64]) -> f64 {
        match self.space.mesh.dimension {
            2 => self.distance_in::<2, 3>(moments, u_h),
            _ => self.distance_in::<3, 6>(moments, u_h),
        }
    }

    fn distance_in<const D: usize, const S: usize>(
        &mut self,
        moments: &Moments,
        u_h: &[f64],
    ) -> f64 {
        let space = self.space;
        let mut force = vec![0.0; space.nodes.len()];
        for c in 0..space.mesh.cell_count() {
            let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
            let mut difference = strain_of::<S>(gradients, nodes, u_h);
            for (value, mean) in difference.iter_mut().zip(&moments.strain.mean[S * c..]) {
                *value = mean - *value;
            }
            let measure = space.geometry.measure[c];
            let stress = self.operator.on(space.region(c)).apply(&difference).map(|s| measure * s);
            stress_force::<D, S>(gradients, nodes, &stress, &mut force);
        }
        let unknowns = &mut force[..space.dofs()];
        space.analysis.solve(&self.factor, unknowns, &mut self.workspace);
        force[space.dofs()..].fill(0.0);
        crate::contact::strain_norm(space, &force)
    }
}
