//! Λ of Problem 14 at a level that is open, with its derivative.

use super::assembly::stress_force;
use super::last_slot::LastSlot;
use super::{CaseError, Discretization, Evolution, MemoryTerm, Model};
use algebra::in_dimension;
use algebra::linalg::{Analysis, Factor, FactorError, Front, axpy, dot};
use vhi::history::TimeGrid;
use vhi::law::{Projection, TensorField};
use vhi::{
    BoundaryGraph, FrozenDerivative, HistoryInequality, OpenInequality, StepInequality, StepState,
};

/// A run whose last slot may be given any weight, with DΛ of the level that is open.
pub struct OpenLevel<'a> {
    space: &'a Discretization,
    model: &'a Model,
    evolution: Evolution<'a>,
    slot: LastSlot,
    /// Stiffness of each ℬ₀, empty without memory.
    memory: Vec<Vec<f64>>,
    /// Strain products G and their factor.
    gram: Vec<f64>,
    gram_factor: Factor,
    analysis: &'a Analysis,
    front: Front<f64>,
    /// ∂F/∂ζ at Λη and w ∂‖ε(η)‖/∂η, where the level depends on ζ.
    by_zeta: Option<(Vec<f64>, Vec<f64>)>,
}

/// Residual of the linear solves within DΛ, relative: rounding of a factorization.
const LINEAR: f64 = 1e-13;

impl<'a> OpenLevel<'a> {
    /// The run `evolution`, of `model` on `space`.
    ///
    /// # Errors
    /// The factorization of the strain products.
    pub fn new(
        space: &'a Discretization,
        model: &'a Model,
        evolution: Evolution<'a>,
    ) -> Result<Self, FactorError> {
        let gram = space.stiffness_of_unknowns(&TensorField::identity());
        let analysis = space.analysis()?;
        let (mut gram_factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&space.pattern, &gram, &mut gram_factor, &mut workspace)?;
        let terms = model.memory.iter();
        Ok(Self {
            slot: LastSlot::default(),
            memory: terms.map(|term| space.stiffness_of_unknowns(&term.tensor)).collect(),
            gram,
            gram_factor,
            analysis,
            front: Front::default(),
            by_zeta: None,
            space,
            model,
            evolution,
        })
    }

    /// Adds -Σ W ℬ₀ x as a force; nothing without memory.
    fn add_memory(&self, x: &[f64], out: &mut [f64]) {
        for (memory, &weight) in self.memory.iter().zip(&self.slot.memory) {
            if weight != 0.0 {
                let mut force = vec![0.0; x.len()];
                self.space.pattern.multiply(memory, x, &mut force);
                axpy(-weight, &force, out);
            }
        }
    }
}

impl FrozenDerivative for OpenLevel<'_> {
    fn set_step(&mut self, k: f64) {
        let rule = &self.model.time_rule;
        let last_weight =
            |term: &MemoryTerm| rule.last_weight(term.kernel.power(), k) * term.kernel.factor(0.0);
        let memory = self.model.memory.iter().map(last_weight).collect();
        self.slot = LastSlot { zeta: rule.last_share() * k, memory };
        self.evolution.set_last_slot(self.slot.clone());
    }

    fn differentiate(&mut self, eta: &[f64], state: &StepState) -> Result<(), FactorError> {
        self.evolution.freeze(Some(eta));
        let mut force = vec![0.0; state.u.len()];
        self.evolution.residual(&state.u, &mut force);
        let (slopes, prescribed) = self.evolution.graph().pieces(state);
        self.evolution.take_pressures(&state.pressure);
        self.evolution.linearize(&slopes, &prescribed)?;
        self.by_zeta = None;
        let size = self.evolution.norm(eta);
        if let Some(limit) = self.model.projection.limit()
            && size > 0.0
        {
            // The frozen level has ζ_past + w‖ε(η)‖ as its ζ.
            let zeta = self.evolution.problem().zeta();
            let nodal = self.evolution.nodal(&state.u);
            let mut by_zeta = force_by_limit(self.space, self.model, &nodal, limit.value(zeta));
            self.space.frames.force_on_unknowns(&mut by_zeta);
            by_zeta.truncate(eta.len());
            let slope = limit.slope(zeta);
            by_zeta.iter_mut().for_each(|value| *value *= slope);
            let mut by_eta = vec![0.0; eta.len()];
            self.space.pattern.multiply(&self.gram, eta, &mut by_eta);
            by_eta.iter_mut().for_each(|value| *value *= self.slot.zeta / size);
            self.by_zeta = Some((by_zeta, by_eta));
        }
        Ok(())
    }

    /// DΛ x = -J⁻¹(W ℬ₀ x + ∂F/∂ζ (w ∂‖ε(η)‖·x)), J the tangent of the frozen level.
    fn derivative(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        out.fill(0.0);
        self.add_memory(x, out);
        if let Some((by_zeta, by_eta)) = &self.by_zeta {
            axpy(-dot(by_eta, x), by_zeta, out);
        }
        self.evolution.solve(out, LINEAR)
    }

    /// G⁻¹ (DΛ)ᵀ G x; ℬ₀ is symmetric, and J but for the entries of friction that follows p.
    fn adjoint(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        let mut force = vec![0.0; x.len()];
        self.space.pattern.multiply(&self.gram, x, &mut force);
        self.evolution.problem_mut().transpose();
        let outcome = self.evolution.solve(&mut force, LINEAR);
        self.evolution.problem_mut().transpose();
        outcome?;
        out.fill(0.0);
        self.add_memory(&force, out);
        if let Some((by_zeta, by_eta)) = &self.by_zeta {
            axpy(-dot(by_zeta, &force), by_eta, out);
        }
        self.analysis.solve(&self.gram_factor, out, &mut self.front);
        Ok(())
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.space.pattern.multiply(&self.gram, x, out);
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

impl HistoryInequality for OpenLevel<'_> {
    type Error = CaseError;

    fn grid(&self) -> &TimeGrid {
        self.evolution.grid()
    }

    fn open(&mut self) -> Result<(), CaseError> {
        self.evolution.open()?;
        self.slot = self.evolution.last_slot();
        Ok(())
    }

    fn commit(&mut self, solution: &StepState) {
        self.evolution.commit(solution);
    }
}

impl OpenInequality for OpenLevel<'_> {
    fn freeze(&mut self, eta: Option<&[f64]>) {
        self.evolution.freeze(eta);
    }

    fn norm(&self, v: &[f64]) -> f64 {
        self.evolution.norm(v)
    }
}

impl StepInequality for OpenLevel<'_> {
    fn dofs(&self) -> usize {
        self.evolution.dofs()
    }

    fn graph(&self) -> &BoundaryGraph {
        self.evolution.graph()
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        self.evolution.residual(u, out);
    }

    fn take_pressures(&mut self, pressures: &[f64]) {
        self.evolution.take_pressures(pressures);
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        self.evolution.linearize(slopes, prescribed)
    }

    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        self.evolution.solve(rhs, forcing)
    }

    fn force_scale(&self, u: &[f64]) -> f64 {
        self.evolution.force_scale(u)
    }
}
