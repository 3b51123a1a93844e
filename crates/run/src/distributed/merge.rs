//! Merges the records of many processes into one table, and judges scene by scene.
//!
//! Memory: a fixed number of cases while sorting; then the predictions' data of one scene.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::rc::Rc;

use super::comparing::Comparing;
use super::error::DistributedError;
use super::missing::{Missing, NAMED, WayOn, with_jobs};
use super::parts::Parts;
use super::plan::{SweepPlan, id};
use super::sorted::{SortedCases, agree};
use crate::sweep::{CasePlan, Overrides, Provenance, ScenePlan, foresee, is_complete, judge_scene};
use judge::record::{CaseRecord, Key, NormError, Status, TableWriter};
use judge::verdict::{Baseline, Comparison, Verdict};
use scene::Norm;
use scene::setup::Subject;

/// What a merge came to.
pub struct Merged {
    /// As of one process, scene by scene.
    pub verdicts: Vec<Verdict>,
    /// Records of failed cases, with reasons.
    pub failed: Vec<CaseRecord>,
    /// Cases recorded as skipped.
    pub missing: Missing,
    /// Number of cases in the table.
    pub cases: usize,
    /// With the baseline, where one was given.
    pub comparison: Option<Comparison>,
    /// Scenes with texts and remarks, without the machine of the merge.
    pub provenance: Provenance,
}

/// Merges `parts` into a table that is to stand at `table`, for the caller to finish, and judges; temporary files go
/// below `folder`. With `incomplete`, missing cases are recorded as skipped. Cases recorded in `baseline` are compared.
pub fn merge(
    parts: &Parts,
    plan: Option<(&SweepPlan, &Path)>,
    (table, folder): (&Path, &Path),
    at_once: usize,
    incomplete: bool,
    baseline: Option<&Baseline>,
) -> Result<(Merged, TableWriter), DistributedError> {
    let mut merging = Merging {
        parts,
        plan,
        sorted: SortedCases::new(&parts.tables(), folder, at_once)?,
        table: TableWriter::create(table)?,
        missing: Vec::new(),
        comparing: baseline.map(Comparing::new),
        merged: Merged {
            verdicts: Vec::new(),
            failed: Vec::new(),
            missing: Missing {
                way: if plan.is_some() { WayOn::Plan } else { WayOn::Grids },
                ..Missing::default()
            },
            cases: 0,
            comparison: None,
            provenance: Provenance::new(std::iter::empty()),
        },
    };
    if let Some(platform) = &parts.platform {
        merging.merged.provenance.platform.clone_from(platform);
    }
    let planned = plan.iter().flat_map(|(plan, _)| plan.scenes.iter().map(|scene| &scene.name));
    let names: BTreeSet<&String> = planned.chain(parts.scenes()).collect();
    let mut verdicts: BTreeMap<&str, Vec<Verdict>> = BTreeMap::new();
    for name in &names {
        verdicts.insert(name, merging.scene(name)?);
    }
    if let Some(scene) = merging.sorted.scene() {
        let reason = format!("records of the scene `{scene}`, which no provenance.json names");
        return Err(DistributedError::Other(reason));
    }
    let Merging { table, missing, comparing, mut merged, .. } = merging;
    merged.missing.first = with_jobs(&missing, plan)?;
    if merged.missing.number > 0 && !incomplete {
        return Err(DistributedError::Other(merged.missing.to_string()));
    }
    // In the order of the plan, as one process would judge.
    let order: Vec<&str> = match plan {
        Some((plan, _)) => plan.scenes.iter().map(|scene| scene.name.as_str()).collect(),
        None => verdicts.keys().copied().collect(),
    };
    merged.verdicts = order.iter().filter_map(|name| verdicts.remove(name)).flatten().collect();
    merged.comparison = comparing.map(|comparing| comparing.found(&order, &merged.verdicts));
    Ok((merged, table))
}

struct Merging<'a> {
    parts: &'a Parts,
    plan: Option<(&'a SweepPlan, &'a Path)>,
    sorted: SortedCases,
    table: TableWriter,
    /// The first missing cases.
    missing: Vec<Key>,
    comparing: Option<Comparing<'a>>,
    merged: Merged,
}

struct Open<'a> {
    /// Its cases are moved to `expected`.
    plan: ScenePlan,
    /// Expected cases in table order, and how many have passed.
    expected: Vec<Awaited>,
    passed: usize,
    /// Norms used by predictions; the others are written and dropped.
    judged: BTreeSet<&'a str>,
    records: Vec<CaseRecord>,
}

/// An expected case. Most cases share their norms, and there may be a million of them.
struct Awaited {
    n: Option<u32>,
    steps: u32,
    norms: Rc<[Norm]>,
}

impl Awaited {
    /// The cases of a plan in table order, each once.
    fn of(mut cases: Vec<CasePlan>) -> Vec<Self> {
        cases.sort_by_key(|case| (case.n, case.steps));
        cases.dedup_by_key(|case| (case.n, case.steps));
        let mut lists: Vec<Rc<[Norm]>> = Vec::new();
        let mut expected = Vec::with_capacity(cases.len());
        for CasePlan { n, steps, norms } in cases {
            let list = match lists.iter().find(|list| list[..] == norms) {
                Some(list) => list.clone(),
                None => {
                    lists.push(norms.into());
                    lists[lists.len() - 1].clone()
                }
            };
            expected.push(Self { n, steps, norms: list });
        }
        expected
    }
}

impl Merging<'_> {
    /// Writes the cases of a scene, and judges it.
    fn scene(&mut self, name: &str) -> Result<Vec<Verdict>, DistributedError> {
        let scene = match self.plan.and_then(|(plan, dir)| Some((plan.planned(name)?, dir))) {
            Some((planned, dir)) => planned.scene(dir)?,
            None => self.parts.scene(name)?,
        };
        let overrides = self.plan.map_or_else(Overrides::default, |(plan, _)| plan.overrides());
        let mut plan = ScenePlan::new(Subject::new(scene).map_err(Box::new)?, &overrides);
        let added = self.parts.added.get(name).map_or(&[][..], Vec::as_slice);
        self.merged.provenance.add_plan(&plan, added);
        if let Some(comparing) = &mut self.comparing {
            let own_grids = overrides.n.is_none() && overrides.steps.is_none();
            comparing.open(&plan, own_grids);
        }
        let expected = Awaited::of(std::mem::take(&mut plan.cases));
        let predicts = &plan.scene().predicts.clone();
        let judged = predicts.iter().map(|prediction| prediction.norm.name()).collect();
        let kept = if plan.scene().judge { expected.len() } else { 0 };
        let records = Vec::with_capacity(kept);
        let mut open = Open { plan, expected, passed: 0, judged, records };
        while self.sorted.scene() == Some(name) {
            let Some((key, case)) = self.one()? else { break };
            self.pass(&mut open, &key, case)?;
        }
        while open.passed < open.expected.len() {
            self.miss(&mut open)?;
        }
        Ok(open.judge())
    }

    /// The next case, if all its records agree.
    fn one(&mut self) -> Result<Option<(Key, CaseRecord)>, DistributedError> {
        let Some((key, first)) = self.sorted.next()? else { return Ok(None) };
        while self.sorted.is_next(&key) {
            let Some((_, other)) = self.sorted.next()? else { break };
            if !agree(&first, &other) {
                let parts = self.parts.holders(&key);
                return Err(DistributedError::Disagree { id: id(&key), parts });
            }
        }
        Ok(Some((key, first)))
    }

    fn pass(
        &mut self,
        open: &mut Open<'_>,
        key: &Key,
        mut case: CaseRecord,
    ) -> Result<(), DistributedError> {
        let place = (key.n, key.steps);
        while open.expects().is_some_and(|next| (next.n, next.steps) < place) {
            self.miss(open)?;
        }
        match open.expects().filter(|next| (next.n, next.steps) == place) {
            Some(next) => {
                if !is_complete(&case, &next.norms) {
                    return self.miss(open);
                }
                open.passed += 1;
            }
            None if self.plan.is_some() => {
                let parts = self.parts.holders(key);
                return Err(DistributedError::Unplanned { id: id(key), parts });
            }
            None => {}
        }
        if let Status::Failed { reason } = &mut case.status {
            if let Some(known) = self.parts.reasons.get(key) {
                reason.clone_from(known);
            }
            self.merged.failed.push(case.clone());
        }
        self.write(open, case)
    }

    /// Records the next expected case as skipped.
    fn miss(&mut self, open: &mut Open<'_>) -> Result<(), DistributedError> {
        let Some(case) = open.expects() else { return Ok(()) };
        let key = Key { scene: open.plan.scene().name.clone(), n: case.n, steps: case.steps };
        let record = open.plan.unmeasured(case.n, case.steps, &case.norms);
        open.passed += 1;
        self.merged.missing.number += 1;
        if self.missing.len() < NAMED {
            self.missing.push(key);
        }
        self.write(open, record)
    }

    fn write(&mut self, open: &mut Open<'_>, mut case: CaseRecord) -> Result<(), DistributedError> {
        self.table.append(&mut case)?;
        self.merged.cases += 1;
        if let Some(comparing) = &mut self.comparing {
            comparing.keep(&case);
        }
        if open.plan.scene().judge {
            // Reallocated: shrinking in place would leave unusable holes.
            let judged = |entry: &&NormError| open.judged.contains(entry.norm.as_str());
            let mut kept = Vec::with_capacity(case.errors.iter().filter(judged).count());
            kept.extend(case.errors.iter().filter(judged).cloned());
            case.errors = kept;
            open.records.push(case);
        }
        Ok(())
    }
}

impl Open<'_> {
    fn expects(&self) -> Option<&Awaited> {
        self.expected.get(self.passed)
    }

    fn judge(self) -> Vec<Verdict> {
        let foreseen = foresee(&self.plan.subject, &self.records);
        // Missing cases are recorded as skipped, so the records are complete.
        judge_scene(self.plan.scene(), &self.records, &[], &foreseen)
    }
}
