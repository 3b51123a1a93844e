//! One direction of an error table.

use serde_json::json;

use super::{
    Part, Predicted, gap_verdict, line_points, next_step, orders_text, step_name, verdict_text,
};
use files::counted;
use judge::fit::{
    Correction, Direction, FitError, Interval, JointFits, LARGEST_OTHER_SHARE, NotIdentifiable,
    OrderInterval, Point, Sample, constant_under, local_slopes, order_interval, samples, screen,
};
use judge::table::Group;
use judge::verdict::{Aim, Decision, compare};

/// Nobody knows the scheme behind a table: the next term is taken to be the next power, which
/// covers the even terms of a trapezoidal rule as well, at the price of a wider interval.
const CORRECTION: Correction = Correction::Linear;

/// A line with its order.
struct Fitted {
    samples: Vec<Sample>,
    order: OrderInterval,
}

/// The order in one direction; none if it is neither refined nor predicted.
pub(super) fn part(
    group: &Group,
    direction: Direction,
    claims: Predicted,
    joint: Option<&Result<JointFits, NotIdentifiable>>,
) -> Option<Part> {
    let predicted = claims.order(direction);
    if !group.refined(direction) && predicted.is_none() {
        return None;
    }
    let line = line_points(group, direction);
    let fitted = samples(&line, direction)
        .and_then(|samples| Ok(Fitted { order: order_interval(&samples, CORRECTION)?, samples }));
    let verdict = predicted.map(|order| {
        gap_verdict(group)
            .or_else(|| bent(&line, direction, claims.aim(order), joint))
            .unwrap_or_else(|| decide(&fitted, &line, direction, claims.aim(order)))
    });
    Some(Part {
        text: text(&fitted, &line, direction, predicted, verdict.as_ref()),
        json: object(&fitted, &line, direction, predicted, verdict.as_ref()),
        decision: verdict.map(|(decision, _)| decision),
    })
}

fn decide(
    fitted: &Result<Fitted, FitError>,
    line: &[Point],
    direction: Direction,
    aim: Aim,
) -> (Decision, String) {
    let name = step_name(direction);
    let steps = |samples: &[Sample]| samples.iter().map(|s| s.step).collect::<Vec<f64>>();
    match fitted {
        Ok(fitted) => {
            let (decision, reason) = compare(fitted.order.interval, aim);
            let wide =
                decision == Decision::Unresolved && fitted.order.interval.contains(aim.order);
            let next = next_step(name, &steps(&fitted.samples));
            let part = fitted.order.widest_part();
            let hint = if wide { format!(", from {part}: {next}") } else { String::new() };
            (decision, reason + &hint)
        }
        Err(error) => {
            let left = samples(line, direction).unwrap_or_default();
            let hint = match error {
                FitError::TooFew { .. } => format!(": {}", next_step(name, &steps(&left))),
                _ => String::new(),
            };
            (Decision::Unresolved, format!("{error}{}{hint}", left_out_text(line)))
        }
    }
}

/// Where the term of the other direction bends this line, the grid decides; and where the grid
/// shows that the term of this direction is too small to be seen, nothing does.
fn bent(
    line: &[Point],
    direction: Direction,
    aim: Aim,
    joint: Option<&Result<JointFits, NotIdentifiable>>,
) -> Option<(Decision, String)> {
    let best = match joint? {
        Ok(fits) => &fits.best,
        Err(refused) if refused.hidden == Some(direction) => {
            return Some((Decision::Unresolved, refused.to_string()));
        }
        Err(_) => return None,
    };
    let (own, other, name) = match direction {
        Direction::Space => (best.order_h, 1, "k"),
        Direction::Time => (best.order_k, 0, "h"),
    };
    let used = line.iter().filter(|point| screen(point).is_ok());
    let share = used.map(|point| best.weights(point.h, point.k)[other]).fold(0.0, f64::max);
    (share > LARGEST_OTHER_SHARE).then(|| {
        let (decision, reason) = compare(own.interval, aim);
        let percent = 100.0 * share;
        let grid =
            format!("the term in {name} is up to {percent:.0} % of the error on this line, ");
        (decision, format!("{grid}so the grid is judged: {reason}"))
    })
}

/// `; 2 points below floor`.
fn left_out_text(line: &[Point]) -> String {
    match line.iter().filter(|point| screen(point).is_err()).count() {
        0 => String::new(),
        lost => format!("; {} below floor", counted(lost, "point")),
    }
}

/// Under the predicted order with its interval, or of the fitted law without.
fn constant(fitted: &Fitted, predicted: Option<f64>) -> (f64, Option<Interval>) {
    let law = (fitted.order.law.constant, None);
    predicted
        .and_then(|order| constant_under(order, &fitted.samples, CORRECTION))
        .map_or(law, |(value, interval)| (value, Some(interval)))
}

fn text(
    fitted: &Result<Fitted, FitError>,
    line: &[Point],
    direction: Direction,
    predicted: Option<f64>,
    verdict: Option<&(Decision, String)>,
) -> String {
    let name = step_name(direction);
    let verdict = verdict_text(predicted.map(|order| order.to_string()), verdict);
    let fitted = match fitted {
        Ok(fitted) => fitted,
        Err(_) if !verdict.is_empty() => return format!("{name}: {verdict}"),
        Err(error) => return format!("{name}: {error}{}", left_out_text(line)),
    };
    let Interval { lo, hi } = fitted.order.interval;
    let (value, interval) = constant(fitted, predicted);
    let interval = interval.map_or(String::new(), |i| format!(" in [{:.4e}, {:.4e}]", i.lo, i.hi));
    let verdict = if verdict.is_empty() { verdict } else { format!("; {verdict}") };
    format!(
        "{name}: order {:.3} in [{lo:.3}, {hi:.3}], constant {value:.4e}{interval}{verdict}\n   local orders {}{}",
        fitted.order.law.order,
        orders_text(&local_slopes(&fitted.samples)),
        left_out_text(line),
    )
}

fn object(
    fitted: &Result<Fitted, FitError>,
    line: &[Point],
    direction: Direction,
    predicted: Option<f64>,
    verdict: Option<&(Decision, String)>,
) -> serde_json::Map<String, serde_json::Value> {
    let found = fitted.as_ref().ok();
    let constant = found.map(|fitted| constant(fitted, predicted));
    let (used, left): (Vec<&Point>, Vec<&Point>) =
        line.iter().partition(|point| screen(point).is_ok());
    let plain = |point: &&Point| json!({"h": point.h, "k": point.k, "error": point.error});
    let lost = |point: &&Point| {
        let reason = screen(point).err().map(|reason| reason.to_string());
        json!({"h": point.h, "k": point.k, "error": point.error, "reason": reason})
    };
    let reason = match (verdict, fitted) {
        (Some((_, reason)), _) => reason.clone(),
        (None, Err(error)) => error.to_string(),
        (None, Ok(_)) => String::new(),
    };
    let object = json!({
        "variable": step_name(direction),
        "local_slopes": found.map(|fitted| local_slopes(&fitted.samples)),
        "observed": found.map(|fitted| fitted.order.law.order),
        "interval": found.map(|fitted| [fitted.order.interval.lo, fitted.order.interval.hi]),
        "constant": constant.map(|(value, _)| value),
        "constant_interval": constant.and_then(|(_, found)| found).map(|i| [i.lo, i.hi]),
        "predicted": predicted,
        "verdict": verdict.map(|(decision, _)| decision.name()),
        "reason": reason,
        "points_used": used.iter().map(plain).collect::<Vec<_>>(),
        "points_left_out": left.iter().map(lost).collect::<Vec<_>>(),
    });
    super::map(object)
}
