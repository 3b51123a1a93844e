//! Verdicts as a text table, with reasons below.

use std::collections::BTreeSet;

use super::columns::text_table;
use crate::legend::wrapped;
use files::counted;
use judge::record::{CaseRecord, Status};
use judge::verdict::{Decision, Verdict, cell_texts};

/// Heads of the cells of verdicts.
pub(super) const VERDICT_HEADS: [&str; 7] =
    ["scene", "norm", "in", "predicted", "observed", "verdict", "by"];

/// Minimal width for the theorems beside the intervals.
const WITH_REASONS: u16 = 96;

/// What stands in place of an empty table.
const NOTHING_JUDGED: &str =
    "nothing was judged: every scene here says judge = false and is measured only";

/// The verdicts in `width` characters, with the theorems where there is room; below the table the reason of every verdict
/// that is not a plain pass.
pub fn verdict_table(verdicts: &[Verdict], width: u16) -> String {
    if verdicts.is_empty() {
        return NOTHING_JUDGED.into();
    }
    let columns = VERDICT_HEADS.len() - usize::from(width < WITH_REASONS);
    let row = |verdict: &Verdict| cell_texts(verdict)[..columns].to_vec();
    let rows: Vec<Vec<String>> = verdicts.iter().map(row).collect();
    let heads = [&VERDICT_HEADS[..6], &["why"]].concat();
    let mut blocks = vec![text_table(&heads[..columns], &rows, width)];
    blocks.extend(reasons(verdicts, width.into()));
    blocks.join("\n")
}

/// Verdicts and cases in numbers; tables where no cases were run.
pub(crate) fn outcome(records: &[CaseRecord], verdicts: &[Verdict]) -> String {
    let met = verdicts.iter().filter(|verdict| verdict.as_expected()).count();
    let failed = records.iter().filter(|record| matches!(record.status, Status::Failed { .. }));
    let judged = match verdicts.len() {
        0 => NOTHING_JUDGED.to_owned(),
        all => format!("{met} of {} as expected", counted(all, "verdict")),
    };
    if records.is_empty() {
        let tables: BTreeSet<_> = verdicts.iter().map(|v| (&v.scene, &v.norm)).collect();
        return format!("{judged}; {}", counted(tables.len(), "table"));
    }
    format!("{judged}; {}, {} of them failed", counted(records.len(), "case"), failed.count())
}

/// Reasons of all but plain passes; one that several orders of a scene share is stated once.
fn reasons(verdicts: &[Verdict], width: usize) -> Vec<String> {
    let plain = |v: &Verdict| v.as_expected() && v.decision == Decision::Pass;
    let explained: Vec<&Verdict> = verdicts.iter().filter(|verdict| !plain(verdict)).collect();
    let shared = explained
        .chunk_by(|a, b| (&a.scene, a.decision, &a.reason) == (&b.scene, b.decision, &b.reason));
    let words = |group: &[&Verdict]| {
        let Verdict { scene, decision, reason, .. } = group[0];
        let orders =
            group.iter().map(|verdict| format!("{} in {}", verdict.norm, verdict.variable.name()));
        let orders = orders.collect::<Vec<_>>().join(", ");
        let words = format!("{scene} {orders}: {}: {reason}", decision.name());
        wrapped(&words, width.saturating_sub(4), usize::MAX).join("\n    ")
    };
    shared.map(words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::record::{NormError, V_MAX};
    use judge::verdict::{Prediction, Variable, judge};

    fn verdict(order: f64, predicted: f64) -> Verdict {
        let record = |n: u32| {
            let error = Some(f64::from(n).powf(-order));
            CaseRecord {
                status: Status::Converged,
                errors: vec![NormError { norm: V_MAX.into(), error, floor: Some(0.0) }],
                ..CaseRecord::without_work("block", Some(n), 4, 0.25)
            }
        };
        let records = [8, 16, 32, 64, 128].map(record);
        let prediction =
            Prediction { why: "(5.26)".into(), ..Prediction::new(V_MAX, Variable::H, predicted) };
        judge("block", &records, &[], &prediction, Decision::Pass)
    }

    #[test]
    fn reasons_are_said_of_all_but_plain_passes() {
        let one = verdict(1.0, 1.0);
        assert_eq!(verdict_table(std::slice::from_ref(&one), 100).lines().count(), 5);
        let bound = Verdict { at_least: true, expect: Decision::Fail, ..one.clone() };
        let failed =
            Verdict { decision: Decision::Fail, reason: "because".into(), ..bound.clone() };
        for other in [&bound, &failed] {
            let text = verdict_table(&[one.clone(), other.clone()], 100);
            let reason = format!("block V_max in h: {}: {}", other.decision.name(), other.reason);
            assert_eq!(text.lines().last(), Some(&*reason));
            assert_eq!(text.matches("in h:").count(), 1);
        }
    }

    #[test]
    fn the_table_fits_its_width_and_keeps_intervals_whole() {
        let mut verdicts = vec![verdict(1.7, 1.0)];
        let (scene, norm) = ("corner-reentrant-loaded".into(), "pressure_L2_max".into());
        let why = "a theorem of many words that is too long for one line of the table".into();
        verdicts.push(Verdict { scene, norm, why, ..verdicts[0].clone() });
        let observed = cell_texts(&verdicts[0])[4].clone();
        for width in [80, 100, 140] {
            let text = verdict_table(&verdicts, width);
            assert!(text.lines().all(|line| line.chars().count() <= width.into()), "{text}");
            assert!(text.matches(&observed).count() == 2 && text.contains("unresolved"), "{text}");
            // One table: the verdict stands beside the order.
            assert_eq!(text.matches('═').count(), text.lines().next().unwrap().chars().count());
            assert_eq!(text.contains("many words"), width >= 100);
        }
    }
}
