//! Newton's method to the limits of rounding: the distance to its solution shows what the accepted residual of the
//! default solver leaves.

use super::{Newton, OpenInequality, Scratch, StepError, StepInfo, StepSolver, StepState};

/// Solves a level, then continues with single Newton iterations until the residual is below 1/100 of the tolerance, or
/// rounding keeps it from falling. Linear levels are solved the same way, with the factors of a sequence and residuals,
/// not by one direct solve.
#[derive(Debug, Clone, Copy, Default)]
pub struct Polished {
    pub newton: Newton,
}

/// Targeted share of the default tolerance.
const SHARE: f64 = 0.01;
/// Iterations in a row without a smaller residual after which only rounding is left.
const PATIENCE: u32 = 3;
/// Limit of iterations: each divides the residual by 1e4 or meets rounding.
const LIMIT: u32 = 12;

impl StepSolver for Polished {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        let mut info = self.newton.solve(problem, state, scratch)?;
        let further = Newton {
            max_iterations: 1,
            rounding_units: SHARE * self.newton.rounding_units,
            ..self.newton
        };
        let mut best = (state.clone(), scratch.clone());
        let mut since_best = 0;
        for _ in 0..LIMIT {
            let residual = match further.solve(problem, state, scratch) {
                Ok(step) => {
                    info.iterations += step.iterations;
                    info.residual = step.residual;
                    return Ok(info);
                }
                Err(StepError::NotConverged { residual, .. }) => residual,
                Err(error) => return Err(error),
            };
            info.iterations += 1;
            if residual < info.residual {
                info.residual = residual;
                best = (state.clone(), scratch.clone());
                since_best = 0;
            } else {
                since_best += 1;
            }
            if since_best == PATIENCE {
                break;
            }
        }
        // The problem evaluates the best iterate once more, for its strains. Pressures stay: where slip begins, pieces
        // chosen anew from a state at a jump may be others, which leave more than rounding.
        (*state, *scratch) = best;
        problem.residual(&state.u, &mut scratch.force);
        Ok(info)
    }
}
