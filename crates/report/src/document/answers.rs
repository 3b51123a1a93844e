//! The first answers: did the estimates, or the solver under test, hold; what is least certain; what was broken on purpose.

use super::content::{Report, tone};
use super::{Run, Section, Tone};
use files::counted;
use judge::verdict::{Decision, Verdict, cell_texts};

/// Claims that readers know by name, spelt as in the reasons of predictions.
const CLAIMS: [&str; 3] = ["(5.26)", "Theorem 7", "(5.24)"];

pub(super) fn write(section: &mut Section, report: &Report<'_>) {
    let verdicts = report.verdicts;
    section.text(by_claim(verdicts, report.of_a_solver()));
    if let Some(verdict) = least_certain(verdicts) {
        section.text(closest(verdict, report.link(&verdict.scene)));
    }
    broken(section, report);
}

/// The first two answers, on the estimates, in a line each.
pub fn answers(verdicts: &[Verdict]) -> Vec<String> {
    let least = least_certain(verdicts).map(|verdict| closest(verdict, None));
    let lines = [Some(by_claim(verdicts, false)), least];
    let text = |runs: Vec<Run>| runs.iter().map(|run| run.text.as_str()).collect();
    lines.into_iter().flatten().map(text).collect()
}

fn held(judged: &[&Verdict]) -> (String, Tone) {
    let met = judged.iter().filter(|verdict| verdict.as_expected()).count();
    let tone = if met == judged.len() { Tone::Pass } else { Tone::Miss };
    (format!("{met} of {}", judged.len()), tone)
}

fn by_claim(verdicts: &[Verdict], of_a_solver: bool) -> Vec<Run> {
    // Another program's solver is what `sweep verify` judges; the estimates are known to hold on its scene.
    let question = match of_a_solver {
        true => "Does the solver have the predicted orders? ",
        false => "Did the estimates hold? ",
    };
    let mut by_claim = vec![Run::of(question, Tone::Strong)];
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
    by_claim
}

/// The verdict closest to being another one: the prediction holds with little more than needed for a pass, or misses it
/// by little. An unresolved one is closest. A scene that fails because it was built to is no warning.
fn least_certain(verdicts: &[Verdict]) -> Option<&Verdict> {
    let by_constant = |verdict: &Verdict| verdict.constant.as_ref().is_some_and(|c| c.decides);
    let certainty = |verdict: &Verdict| match (verdict.decision, verdict.probability) {
        (Decision::Pass, _) if by_constant(verdict) => 1.0,
        (Decision::Pass, Some(probability)) => probability,
        (Decision::Fail, Some(probability)) => 1.0 - probability,
        // Without a probability cases are missing: that is certain.
        (Decision::Pass | Decision::Fail, None) => 1.0,
        (Decision::Unresolved, _) => 0.0,
    };
    let meant = |verdict: &&Verdict| verdict.decision == Decision::Pass || !verdict.as_expected();
    verdicts.iter().filter(meant).min_by(|a, b| certainty(a).total_cmp(&certainty(b)))
}

/// A verdict with its numbers, linked to its scene.
fn closest(verdict: &Verdict, link: Option<String>) -> Vec<Run> {
    let [scene, norm, variable, predicted, observed, decision, _] = cell_texts(verdict);
    let certain = match verdict.probability {
        Some(probability) => format!("holds with probability {probability:.2}"),
        None => "has no probability".into(),
    };
    let observed = observed.replace('\n', "; ");
    vec![
        Run::of("Which is least certain? ", Tone::Strong),
        Run { target: link, ..Run::plain(scene) },
        Run::plain(format!(", {norm} in {variable}: {observed} for {predicted} {certain}, ")),
        Run::of(decision, tone(verdict)),
        Run::plain("."),
    ]
}

fn broken(section: &mut Section, report: &Report<'_>) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use judge::verdict::{ConstantClaim, Prediction, Variable};

    fn verdict(scene: &str, expect: Decision, decision: Decision, probability: f64) -> Verdict {
        let prediction = Prediction::new("V_max", Variable::H, 1.0);
        let open = Verdict::open(scene, &prediction, expect);
        Verdict { decision, probability: Some(probability), ..open }
    }

    #[test]
    fn a_failure_on_purpose_is_not_the_least_certain() {
        use Decision::{Fail, Pass, Unresolved};
        let mut verdicts = vec![
            verdict("built-to-fail", Fail, Fail, 0.0),
            verdict("clear", Pass, Pass, 0.99),
            verdict("close", Pass, Pass, 0.80),
            verdict("defect", Pass, Fail, 0.01),
        ];
        let least = |verdicts: &[Verdict]| least_certain(verdicts).map(|v| v.scene.clone());
        assert_eq!(least(&verdicts).as_deref(), Some("close"));
        // Its constant shows the order, whatever the slopes say.
        let claim = |decides| {
            Some(ConstantClaim {
                name: "C_k",
                decision: Pass,
                reason: String::new(),
                owed: false,
                decides,
            })
        };
        verdicts
            .push(Verdict { constant: claim(true), ..verdict("by-constant", Pass, Pass, 0.06) });
        assert_eq!(least(&verdicts).as_deref(), Some("close"));
        verdicts.push(verdict("open", Pass, Unresolved, 0.9));
        assert_eq!(least(&verdicts).as_deref(), Some("open"));
        assert_eq!(least(&verdicts[..1]), None);
    }
}
