//! Γ3 of a run whose volume is condensed: one small full problem per level.

use super::boundary::boundary_graph;
use super::condensed_level::CondensedLevel;
use super::one_matrix::Pending;
use super::volume::Volume;
use super::{Discretization, Model};
use vhi::history::{Memory, TimeGrid};
use vhi::{Extrapolation, Newton, Scratch, StepError, StepInfo, StepState};

/// Γ3 with what it remembers.
pub(super) struct Side<'a> {
    pub level: CondensedLevel<'a>,
    /// β of ℬ₀ = β𝒜, 0 otherwise.
    beta: f64,
    /// With a multiple: the memory of the unknowns of Γ3 alone, and its sum over the past.
    memory: Option<Memory>,
    past: Vec<f64>,
    state: StepState,
    scratch: Scratch,
    extrapolation: Extrapolation,
}

impl<'a> Side<'a> {
    /// Before the first level.
    pub(super) fn new(
        space: &Discretization,
        model: &'a Model,
        grid: &TimeGrid,
        volume: &Volume<'_>,
    ) -> Self {
        let graph = boundary_graph(space, model, &volume.elastic);
        let graphs = graph.coordinates.len();
        let level = CondensedLevel::new(space, model, graph);
        let size = level.unknowns().len();
        let rule = model.time_rule.as_ref();
        let term = model.memory.first().filter(|_| volume.beta.is_some());
        Self {
            beta: volume.beta.unwrap_or(0.0),
            memory: term.map(|term| Memory::new(&*term.kernel, rule, grid, size)),
            past: vec![0.0; size],
            state: StepState { u: vec![0.0; size], pressure: vec![0.0; graphs] },
            scratch: Scratch::default(),
            extrapolation: Extrapolation::default(),
            level,
        }
    }

    pub(super) fn size(&self) -> usize {
        self.past.len()
    }

    pub(super) fn bytes(&self) -> usize {
        self.memory.as_ref().map_or(0, Memory::bytes)
    }

    /// Takes the start values of a level.
    pub(super) fn start(&mut self, t: f64) {
        self.extrapolation.start(t, &mut self.state);
    }

    /// Keeps the level that was solved last.
    pub(super) fn keep(&mut self, grid: &TimeGrid, t: f64) {
        self.extrapolation.keep(t, &self.state);
        if let Some(memory) = &mut self.memory {
            memory.commit(grid, &self.state.u);
        }
    }

    /// Solves `pending`, whose condensed right side is every `width`-th of `rows`, and leaves v_n there.
    pub(super) fn solve(
        &mut self,
        model: &Model,
        grid: &TimeGrid,
        newton: &Newton,
        pending: &mut Pending,
        (rows, width): (&mut [f64], usize),
    ) -> Result<StepInfo, StepError> {
        let (level, beta) = (&mut self.level, self.beta);
        level.scale = pending.scale;
        let right = rows.iter().step_by(width);
        level.load.iter_mut().zip(right).for_each(|(load, row)| *load = *row);
        if let (Some(memory), Some(term)) = (&mut self.memory, model.memory.first()) {
            memory.past(&*term.kernel, model.time_rule.as_ref(), grid, &mut self.past);
            level.add_to_load(-beta, self.past.iter().copied());
        }
        let info = newton.solve(level, &mut self.state, &mut self.scratch)?;
        let known = self.state.u.iter().zip(&self.past);
        for (row, (u, past)) in rows.iter_mut().step_by(width).zip(known) {
            *row = pending.scale * u + beta * past;
        }
        pending.state.clone_from(&self.state);
        Ok(info)
    }
}
