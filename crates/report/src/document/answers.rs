//! The first answers: did the estimates hold, what is least certain, what was broken on purpose.

use super::content::{Report, tone};
use super::{Run, Section, Tone};
use files::counted;
use judge::verdict::{Verdict, cell_texts};

/// Claims that readers know by name, spelt as in the reasons of predictions.
const CLAIMS: [&str; 3] = ["(5.26)", "Theorem 7", "(5.24)"];

pub(super) fn write(section: &mut Section, report: &Report<'_>) {
    let verdicts = report.verdicts;
    let held = |judged: &[&Verdict]| {
        let met = judged.iter().filter(|verdict| verdict.as_expected()).count();
        (
            format!("{met} of {}", judged.len()),
            if met == judged.len() { Tone::Pass } else { Tone::Miss },
        )
    };
    let mut by_claim = vec![Run::of("Did the estimates hold? ", Tone::Strong)];
    for claim in CLAIMS {
        let of_claim: Vec<&Verdict> = verdicts.iter().filter(|v| v.why.contains(claim)).collect();
        if !of_claim.is_empty() {
            let (words, tone) = held(&of_claim);
            by_claim.push(Run::plain(format!("{claim}: ")));
            by_claim.push(Run::of(words, tone));
            by_claim.push(Run::plain("; "));
        }
    }
    let (all, tone) = held(&verdicts.iter().collect::<Vec<_>>());
    by_claim.push(Run::plain("all orders: "));
    by_claim.push(Run::of(all, tone));
    by_claim.push(Run::plain(" as expected."));
    section.text(by_claim);
    if let Some(verdict) = least_certain(verdicts) {
        let mut runs = vec![Run::of("Which is least certain? ", Tone::Strong)];
        runs.extend(named(report, verdict));
        section.text(runs);
    }
    broken(section, report, held);
}

/// The verdict of least probability; orders without one come first.
fn least_certain(verdicts: &[Verdict]) -> Option<&Verdict> {
    let probability = |verdict: &Verdict| verdict.probability.unwrap_or(-1.0);
    verdicts.iter().min_by(|a, b| probability(a).total_cmp(&probability(b)))
}

/// A verdict with its numbers, linked to its scene.
fn named(report: &Report<'_>, verdict: &Verdict) -> Vec<Run> {
    let [scene, norm, variable, predicted, observed, decision, _] = cell_texts(verdict);
    let certain = match verdict.probability {
        Some(probability) => format!("holds with probability {probability:.2}"),
        None => "has no probability".into(),
    };
    let observed = observed.replace('\n', "; ");
    vec![
        Run { target: report.link(&verdict.scene), ..Run::plain(scene) },
        Run::plain(format!(", {norm} in {variable}: {observed} for {predicted} {certain}, ")),
        Run::of(decision, tone(verdict)),
        Run::plain("."),
    ]
}

fn broken(
    section: &mut Section,
    report: &Report<'_>,
    held: impl Fn(&[&Verdict]) -> (String, Tone),
) {
    let scenes: Vec<_> = report.scenes.iter().filter(|scene| !scene.violates.is_empty()).collect();
    if scenes.is_empty() {
        return;
    }
    let mut hypotheses: Vec<&str> =
        scenes.iter().flat_map(|scene| &scene.violates).map(String::as_str).collect();
    hypotheses.sort_unstable();
    hypotheses.dedup();
    let hypotheses: Vec<String> = hypotheses.into_iter().map(super::chapter::numbered).collect();
    let is_broken = |verdict: &&Verdict| scenes.iter().any(|scene| scene.name == verdict.scene);
    let broken: Vec<&Verdict> = report.verdicts.iter().filter(is_broken).collect();
    let (words, tone) = held(&broken);
    section.text(vec![
        Run::of("What was broken on purpose? ", Tone::Strong),
        Run::plain("hypotheses").to("#chapter-broken"),
        Run::plain(format!(" {} in {}; ", hypotheses.join(", "), counted(scenes.len(), "scene"))),
        Run::of(words, tone),
        Run::plain(" orders are those that were derived for it."),
    ]);
}
