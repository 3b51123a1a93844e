//! Why there is no bound.

use algebra::linalg::FactorError;
use fem::contact::CaseError;
use scene::setup::SetupError;

/// Why there is no bound.
#[derive(Debug, thiserror::Error)]
pub enum GuaranteeError {
    #[error("no guaranteed bound: {reason}")]
    Refused { reason: String },
    #[error("no guaranteed bound: {what} is not finite at t = {t}")]
    NotFinite { what: &'static str, t: f64 },
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error("the problem of equilibrated stresses: {0}")]
    Factor(#[from] FactorError),
    #[error(transparent)]
    Case(#[from] CaseError),
}

impl GuaranteeError {
    pub(super) fn refused(reason: impl Into<String>) -> Self {
        Self::Refused { reason: reason.into() }
    }
}
