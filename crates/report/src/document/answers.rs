//! What a reader asks first: did the estimates hold, what is least certain, what was broken on purpose.

use super::content::{Report, id_of, tone};
use super::{Run, Section, Tone};
use files::counted;
use judge::verdict::{Verdict, cell_texts};

/// Claims that a reader knows by name, as the reasons of predictions spell them.
const CLAIMS: [&str; 3] = ["(5.26)", "Theorem 7", "(5.24)"];

/// The answers, below the sentence that says everything at once.
pub(super) fn write(section: &mut Section, report: &Report<'_>) {
    let verdicts = report.verdicts;
    let held = |own: &[&Verdict]| {
        let met = own.iter().filter(|verdict| verdict.as_expected()).count();
        (format!("{met} of {}", own.len()), if met == own.len() { Tone::Pass } else { Tone::Miss })
    };
    let mut by_claim = vec![Run::of("Did the estimates hold? ", Tone::Strong)];
    for claim in CLAIMS {
        let own: Vec<&Verdict> = verdicts.iter().filter(|v| v.why.contains(claim)).collect();
        if !own.is_empty() {
            let (words, tone) = held(&own);
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

/// That with the least probability; an order without one is less certain than all others.
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
        Run { target: id_of(report, &verdict.scene), ..Run::plain(scene) },
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
    let own = |verdict: &&Verdict| scenes.iter().any(|scene| scene.name == verdict.scene);
    let own: Vec<&Verdict> = report.verdicts.iter().filter(own).collect();
    let (words, tone) = held(&own);
    section.text(vec![
        Run::of("What was broken on purpose? ", Tone::Strong),
        Run::plain("hypotheses").to("#chapter-broken"),
        Run::plain(format!(" {} in {}; ", hypotheses.join(", "), counted(scenes.len(), "scene"))),
        Run::of(words, tone),
        Run::plain(" orders are those that were derived for it."),
    ]);
}
