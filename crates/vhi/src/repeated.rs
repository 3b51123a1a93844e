//! Maps of a level that are repeated until they change nothing: Λ, and the convex problems of Remark 3.

use super::{OpenInequality, StepError, StepInfo, StepState};

/// Changes within rounding, as a share of ‖u‖: a level is solved to about condition · ε, so iterates keep differing by
/// as much.
const ROUNDING: f64 = 1e-11;
/// Iterations in a row without a smaller change after which a map does not contract.
const PATIENCE: u32 = 12;
/// Changes, as a share of ‖u‖, whose quotients count: above the accuracy of one solve.
const COUNTED: f64 = 1e-8;

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    pub iterations: u32,
    /// Of the change ‖u' - u‖_X, as a share of ‖u'‖_X.
    pub tolerance: f64,
}

/// The sums over all iterations with the residual of the last, their number, and the largest quotient of successive
/// changes, 0 if none was measured.
pub(crate) type Repeated = (StepInfo, u32, f64);

/// Repeats `map`, which is given the last iterate and leaves the next in the state.
///
/// # Errors
/// Those of `map`; `expanding` of iterations, change, and quotient of changes where they do not contract.
pub(crate) fn repeated(
    limits: Limits,
    problem: &mut dyn OpenInequality,
    state: &mut StepState,
    mut map: impl FnMut(&mut dyn OpenInequality, &[f64], &mut StepState) -> Result<StepInfo, StepError>,
    expanding: impl Fn(u32, f64, f64) -> StepError,
) -> Result<Repeated, StepError> {
    let mut total = StepInfo::default();
    let mut before = state.u.clone();
    let (mut best, mut since_best, mut last) = (f64::INFINITY, 0, f64::INFINITY);
    let mut contraction = 0f64;
    for iteration in 1..=limits.iterations {
        let info = map(problem, &before, state)?;
        total = StepInfo {
            iterations: total.iterations + info.iterations,
            active_set_changes: total.active_set_changes + info.active_set_changes,
            damped: total.damped + info.damped,
            ..info
        };
        for (before, u) in before.iter_mut().zip(&state.u) {
            *before = u - *before;
        }
        let (change, size) = (problem.norm(&before), problem.norm(&state.u));
        if !change.is_finite() {
            return Err(StepError::NotFinite { iteration, value: change });
        }
        // Quotients of changes near rounding say nothing about the map.
        if last.is_finite() && last > COUNTED * size {
            contraction = contraction.max(change / last);
        }
        if change < best {
            (best, since_best) = (change, 0);
        } else {
            since_best += 1;
        }
        let stands = since_best >= PATIENCE && best <= ROUNDING * size;
        if change <= limits.tolerance * size || stands {
            return Ok((total, iteration, contraction));
        }
        if since_best >= PATIENCE {
            return Err(expanding(iteration, change, change / last));
        }
        last = change;
        before.clone_from(&state.u);
    }
    Err(expanding(limits.iterations, last, f64::NAN))
}
