//! Merges the records of many processes into one table, and judges scene by scene.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::error::DistributedError;
use super::missing::{NAMED, missing_in_words};
use super::parts::Parts;
use super::plan::{SweepPlan, id};
use crate::sweep::{Overrides, Provenance, ScenePlan, judge_plan, missing_cases};
use judge::record::{CaseRecord, Key};
use judge::verdict::{Baseline, Comparison, Verdict};
use scene::setup::Subject;

/// What a merge came to.
pub struct Merged {
    /// Of all parts, sorted by key.
    pub records: Vec<CaseRecord>,
    /// As of one process, scene by scene.
    pub verdicts: Vec<Verdict>,
    /// Number of cases recorded as skipped, and their names.
    pub missing: Option<(usize, String)>,
    /// With the baseline, where one was given.
    pub comparison: Option<Comparison>,
    /// Scenes with texts and remarks, without the machine of the merge.
    pub provenance: Provenance,
}

/// Merges `parts` and judges. With `incomplete`, missing cases are recorded as skipped. Cases recorded in `baseline` are
/// compared.
pub fn merge(
    parts: Parts,
    plan: Option<(&SweepPlan, &Path)>,
    incomplete: bool,
    baseline: Option<&Baseline>,
) -> Result<Merged, DistributedError> {
    let overrides = plan.map_or_else(Overrides::default, |(plan, _)| plan.overrides.clone());
    let mut provenance = Provenance { platform: parts.platform(), ..Provenance::new([]) };
    let (mut records, mut verdicts, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    let mut missing: Vec<Key> = Vec::new();
    // In the order of the plan, as one process would judge.
    let names: Vec<&String> = match plan {
        Some((plan, _)) => plan.scenes.iter().map(|scene| &scene.name).collect(),
        None => parts.scenes().collect(),
    };
    for name in names {
        let scene = match plan.and_then(|(plan, dir)| Some((plan.planned(name)?, dir))) {
            Some((planned, dir)) => planned.scene(dir)?,
            None => parts.scene(name)?,
        };
        let scene_plan = ScenePlan::new(Subject::new(scene).map_err(Box::new)?, &overrides);
        provenance.add_plan(&scene_plan);
        let mut of_scene: Vec<CaseRecord> = parts.of_scene(name).cloned().collect();
        if plan.is_some() {
            only_planned(&parts, &scene_plan, &of_scene)?;
        }
        let lost = missing_cases(name, &scene_plan.cases, &of_scene);
        let lost: BTreeSet<Key> = lost.into_iter().collect();
        of_scene.retain(|record| !lost.contains(&record.key()));
        let skipped = scene_plan.cases.iter().filter(|case| lost.contains(&case.place().key(name)));
        of_scene.extend(skipped.map(|case| scene_plan.unmeasured(case)));
        verdicts.extend(judge_plan(&scene_plan, &of_scene, true));
        runs.push(scene_plan.compared(overrides.n.is_none() && overrides.steps.is_none()));
        records.extend(of_scene);
        missing.extend(lost);
    }
    let missing = named(missing, plan)?;
    if let Some((_, words)) = missing.as_ref().filter(|_| !incomplete) {
        return Err(DistributedError::Other(words.clone()));
    }
    records.sort_by_key(CaseRecord::key);
    let comparison = baseline.map(|baseline| baseline.compare(&runs, &records, &verdicts));
    Ok(Merged { records, verdicts, missing, comparison, provenance })
}

/// Refuses a case that the plan of its scene does not have.
fn only_planned(
    parts: &Parts,
    plan: &ScenePlan,
    records: &[CaseRecord],
) -> Result<(), DistributedError> {
    let planned: BTreeSet<Key> = plan.keys().into_iter().collect();
    match records.iter().map(CaseRecord::key).find(|key| !planned.contains(key)) {
        None => Ok(()),
        Some(key) => {
            let dir = parts.holder(&key).to_owned();
            Err(DistributedError::Unplanned { id: id(&key), dir })
        }
    }
}

/// Missing cases with their number, the first of them with their jobs if there is a plan.
fn named(
    mut missing: Vec<Key>,
    plan: Option<(&SweepPlan, &Path)>,
) -> Result<Option<(usize, String)>, DistributedError> {
    if missing.is_empty() {
        return Ok(None);
    }
    missing.sort();
    let words = match plan {
        None => {
            let way = "they are on the grids of the scenes' files: give the plan with --plan if another grid was run, or merge with --incomplete: their verdicts fail then";
            missing_in_words(&missing, id, way)
        }
        Some((plan, dir)) => {
            let first: Vec<String> = missing.iter().take(NAMED).map(id).collect();
            let rows = plan.rows(dir, &first, &[])?;
            let jobs: BTreeMap<String, usize> =
                rows.into_iter().map(|row| (row.id, row.job)).collect();
            let with_job = |key: &Key| format!("{} (job {})", id(key), jobs[&id(key)]);
            let way = "run them with `sweep case --job JOB`, or merge with --incomplete: their verdicts fail then";
            missing_in_words(&missing, with_job, way)
        }
    };
    Ok(Some((missing.len(), words)))
}
