//! Why a run has no guaranteed bound.

use fem::contact::CaseError;
use scene::setup::SetupError;

/// Why there is no bound, or no run.
#[derive(Debug, thiserror::Error)]
pub enum GuaranteeError {
    /// A scene that the theorem does not cover, or a bound that is infinite.
    #[error("no guaranteed bound: {0}")]
    NoBound(String),
    #[error("no guaranteed bound: {what} is not finite at t = {t}")]
    NotFinite { what: &'static str, t: f64 },
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error("a run: {0}")]
    Case(#[from] CaseError),
}

pub(super) type Result<T, E = GuaranteeError> = std::result::Result<T, E>;

impl GuaranteeError {
    pub(super) fn no_bound(reason: impl Into<String>) -> Self {
        Self::NoBound(reason.into())
    }
}
