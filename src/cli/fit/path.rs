//! An error table refined along a path k = c h^s.

use serde_json::json;

use super::asked::{Answer, Asked, gap_verdict, next, verdict_text};
use super::wording::Part;
use files::digits;
use judge::fit::{Direction, FitError, Further, LineReading, Posterior, RefinementPath};
use judge::table::Group;
use judge::verdict::Decision;

/// The order in h along the path, min(p, s q), and what it implies for p and q.
pub(super) fn part(group: &Group, path: RefinementPath, asked: Asked) -> Part {
    let measured = group.measurements();
    let read = LineReading::of(&measured, Direction::Space, &asked.known());
    let order = along(path, asked);
    let answer = order.map(|order| {
        gap_verdict(group).unwrap_or_else(|| match &read {
            Ok(read) => decide(read, path, asked, order),
            Err(error) => Answer::open(error),
        })
    });
    let RefinementPath { exponent, constant } = path;
    let found = read.as_ref().ok().map(|read| &read.posterior);
    let answered = answer.as_ref();
    let further = json!({
        "variable": "path",
        "exponent": exponent,
        "path_constant": constant,
        "local_slopes": found.map(|fitted| &fitted.slopes),
        "predicted": asked.p,
        "predicted_k": asked.q,
        "next": next(answered),
    });
    let otherwise = format!("along the path the order in h is min(p, {exponent:.2} q)");
    let text = text(&read, path, order, answered);
    asked.part((text, further), found, answer, otherwise)
}

fn text(
    read: &Result<LineReading, FitError>,
    path: RefinementPath,
    order: Option<f64>,
    answer: Option<&Answer>,
) -> String {
    let RefinementPath { exponent, constant } = path;
    let head = format!("path k = {} h^{exponent:.2}:", digits(constant, 4));
    let tail = verdict_text(order.map(|order| format!("order {order} along it")), answer);
    match read {
        Ok(LineReading { posterior: Posterior { order, interval, .. }, .. }) => {
            let tail = match tail.is_empty() {
                true => format!("; it is min(p, {exponent:.2} q)"),
                false => format!("\n   {tail}"),
            };
            format!("{head} order {order:.3} in {interval} in h{tail}")
        }
        Err(_) if !tail.is_empty() => format!("{head} {tail}"),
        Err(error) => format!("{head} {error}"),
    }
}

/// The predicted order along the path, without the rounding of its exponent; a missing p or q counts as the faster
/// term.
fn along(path: RefinementPath, asked: Asked) -> Option<f64> {
    let order = match (asked.p, asked.q) {
        (Some(p), Some(q)) => path.order(p, q),
        (Some(p), None) => p,
        (None, Some(q)) => path.exponent * q,
        (None, None) => return None,
    };
    Some((1e6 * order).round() / 1e6)
}

fn decide(read: &LineReading, path: RefinementPath, asked: Asked, order: f64) -> Answer {
    let steps: Vec<f64> = read.samples.iter().map(|sample| sample.step).collect();
    let answer =
        asked.answer(&read.posterior, order, Further::after("h", &steps, &[], asked.reference));
    let (reason, helps) = (answer.reason.clone(), !answer.next.is_empty());
    let and = |words: &str| Answer { reason: format!("{reason}{words}"), ..answer };
    match (answer.decision, asked.p, asked.q) {
        (Decision::Pass, Some(p), Some(q)) => {
            let balanced = format!("run k proportional to h^{:.2}, or the grid", p / q);
            let hidden = |other: f64, name: &str, least: f64| {
                Answer::open(format!(
                    "{reason}, but the path cannot tell order {other} in {name} from {least:.2}: {balanced}"
                ))
            };
            match path.tests(p, q) {
                [true, true] => and(&format!(", so the orders are at least {p} in h and {q} in k")),
                [true, false] => hidden(q, "k", order / path.exponent),
                _ => hidden(p, "h", order),
            }
        }
        (Decision::Pass, Some(p), None) => and(&format!(", so the order is at least {p} in h")),
        (Decision::Pass, None, Some(q)) => and(&format!(", so the order is at least {q} in k")),
        (Decision::Fail, Some(_), None) => {
            Answer::open(format!("{reason}, in h or in k: run one k with several h"))
        }
        (Decision::Fail, None, Some(_)) => {
            Answer::open(format!("{reason}, in h or in k: run one h with several k"))
        }
        (Decision::Unresolved, ..) if helps => and(" on the path"),
        _ => and(""),
    }
}
