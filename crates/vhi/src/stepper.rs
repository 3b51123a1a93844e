//! The march in time, each level started from an extrapolation of the last ones.

use super::{
    Extrapolation, FailedStep, HistoryInequality, Newton, OpenInequality, Scratch, StepError,
    StepInfo, StepState,
};

/// A solver of one time level, including the history operator.
pub trait StepSolver {
    /// Solves the open level of `problem` from the start value in `state`.
    ///
    /// # Errors
    /// See [`StepError`]; `state` is then the last iterate.
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError>;
}

impl StepSolver for Newton {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        match problem.solve_condensed(self, state) {
            Some(outcome) => outcome,
            None => self.solve(problem, state, scratch),
        }
    }
}

/// Newton's method on a level as it is, also where it could be condensed.
#[derive(Debug, Clone, Copy, Default)]
pub struct InVolume(pub Newton);

impl StepSolver for InVolume {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        self.0.solve(problem, state, scratch)
    }
}

/// The state of a march.
pub struct Stepper<'a> {
    solver: &'a dyn StepSolver,
    pub state: StepState,
    /// Vectors of the iteration; after a step that was not condensed they hold the parts of the last residual.
    pub scratch: Scratch,
    extrapolation: Extrapolation,
    level: usize,
}

impl<'a> Stepper<'a> {
    /// Before the first level, with start value zero.
    pub fn new<P: HistoryInequality>(problem: &P, solver: &'a dyn StepSolver) -> Self {
        let graphs = problem.graph().coordinates.len();
        Self {
            solver,
            state: StepState { u: vec![0.0; problem.dofs()], pressure: vec![0.0; graphs] },
            scratch: Scratch::default(),
            extrapolation: Extrapolation::default(),
            level: 0,
        }
    }

    /// Opens, solves and commits the next level.
    ///
    /// # Errors
    /// The load fails, or [`FailedStep`].
    pub fn step<P: HistoryInequality>(&mut self, problem: &mut P) -> Result<StepInfo, P::Error> {
        let (n, t) = (self.level, problem.grid().time(self.level));
        problem.open()?;
        self.extrapolation.start(t, &mut self.state);
        let info = self
            .solver
            .solve_level(problem, &mut self.state, &mut self.scratch)
            .map_err(|source| FailedStep { n, t, source })?;
        problem.commit(&self.state);
        self.extrapolation.keep(t, &self.state);
        self.level += 1;
        Ok(info)
    }
}
