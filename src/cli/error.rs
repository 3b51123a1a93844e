//! The error of a command, and its exit code.

use std::fmt::Display;

use scene::SceneError;
use scene::setup::SetupError;

/// The exit code where nothing could be judged.
pub(super) const COULD_NOT_JUDGE: u8 = 2;

/// An error that ends a command, as one message on stderr and exit code 2.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    #[error("{0}")]
    Scene(#[from] SceneError),
    #[error("{0}")]
    Setup(#[from] SetupError),
    #[error("error: {0}")]
    File(#[from] files::FileError),
    #[error("error: {0}")]
    Sweep(#[from] ::run::sweep::SweepError),
    #[error("error: {0}")]
    Output(#[from] ::run::sweep::OutputError),
    #[error("error: {0}")]
    Memory(#[from] ::run::sweep::Refused),
    #[error("error: {0}")]
    Report(#[from] ::report::ReportError),
    #[error("error: {0}")]
    Other(String),
}

impl From<::run::FrontError> for CliError {
    fn from(error: ::run::FrontError) -> Self {
        match error {
            ::run::FrontError::Scene(error) => error.into(),
            ::run::FrontError::Setup(error) => error.into(),
            other => Self::other(other),
        }
    }
}

impl CliError {
    pub(super) fn other(error: impl Display) -> Self {
        Self::Other(error.to_string())
    }

    /// An error that does not name its file, scene or case.
    pub(super) fn about(what: impl Display, error: impl Display) -> Self {
        Self::Other(format!("{what}: {error}"))
    }
}
