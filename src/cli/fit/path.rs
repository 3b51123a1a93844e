//! An error table refined along a path k = c h^s.

use serde_json::json;

use super::{Part, Predicted, gap_verdict, next_step, orders_text, verdict_text};
use judge::fit::{
    Correction, Direction, Interval, OrderInterval, Path, Sample, local_slopes, order_interval,
    samples,
};
use judge::table::Group;
use judge::verdict::{Decision, compare};

/// The order in h along the path, which is min(p, s q), and what it says of p and q.
pub(super) fn part(group: &Group, path: Path, predicted: Predicted) -> Part {
    let fitted = samples(&group.points(), Direction::Space)
        .and_then(|samples| Ok((order_interval(&samples, Correction::Linear)?, samples)));
    let order = along(path, predicted);
    let verdict = order.map(|order| {
        gap_verdict(group).unwrap_or_else(|| match &fitted {
            Ok((found, samples)) => decide(found, samples, path, predicted, order),
            Err(error) => (Decision::Unresolved, error.to_string()),
        })
    });
    let Path { exponent, constant } = path;
    let found = fitted.as_ref().ok();
    let json = super::map(json!({
        "variable": "path",
        "exponent": exponent,
        "path_constant": constant,
        "observed": found.map(|(found, _)| found.law.order),
        "interval": found.map(|(found, _)| [found.interval.lo, found.interval.hi]),
        "local_slopes": found.map(|(_, samples)| local_slopes(samples)),
        "predicted": predicted.p,
        "predicted_k": predicted.q,
        "verdict": verdict.as_ref().map(|(decision, _)| decision.name()),
        "reason": verdict.as_ref().map_or_else(
            || format!("along the path the order in h is min(p, {exponent:.2} q)"),
            |(_, reason)| reason.clone(),
        ),
    }));
    let head = format!("path k = {constant:.3} h^{exponent:.2}:");
    let order = order.map(|order| format!("order {order} along it"));
    let tail = verdict_text(order, verdict.as_ref());
    let text = match &fitted {
        Ok((found, samples)) => {
            let Interval { lo, hi } = found.interval;
            let tail = if tail.is_empty() {
                format!("; it is min(p, {exponent:.2} q)")
            } else {
                format!("; {tail}")
            };
            let slopes = orders_text(&local_slopes(samples));
            let order = found.law.order;
            format!(
                "{head} order {order:.3} in [{lo:.3}, {hi:.3}] in h{tail}\n   local orders {slopes}"
            )
        }
        Err(_) if !tail.is_empty() => format!("{head} {tail}"),
        Err(error) => format!("{head} {error}"),
    };
    Part { text, json, decision: verdict.map(|(decision, _)| decision) }
}

/// The order that is predicted along the path; where one of p, q is not given, as if the other
/// term were the slower one.
fn along(path: Path, predicted: Predicted) -> Option<f64> {
    match (predicted.p, predicted.q) {
        (Some(p), Some(q)) => Some(path.order(p, q)),
        (Some(p), None) => Some(p),
        (None, Some(q)) => Some(path.exponent * q),
        (None, None) => None,
    }
}

fn decide(
    found: &OrderInterval,
    samples: &[Sample],
    path: Path,
    predicted: Predicted,
    order: f64,
) -> (Decision, String) {
    let (decision, reason) = compare(found.interval, predicted.aim(order));
    let s = path.exponent;
    match (decision, predicted.p, predicted.q) {
        (Decision::Pass, Some(p), Some(q)) => match path.tests(p, q) {
            [true, true] => {
                (decision, format!("{reason}, so the orders are at least {p} in h and {q} in k"))
            }
            [true, false] => {
                let balanced = format!("run k proportional to h^{:.2}, or the grid", p / q);
                let least = order / s;
                let hidden = format!(
                    "{reason}, but the path cannot tell order {q} in k from {least:.2}: {balanced}"
                );
                (Decision::Unresolved, hidden)
            }
            _ => {
                let balanced = format!("run k proportional to h^{:.2}, or the grid", p / q);
                let hidden = format!(
                    "{reason}, but the path cannot tell order {p} in h from {order:.2}: {balanced}"
                );
                (Decision::Unresolved, hidden)
            }
        },
        (Decision::Pass, Some(p), None) => {
            (decision, format!("{reason}, so the order is at least {p} in h"))
        }
        (Decision::Pass, None, Some(q)) => {
            (decision, format!("{reason}, so the order is at least {q} in k"))
        }
        (Decision::Fail, Some(_), None) => {
            (Decision::Unresolved, format!("{reason}, in h or in k: run one k with several h"))
        }
        (Decision::Fail, None, Some(_)) => {
            (Decision::Unresolved, format!("{reason}, in h or in k: run one h with several k"))
        }
        (Decision::Unresolved, ..) if found.interval.contains(order) => {
            let steps: Vec<f64> = samples.iter().map(|sample| sample.step).collect();
            (decision, format!("{reason}: {} on the path", next_step("h", &steps)))
        }
        _ => (decision, reason),
    }
}
