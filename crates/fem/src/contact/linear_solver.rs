//! Which linear solver a run uses: a factor of each Jacobian, or conjugate gradients with multigrid.

/// A solver of the linear systems of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearSolver {
    /// Sparse Cholesky factors.
    Direct,
    /// Conjugate gradients with a multigrid cycle; meshes that refine a coarser one.
    Multigrid,
}

impl LinearSolver {
    /// The name by which a command takes it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Multigrid => "multigrid",
        }
    }
}
