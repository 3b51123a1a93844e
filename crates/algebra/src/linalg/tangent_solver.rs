//! Solver of a sequence of Jacobians, with or without factors.

use super::cholesky::FactorError;
use super::multigrid_sequence::MultigridSequence;
use super::sequence::{LinearWork, NonsymmetricEntry, RankOne, SequenceSolver};

/// Methods are those of [`SequenceSolver`].
pub enum TangentSolver<'a> {
    Direct(Box<SequenceSolver<'a>>),
    Multigrid(Box<MultigridSequence<'a>>),
}

impl TangentSolver<'_> {
    /// Lower-triangle values of K, to be refilled for [`Self::prepare`].
    pub fn take_values(&mut self) -> Vec<f64> {
        match self {
            Self::Direct(solver) => solver.take_values(),
            Self::Multigrid(solver) => solver.take_values(),
        }
    }

    /// The rank-one part of the last Jacobian, to be refilled likewise; empty vectors if it had none.
    pub fn take_rank_one(&mut self) -> RankOne {
        match self {
            Self::Direct(solver) => solver.take_rank_one(),
            Self::Multigrid(solver) => solver.take_rank_one(),
        }
    }

    /// The unknowns whose rows and columns in the next K are zero off the diagonal.
    pub fn hold(&mut self, dofs: impl Iterator<Item = usize>) {
        if let Self::Multigrid(solver) = self {
            solver.hold(dofs);
        }
    }

    /// Sets C of the next Jacobians. Multigrid ignores it: Newton steps then use the rest of the Jacobian, and more are
    /// needed.
    pub fn couple(&mut self, couplings: impl Iterator<Item = NonsymmetricEntry>) {
        if let Self::Direct(solver) = self {
            solver.couple(couplings);
        }
    }

    /// Transposes C, for solves with the transposed Jacobian if C is its only nonsymmetric part.
    pub fn transpose_couplings(&mut self) {
        if let Self::Direct(solver) = self {
            solver.transpose_couplings();
        }
    }

    /// The Jacobian K + a bᵀ + C for the next solves.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn prepare(
        &mut self,
        values: Vec<f64>,
        rank_one: Option<RankOne>,
        unchanged: bool,
    ) -> Result<(), FactorError> {
        match self {
            Self::Direct(solver) => solver.prepare(values, rank_one, unchanged),
            Self::Multigrid(solver) => solver.prepare(values, rank_one, unchanged),
        }
    }

    /// Solves in place, to a residual of at most `forcing` times the right side.
    ///
    /// # Errors
    /// As [`Self::prepare`]; a rank-one part that makes the Jacobian singular.
    pub fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        match self {
            Self::Direct(solver) => solver.solve(rhs, forcing),
            Self::Multigrid(solver) => solver.solve(rhs, forcing),
        }
    }

    /// Diagonal entry of the present K.
    pub fn diagonal(&self, dof: usize) -> f64 {
        match self {
            Self::Direct(solver) => solver.diagonal(dof),
            Self::Multigrid(solver) => solver.diagonal(dof),
        }
    }

    /// K⁻¹ r with the last factor, or an estimate of it; no operation before the first K.
    pub fn solve_with_last_factor(&mut self, rhs: &mut [f64]) {
        match self {
            Self::Direct(solver) => solver.solve_with_last_factor(rhs),
            Self::Multigrid(solver) => solver.solve_again(rhs),
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
