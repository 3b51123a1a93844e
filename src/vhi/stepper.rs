//! The march in time: level after level, each started from an extrapolation of the last ones.

use super::{FailedStep, HistoryInequality, Newton, Scratch, StepError, StepInfo, StepState};

/// A solver of one time level, the history operator included.
pub trait StepSolver {
    /// Solves the open level of `problem` from the start value in `state`.
    ///
    /// # Errors
    /// See [`StepError`]; `state` is then the last iterate and no result.
    fn solve_level<P: HistoryInequality>(
        &self,
        problem: &mut P,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError>;

    /// Whether a linear level may be solved by one linear solve in place of this solver.
    fn is_direct(&self) -> bool {
        false
    }
}

impl StepSolver for Newton {
    fn solve_level<P: HistoryInequality>(
        &self,
        problem: &mut P,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        self.solve(problem, state, scratch)
    }

    fn is_direct(&self) -> bool {
        true
    }
}

/// Levels through which start values are extrapolated.
const EXTRAPOLATED: usize = 3;

/// The state of a march.
pub struct Stepper<'a, S> {
    solver: &'a S,
    /// The level that was solved last.
    pub state: StepState,
    /// Vectors of the iteration; after a step they hold what the last residual was made of.
    pub scratch: Scratch,
    /// The last solutions (u, c) with their times, newest first.
    last: Vec<(f64, StepState)>,
    level: usize,
}

impl<'a, S: StepSolver> Stepper<'a, S> {
    /// Before the first level; the start value there is zero.
    pub fn new<P: HistoryInequality>(problem: &P, solver: &'a S) -> Self {
        let graphs = problem.graph().coordinates.len();
        Self {
            solver,
            state: StepState { u: vec![0.0; problem.dofs()], pressure: vec![0.0; graphs] },
            scratch: Scratch::default(),
            last: Vec::new(),
            level: 0,
        }
    }

    /// Opens, solves and commits the next level.
    ///
    /// # Errors
    /// The load's, or [`FailedStep`] with what the solver said.
    pub fn step<P: HistoryInequality>(&mut self, problem: &mut P) -> Result<StepInfo, P::Error> {
        let (n, t) = (self.level, problem.grid().time(self.level));
        problem.open()?;
        self.extrapolate(t);
        let info = self
            .solver
            .solve_level(problem, &mut self.state, &mut self.scratch)
            .map_err(|source| FailedStep { n, t, source })?;
        problem.commit(&self.state);
        self.keep(t);
        self.level += 1;
        Ok(info)
    }

    fn keep(&mut self, t: f64) {
        if self.last.len() == EXTRAPOLATED {
            self.last.rotate_right(1);
            self.last[0].0 = t;
            self.last[0].1.clone_from(&self.state);
        } else {
            self.last.insert(0, (t, self.state.clone()));
        }
    }

    /// Start values: u and c through the last levels, exact for quadratics on any grid.
    fn extrapolate(&mut self, t: f64) {
        let last = &self.last;
        if last.is_empty() {
            return;
        }
        let weights: Vec<f64> = (0..last.len())
            .map(|a| {
                let others = (0..last.len()).filter(|&b| b != a);
                others.map(|b| (t - last[b].0) / (last[a].0 - last[b].0)).product()
            })
            .collect();
        let blend = |pick: fn(&StepState) -> &[f64], out: &mut [f64]| {
            out.fill(0.0);
            for ((_, state), weight) in last.iter().zip(&weights) {
                crate::linalg::axpy(*weight, pick(state), out);
            }
        };
        blend(|state| &state.u, &mut self.state.u);
        blend(|state| &state.pressure, &mut self.state.pressure);
    }
}
