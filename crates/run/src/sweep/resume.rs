//! What an interrupted sweep left: complete cases are kept, all others run again.

use std::path::{Path, PathBuf};

use super::{Provenance, ScenePlan, is_complete};
use judge::record::{CaseRecord, RecordError, Table, read_table};

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

/// What is kept of earlier records.
#[derive(Debug, Default)]
pub struct Resumed {
    /// Complete cases.
    pub records: Vec<CaseRecord>,
    /// Why others that were there are run again, where it is more than that they are not complete.
    pub doubts: Vec<String>,
}

/// Lines that are named before the rest is counted.
const NAMED: usize = 10;

/// The complete cases in `dir` that belong to `plans`. An empty or missing directory has none. Rows that are not as they
/// were written, or hold what no measurement gives, are not kept.
///
/// # Errors
/// Records of another version or of another text of a scene, unreadable files.
pub fn resume(dir: &Path, plans: &[ScenePlan]) -> Result<Resumed, ResumeError> {
    let path = dir.join("cases.csv");
    if !path.exists() {
        return Ok(Resumed::default());
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
    let table = read_table(&path)?;
    let mut resumed = Resumed { doubts: doubts(&path, &table), ..Resumed::default() };
    // Nobody knows whether rows without a checksum are those that were written.
    let cases = if table.checked { table.cases } else { Vec::new() };
    for record in cases {
        // The table is written anew from what is returned here: a case outside the plan would be lost.
        let Some(case) = case_of(&record) else {
            let key = record.key();
            return Err(different(format!("`{}` {key} is no case of this sweep", key.scene)));
        };
        if let Some(entry) = record.unsound() {
            let (error, floor) = (entry.error, entry.floor);
            resumed.doubts.push(format!(
                "{}: `{}` {}: error {error:?} and floor {floor:?} in {} are no measurement: the case is run again",
                path.display(), record.scene, record.key(), entry.norm
            ));
        } else if record.converged() && is_complete(&record, &case.norms) {
            resumed.records.push(record);
        }
    }
    Ok(resumed)
}

fn doubts(path: &Path, table: &Table) -> Vec<String> {
    let lines: Vec<String> = table.changed.iter().take(NAMED).map(u64::to_string).collect();
    let more = match table.changed.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let lines = lines.join(", ");
    let path = path.display();
    let changed = format!(
        "{path}: line {lines}{more}: changed after it was written (the checksum is another): the case is run again"
    );
    let unchecked =
        format!("{path}: rows without checksums are not trusted: all cases are run again");
    let found = [(!table.changed.is_empty(), changed), (!table.checked, unchecked)];
    found.into_iter().filter(|(found, _)| *found).map(|(_, doubt)| doubt).collect()
}
