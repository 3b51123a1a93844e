//! A study of one scene as a command: what it is asked, and why it may have no findings.

use std::fmt::Display;

use algebra::linalg::{EigenError, FactorError};
use fem::contact::{CaseError, LoadError};
use guarantee::GuaranteeError;
use report::Findings;
use run::sweep::{MemoryLimit, Refused};
use scene::setup::SetupError;
use scene::{Scene, SceneError};
use vhi::FailedStep;
use vhi::finite::FiniteError;

/// A study as its command runs it; help, options, files and exit code are the command's.
pub type Study = fn(Scene, &Asked) -> Result<Findings>;

/// What is asked of a study.
pub struct Asked {
    pub n: Option<Vec<u32>>,
    pub steps: Option<Vec<u32>>,
    pub limit: MemoryLimit,
    /// Runs at a time.
    pub jobs: usize,
}

impl Asked {
    /// Meshes and numbers of steps in place of the scene's; of its meshes those up to `finest`.
    ///
    /// # Errors
    /// Numbers that the scene cannot have, or none.
    pub fn grid(&self, scene: &Scene, finest: u32) -> Result<(Vec<u32>, Vec<u32>), SceneError> {
        let given = |list: &Option<Vec<u32>>| list.clone().unwrap_or_default();
        scene.check_grid(&given(&self.n), &given(&self.steps))?;
        let mut own = scene.sweep.clone().unwrap_or_default();
        own.n.retain(|n| *n <= finest);
        let ns = self.n.clone().unwrap_or(own.n);
        let steps = self.steps.clone().unwrap_or(own.steps);
        if ns.is_empty() || steps.is_empty() {
            return Err(scene.no_case("study"));
        }
        Ok((ns, steps))
    }

    /// The one mesh, where a study has one.
    pub fn mesh(&self) -> Option<u32> {
        self.n.as_ref()?.first().copied()
    }
}

/// Why a study has no findings.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error(transparent)]
    Memory(#[from] Refused),
    /// No such bound: no history, or a constant that is not known, not finite or not positive.
    #[error("scene `{scene}`{why}")]
    Unbounded { scene: String, why: String },
    #[error(transparent)]
    Guarantee(#[from] GuaranteeError),
    #[error("a run: {0}")]
    Case(#[from] CaseError),
    #[error("a run: {0}")]
    Finite(#[from] FiniteError),
    #[error("a run: {0}")]
    Step(#[from] FailedStep),
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error("a dual norm: {0}")]
    Dual(#[from] FactorError),
    #[error("a constant of the mesh: {0}")]
    Constant(#[from] EigenError),
    #[error("{0}")]
    Other(String),
}

/// What a study computes.
pub type Result<T, E = StudyError> = std::result::Result<T, E>;

impl StudyError {
    pub fn other(error: impl Display) -> Self {
        Self::Other(error.to_string())
    }

    /// An error with where it is.
    pub(crate) fn at(place: impl Display, error: impl Display) -> Self {
        Self::Other(format!("{place}: {error}"))
    }
}

/// Refuses an n for a problem without a mesh.
///
/// # Errors
/// [`SceneError`].
pub fn no_mesh(scene: &Scene, n: Option<u32>) -> Result<(), SceneError> {
    let message = || format!("an abstract problem has no mesh, so no n = {}", n.unwrap_or(0));
    scene.refuse_if(n.is_some(), "scene.kind", message(), "leave --n away")
}
