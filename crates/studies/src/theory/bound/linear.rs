//! Linear scenes: the smallest k at which 𝒜 + (k/2)ℬ(0) is singular, on S^d and on V^h.

use crate::quotients::quotients;
use algebra::linalg::{EigenError, FactorError, LinearMap, largest_eigenvalue, signed_unit};
use fem::contact::{Discretization, Model, StiffnessInverse, relaxation};

/// The smallest k > 0 at which the step of a linear scene is singular; infinite if none is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearLoss {
    /// With tensors of S^d: λ_min(𝒜 + (k/2)ℬ(0)) = 0.
    pub tensors: f64,
    /// The k with strains of V^h.
    pub mesh: f64,
}

/// Both, for a scene without projection and contact; none for others.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub(crate) fn linear_loss(
    space: &Discretization,
    model: &Model,
) -> Result<Option<LinearLoss>, EigenError> {
    if !model.is_linear() {
        return Ok(None);
    }
    let none = LinearLoss { tensors: f64::INFINITY, mesh: f64::INFINITY };
    let d = space.mesh.dimension;
    let Some(at_zero) = relaxation(&model.memory, 0.0, d) else { return Ok(Some(none)) };
    let minus = at_zero.scaled(-1.0);
    let quotients = quotients(&minus, &model.elasticity, d);
    let ratio = quotients.iter().copied().fold(0.0, f64::max);
    if ratio == 0.0 {
        return Ok(Some(none));
    }
    let stiffness = StiffnessInverse::passing(space, &model.elasticity)?;
    // Shifted by the smallest quotient on S^d, so that it is positive semidefinite.
    let shift = quotients.iter().copied().fold(0.0, f64::min);
    let memory = space.stiffness(&minus);
    let mut map = Quotient { space, stiffness, memory, shift };
    let mut seed = 21;
    let start: Vec<f64> = (0..space.dofs()).map(|_| signed_unit(&mut seed)).collect();
    let largest = largest_eigenvalue(&mut map, &start)?.value + shift;
    let mesh = if largest > 0.0 { 2.0 / largest } else { f64::INFINITY };
    Ok(Some(LinearLoss { tensors: 2.0 / ratio, mesh }))
}

/// K_𝒜⁻¹K_{-ℬ(0)} - shift, in the inner product of K_𝒜.
struct Quotient<'a> {
    space: &'a Discretization,
    stiffness: StiffnessInverse<'a>,
    memory: Vec<f64>,
    shift: f64,
}

impl LinearMap for Quotient<'_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        self.space.pattern.multiply(&self.memory, x, out);
        self.stiffness.solve(out);
        for (value, x) in out.iter_mut().zip(x) {
            *value -= self.shift * x;
        }
        Ok(())
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.stiffness.multiply(x, out);
    }
}
