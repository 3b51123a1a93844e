//! The contraction factor of Λ at a state: by its derivative, and by finite perturbations.

use algebra::linalg::{
    EigenError, FactorError, LinearMap, Spectrum, larger, largest_eigenvalue, signed_unit, spectrum,
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

/// A direction with a part of everything.
fn start(length: usize, mut seed: u64) -> Vec<f64> {
    (0..length).map(|_| signed_unit(&mut seed)).collect()
}

/// ‖DΛ(η)‖ and its direction, where `state` is Λη.
///
/// # Errors
/// A linear solve fails, or the iteration does not settle.
pub(crate) fn operator_norm<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
) -> Result<(f64, Vec<f64>), EigenError> {
    level.differentiate(eta, state)?;
    let between = vec![0.0; eta.len()];
    let found =
        largest_eigenvalue(&mut Map { level, normal: true, between }, &start(eta.len(), 11))?;
    Ok((found.value.max(0.0).sqrt(), found.vector))
}

/// The outer eigenvalues of DΛ(η), where `state` is Λη.
///
/// # Errors
/// As `operator_norm`.
pub(crate) fn eigenvalues<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
) -> Result<Spectrum, EigenError> {
    level.differentiate(eta, state)?;
    spectrum(&mut Map { level, normal: false, between: Vec::new() }, &start(eta.len(), 12))
}

/// Norm and eigenvalues.
///
/// # Errors
/// As `operator_norm`.
pub fn contraction<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
) -> Result<Contraction, EigenError> {
    let (norm, direction) = operator_norm(level, eta, state)?;
    let Spectrum { radius, rightmost, .. } = eigenvalues(level, eta, state)?;
    Ok(Contraction { norm, direction, radius, rightmost })
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

/// The largest [`finite_factor`] over `count` random directions.
///
/// # Errors
/// The solver's.
pub(crate) fn random_finite_factor<L: FrozenDerivative>(
    level: &mut L,
    eta: &[f64],
    state: &StepState,
    count: u64,
) -> Result<f64, StepError> {
    (0..count).try_fold(0.0, |worst, seed| {
        let factor = finite_factor(level, eta, state, &start(eta.len(), 100 + seed))?;
        Ok(larger(worst, factor))
    })
}
