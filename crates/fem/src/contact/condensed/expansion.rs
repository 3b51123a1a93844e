//! From Γ3 into the volume: displacements, histories and what an observer sees of levels that are solved on Γ3.

use std::time::Instant;

use super::Condensed;
use crate::contact::floor::Accepted;
use crate::contact::kkt::kkt_residual_in;
use crate::contact::march::{CaseError, Observer, StepView, split_pressures};
use crate::contact::{Floors, strain_norm};
use algebra::linalg::{Side, axpy, norm};
use vhi::history::{Memory, TimeGrid};
use vhi::law::Projection;
use vhi::{Newton, StepInequality, StepState};

/// A level that is solved on Γ3.
#[derive(Debug, Clone, Default)]
pub(super) struct Pending {
    /// n.
    pub n: usize,
    /// s of the level.
    pub scale: f64,
    /// Weights W_i of the last slot.
    pub slot: Vec<f64>,
    /// F_n, Cartesian.
    pub force: Vec<f64>,
    /// In the order of the factor: L₁₁⁻¹ of the right side, then v_n on Γ3; v_n throughout after the pass.
    pub swept: Vec<f64>,
    /// u_n on Γ3 and its pressures.
    pub state: StepState,
}

impl Pending {
    /// Room for a level of so many unknowns.
    pub fn new(dofs: usize) -> Self {
        Self { force: vec![0.0; dofs], swept: vec![0.0; dofs], ..Self::default() }
    }
}

impl<P: Projection> Condensed<'_, P> {
    /// Expands the levels that are solved, commits and shows them in their order.
    pub(super) fn expand(
        &mut self,
        grid: &TimeGrid,
        observe: &mut Observer<'_>,
    ) -> Result<(), CaseError> {
        let start = Instant::now();
        self.substitute();
        self.info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        for at in 0..std::mem::take(&mut self.solved) {
            self.shown = at;
            self.commit(grid);
            self.show(grid, observe)?;
        }
        Ok(())
    }

    /// v from its part on Γ3, for all pending levels in one pass over the factor.
    fn substitute(&mut self) {
        self.info.work.linear.solves += self.solved as u32;
        let (factor, cut) = (&self.factor, self.cut);
        if let [single] = &mut self.pending[..] {
            self.analysis.backward(factor, cut, &mut single.swept, &mut self.front);
            return;
        }
        // Places without a level hold an old one, which nobody asks for.
        for (row, side) in self.block.iter_mut().enumerate() {
            *side = std::array::from_fn(|l| self.pending[l].swept[row]);
        }
        self.analysis.backward_block(factor, cut, &mut self.block, &mut self.block_front);
        for (l, pending) in self.pending.iter_mut().enumerate().take(self.solved) {
            let own = |side: &Side| side[l];
            pending.swept.iter_mut().zip(&self.block).for_each(|(value, side)| *value = own(side));
        }
    }

    /// u_n from v_n, committed.
    fn commit(&mut self, grid: &TimeGrid) {
        if self.on_side.is_some() {
            self.recall(grid);
        }
        let dofs = self.space.dofs();
        let Pending { scale, slot, swept, state, .. } = &self.pending[self.shown];
        let past = self.beta.zip(self.history.first());
        for (&value, &dof) in swept.iter().zip(self.analysis.order()) {
            let dof = dof as usize;
            self.u[dof] = match past {
                Some((beta, past)) => (value - beta * past[dof]) / scale,
                None => value,
            };
        }
        // Values that a graph holds stay exact.
        for (&dof, u) in self.level.unknowns().iter().zip(&state.u) {
            self.u[dof as usize] = *u;
        }
        for ((memory, history), own) in self.memory.iter_mut().zip(&mut self.history).zip(slot) {
            memory.commit(grid, &self.u[..dofs]);
            axpy(*own, &self.u[..dofs], &mut history[..dofs]);
        }
        let held = self.memory.iter().chain(&self.on_side).map(Memory::bytes).sum();
        self.info.peak_history_bytes = self.info.peak_history_bytes.max(held);
    }

    fn show(&mut self, grid: &TimeGrid, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        let framed = !self.space.frames.is_empty();
        self.nodal.copy_from_slice(&self.u);
        self.space.frames.to_cartesian(&mut self.nodal);
        for (shown, history) in self.shown_history.iter_mut().zip(&self.history) {
            shown.copy_from_slice(history);
            self.space.frames.to_cartesian(shown);
        }
        let Pending { n, force, state, .. } = &self.pending[self.shown];
        split_pressures(
            self.space,
            self.model,
            self.level.graph(),
            state,
            [&mut self.compliance, &mut self.multiplier],
        );
        let strain_norm = strain_norm(self.space, &self.nodal);
        self.accumulated.commit(grid, strain_norm);
        let view = StepView {
            n: *n,
            t: grid.time(*n),
            u: &self.nodal,
            history: if framed { &self.shown_history } else { &self.history },
            zeta: self.accumulated.value(),
            kappa: f64::INFINITY,
            strain_norm,
            compliance: &self.compliance,
            multiplier: &self.multiplier,
        };
        let residual = kkt_residual_in(self.space, self.model, &view, force, &mut self.balance);
        self.info.accept(&view, residual)?;
        observe(&view)?;
        // Floors grow with the load: levels of twice the largest load so far are few.
        if norm(force) > 2.0 * self.largest_force {
            self.raise_floors();
        }
        Ok(())
    }

    /// Raises the floors to those of the correction that one more solve of the level shown last would make.
    pub(super) fn raise_floors(&mut self) {
        let Pending { force, state, .. } = &self.pending[self.shown];
        self.largest_force = self.largest_force.max(norm(force));
        let (space, dofs) = (self.space, self.space.dofs());
        let mut unbalanced = force.clone();
        space.frames.force_on_unknowns(&mut unbalanced);
        let graph = self.level.graph().coordinates.iter();
        for (at, pressure) in graph.zip(&state.pressure) {
            let dof = self.level.unknowns()[at.dof as usize] as usize;
            unbalanced[dof] -= at.sign * at.weight * pressure;
        }
        // K acts on v, see above; each ℬ_i acts on its history, which holds u_n.
        let mut v = self.u[..dofs].to_vec();
        if let (Some(beta), Some(history)) = (self.beta, self.history.first()) {
            axpy(beta, &history[..dofs], &mut v);
        }
        let mut product = vec![0.0; dofs];
        space.pattern.multiply(&self.elastic, &v, &mut product);
        axpy(-1.0, &product, &mut unbalanced);
        for (matrix, history) in self.by_memory.iter().zip(&self.history) {
            space.pattern.multiply(matrix, &history[..dofs], &mut product);
            axpy(-1.0, &product, &mut unbalanced);
        }
        let diagonal = |i: usize| self.elastic[space.pattern.diagonal(i)] * v[i];
        let forces: Vec<f64> = (0..dofs).map(diagonal).collect();
        let size = norm(&forces) + norm(force);
        // What the tolerance of Newton's method in the volume would be.
        let tolerance = Newton::default().rounding_units * f64::EPSILON * size;
        let accepted = Accepted { residual: norm(&unbalanced), tolerance };
        self.analysis.solve(&self.factor, &mut unbalanced, &mut self.front);
        unbalanced.resize(space.nodes.len(), 0.0);
        space.frames.to_cartesian(&mut unbalanced);
        let largest = self.model.elasticity.eigenvalues(space.mesh.dimension).1;
        let floors = Floors::new(space, &unbalanced, &self.nodal, accepted, largest);
        self.info.floors = self.info.floors.max(floors);
    }
}
