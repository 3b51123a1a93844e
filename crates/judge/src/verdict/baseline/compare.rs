//! A run against its baseline.

use std::collections::BTreeMap;

use serde::Serialize;

use super::tolerance::{REPEATED_WITHIN, in_percent};
use super::{Baseline, Owing, RecordedCase};
use crate::record::{CaseRecord, Key, Status};
use crate::verdict::{Variable, Verdict};
use fit::Decision;

/// Share or number by which work may grow: an iteration more in a few steps is rounding.
const WORK_SHARE: f64 = 0.10;
const WORK_NUMBER: u64 = 2;

/// What deviates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum DeviationKind {
    Error,
    /// A recorded case or norm is missing.
    Missing,
    /// More iterations or factorizations than recorded.
    Cost,
    /// The scene file has changed since: nothing can be compared.
    Stale,
    /// A verdict or compared constant is owed and missing, or present and not owed.
    Owed,
}

impl DeviationKind {
    /// A changed scene is unresolved; everything else fails.
    pub(crate) fn decision(self) -> Decision {
        match self {
            DeviationKind::Stale => Decision::Unresolved,
            _ => Decision::Fail,
        }
    }
}

/// One deviation from the baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Deviation {
    pub scene: String,
    /// Mesh cells per unit length, where a case deviates.
    pub n: Option<u32>,
    /// Number of time steps, where a case deviates.
    pub steps: Option<u32>,
    pub norm: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variable: Option<Variable>,
    pub kind: DeviationKind,
    pub recorded: Option<f64>,
    /// None if NaN.
    pub found: Option<f64>,
    pub verdict: Decision,
    pub reason: String,
}

#[derive(Debug, Clone)]
pub struct ComparedRun {
    pub scene: String,
    pub hash: String,
    pub planned: Vec<Key>,
    /// It ran on the default grids of its file: every recorded case has to be there.
    pub own_grids: bool,
}

/// What the comparison of a run found.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Comparison {
    /// Scenes that were compared, in the order of the run.
    pub scenes: Vec<String>,
    pub compared: usize,
    /// Scenes that the baseline does not have.
    pub not_recorded: Vec<String>,
    /// What the compared scenes owe on their default grids.
    pub owed: Owing,
    /// Scenes for which the baseline does not record what they owe.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub owed_not_said: Vec<String>,
    pub deviations: Vec<Deviation>,
}

impl Comparison {
    /// 0 without deviations, else 1.
    pub fn exit_code(&self) -> u8 {
        u8::from(!self.deviations.is_empty())
    }

    /// One line per deviation, the scenes not recorded, and a summary.
    pub fn lines(&self) -> Vec<String> {
        let line = |d: &Deviation| format!("baseline: {}: {}", d.verdict.name(), d.reason);
        let mut lines: Vec<String> = self.deviations.iter().map(line).collect();
        if !self.not_recorded.is_empty() {
            let names = self.not_recorded.join(", ");
            lines.push(format!("baseline: not recorded, hence not compared: {names}"));
        }
        lines.extend(self.owed_in_words());
        let found = match self.deviations.len() {
            0 => "no deviation".to_owned(),
            1 => "1 deviation".to_owned(),
            more => format!("{more} deviations"),
        };
        lines.push(format!("baseline: {} errors compared, {found}", self.compared));
        if !self.deviations.is_empty() {
            let cure =
                "baseline: if the change is meant, record it: sweep baseline, or make baseline";
            lines.push(cure.to_owned());
        }
        lines
    }
}

impl Baseline {
    /// Compares runs of scenes with their records: errors and work, and what the verdicts leave owing. Scenes on other
    /// than their default grids, or left out of the comparison, owe nothing.
    pub fn compare(
        &self,
        runs: &[ComparedRun],
        records: &[CaseRecord],
        verdicts: &[Verdict],
    ) -> Comparison {
        let (mut comparison, mut left_owing) = (Comparison::default(), Vec::new());
        for run in runs {
            let Some(recorded) = self.scenes.get(&run.scene) else {
                comparison.not_recorded.push(run.scene.clone());
                continue;
            };
            comparison.scenes.push(run.scene.clone());
            if recorded.hash != run.hash {
                let reason = format!(
                    "{}: the scene file changed after it was recorded: nothing to compare",
                    run.scene
                );
                comparison.deviations.push(Deviation::of(DeviationKind::Stale, &run.scene, reason));
                continue;
            }
            let of_scene = || records.iter().rev().filter(|record| record.scene == run.scene);
            for case in &recorded.cases {
                let planned = run.planned.iter().any(|key| case.is_case(key.n, key.steps));
                if planned || run.own_grids {
                    let found = of_scene().find(|record| case.is_case(record.n, record.steps));
                    let converged = found.is_some_and(CaseRecord::converged);
                    comparison.compared += if converged { case.errors.len() } else { 0 };
                    comparison.deviations.extend(compare_case(&run.scene, case, found));
                }
            }
            if run.own_grids {
                left_owing.extend(comparison.owe(&run.scene, recorded, verdicts));
            }
        }
        comparison.deviations.extend(left_owing);
        comparison
    }
}

impl Deviation {
    /// Of no case, norm or number.
    pub(super) fn of(kind: DeviationKind, scene: &str, reason: String) -> Self {
        Self {
            scene: scene.to_owned(),
            n: None,
            steps: None,
            norm: None,
            variable: None,
            kind,
            recorded: None,
            found: None,
            verdict: kind.decision(),
            reason,
        }
    }
}

/// Deviations of a recorded case, whose last record is `found`.
fn compare_case(scene: &str, case: &RecordedCase, found: Option<&CaseRecord>) -> Vec<Deviation> {
    let mut deviations = Vec::new();
    let mut say = |kind, norm: Option<&str>, [recorded, found]: [Option<f64>; 2], what: &str| {
        let subject = norm.map_or(String::new(), |norm| format!(": {norm}"));
        let reason = format!("{scene}, {}{subject} {what}", case.name());
        let (n, steps, norm) = (case.n, Some(case.steps), norm.map(str::to_owned));
        let of_scene = Deviation::of(kind, scene, reason);
        deviations.push(Deviation { n, steps, norm, recorded, found, ..of_scene });
    };
    let Some(record) = found.filter(|record| record.converged()) else {
        let what = match found.map(|record| &record.status) {
            None => "was not run".to_owned(),
            Some(Status::Failed { reason }) => format!("failed: {reason}"),
            Some(_) => "was skipped".to_owned(),
        };
        say(DeviationKind::Missing, None, [None; 2], &what);
        return deviations;
    };
    for (norm, &recorded) in &case.errors {
        let allowed = case.allowed.get(norm).copied().unwrap_or(REPEATED_WITHIN);
        let Some(error) = record.norm(norm).and_then(|entry| entry.error) else {
            let values = [Some(recorded), None];
            say(DeviationKind::Missing, Some(norm), values, "was not measured");
            continue;
        };
        let change = error / recorded - 1.0;
        // A NaN is not a small change.
        if change.is_nan() || change.abs() > allowed {
            let finite = Some(error).filter(|error| error.is_finite());
            let what = match finite {
                Some(_) => {
                    format!("is {error:.6e}, recorded {recorded:.6e}: {}", in_percent(change))
                }
                None => format!("is {error}, recorded {recorded:.6e}"),
            };
            say(DeviationKind::Error, Some(norm), [Some(recorded), finite], &what);
        }
    }
    for ((name, _, recorded), (_, _, now)) in
        case.work().into_iter().zip(RecordedCase::of(record, &BTreeMap::new()).work())
    {
        if let Some((recorded, now)) =
            recorded.zip(now).filter(|(recorded, now)| grew(*recorded, *now))
        {
            let what = format!("rose from {recorded} to {now}: the same result costs more");
            say(DeviationKind::Cost, Some(name), [recorded, now].map(|v| Some(v as f64)), &what);
        }
    }
    deviations
}

fn grew(recorded: u64, now: u64) -> bool {
    now > recorded + WORK_NUMBER && now as f64 > recorded as f64 * (1.0 + WORK_SHARE)
}
