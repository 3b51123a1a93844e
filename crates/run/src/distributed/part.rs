//! Runs some cases of a plan in one process; their records are published atomically at the end.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::error::DistributedError;
use super::names::{CASES, PLAN};
use super::plan::{CaseRow, SweepPlan};
use crate::sweep::{
    Machine, MemoryLimit, OutputDirectory, Progress, Provenance, Refused, Resumed, ScenePlan,
    replace_records, resume, run_sweep,
};
use files::{FileError, counted};
use judge::record::{CaseRecord, write_sorted};
use judge::verdict::{failures, write_json};
use scene::setup::Subject;

/// Below the directory of a part: holds records until all are there.
const UNFINISHED: &str = ".unfinished";

/// What became of a part.
#[derive(Debug)]
pub struct PartRun {
    /// Sorted by scene, n and steps.
    pub records: Vec<CaseRecord>,
    /// The records existed before.
    pub known: bool,
}

/// The scenes of the rows with their cases, in the plan's order of scenes.
///
/// # Errors
/// A scene that has changed since the plan was made, or a row that is not a case of it.
pub(crate) fn plans(
    plan: &SweepPlan,
    dir: &Path,
    rows: &[CaseRow],
) -> Result<Vec<ScenePlan>, DistributedError> {
    let malformed = |path: PathBuf, reason| DistributedError::Malformed { path, reason };
    let mut of_scene: BTreeMap<&str, Vec<&CaseRow>> = BTreeMap::new();
    rows.iter().for_each(|row| of_scene.entry(&row.scene).or_default().push(row));
    let mut plans = Vec::new();
    for planned in &plan.scenes {
        let Some(rows) = of_scene.remove(planned.name.as_str()) else { continue };
        planned.unchanged()?;
        let subject = Subject::new(planned.scene(dir)?).map_err(Box::new)?;
        let mut scene_plan = ScenePlan::new(subject, &plan.overrides);
        let wanted: BTreeSet<_> = rows.iter().map(|row| (row.n, row.steps)).collect();
        scene_plan.cases.retain(|case| wanted.contains(&(case.n, case.steps)));
        if scene_plan.cases.len() != rows.len() {
            let reason = format!("rows of `{}` are no cases of that scene", planned.name);
            return Err(malformed(dir.join(CASES), reason));
        }
        plans.push(scene_plan);
    }
    match of_scene.keys().next() {
        Some(scene) => {
            let reason = format!("the scene `{scene}` of {CASES} is not in it");
            Err(malformed(dir.join(PLAN), reason))
        }
        None => Ok(plans),
    }
}

/// Runs the cases of `rows` one after the other and publishes them in `out`. Complete records, and cases that a killed
/// process had finished, are kept.
///
/// # Errors
/// [`DistributedError`]: nothing is published then. A case whose solver fails is a record.
pub fn run_part(
    plan: &SweepPlan,
    dir: &Path,
    rows: &[CaseRow],
    out: &Path,
    machine: &Machine,
    progress: &dyn Progress,
) -> Result<PartRun, DistributedError> {
    let plans = plans(plan, dir, rows)?;
    for row in rows {
        let refused = |source| Refused { what: row.id.clone(), source };
        machine.memory.admit(row.bytes, false).map_err(refused)?;
    }
    // Records of another plan or version are replaced at the end.
    if let Ok(Resumed { records, doubts }) = resume(out, &plans) {
        if records.len() == rows.len() {
            return Ok(PartRun { records, known: true });
        }
        doubts.iter().for_each(|doubt| progress.doubted(doubt));
    }
    let unfinished = out.join(UNFINISHED);
    let held = OutputDirectory::take(&unfinished)?;
    // Each row was admitted above.
    let machine = Machine { jobs: 1, memory: MemoryLimit::NONE, ..machine.clone() };
    let resumable = resume(&unfinished, &plans).is_ok();
    let records = run_sweep(&plans, &held, &machine, resumable, progress)?;
    publish(out, &records, &Provenance::of_run(&plans, &machine))?;
    drop(held);
    fs::remove_dir_all(&unfinished).map_err(FileError::at(&unfinished))?;
    Ok(PartRun { records, known: false })
}

/// Publishes the files, the table last: without it the directory holds no records.
fn publish(
    out: &Path,
    records: &[CaseRecord],
    provenance: &Provenance,
) -> Result<(), DistributedError> {
    replace_records(out, provenance, false)?;
    if !failures(records).is_empty() {
        // The table has no column for reasons.
        write_json(&out.join("verdict.json"), &provenance.json(), &[], records, None)?;
    }
    Ok(write_sorted(&out.join("cases.csv"), records)?)
}

/// The failed cases of a part in words, for a message.
pub fn failed_in_words(records: &[CaseRecord]) -> Option<String> {
    let failed = failures(records);
    let first = failed.first()?;
    let number = counted(failed.len(), "case");
    let (scene, reason) = (&first.key.scene, &first.reason);
    Some(format!("{number} failed and recorded as such, the first: {scene}: {reason}"))
}
