//! Why there is no bound.

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
    #[error(transparent)]
    Case(#[from] CaseError),
}

impl GuaranteeError {
    pub(super) fn refused(reason: impl Into<String>) -> Self {
        Self::Refused { reason: reason.into() }
    }
}
