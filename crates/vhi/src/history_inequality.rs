//! Problems 5 and 9 over a whole time grid: the inequality with its history operator.

use super::{Newton, StepError, StepInequality, StepInfo, StepState};
use crate::history::TimeGrid;

/// The fully discrete problem (4.3) on a time grid: at each t_n find u_n ∈ K with
///
///   ⟨A u_n, v-u_n⟩ + φ(S_n^k u, u_n, v) - φ(S_n^k u, u_n, u_n) + j⁰(γ_j u_n; γ_j v-γ_j u_n) ≥ ⟨f_n, v-u_n⟩
///
/// for all v ∈ K, where S_n^k u = R(k Σ'_{j≤n} q(t_n, t_j) u_j + a_S). Coordinates of u_n and graphs of ∂j + ∂I_K are
/// those of [`StepInequality`].
///
/// Levels are opened, solved and committed in turn; only [`Self::commit`] changes the history, so a failed or repeated
/// solve leaves no trace.
pub trait HistoryInequality: OpenInequality {
    type Error: From<FailedStep>;

    fn grid(&self) -> &TimeGrid;

    /// Opens the next level (the first is n = 0): the load f(t_n) and the sum over j < n. The last slot of the history
    /// is implicit: F depends on u_n through it.
    ///
    /// # Errors
    /// The load fails.
    fn open(&mut self) -> Result<(), Self::Error>;

    /// Appends u_n to the history and closes the level.
    fn commit(&mut self, solution: &StepState);
}

/// The open level of a [`HistoryInequality`], as solvers of a level see it.
pub trait OpenInequality: StepInequality {
    /// Freezes the last slot of the history of the open level at η, as the operator Λ: η ↦ u_η of the proof of Theorem
    /// 6; None makes it implicit again.
    fn freeze(&mut self, eta: Option<&[f64]>);

    /// Solves the open level by a smaller problem with the same solution, from the start value in `state`; None where there
    /// is no such problem.
    fn solve_condensed(
        &mut self,
        _newton: &Newton,
        _state: &mut StepState,
    ) -> Option<Result<StepInfo, StepError>> {
        None
    }

    /// ‖v‖_X.
    fn norm(&self, v: &[f64]) -> f64;
}

/// A time level without a computed solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("step {n} (t = {t}): {source}")]
pub struct FailedStep {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    pub source: StepError,
}
