//! Loads of several levels together, where one matrix serves all of them: a factor is read once for eight right sides, in a
//! third of the time.

use crate::contact::{ContactProblem, Load, LoadError};
use vhi::history::TimeGrid;

/// Levels whose loads are solved with together.
const LEVELS: usize = 8;

pub(super) struct LoadsAhead<'a> {
    source: &'a mut dyn Load,
    /// The first level of those that are here, their loads F_n and 𝒜⁻¹ F_n, one after another.
    first: usize,
    loads: Vec<f64>,
    solved: Vec<f64>,
    order: usize,
}

impl<'a> LoadsAhead<'a> {
    pub(super) fn new(source: &'a mut dyn Load) -> Self {
        Self { source, first: 0, loads: Vec::new(), solved: Vec::new(), order: 0 }
    }

    /// `load` ← F_n.
    ///
    /// # Errors
    /// [`LoadError`] of this load; one of a later level is that level's.
    pub(super) fn take(
        &mut self,
        n: usize,
        grid: &TimeGrid,
        problem: &mut ContactProblem<'_>,
        load: &mut [f64],
    ) -> Result<(), LoadError> {
        self.order = load.len();
        if !problem.solves_ahead() {
            return self.source.assemble(grid.time(n), load);
        }
        if self.column(n).is_none() {
            self.first = n;
            self.loads.clear();
            for level in n..=grid.steps().min(n + LEVELS - 1) {
                match self.source.assemble(grid.time(level), load) {
                    Err(error) if level == n => return Err(error),
                    Err(_) => break,
                    Ok(()) => self.loads.extend_from_slice(load),
                }
            }
            self.solved.clone_from(&self.loads);
            problem.solve_ahead(&mut self.solved);
        }
        if let Some(at) = self.column(n) {
            load.copy_from_slice(&self.loads[at]);
        }
        Ok(())
    }

    /// 𝒜⁻¹ F_n.
    pub(super) fn solved(&self, n: usize) -> Option<&[f64]> {
        self.column(n).map(|at| &self.solved[at])
    }

    fn column(&self, n: usize) -> Option<std::ops::Range<usize>> {
        let start = n.checked_sub(self.first)? * self.order;
        (start < self.loads.len()).then(|| start..start + self.order)
    }
}
