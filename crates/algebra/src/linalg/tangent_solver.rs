//! Solver of a sequence of Jacobians, with or without factors.

use super::cholesky::FactorError;
use super::jacobian::Jacobian;
use super::multigrid_sequence::MultigridSequence;
use super::sequence::{LinearWork, SequenceSolver};

/// Methods are those of [`SequenceSolver`].
pub enum TangentSolver<'a> {
    Direct(Box<SequenceSolver<'a>>),
    Multigrid(Box<MultigridSequence<'a>>),
}

impl TangentSolver<'_> {
    /// Takes the Jacobian of the next solves. `unchanged` says that K is that of the last one, without a rank-one part.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn prepare(&mut self, jacobian: &Jacobian, unchanged: bool) -> Result<(), FactorError> {
        match self {
            Self::Direct(solver) => solver.prepare(jacobian, unchanged),
            Self::Multigrid(solver) => solver.prepare(jacobian, unchanged),
        }
    }

    /// Solves in place, to a residual of at most `forcing` times the right side.
    ///
    /// # Errors
    /// As [`Self::prepare`]; a rank-one part that makes the Jacobian singular.
    pub fn solve(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        forcing: f64,
    ) -> Result<(), FactorError> {
        match self {
            Self::Direct(solver) => solver.solve(jacobian, rhs, forcing),
            Self::Multigrid(solver) => solver.solve(jacobian, rhs, forcing),
        }
    }

    /// K⁻¹ r with the last factor, or an estimate of it; no operation before the first K.
    pub fn solve_with_last_factor(&mut self, jacobian: &Jacobian, rhs: &mut [f64]) {
        match self {
            Self::Direct(solver) => solver.solve_with_last_factor(rhs),
            Self::Multigrid(solver) => solver.solve_again(jacobian, rhs),
        }
    }

    /// Counters and times.
    pub fn work(&self) -> LinearWork {
        match self {
            Self::Direct(solver) => solver.work,
            Self::Multigrid(solver) => solver.work,
        }
    }
}
