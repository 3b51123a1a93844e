//! Resuming an interrupted sweep: complete cases are kept, all others run again.

use std::path::{Path, PathBuf};

use super::{Provenance, ScenePlan, is_complete};
use files::FileError;
use judge::record::{CaseRecord, CaseTable, RecordError, read_table};

/// Why a directory cannot be resumed.
#[derive(Debug, thiserror::Error)]
pub enum ResumeError {
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Io(#[from] FileError),
    /// The records belong to something else.
    #[error("{}: {what}; run without --resume to start anew, or choose another --out", dir.display())]
    Different { dir: PathBuf, what: String },
}

/// What is kept of earlier records.
#[derive(Debug, Default)]
pub struct Resumed {
    pub records: Vec<CaseRecord>,
    /// Why other records are discarded, if they are not only incomplete.
    pub doubts: Vec<String>,
}

/// Lines named before the rest is counted.
const NAMED: usize = 10;

/// The complete cases in `dir` that belong to `plans`; none for an empty or missing directory. Rows that fail their
/// checksum, or hold impossible values, are dropped.
///
/// # Errors
/// Records of another version or of another text of a scene, unreadable files.
pub fn resume(dir: &Path, plans: &[ScenePlan]) -> Result<Resumed, ResumeError> {
    let path = dir.join("cases.csv");
    if !path.exists() {
        return Ok(Resumed::default());
    }
    let different = |what: String| ResumeError::Different { dir: dir.to_owned(), what };
    let known = Provenance::read(dir)?
        .ok_or_else(|| different("records without provenance.json".into()))?;
    let current = Provenance::new(plans.iter().map(|plan| plan.scene()));
    if let Some(other) = known.other_version() {
        return Err(different(other));
    }
    for (scene, hash) in &current.scenes {
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
    // Rows without a checksum cannot be trusted.
    let cases = if table.checked { table.cases } else { Vec::new() };
    for record in cases {
        // The table is rewritten from the returned records: a case outside the plan would be lost.
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

fn doubts(path: &Path, table: &CaseTable) -> Vec<String> {
    let lines = first_named(table.changed.iter().map(u64::to_string), NAMED);
    let path = path.display();
    let changed = format!(
        "{path}: line {lines}: changed after it was written (its checksum differs), so the case is run again"
    );
    let unchecked =
        format!("{path}: all cases are run again, because rows without checksums are not trusted");
    let found = [(!table.changed.is_empty(), changed), (!table.checked, unchecked)];
    found.into_iter().filter(|(found, _)| *found).map(|(_, doubt)| doubt).collect()
}

/// The first names of a list, and how many more there are.
pub(crate) fn first_named(all: impl ExactSizeIterator<Item = String>, most: usize) -> String {
    let more = all.len().saturating_sub(most);
    let named = all.take(most).collect::<Vec<_>>().join(", ");
    if more == 0 { named } else { format!("{named} and {more} more") }
}
