use std::path::PathBuf;

use super::names::{CASES, PLAN};
use crate::sweep::{OutputError, Refused, SweepError};
use files::{FileError, counted};
use judge::record::RecordError;
use judge::verdict::DocumentError;
use scene::SceneError;
use scene::setup::SetupError;

/// Why nothing was planned, run or merged.
#[derive(Debug, thiserror::Error)]
pub enum DistributedError {
    #[error("{}: {reason}", path.display())]
    File { path: PathBuf, reason: String },
    #[error("{}: {reason}; make the plan again with `sweep plan`", path.display())]
    Malformed { path: PathBuf, reason: String },
    #[error(
        "{}: the plan is of version {found}, this is {running}: records of both would not be of one sweep; run its cases with version {found}, or plan again", path.display()
    )]
    Version { path: PathBuf, found: String, running: String },
    #[error(
        "{}: the scene `{scene}` has changed since the plan was made ({planned} planned, {found} found); plan again into another directory, or restore the file (its text is kept in {PLAN} of the plan)", path.display()
    )]
    Changed { path: PathBuf, scene: String, planned: String, found: String },
    /// The plan has no such case or job.
    #[error("{}: {what} in this plan; its {} are in {CASES}", path.display(), counted(*cases, "case"))]
    Unknown { path: PathBuf, what: String, cases: usize },
    #[error(
        "{}: another plan stands here, and what was run by it would be lost; choose another directory with --out, or remove this one", path.display()
    )]
    OtherPlan { path: PathBuf },
    /// More memory than available. Not a record, since an engine may retry where there is more.
    #[error(transparent)]
    TooLarge(#[from] Refused),
    /// A part does not belong to the others.
    #[error("{}: {what}; leave the directory out, or run its cases again", dir.display())]
    Different { dir: PathBuf, what: String },
    #[error(
        "{id}: the records in {} and {} differ in more than their seconds; remove the wrong one, or run the case again",
        parts[0].display(), parts[1].display()
    )]
    Disagree { id: String, parts: [PathBuf; 2] },
    #[error("{}: {id} is no case of the plan; leave the directory out", dir.display())]
    Unplanned { id: String, dir: PathBuf },
    #[error("{0}")]
    Scene(#[from] Box<SceneError>),
    #[error("{0}")]
    Setup(#[from] Box<SetupError>),
    #[error(transparent)]
    Io(#[from] FileError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("{0}")]
    Other(String),
}
