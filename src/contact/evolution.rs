//! Problem 14 over a time grid as a [`HistoryInequality`]: one [`ContactProblem`] level after
//! another, with the histories of ℬ and ζ.

use std::borrow::Cow;
use std::time::Instant;

use super::problem::LastSlot;
use super::{CaseError, ContactProblem, Discretization, Load, Model, strain_norm};
use crate::history::{Accumulated, Memory, TimeGrid};
use crate::law::{Convolution, Projection};
use crate::linalg::{FactorError, axpy};
use crate::vhi::{BoundaryGraph, HistoryInequality, StepInequality, StepState};

/// The contact problem with its committed history.
pub struct Evolution<'a, P> {
    space: &'a Discretization,
    model: &'a Model<P>,
    grid: &'a TimeGrid,
    source: &'a mut dyn Load,
    problem: ContactProblem<'a, P>,
    memory: Option<Memory>,
    accumulated: Accumulated,
    /// Levels committed so far: the index n of the open one.
    committed: usize,
    slot: LastSlot,
    past_zeta: f64,
    /// F_n, Cartesian.
    load: Vec<f64>,
    /// Σ_{j<n} W_nj u_j while a level is open, Σ'_{j≤n} W_nj u_j after its commit, of
    /// unknowns padded to all nodes.
    history: Vec<f64>,
    /// The same with a frozen last slot.
    frozen_history: Vec<f64>,
    zeta: f64,
    /// Seconds in loads.
    pub seconds_load: f64,
    /// Largest memory held by the history.
    pub peak_history_bytes: usize,
}

impl<'a, P: Projection> Evolution<'a, P> {
    /// Before the first level.
    pub fn new(
        space: &'a Discretization,
        model: &'a Model<P>,
        grid: &'a TimeGrid,
        source: &'a mut dyn Load,
    ) -> Self {
        let rule = model.time_rule.as_ref();
        let memory =
            model.memory.as_ref().map(|term| Memory::new(&*term.kernel, rule, space.dofs()));
        let remembered = if memory.is_some() { space.nodes.len() } else { 0 };
        Self {
            problem: ContactProblem::new(space, model),
            memory,
            accumulated: Accumulated::default(),
            committed: 0,
            slot: LastSlot::default(),
            past_zeta: 0.0,
            load: vec![0.0; space.dofs()],
            history: vec![0.0; remembered],
            frozen_history: Vec::new(),
            zeta: 0.0,
            seconds_load: 0.0,
            peak_history_bytes: 0,
            space,
            model,
            grid,
            source,
        }
    }

    /// The problem at the open or last committed level.
    pub fn problem(&self) -> &ContactProblem<'a, P> {
        &self.problem
    }

    /// The same, for a solve with its last factor.
    pub fn problem_mut(&mut self) -> &mut ContactProblem<'a, P> {
        &mut self.problem
    }

    /// F_n of the open or last committed level.
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// Σ'_{j≤n} W_nj u_j of the last committed level as a nodal vector, where there is memory.
    pub fn history(&self) -> Option<Cow<'_, [f64]>> {
        self.memory.as_ref()?;
        Some(if self.space.frames.is_empty() {
            Cow::Borrowed(&self.history)
        } else {
            Cow::Owned(self.nodal(&self.history))
        })
    }

    /// A vector of unknowns as displacements of all nodes.
    pub fn nodal(&self, unknowns: &[f64]) -> Vec<f64> {
        let mut nodal = unknowns.to_vec();
        nodal.resize(self.space.nodes.len(), 0.0);
        self.space.frames.to_cartesian(&mut nodal);
        nodal
    }

    /// ζ_n of the last committed level.
    pub fn zeta(&self) -> f64 {
        self.zeta
    }

    /// Weights of the last slot of the open or last committed level.
    pub fn last_slot(&self) -> LastSlot {
        self.slot
    }

    /// Changes the weights of the last slot of the open level: a last step of another size after the
    /// same past.
    pub fn set_last_slot(&mut self, slot: LastSlot) {
        self.slot = slot;
        self.begin_implicit();
    }

    fn begin_implicit(&mut self) {
        let dofs = self.space.dofs();
        let past = self.memory.as_ref().filter(|_| self.committed > 0);
        let past = past.map(|_| &self.history[..dofs]);
        self.problem.begin(self.slot, self.past_zeta, &self.load, past);
    }
}

impl<P: Projection> HistoryInequality for Evolution<'_, P> {
    type Error = CaseError;

    fn grid(&self) -> &TimeGrid {
        self.grid
    }

    fn open(&mut self) -> Result<(), CaseError> {
        let n = self.committed;
        let start = Instant::now();
        self.source.assemble(self.grid.time(n), &mut self.load)?;
        self.seconds_load += start.elapsed().as_secs_f64();
        let rule = self.model.time_rule.as_ref();
        self.slot = LastSlot { zeta: rule.weight(self.grid, n, n), memory: 0.0 };
        self.past_zeta = self.accumulated.past(rule, self.grid);
        if let (Some(memory), Some(term)) = (&self.memory, &self.model.memory) {
            self.slot.memory = rule.kernel_weight(&Convolution(&*term.kernel), self.grid, n, n);
            let dofs = self.space.dofs();
            memory.past(&*term.kernel, rule, self.grid, &mut self.history[..dofs]);
        }
        self.begin_implicit();
        Ok(())
    }

    fn freeze(&mut self, eta: Option<&[f64]>) {
        let Some(eta) = eta else { return self.begin_implicit() };
        let dofs = self.space.dofs();
        let zeta = self.past_zeta + self.slot.zeta * self.norm(eta);
        let past = self.memory.as_ref().map(|_| {
            self.frozen_history.resize(dofs, 0.0);
            self.frozen_history.copy_from_slice(&self.history[..dofs]);
            axpy(self.slot.memory, eta, &mut self.frozen_history);
            self.frozen_history.as_slice()
        });
        self.problem.begin(LastSlot::default(), zeta, &self.load, past);
    }

    fn commit(&mut self, solution: &StepState) {
        let dofs = self.space.dofs();
        let strain_norm = self.problem.strain_norm();
        self.zeta = self.past_zeta + self.slot.zeta * strain_norm;
        self.accumulated.commit(self.grid, strain_norm);
        if let Some(memory) = &mut self.memory {
            memory.commit(self.grid, &solution.u);
            axpy(self.slot.memory, &solution.u, &mut self.history[..dofs]);
            self.peak_history_bytes = self.peak_history_bytes.max(memory.bytes());
        }
        self.committed += 1;
    }

    /// ‖ε(v)‖.
    fn norm(&self, v: &[f64]) -> f64 {
        strain_norm(self.space, &self.nodal(v))
    }
}

impl<P: Projection> StepInequality for Evolution<'_, P> {
    fn dofs(&self) -> usize {
        self.problem.dofs()
    }

    fn descent(&self, i: usize) -> f64 {
        self.problem.descent(i)
    }

    fn graph(&self) -> &BoundaryGraph {
        self.problem.graph()
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        self.problem.residual(u, out);
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        self.problem.linearize(slopes, prescribed)
    }

    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        self.problem.solve(rhs, forcing)
    }

    fn force_scale(&self, u: &[f64]) -> f64 {
        self.problem.force_scale(u)
    }
}
