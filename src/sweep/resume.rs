//! What an interrupted sweep left: complete cases are kept, all others run again.

use std::path::{Path, PathBuf};

use super::{Provenance, ScenePlan};
use crate::record::{CaseRecord, RecordError, read};

/// Why a directory cannot be resumed.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    /// The records are unreadable.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// The provenance is unreadable.
    #[error("{}: {reason}", path.display())]
    Provenance { path: PathBuf, reason: String },
    /// The records belong to something else.
    #[error("{}: {what}; run without --resume to start anew, or choose another --out", dir.display())]
    Different { dir: PathBuf, what: String },
}

/// The complete cases in `dir` that belong to `plans`. An empty or missing directory has none.
///
/// # Errors
/// Records of another version or of another text of a scene, unreadable files.
pub fn resume(dir: &Path, plans: &[ScenePlan]) -> Result<Vec<CaseRecord>, ResumeError> {
    let path = dir.join("cases.csv");
    if !path.exists() {
        return Ok(Vec::new());
    }
    let different = |what: String| ResumeError::Different { dir: dir.to_owned(), what };
    let known = Provenance::read(dir)
        .map_err(|(path, reason)| ResumeError::Provenance { path, reason })?
        .ok_or_else(|| different("records without provenance.json".into()))?;
    let own = Provenance::new(plans.iter().map(|plan| plan.scene()));
    if known.version != own.version {
        return Err(different(format!(
            "the records are of version {}, this is {}",
            known.version, own.version
        )));
    }
    for (scene, hash) in &own.scenes {
        if known.scenes.get(scene).is_some_and(|other| other != hash) {
            return Err(different(format!("the scene `{scene}` has changed since")));
        }
    }
    let case_of = |record: &CaseRecord| {
        let plan = plans.iter().find(|plan| plan.scene().name == record.scene)?;
        plan.cases.iter().find(|case| case.n == record.n && case.steps == record.steps)
    };
    let mut complete = Vec::new();
    for record in read(&path)? {
        // The table is written anew from what is returned here: a case outside the plan would be lost.
        let Some(case) = case_of(&record) else {
            let key = record.key();
            return Err(different(format!("`{}` {key} is no case of this sweep", key.scene)));
        };
        let measured = case.norms.iter().all(|norm| record.norm(norm.name()).is_some());
        if record.converged() && measured {
            complete.push(record);
        }
    }
    Ok(complete)
}
