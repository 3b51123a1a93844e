use std::path::PathBuf;

use super::missing::Missing;
use super::plan::PlanError;
use judge::record::RecordError;
use scene::SceneError;
use scene::setup::SetupError;

/// Why nothing was merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    /// A part does not belong to the others.
    #[error("{}: {what}; leave the directory out, or run its cases again", dir.display())]
    Different { dir: PathBuf, what: String },
    #[error(
        "{id}: the records in {} differ in more than their seconds; remove the wrong one, or run the case again",
        in_words(parts)
    )]
    Disagree { id: String, parts: Vec<PathBuf> },
    #[error("{}: {id} is no case of the plan; leave the directory out", in_words(parts))]
    Unplanned { id: String, parts: Vec<PathBuf> },
    #[error("{0}")]
    Missing(Missing),
    #[error("{0}")]
    Scene(#[from] Box<SceneError>),
    #[error("{0}")]
    Setup(#[from] Box<SetupError>),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error("{0}")]
    Other(String),
}

fn in_words(parts: &[PathBuf]) -> String {
    parts.iter().map(|part| part.display().to_string()).collect::<Vec<_>>().join(" and ")
}
