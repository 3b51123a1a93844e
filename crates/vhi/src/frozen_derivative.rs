//! The derivative of Λ, for checks of the theory.

use super::{HistoryInequality, StepState};
use algebra::linalg::FactorError;

/// A problem whose open level has a map Λ: η ↦ u_η (3.7) with a (generalized) derivative.
///
/// The step size of the open level may be varied: load and past are kept, only the implicit weight k/2 of the last slot
/// changes. Maps act on coefficient vectors.
pub trait FrozenDerivative: HistoryInequality + Send {
    /// Gives the last slot of the open level the weight of a step k.
    fn set_step(&mut self, k: f64);

    /// Prepares DΛ(η), where `state` is Λη.
    fn differentiate(&mut self, eta: &[f64], state: &StepState) -> Result<(), FactorError>;

    /// `out` ← DΛ x.
    fn derivative(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError>;

    /// `out` ← (DΛ)* x, the adjoint in the inner product of X.
    fn adjoint(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError>;

    /// `out` ← G x with the matrix G of the inner product of X.
    fn gram(&mut self, x: &[f64], out: &mut [f64]);
}
