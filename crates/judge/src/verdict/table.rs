//! A verdict in the cells of a table.

use super::Verdict;
use fit::Decision;

/// The cells of a verdict: scene, norm, in, predicted, observed, verdict, why.
pub fn cell_texts(verdict: &Verdict) -> [String; 7] {
    let name = verdict.decision.name();
    let decision = match (verdict.as_expected(), verdict.decision) {
        (true, Decision::Pass) => match &verdict.constant {
            Some(constant) if constant.decides => format!("{name}, by {}", constant.name),
            _ => name.to_owned(),
        },
        (false, Decision::Fail | Decision::Unresolved) => name.to_owned(),
        (true, _) => format!("{name}, as expected"),
        (false, Decision::Pass) => format!("{name}, expected {}", verdict.expect.name()),
    };
    [
        verdict.scene.clone(),
        verdict.norm.clone(),
        verdict.variable.name().to_owned(),
        predicted(verdict),
        observed(verdict),
        decision,
        verdict.why.clone(),
    ]
}

fn predicted(verdict: &Verdict) -> String {
    let bound = match verdict.at_least {
        true if verdict.predicted == 0.0 => "→ ",
        true => "≥ ",
        false => "",
    };
    let order_k = verdict.predicted_k.map_or_else(String::new, |order| format!(", {order}"));
    format!("{bound}{}{order_k}", verdict.predicted)
}

/// Two digits after the point, and no zero with a sign.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" { "0.00".into() } else { text }
}

fn observed(verdict: &Verdict) -> String {
    let text = |order: Option<f64>, interval: Option<[f64; 2]>| {
        order
            .zip(interval)
            .map(|(order, [lo, hi])| format!("{} [{}, {}]", short(order), short(lo), short(hi)))
    };
    let both =
        [text(verdict.observed, verdict.interval), text(verdict.observed_k, verdict.interval_k)];
    let texts: Vec<String> = both.into_iter().flatten().collect();
    if texts.is_empty() { "-".to_owned() } else { texts.join("\n") }
}
