//! The fixed-point iteration Λ of the proof of Theorem 6, as a solver.

use super::repeated::{Limits, repeated};
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

impl StepSolver for FixedPoint {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let limits = Limits { iterations: self.max_iterations, tolerance: self.tolerance };
        let map = |problem: &mut dyn OpenInequality, eta: &[f64], state: &mut StepState| {
            problem.freeze(Some(eta));
            self.newton.solve(problem, state, scratch)
        };
        let expanding =
            |iterations, change, factor| StepError::NotContracting { iterations, change, factor };
        let outcome = repeated(limits, problem, state, map, expanding);
        problem.freeze(None);
        let (info, fixed_point_iterations, _) = outcome?;
        Ok(StepInfo { fixed_point_iterations, ..info })
    }
}
