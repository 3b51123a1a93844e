//! The A-projection of a field: P_h u ∈ V^h with (A ε(P_h u), ε(v)) = (A ε(u), ε(v)) for all v,
//! A = 𝒜 + μ as in the paper's operator. The distance u_h - P_h u shows the time error, and what
//! contact and projection do, without most of the interpolation error.

use super::Moments;
use crate::contact::{Discretization, StiffnessInverse, stress_force};
use algebra::in_dimension;
use algebra::linalg::FactorError;
use vhi::law::TensorField;

/// A on one mesh, factorized.
pub struct ElasticProjection<'a> {
    space: &'a Discretization,
    operator: TensorField,
    inverse: StiffnessInverse<'a>,
}

impl<'a> ElasticProjection<'a> {
    /// Factorizes A = 𝒜 + μ I; whether `space` is to `keep` the factor, for runs on other grids in time.
    ///
    /// # Errors
    /// The factorization's.
    pub fn new(
        space: &'a Discretization,
        elasticity: &TensorField,
        mu: f64,
        keep: bool,
    ) -> Result<Self, FactorError> {
        let operator = elasticity.plus(mu, &TensorField::identity(), space.mesh.dimension);
        Ok(Self { inverse: StiffnessInverse::new(space, &operator, keep)?, space, operator })
    }

    /// A⁻¹F for a force over the unknowns, as a nodal vector: one solve.
    pub fn response(&mut self, force: &[f64]) -> Vec<f64> {
        let mut nodal = vec![0.0; self.space.nodes.len()];
        let unknowns = &mut nodal[..self.space.dofs()];
        unknowns.copy_from_slice(force);
        self.inverse.solve(unknowns);
        nodal
    }

    /// ‖ε(P_h u - u_h)‖ for the truth `moments` of u and the nodal vector `u_h`: one solve.
    pub fn distance(&mut self, moments: &Moments, u_h: &[f64]) -> f64 {
        in_dimension!(self.space.mesh.dimension, D, S => self.distance_in::<D, S>(moments, u_h))
    }

    fn distance_in<const D: usize, const S: usize>(
        &mut self,
        moments: &Moments,
        u_h: &[f64],
    ) -> f64 {
        let space = self.space;
        let mut force = vec![0.0; space.nodes.len()];
        for at in space.points() {
            let mut difference = at.strain::<S>(u_h);
            for (value, exact) in difference.iter_mut().zip(&moments.strain.at[S * at.index..]) {
                *value = exact - *value;
            }
            let stress = self.operator.on(space.region(at.cell)).apply(&difference);
            let stress = stress.map(|s| at.weight * s);
            stress_force::<D, S>(at.gradients, at.nodes, &stress, &mut force);
        }
        let unknowns = &mut force[..space.dofs()];
        self.inverse.solve(unknowns);
        force[space.dofs()..].fill(0.0);
        crate::contact::strain_norm(space, &force)
    }
}
