//! The error of a command, and its exit code.

use std::error::Error;
use std::fmt::{self, Display};

use run::FrontError;
use scene::SceneError;
use scene::setup::SetupError;
use studies::study::StudyError;

/// The exit code where nothing could be judged.
pub(super) const COULD_NOT_JUDGE: u8 = 2;

/// An error that ends a command, as one message on stderr and exit code 2.
#[derive(Debug)]
pub struct CliError(String);

impl Display for CliError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl<E: Error + 'static> From<E> for CliError {
    /// Errors of scenes begin themselves, with the line of the file.
    fn from(error: E) -> Self {
        let any: &dyn Error = &error;
        let of_scene = any.is::<SceneError>()
            || any.is::<SetupError>()
            || matches!(any.downcast_ref(), Some(FrontError::Scene(_) | FrontError::Setup(_)))
            || matches!(any.downcast_ref(), Some(StudyError::Scene(_) | StudyError::Setup(_)));
        if of_scene { Self(error.to_string()) } else { Self::other(error) }
    }
}

impl CliError {
    pub(super) fn other(error: impl Display) -> Self {
        Self(format!("error: {error}"))
    }

    /// An error that does not name its file, scene or case.
    pub(super) fn about(what: impl Display, error: impl Display) -> Self {
        Self::other(format!("{what}: {error}"))
    }
}
