//! Problem 14 over a time grid as a [`HistoryInequality`]: one [`ContactProblem`] level after
//! another, with the histories of ℬ and ζ.

mod ahead;
mod frozen;

use std::time::Instant;

use self::ahead::LoadsAhead;
use self::frozen::Frozen;
use super::histories::Histories;
use super::last_slot::LastSlot;
use super::{CaseError, ContactProblem, Discretization, Load, Model, strain_norm};
use algebra::linalg::{FactorError, axpy};
use vhi::history::TimeGrid;
use vhi::{
    BoundaryGraph, FailedStep, HistoryInequality, Newton, OpenInequality, StepError,
    StepInequality, StepInfo, StepState,
};

/// The contact problem with its committed history.
pub struct Evolution<'a> {
    pub(super) space: &'a Discretization,
    pub(super) model: &'a Model,
    grid: &'a TimeGrid,
    source: LoadsAhead<'a>,
    pub(super) problem: ContactProblem<'a>,
    histories: Histories<'a>,
    /// Σ_{j<n} W_nj u_j of each term of the memory while level n is open, Σ'_{j≤n} W_nj u_j after its commit.
    sums: Vec<Vec<f64>>,
    /// The latter as nodal vectors.
    history: Vec<Vec<f64>>,
    /// Levels committed so far: the index n of the open one.
    committed: usize,
    slot: LastSlot,
    past_zeta: f64,
    /// F_n, Cartesian.
    load: Vec<f64>,
    zeta: f64,
    /// DΛ of the open level, if it was asked for.
    frozen: Option<Frozen<'a>>,
    /// Seconds in loads.
    pub seconds_load: f64,
    /// Largest memory held by the history.
    pub peak_history_bytes: usize,
}

impl<'a> Evolution<'a> {
    /// Before the first level.
    ///
    /// # Errors
    /// The pattern of the tangent cannot be analysed.
    pub fn new(
        space: &'a Discretization,
        model: &'a Model,
        grid: &'a TimeGrid,
        source: &'a mut dyn Load,
    ) -> Result<Self, FailedStep> {
        Ok(Self {
            problem: ContactProblem::new(space, model).map_err(|source| FailedStep {
                n: 0,
                t: grid.time(0),
                source: StepError::Factor { iteration: 0, source },
            })?,
            histories: Histories::new(&model.memory, &*model.time_rule, grid, space.dofs()),
            sums: vec![vec![0.0; space.dofs()]; model.memory.len()],
            history: vec![vec![0.0; space.nodes.len()]; model.memory.len()],
            committed: 0,
            slot: LastSlot::default(),
            past_zeta: 0.0,
            load: vec![0.0; space.dofs()],
            zeta: 0.0,
            frozen: None,
            seconds_load: 0.0,
            peak_history_bytes: 0,
            space,
            model,
            grid,
            source: LoadsAhead::new(source),
        })
    }

    /// The problem at the open or last committed level.
    pub fn problem(&self) -> &ContactProblem<'a> {
        &self.problem
    }

    /// F_n of the open or last committed level.
    pub fn load(&self) -> &[f64] {
        &self.load
    }

    /// Σ'_{j≤n} W_nj u_j of the last committed level as nodal vectors, one per term of the memory.
    pub fn history(&self) -> &[Vec<f64>] {
        &self.history
    }

    /// A vector of unknowns as displacements of all nodes.
    pub(crate) fn nodal(&self, unknowns: &[f64]) -> Vec<f64> {
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
        self.slot.clone()
    }

    /// Changes the weights of the last slot of the open level: a last step of another size after the
    /// same past.
    pub fn set_last_slot(&mut self, slot: LastSlot) {
        self.slot = slot;
        self.begin_implicit();
    }

    fn begin_implicit(&mut self) {
        let sums = if self.committed > 0 { &self.sums[..] } else { &[] };
        self.problem.begin(&self.slot, self.past_zeta, &self.load, sums);
        if let Some(solved) = self.source.solved(self.committed) {
            self.problem.take_solved(solved, sums);
        }
    }
}

impl HistoryInequality for Evolution<'_> {
    type Error = CaseError;

    fn grid(&self) -> &TimeGrid {
        self.grid
    }

    fn open(&mut self) -> Result<(), CaseError> {
        let n = self.committed;
        let start = Instant::now();
        self.source.take(n, self.grid, &mut self.problem, &mut self.load)?;
        self.seconds_load += start.elapsed().as_secs_f64();
        let rule = self.model.time_rule.as_ref();
        self.slot.zeta = rule.weight(self.grid, n, n);
        self.slot.memory.clear();
        self.slot.memory.extend(self.model.last_weights(self.grid, n));
        self.past_zeta = self.histories.past(self.grid, &mut self.sums);
        self.problem.set_time(self.grid.time(n));
        self.begin_implicit();
        Ok(())
    }

    fn commit(&mut self, solution: &StepState) {
        let strain_norm = self.problem.strain_norm();
        self.zeta = self.past_zeta + self.slot.zeta * strain_norm;
        let level = (&solution.u[..], strain_norm);
        self.histories.commit(self.grid, level, &self.slot.memory, &mut self.sums);
        for (nodal, sum) in self.history.iter_mut().zip(&self.sums) {
            nodal[..sum.len()].copy_from_slice(sum);
            self.space.frames.to_cartesian(nodal);
        }
        self.peak_history_bytes = self.peak_history_bytes.max(self.histories.bytes());
        self.committed += 1;
    }
}

impl OpenInequality for Evolution<'_> {
    fn freeze(&mut self, eta: Option<&[f64]>) {
        let Some(eta) = eta else { return self.begin_implicit() };
        let zeta = self.past_zeta + self.slot.zeta * self.norm(eta);
        let mut sums = self.sums.clone();
        sums.iter_mut().zip(&self.slot.memory).for_each(|(sum, weight)| axpy(*weight, eta, sum));
        self.problem.begin(&LastSlot::default(), zeta, &self.load, &sums);
        if let Some(solved) = self.source.solved(self.committed) {
            self.problem.take_solved(solved, &sums);
        }
    }

    fn solve_condensed(
        &mut self,
        newton: &Newton,
        state: &mut StepState,
    ) -> Option<Result<StepInfo, StepError>> {
        self.problem.solve_condensed(newton, state)
    }

    /// ‖ε(v)‖.
    fn norm(&self, v: &[f64]) -> f64 {
        strain_norm(self.space, &self.nodal(v))
    }
}

impl StepInequality for Evolution<'_> {
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

    fn take_pressures(&mut self, pressures: &[f64]) {
        self.problem.take_pressures(pressures);
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

    fn add_rounding(&self, state: &StepState, sizes: &mut [f64]) {
        self.problem.add_rounding(state, sizes);
    }
}
