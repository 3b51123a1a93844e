//! Uniqueness of a step, sampled: Newton's method from random starts.

use super::factor::solve;
use algebra::linalg::signed_unit;
use vhi::{FrozenDerivative, StepState};

/// Where the random starts ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct Starts {
    /// Starts that end at the known solution.
    pub same: u32,
    /// Starts that end at another solution.
    pub distinct: u32,
    /// Nowhere: Newton's method is local, so this says nothing.
    pub failed: u32,
}

/// Two solutions are the same if they differ by less than this share: each is found to rounding times
/// the condition of the step.
const SAME: f64 = 1e-7;

/// Solves the open level, its last slot implicit, from `count` random starts of up to three times the
/// size of `known`.
pub(crate) fn random_starts<L: FrozenDerivative>(
    level: &mut L,
    known: &StepState,
    count: u64,
) -> Starts {
    let mut starts = Starts::default();
    let size = level.norm(&known.u).max(f64::MIN_POSITIVE);
    for number in 0..count {
        let mut seed = 1000 + number;
        let mut u: Vec<f64> = known.u.iter().map(|_| signed_unit(&mut seed)).collect();
        let scale = size * (1.0 + (number % 3) as f64) / level.norm(&u);
        u.iter_mut().for_each(|value| *value *= scale);
        let mut state = StepState { u, pressure: vec![0.0; known.pressure.len()] };
        let solved = solve(level, None, &mut state).is_ok();
        let off: Vec<f64> = state.u.iter().zip(&known.u).map(|(a, b)| a - b).collect();
        // A NaN is not the same.
        let end = match level.norm(&off) <= SAME * size {
            _ if !solved => &mut starts.failed,
            true => &mut starts.same,
            false => &mut starts.distinct,
        };
        *end += 1;
    }
    starts
}
