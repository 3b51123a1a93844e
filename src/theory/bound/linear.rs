//! Linear scenes: the smallest k at which 𝒜 + (k/2)ℬ(0) is singular, on S^d and on V^h.

use crate::contact::{Discretization, Model};
use crate::law::{Isotropic, Projection};
use crate::linalg::{
    EigenError, Factor, FactorError, LinearMap, Workspace, largest_eigenvalue, signed_unit,
};

/// The smallest k > 0 at which the step of a linear scene is singular; infinite if none is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearLoss {
    /// With tensors of S^d: λ_min(𝒜 + (k/2)ℬ(0)) = 0.
    pub tensors: f64,
    /// With strains of V^h.
    pub mesh: f64,
}

/// Both, for a scene without projection and contact; none for others.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub fn linear_loss<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
) -> Result<Option<LinearLoss>, EigenError> {
    if !model.is_linear() {
        return Ok(None);
    }
    let none = LinearLoss { tensors: f64::INFINITY, mesh: f64::INFINITY };
    let Some(term) = &model.memory else { return Ok(Some(none)) };
    let at_zero = term.kernel.value(0.0);
    let minus = Isotropic { lambda: -at_zero * term.tensor.lambda, mu: -at_zero * term.tensor.mu };
    let d = space.mesh.dimension;
    let eigenvalues = |law: &Isotropic| [2.0 * law.mu, 2.0 * law.mu + d as f64 * law.lambda];
    let (elastic, memory) = (eigenvalues(&model.elasticity), eigenvalues(&minus));
    let ratio = memory.iter().zip(elastic).map(|(b, a)| b / a).fold(0.0, f64::max);
    if ratio == 0.0 {
        return Ok(Some(none));
    }
    let stiffness = space.stiffness(&model.elasticity);
    let (mut factor, mut workspace) = (space.analysis.factor(), space.analysis.workspace(1));
    space.analysis.factorize(&space.pattern, &stiffness, &mut factor, &mut workspace)?;
    // Shifted by the smallest quotient on S^d, so that it is positive semidefinite.
    let shift = memory.iter().zip(elastic).map(|(b, a)| b / a).fold(0.0, f64::min);
    let memory = space.stiffness(&minus);
    let mut map = Quotient { space, stiffness, memory, shift, factor, workspace };
    let mut seed = 21;
    let start: Vec<f64> = (0..space.dofs()).map(|_| signed_unit(&mut seed)).collect();
    let largest = largest_eigenvalue(&mut map, &start)?.value + shift;
    let mesh = if largest > 0.0 { 2.0 / largest } else { f64::INFINITY };
    Ok(Some(LinearLoss { tensors: 2.0 / ratio, mesh }))
}

/// K_𝒜⁻¹K_{-ℬ(0)} - shift, in the inner product of K_𝒜.
struct Quotient<'a> {
    space: &'a Discretization,
    stiffness: Vec<f64>,
    memory: Vec<f64>,
    shift: f64,
    factor: Factor,
    workspace: Workspace,
}

impl LinearMap for Quotient<'_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        self.space.pattern.multiply(&self.memory, x, out);
        self.space.analysis.solve(&self.factor, out, &mut self.workspace);
        for (value, x) in out.iter_mut().zip(x) {
            *value -= self.shift * x;
        }
        Ok(())
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.space.pattern.multiply(&self.stiffness, x, out);
    }
}
