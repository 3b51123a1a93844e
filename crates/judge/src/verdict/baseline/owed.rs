//! What a scene owes: verdicts that a run has to judge and constants that it has to compare. They are recorded, so that
//! a gate which judges less than before fails.

use serde::{Deserialize, Serialize};

use super::compare::{ComparedRun, Comparison, Deviation, DeviationKind, compare_with_baseline};
use super::{Baseline, Recorded};
use crate::record::CaseRecord;
use crate::verdict::{Variable, Verdict};
use files::counted;

/// A verdict that is owed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Owed {
    pub norm: String,
    pub variable: Variable,
    /// Constants compared with their prediction.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub constants: Vec<String>,
}

/// Totals over the compared scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Owing {
    pub verdicts: usize,
    /// Constants that are compared with their prediction.
    pub constants: usize,
}

impl Owed {
    fn of(verdict: &Verdict) -> Self {
        let compared = verdict.constants.iter().filter(|(_, constant)| constant.ratio.is_some());
        Self {
            norm: verdict.norm.clone(),
            variable: verdict.variable,
            constants: compared.map(|(name, _)| (*name).to_owned()).collect(),
        }
    }

    /// What the verdicts of a scene settle.
    pub(crate) fn of_scene(scene: &str, verdicts: &[Verdict]) -> Vec<Self> {
        verdicts.iter().filter(|verdict| verdict.scene == scene).map(Self::of).collect()
    }

    fn is_of(&self, other: &Self) -> bool {
        (&self.norm, self.variable) == (&other.norm, other.variable)
    }

    fn name(&self) -> String {
        format!("{} in {}", self.norm, self.variable.name())
    }
}

impl Baseline {
    /// Records what these verdicts settle as owed.
    #[must_use]
    pub fn owing(mut self, verdicts: &[Verdict]) -> Self {
        for (scene, recorded) in &mut self.scenes {
            recorded.owes = Some(Owed::of_scene(scene, verdicts));
        }
        self
    }

    /// Compares runs of scenes with their records: errors and work, and what the verdicts leave owing.
    pub fn compare(
        &self,
        runs: &[ComparedRun],
        records: &[CaseRecord],
        verdicts: &[Verdict],
    ) -> Comparison {
        let mut comparison = compare_with_baseline(self, runs, records);
        compare_owed(self, runs, verdicts, &mut comparison);
        comparison
    }
}

/// Adds what `runs` still owe to a comparison. Scenes on other than their default grids, or left out of the comparison,
/// owe nothing.
pub fn compare_owed(
    baseline: &Baseline,
    runs: &[ComparedRun],
    verdicts: &[Verdict],
    comparison: &mut Comparison,
) {
    for run in runs.iter().filter(|run| run.own_grids) {
        let recorded = baseline.scenes.get(&run.scene);
        let Some(recorded) = recorded.filter(|recorded| recorded.hash == run.hash) else {
            continue;
        };
        let Some(owes) = &recorded.owes else {
            comparison.owed_not_said.push(run.scene.clone());
            continue;
        };
        comparison.owed.verdicts += owes.len();
        comparison.owed.constants += owes.iter().map(|owed| owed.constants.len()).sum::<usize>();
        let settled = Owed::of_scene(&run.scene, verdicts);
        comparison.deviations.extend(left_owing(&run.scene, owes, settled));
    }
}

/// Every item counts once, in any order; settled items that are not owed are reported as well.
fn left_owing(scene: &str, owes: &[Owed], mut settled: Vec<Owed>) -> Vec<Deviation> {
    let mut found = Vec::new();
    let mut say = |owed: &Owed, what: String| found.push(deviation(scene, owed, &what));
    for owed in owes {
        let Some(at) = settled.iter().position(|other| other.is_of(owed)) else {
            say(owed, "the verdict is owed and was not judged".into());
            continue;
        };
        let judged = settled.remove(at);
        for name in owed.constants.iter().filter(|name| !judged.constants.contains(name)) {
            say(owed, format!("the constant {name} is owed and was not compared"));
        }
        for name in judged.constants.iter().filter(|name| !owed.constants.contains(name)) {
            say(owed, format!("the constant {name} was compared and is not owed"));
        }
    }
    for other in &settled {
        say(other, "the verdict was judged and is not owed".into());
    }
    found
}

fn deviation(scene: &str, owed: &Owed, what: &str) -> Deviation {
    Deviation {
        scene: scene.to_owned(),
        n: None,
        steps: None,
        norm: Some(owed.norm.clone()),
        variable: Some(owed.variable),
        kind: DeviationKind::Owed,
        recorded: None,
        found: None,
        verdict: DeviationKind::Owed.decision(),
        reason: format!("{scene}: {}: {what}", owed.name()),
    }
}

impl Comparison {
    /// What was owed, and whether the baseline recorded it.
    pub(super) fn owed_in_words(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if !self.owed_not_said.is_empty() {
            let scenes = counted(self.owed_not_said.len(), "scene");
            lines.push(format!(
                "baseline: does not say what verdicts and constants are owed by {scenes}, the first is {}; sweep baseline records it",
                self.owed_not_said[0]
            ));
        }
        if self.owed.verdicts > 0 {
            let left = self.deviations.iter().filter(|d| d.kind == DeviationKind::Owed).count();
            let found = match left {
                0 => "all judged".to_owned(),
                left => format!("{left} not as owed"),
            };
            let verdicts = counted(self.owed.verdicts, "verdict");
            let constants = counted(self.owed.constants, "compared constant");
            lines.push(format!("baseline: {verdicts} and {constants} owed, {found}"));
        }
        lines
    }
}

/// Changes in what a scene owes, a line each.
pub(super) fn changes_of_owed(scene: &str, old: &Recorded, new: &Recorded) -> Vec<String> {
    let (Some(was), Some(is)) = (&old.owes, &new.owes) else {
        // Absent in an older baseline is not a change.
        return Vec::new();
    };
    let mut lines = Vec::new();
    let mut left = is.clone();
    let names = |owed: &Owed| match owed.constants.len() {
        0 => "no constant".to_owned(),
        _ => owed.constants.join(", "),
    };
    for owed in was {
        match left.iter().position(|other| other.is_of(owed)) {
            None => lines.push(format!("{scene}: {}: no longer owed", owed.name())),
            Some(at) => {
                let judged = left.remove(at);
                if judged != *owed {
                    let (was, is) = (names(owed), names(&judged));
                    lines.push(format!("{scene}: {}: owes {was} -> {is}", owed.name()));
                }
            }
        }
    }
    lines.extend(left.iter().map(|owed| format!("{scene}: {}: owed from now on", owed.name())));
    lines
}
