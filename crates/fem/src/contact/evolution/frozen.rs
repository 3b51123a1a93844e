//! The derivative of Λ of Problem 14 at a level that is open.

use super::Evolution;
use crate::contact::{Discretization, LastSlot, MemoryTerm, Model, stress_force};
use algebra::in_dimension;
use algebra::linalg::{Analysis, Factor, FactorError, Front, axpy, dot};
use vhi::law::{MemoryKernel, Projection, TensorField};
use vhi::{FrozenDerivative, OpenInequality, StepInequality, StepState};

/// DΛ of the open level but for the tangent of its frozen problem.
pub(super) struct Frozen<'a> {
    /// Strain products G and their factor.
    gram: Vec<f64>,
    gram_factor: Factor,
    analysis: &'a Analysis,
    front: Front,
    /// ∂F/∂ζ at Λη and w ∂‖ε(η)‖/∂η, where the level depends on ζ.
    by_zeta: Option<(Vec<f64>, Vec<f64>)>,
}

/// Residual of the linear solves within DΛ, relative: rounding of a factorization.
const LINEAR: f64 = 1e-13;

impl<'a> Frozen<'a> {
    fn new(space: &'a Discretization) -> Result<Self, FactorError> {
        let gram = space.stiffness_of_unknowns(&TensorField::identity());
        let analysis = space.analysis()?;
        let (mut gram_factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&space.pattern, &gram, &mut gram_factor, &mut workspace)?;
        Ok(Self { gram, gram_factor, analysis, front: Front::default(), by_zeta: None })
    }
}

impl Evolution<'_> {
    /// ∂F/∂ζ at Λη = `u` and w ∂‖ε(η)‖/∂η, where the frozen level depends on ζ.
    fn by_zeta(&self, gram: &[f64], eta: &[f64], u: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let limit = self.model.projection.limit()?;
        let size = self.norm(eta);
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        // The frozen level has ζ_past + w‖ε(η)‖ as its ζ.
        let zeta = self.problem.zeta();
        let nodal = self.nodal(u);
        let mut by_zeta = force_by_limit(self.space, self.model, &nodal, limit.value(zeta));
        self.space.frames.force_on_unknowns(&mut by_zeta);
        by_zeta.truncate(eta.len());
        let slope = limit.slope(zeta);
        by_zeta.iter_mut().for_each(|value| *value *= slope);
        let mut by_eta = vec![0.0; eta.len()];
        self.space.pattern.multiply(gram, eta, &mut by_eta);
        by_eta.iter_mut().for_each(|value| *value *= self.slot.zeta / size);
        Some((by_zeta, by_eta))
    }
}

/// Maps are zero before the first [`FrozenDerivative::differentiate`].
impl FrozenDerivative for Evolution<'_> {
    fn set_step(&mut self, k: f64) {
        let rule = &self.model.time_rule;
        let slot =
            |kernel: &dyn MemoryKernel| rule.last_weight(kernel.power(), k) * kernel.factor(0.0);
        let last_weight = |term: &MemoryTerm| term.kernel.product(slot);
        let memory = self.model.memory.iter().map(last_weight).collect();
        self.set_last_slot(LastSlot { zeta: rule.last_share() * k, memory });
    }

    fn differentiate(&mut self, eta: &[f64], state: &StepState) -> Result<(), FactorError> {
        self.freeze(Some(eta));
        let mut force = vec![0.0; state.u.len()];
        self.residual(&state.u, &mut force);
        let (slopes, prescribed) = self.graph().pieces(state);
        self.take_pressures(&state.pressure);
        self.linearize(&slopes, &prescribed)?;
        let mut frozen = match self.frozen.take() {
            Some(known) => known,
            None => Frozen::new(self.space)?,
        };
        frozen.by_zeta = self.by_zeta(&frozen.gram, eta, &state.u);
        self.frozen = Some(frozen);
        Ok(())
    }

    /// DΛ x = -J⁻¹(W ℬ₀ x + ∂F/∂ζ (w ∂‖ε(η)‖·x)), J the tangent of the frozen level.
    fn derivative(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        out.fill(0.0);
        let Some(frozen) = &self.frozen else { return Ok(()) };
        self.problem.subtract_memory(&self.slot.memory, x, out);
        if let Some((by_zeta, by_eta)) = &frozen.by_zeta {
            axpy(-dot(by_eta, x), by_zeta, out);
        }
        self.solve(out, LINEAR)
    }

    /// G⁻¹ (DΛ)ᵀ G x; ℬ₀ is symmetric, and J but for the entries of friction that follows p.
    fn adjoint(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        out.fill(0.0);
        let Some(frozen) = &mut self.frozen else { return Ok(()) };
        let mut force = vec![0.0; x.len()];
        self.space.pattern.multiply(&frozen.gram, x, &mut force);
        self.problem.transpose();
        let outcome = self.problem.solve(&mut force, LINEAR);
        self.problem.transpose();
        outcome?;
        self.problem.subtract_memory(&self.slot.memory, &force, out);
        if let Some((by_zeta, by_eta)) = &frozen.by_zeta {
            axpy(-dot(by_zeta, &force), by_eta, out);
        }
        frozen.analysis.solve(&frozen.gram_factor, out, &mut frozen.front);
        Ok(())
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        match &self.frozen {
            Some(frozen) => self.space.pattern.multiply(&frozen.gram, x, out),
            None => out.fill(0.0),
        }
    }
}

/// ∂/∂κ ∫ σ:ε(v) over all nodes.
fn force_by_limit(space: &Discretization, model: &Model, nodal: &[f64], kappa: f64) -> Vec<f64> {
    fn add<const D: usize, const S: usize>(
        space: &Discretization,
        model: &Model,
        nodal: &[f64],
        kappa: f64,
        out: &mut [f64],
    ) {
        for at in space.points() {
            let strain = at.strain::<S>(nodal);
            if let Some(response) = model.projection.response(&strain, kappa) {
                let stress = response.by_limit.map(|s| s * at.weight);
                stress_force::<D, S>(at.gradients, at.nodes, &stress, out);
            }
        }
    }
    let mut out = vec![0.0; nodal.len()];
    in_dimension!(space.mesh.dimension, D, S => add::<D, S>(space, model, nodal, kappa, &mut out));
    out
}
