//! Why there is no bound.

use algebra::linalg::FactorError;
use fem::contact::CaseError;
use scene::setup::SetupError;

/// Why there is no bound.
#[derive(Debug, thiserror::Error)]
pub enum GuaranteeError {
    /// The theorem does not apply.
    #[error("no guaranteed bound: {reason}")]
    Refused {
        /// Which hypothesis fails.
        reason: String,
    },
    /// A load that is not finite.
    #[error("no guaranteed bound: {what} is not finite at t = {t}")]
    NotFinite {
        /// The load.
        what: &'static str,
        /// t_n.
        t: f64,
    },
    /// The mesh could not be had.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The dual problem could not be factorized.
    #[error("the problem of equilibrated stresses: {0}")]
    Factor(#[from] FactorError),
    /// The run failed.
    #[error(transparent)]
    Case(#[from] CaseError),
}

impl GuaranteeError {
    pub(super) fn refused(reason: impl Into<String>) -> Self {
        Self::Refused { reason: reason.into() }
    }
}
