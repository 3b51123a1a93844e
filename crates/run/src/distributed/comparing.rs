//! Comparison with the baseline during a merge: only recorded cases are kept.

use std::collections::BTreeSet;

use crate::sweep::ScenePlan;
use judge::record::CaseRecord;
use judge::verdict::{Baseline, ComparedRun, Comparison, Verdict};

pub(crate) struct Comparing<'a> {
    baseline: &'a Baseline,
    runs: Vec<ComparedRun>,
    kept: Vec<CaseRecord>,
    /// Recorded cases of the current scene.
    recorded: BTreeSet<(Option<u32>, u32)>,
}

impl<'a> Comparing<'a> {
    pub(crate) fn new(baseline: &'a Baseline) -> Self {
        Self { baseline, runs: Vec::new(), kept: Vec::new(), recorded: BTreeSet::new() }
    }

    /// Called before the cases of a scene.
    pub(crate) fn open(&mut self, plan: &ScenePlan, own_grids: bool) {
        let scene = plan.scene();
        let recorded = self.baseline.scenes.get(&scene.name);
        let cases = recorded.iter().flat_map(|recorded| &recorded.cases);
        self.recorded = cases.map(|case| (case.n, case.steps)).collect();
        let mut planned = plan.keys();
        planned.retain(|key| self.recorded.contains(&(key.n, key.steps)));
        let (scene, hash) = (scene.name.clone(), scene.source.hash.clone());
        self.runs.push(ComparedRun { scene, hash, planned, own_grids });
    }

    pub(crate) fn keep(&mut self, case: &CaseRecord) {
        if self.recorded.contains(&(case.n, case.steps)) {
            self.kept.push(case.clone());
        }
    }

    /// The comparison of all scenes, in this order, including what their verdicts leave owing.
    pub(crate) fn found(mut self, order: &[&str], verdicts: &[Verdict]) -> Comparison {
        let place = |run: &ComparedRun| order.iter().position(|&name| name == run.scene);
        self.runs.sort_by_cached_key(place);
        self.baseline.compare(&self.runs, &self.kept, verdicts)
    }
}
