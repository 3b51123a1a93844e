//! Verdicts as a text table, with reasons below.

use std::collections::BTreeSet;

use super::columns::{GAP, text_table};
use crate::legend::wrapped;
use files::counted;
use judge::record::{CaseRecord, Status};
use judge::verdict::{Decision, Verdict, cell_texts};

/// Heads of the cells of verdicts.
pub(super) const VERDICT_HEADS: [&str; 7] =
    ["scene", "norm", "in", "predicted", "observed", "verdict", "by"];

/// What stands in place of an empty table.
const NOTHING_JUDGED: &str =
    "nothing was judged: every scene here says judge = false and is measured only";

/// The verdicts in `width` characters, a line each, with the theorems where they fit; below the table the reason of every
/// verdict that is not a plain pass.
pub fn verdict_table(verdicts: &[Verdict], width: u16) -> String {
    if verdicts.is_empty() {
        return NOTHING_JUDGED.into();
    }
    let mut rows: Vec<Vec<String>> = verdicts.iter().map(|v| cell_texts(v).to_vec()).collect();
    let heads = [&VERDICT_HEADS[..6], &["why"]].concat();
    let longest = |at: usize| {
        let lines = rows.iter().flat_map(|row| row[at].lines());
        lines.map(|line| line.chars().count()).fold(heads[at].len(), usize::max)
    };
    let others: usize = (0..6).map(longest).sum::<usize>() + 7 * GAP;
    let room = usize::from(width).saturating_sub(others);
    for row in &mut rows {
        row[6] = short(&row[6], room);
    }
    let columns = 6 + usize::from(rows.iter().any(|row| !row[6].is_empty()));
    rows.iter_mut().for_each(|row| row.truncate(columns));
    let mut blocks = vec![text_table(&heads[..columns], &rows, width)];
    blocks.extend(reasons(verdicts, width.into()));
    blocks.join("\n")
}

/// A theorem in so many characters: without what follows it, or not at all.
fn short(why: &str, room: usize) -> String {
    let fits = |words: &&str| words.chars().count() <= room;
    let begin = why.split([':', ';']).next().unwrap_or_default();
    let number = begin.split(',').next().unwrap_or_default();
    [why, begin, number].into_iter().find(fits).unwrap_or_default().to_owned()
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
        let why = "(5.26): a theorem of many words that is too long for most tables".into();
        verdicts.push(Verdict { scene, norm, why, ..verdicts[0].clone() });
        let observed = cell_texts(&verdicts[0])[4].clone();
        for width in [80, 100, 140, 180] {
            let text = verdict_table(&verdicts, width);
            assert!(text.lines().all(|line| line.chars().count() <= width.into()), "{text}");
            assert!(text.matches(&observed).count() == 2 && text.contains("unresolved"), "{text}");
            // One table: the verdict stands beside the order.
            assert_eq!(text.matches('═').count(), text.lines().next().unwrap().chars().count());
            // In one line: the theorem as far as it fits.
            assert!(width < 100 || text.contains("pressure_L2_max  h"), "{width}: {text}");
            assert_eq!(text.contains("(5.26)"), width >= 100, "{width}: {text}");
            assert_eq!(text.contains("many words"), width > 140, "{width}: {text}");
        }
    }
}
