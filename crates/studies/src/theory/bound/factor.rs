//! The contraction factor of Λ at a state, by its derivative and by finite perturbations, and where it reaches one.

use algebra::linalg::{
    EigenError, FactorError, LinearMap, Spectrum, largest_eigenvalue, signed_unit, spectrum,
};
use vhi::{FrozenDerivative, Newton, Scratch, StepError, StepInfo, StepState};

/// What DΛ does at one state.
#[derive(Debug, Clone, PartialEq)]
pub struct Contraction {
    /// ‖DΛ‖ in X: the factor in the worst direction, the local Lipschitz constant of Λ.
    pub norm: f64,
    /// The worst direction, of length 1.
    pub direction: Vec<f64>,
    /// Spectral radius of DΛ: the factor that the iteration shows after many steps.
    pub radius: f64,
    /// Its largest real eigenvalue: the tangent of the step is singular where it is one.
    pub rightmost: f64,
}

/// DΛ or (DΛ)*DΛ as a map.
struct Map<'a, L> {
    level: &'a mut L,
    normal: bool,
    between: Vec<f64>,
}

impl<L: FrozenDerivative> LinearMap for Map<'_, L> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        if self.normal {
            self.level.derivative(x, &mut self.between)?;
            self.level.adjoint(&self.between, out)
        } else {
            self.level.derivative(x, out)
        }
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        self.level.gram(x, out);
    }
}

/// Solves the open level by Newton's method from `state`, with its last slot frozen at η where one is given.
///
/// # Errors
/// Newton's.
pub(super) fn solve<L: FrozenDerivative>(
    level: &mut L,
    eta: Option<&[f64]>,
    state: &mut StepState,
) -> Result<StepInfo, StepError> {
    level.freeze(eta);
    Newton::default().solve(level, state, &mut Scratch::default())
}

/// A vector with a part of everything.
fn mixed(length: usize, mut seed: u64) -> Vec<f64> {
    (0..length).map(|_| signed_unit(&mut seed)).collect()
}

/// Norm and eigenvalues of DΛ(η), where `state` is Λη.
///
/// # Errors
/// A linear solve fails, or the iteration does not settle.
pub fn contraction<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
) -> Result<Contraction, EigenError> {
    level.differentiate(eta, state)?;
    let (length, between) = (eta.len(), vec![0.0; eta.len()]);
    let worst = largest_eigenvalue(&mut Map { level, normal: true, between }, &mixed(length, 11))?;
    let mut map = Map { level, normal: false, between: Vec::new() };
    let Spectrum { radius, rightmost, .. } = spectrum(&mut map, &mixed(length, 12))?;
    Ok(Contraction {
        norm: worst.value.max(0.0).sqrt(),
        direction: worst.vector,
        radius,
        rightmost,
    })
}

/// Size of a perturbation, relative to ‖η‖. Rounding of Λη is some 1e-13 of it, so the ratio has
/// seven digits; kinks of Λ within 1e-6 of η are few.
const PERTURBATION: f64 = 1e-6;

/// ‖Λ(η + δd) - Λη‖/δ‖d‖ for a small δ, where `state` is Λη.
///
/// # Errors
/// The solver's.
pub fn finite_factor<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
    direction: &[f64],
) -> Result<f64, StepError> {
    let size = PERTURBATION * level.norm(eta).max(f64::MIN_POSITIVE) / level.norm(direction);
    let moved: Vec<f64> = eta.iter().zip(direction).map(|(e, d)| e + size * d).collect();
    let solved = |level: &mut L, eta: &[f64]| {
        let mut out = state.clone();
        solve(level, Some(eta), &mut out)?;
        Ok::<_, StepError>(out.u)
    };
    let (here, there) = (solved(level, eta)?, solved(level, &moved)?);
    let difference: Vec<f64> = there.iter().zip(&here).map(|(a, b)| a - b).collect();
    Ok(level.norm(&difference) / (size * level.norm(direction)))
}

/// A random state of up to three times the size of `known`.
pub(super) fn random_state<L: FrozenDerivative>(
    level: &L,
    known: &StepState,
    number: u64,
) -> StepState {
    let mut u = mixed(known.u.len(), 1000 + number);
    let size = level.norm(&known.u).max(f64::MIN_POSITIVE);
    let scale = size * (1.0 + (number % 3) as f64) / level.norm(&u);
    u.iter_mut().for_each(|value| *value *= scale);
    StepState { u, pressure: vec![0.0; known.pressure.len()] }
}

/// Where random starts ended.
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

/// Solves the open level, its last slot implicit, from `count` random states.
pub(super) fn random_starts<L: FrozenDerivative>(
    level: &mut L,
    known: &StepState,
    count: u64,
) -> Starts {
    let mut starts = Starts::default();
    let size = level.norm(&known.u).max(f64::MIN_POSITIVE);
    for number in 0..count {
        let mut state = random_state(level, known, number);
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

/// Between which k a factor reaches one: the first is 0 where it is one or more already at the smallest k that was
/// tried, the second infinite where it stays below one up to the largest.
pub type Crossing = [f64; 2];

const WIDTH: f64 = 1e-8;
/// Evaluations within one bracket: bisection alone would need 30 from a factor of two.
const EVALUATIONS: u32 = 60;

/// The first crossing of `factor` - 1 along the increasing sequence `ladder` of (k, factor), narrowed
/// by the Illinois method (a bracket is kept, so a jump is found as well).
///
/// # Errors
/// `factor` fails.
pub(super) fn crossing<E>(
    ladder: &[(f64, f64)],
    mut factor: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<Crossing>, E> {
    let (Some(first), Some(last)) = (ladder.first(), ladder.last()) else { return Ok(None) };
    let reached = |value: f64| value.is_nan() || value >= 1.0;
    if reached(first.1) {
        return Ok(Some([0.0, first.0]));
    }
    let Some(pair) = ladder.windows(2).find(|pair| reached(pair[1].1)) else {
        return Ok(Some([last.0, f64::INFINITY]));
    };
    let ((mut low, mut below), (mut high, mut above)) =
        ((pair[0].0, pair[0].1 - 1.0), (pair[1].0, pair[1].1 - 1.0));
    let mut side = 0;
    for evaluation in 0..EVALUATIONS {
        if high - low <= WIDTH * high {
            break;
        }
        let secant = low - below * (high - low) / (above - below);
        // Every third point bisects: an end that does not move must not stay far away.
        let inside = secant > low && secant < high && evaluation % 3 != 2;
        let middle = if inside { secant } else { 0.5 * (low + high) };
        let value = factor(middle)? - 1.0;
        if value.is_nan() || value >= 0.0 {
            below *= if side == 1 { 0.5 } else { 1.0 };
            (high, above, side) = (middle, value, 1);
        } else {
            above *= if side == -1 { 0.5 } else { 1.0 };
            (low, below, side) = (middle, value, -1);
        }
    }
    Ok(Some([low, high]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(factor: impl Fn(f64) -> f64) -> Crossing {
        let ladder: Vec<(f64, f64)> =
            (0..12).map(|i| 0.25 * 2f64.powi(i)).map(|k| (k, factor(k))).collect();
        crossing(&ladder, |k| Ok::<_, ()>(factor(k))).unwrap().unwrap()
    }

    #[test]
    fn lines_curves_and_jumps_are_bracketed() {
        for (factor, exact) in [
            (Box::new(|k: f64| k / 3.0) as Box<dyn Fn(f64) -> f64>, 3.0),
            (Box::new(|k: f64| (k / 5.0).powi(4)), 5.0),
            (Box::new(|k: f64| if k < 7.3 { 0.2 } else { 4.0 }), 7.3),
        ] {
            let [low, high] = found(&factor);
            assert!(low <= exact * (1.0 + 1e-15) && exact <= high * (1.0 + 1e-15));
            assert!(high - low <= 1e-8 * exact, "{low} {high}");
        }
    }

    #[test]
    fn ends_are_said_and_a_missing_value_is_no_success() {
        assert_eq!(found(|_| 0.5), [512.0, f64::INFINITY]);
        assert_eq!(found(|_| 2.0), [0.0, 0.25]);
        assert_eq!(found(|_| f64::NAN), [0.0, 0.25]);
        let nan = found(|k| if k < 6.0 { 0.1 * k } else { f64::NAN });
        assert!((nan[0] - 6.0).abs() < 1e-6, "{nan:?}");
    }
}
