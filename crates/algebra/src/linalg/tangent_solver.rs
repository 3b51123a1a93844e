//! Solver of a sequence of Jacobians, with or without factors.

use super::cholesky::FactorError;
use super::jacobian::Jacobian;

/// Counters and times.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinearWork {
    /// Numerical factorizations, in either precision.
    pub factorizations: u32,
    /// Passes over a factor, or solves without one.
    pub solves: u32,
    pub seconds_factor: f64,
    pub seconds_solve: f64,
}

impl LinearWork {
    /// Both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            factorizations: self.factorizations + other.factorizations,
            solves: self.solves + other.solves,
            seconds_factor: self.seconds_factor + other.seconds_factor,
            seconds_solve: self.seconds_solve + other.seconds_solve,
        }
    }
}

/// Takes Jacobians one after the other, and solves with the last one.
pub trait TangentSolver {
    /// Takes the Jacobian of the next solves. `unchanged` says that K is that of the last one, without a rank-one part.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    fn prepare(&mut self, jacobian: &Jacobian, unchanged: bool) -> Result<(), FactorError>;

    /// Solves with the Jacobian of [`Self::prepare`] in place, to a residual of at most `forcing` times the right side.
    ///
    /// # Errors
    /// As [`Self::prepare`]; a rank-one part that makes the Jacobian singular; no convergence.
    fn solve(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        forcing: f64,
    ) -> Result<(), FactorError>;

    /// K⁻¹ r with the last factor, whatever Jacobian it belongs to, or an estimate of it, NaN on failure; no operation before
    /// the first K.
    fn solve_with_last_factor(&mut self, jacobian: &Jacobian, rhs: &mut [f64]);

    /// Counters and times.
    fn work(&self) -> LinearWork;
}
