//! The fixed-point iteration Λ of the proof of Theorem 6, as a solver.

use super::{Newton, OpenInequality, Scratch, StepError, StepInfo, StepSolver, StepState};

/// η ← Λη = u_η until it converges: the last slot of the history is frozen at η, the rest of the level solved by
/// Newton's method. Λ contracts with factor k β_φ‖R‖‖q‖/m0 at most (3.15).
#[derive(Debug, Clone, Copy)]
pub struct FixedPoint {
    /// Solves the level with frozen last slot.
    pub newton: Newton,
    /// Limit of iterations per level.
    pub max_iterations: u32,
    /// Stops when ‖u_η - η‖_X falls below this share of ‖u_η‖_X.
    pub tolerance: f64,
}

impl Default for FixedPoint {
    /// 1e-13: for a factor θ the error is θ/(1-θ) times as large, which meets the promised 1e-9 up to θ = 0.9999. 2,000
    /// iterations reach 1e-13 up to θ = 0.985.
    fn default() -> Self {
        Self { newton: Newton::default(), max_iterations: 2000, tolerance: 1e-13 }
    }
}

/// Changes within rounding, as a share of ‖u‖: a frozen level is solved to about condition · ε, so iterates keep
/// differing by as much.
const ROUNDING: f64 = 1e-11;
/// Iterations in a row without a smaller change after which Λ does not contract.
const PATIENCE: u32 = 12;

impl StepSolver for FixedPoint {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let outcome = self.iterate(problem, state, scratch);
        problem.freeze(None);
        outcome
    }
}

impl FixedPoint {
    fn iterate(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let mut total = StepInfo::default();
        let mut eta = state.u.clone();
        let mut difference = vec![0.0; eta.len()];
        let (mut best, mut since_best, mut last) = (f64::INFINITY, 0, f64::INFINITY);
        for iteration in 1..=self.max_iterations {
            problem.freeze(Some(&eta));
            let info = self.newton.solve(problem, state, scratch)?;
            total = StepInfo {
                iterations: total.iterations + info.iterations,
                active_set_changes: total.active_set_changes + info.active_set_changes,
                damped: total.damped + info.damped,
                fixed_point_iterations: iteration,
                ..info
            };
            for (d, (u, eta)) in difference.iter_mut().zip(state.u.iter().zip(&eta)) {
                *d = u - eta;
            }
            let (change, size) = (problem.norm(&difference), problem.norm(&state.u));
            if !change.is_finite() {
                return Err(StepError::NotFinite { iteration, value: change });
            }
            if change <= self.tolerance * size {
                return Ok(total);
            }
            if change < best {
                (best, since_best) = (change, 0);
            } else {
                since_best += 1;
            }
            if since_best >= PATIENCE {
                if best <= ROUNDING * size {
                    return Ok(total);
                }
                let factor = change / last;
                return Err(StepError::NotContracting { iterations: iteration, change, factor });
            }
            last = change;
            eta.clone_from(&state.u);
        }
        let iterations = self.max_iterations;
        Err(StepError::NotContracting { iterations, change: last, factor: f64::NAN })
    }
}
