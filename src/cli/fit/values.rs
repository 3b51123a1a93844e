//! One direction of a table of values without an exact one.

use serde_json::{Value, json};

use super::{Part, Predicted, gap_verdict, line_points, next_step, step_name, verdict_text};
use files::counted;
use judge::fit::{
    Direction, EcaHoekstra, Expansion, FitError, Triple, ValueOrder, ValueSample, eca_hoekstra,
    path, value_order, value_samples,
};
use judge::table::Group;
use judge::verdict::{Aim, Decision, compare};

/// All that the values say, in direction of refinement.
struct Findings {
    samples: Vec<ValueSample>,
    last_three: Option<Triple>,
    order: Option<ValueOrder>,
    estimate: Option<EcaHoekstra>,
}

/// The extrapolated value in one direction; none if it is neither refined nor predicted.
pub(super) fn part(group: &Group, direction: Direction, claims: Predicted) -> Option<Part> {
    let predicted = claims.order(direction);
    if !group.refined(direction) && predicted.is_none() {
        return None;
    }
    // Along a path the value depends on one step alone.
    let along = path(&group.points()).is_some();
    let line = if along { group.points() } else { line_points(group, direction) };
    let findings = value_samples(&line, direction).map(findings);
    let name = step_name(direction);
    let verdict = predicted.map(|order| {
        gap_verdict(group).unwrap_or_else(|| match &findings {
            Ok(findings) => decide(findings, name, claims.aim(order)),
            Err(error) => (Decision::Unresolved, error.to_string()),
        })
    });
    let tail = verdict_text(predicted.map(|order| order.to_string()), verdict.as_ref());
    Some(Part {
        text: match &findings {
            Ok(findings) => text(findings, name, &tail),
            Err(error) => format!("{name}: {error}"),
        },
        json: object(&findings, name, predicted, verdict.as_ref()),
        decision: verdict.map(|(decision, _)| decision),
    })
}

fn findings(samples: Vec<ValueSample>) -> Findings {
    Findings {
        last_three: samples.last_chunk().map(|three| Triple::of(*three)),
        order: value_order(&samples).ok().flatten(),
        estimate: eca_hoekstra(&samples),
        samples,
    }
}

fn decide(findings: &Findings, name: &str, aim: Aim) -> (Decision, String) {
    let steps: Vec<f64> = findings.samples.iter().map(|sample| sample.step).collect();
    let next = next_step(name, &steps);
    match (findings.last_three, &findings.order) {
        (None, _) => {
            let found = counted(findings.samples.len(), "value");
            (Decision::Unresolved, format!("{found}, an order needs 3: {next}"))
        }
        (Some(Triple::Diverging { order }), _) => {
            (Decision::Fail, format!("the last three values diverge, order {order:.2}"))
        }
        (Some(Triple::Oscillating { .. }), _) => {
            (Decision::Unresolved, format!("the last three values oscillate: {next}"))
        }
        (Some(Triple::Stationary), _) => {
            (Decision::Unresolved, "the last two values are equal: run coarser ones".into())
        }
        (Some(Triple::Converging { .. }), Some(found)) => {
            let (decision, reason) = compare(found.interval, aim);
            let wide = decision == Decision::Unresolved && found.interval.contains(aim.order);
            (decision, if wide { format!("{reason}: {next}") } else { reason })
        }
        (Some(Triple::Converging { .. }), None) if findings.samples.len() < 5 => {
            let found = counted(findings.samples.len(), "value");
            (Decision::Unresolved, format!("{found}, the interval of an order needs 5: {next}"))
        }
        (Some(Triple::Converging { .. }), None) => {
            (Decision::Unresolved, format!("coarser values oscillate or fit no order: {next}"))
        }
    }
}

fn text(findings: &Findings, name: &str, verdict: &str) -> String {
    let mut lines = Vec::new();
    let grids = counted(findings.samples.len(), "value");
    lines.push(match findings.last_three {
        None => format!("{name}: {grids}, an extrapolation needs 3"),
        Some(Triple::Converging { order, limit, gci }) => format!(
            "{name}: extrapolated value {limit:.10}, order {order:.3} of the last three, GCI {gci:.2e} on the finest"
        ),
        Some(Triple::Oscillating { half_range }) => format!(
            "{name}: the last three values oscillate, no extrapolation; half of their range {half_range:.2e}"
        ),
        Some(Triple::Diverging { order }) => {
            format!("{name}: the last three values diverge, order {order:.3}: no extrapolation")
        }
        Some(Triple::Stationary) => format!("{name}: the last two values are equal up to rounding"),
    });
    if let Some(found) = &findings.order {
        lines.push(format!("   order {:.3} in {} over {grids}", found.order, found.interval));
    }
    lines.extend(findings.estimate.filter(|_| !diverges(findings)).map(|found| {
        format!(
            "   Eça-Hoekstra: {:.10}, uncertainty {:.2e} on the finest, expansion {}, factor {}",
            found.limit,
            found.uncertainty,
            expansion(found.expansion),
            found.safety
        )
    }));
    if !verdict.is_empty() {
        lines.push(format!("   {verdict}"));
    }
    lines.join("\n")
}

/// Of values that diverge no estimate is printed: each of them would be a number, none a limit.
fn diverges(findings: &Findings) -> bool {
    matches!(findings.last_three, Some(Triple::Diverging { .. }))
}

fn expansion(expansion: Expansion) -> String {
    match expansion {
        Expansion::Power(p) => format!("α h^{p:.2}"),
        Expansion::First => "α h".into(),
        Expansion::Second => "α h²".into(),
        Expansion::Mixed => "α h + β h²".into(),
    }
}

fn object(
    findings: &Result<Findings, FitError>,
    name: &str,
    predicted: Option<f64>,
    verdict: Option<&(Decision, String)>,
) -> serde_json::Map<String, Value> {
    let found = findings.as_ref().ok();
    let triple = found.and_then(|found| found.last_three);
    let (limit, gci) = match triple {
        Some(Triple::Converging { limit, gci, .. }) => (Some(limit), Some(gci)),
        _ => (None, None),
    };
    let half_range = match triple {
        Some(Triple::Oscillating { half_range }) => Some(half_range),
        _ => None,
    };
    let order = found.and_then(|found| found.order.as_ref());
    let estimate = found.filter(|found| !diverges(found)).and_then(|found| found.estimate);
    let reason = match (verdict, findings) {
        (Some((_, reason)), _) => reason.clone(),
        (None, Err(error)) => error.to_string(),
        (None, Ok(_)) => String::new(),
    };
    super::map(json!({
        "variable": name,
        "behaviour": triple.map(behaviour),
        "finest": found.and_then(|found| found.samples.last()).map(|sample| sample.value),
        "extrapolated": limit,
        "order_of_last_three": triple.and_then(Triple::order),
        "gci": gci,
        "half_range": half_range,
        "observed": order.map(|order| order.order),
        "interval": order.map(|order| [order.interval.lo, order.interval.hi]),
        "eca_hoekstra": estimate.map(|found| json!({
            "limit": found.limit,
            "uncertainty": found.uncertainty,
            "expansion": expansion(found.expansion),
            "weighted": found.weighted,
            "order": found.observed_order,
            "deviation": found.deviation,
            "data_range": found.data_range,
            "safety": found.safety,
        })),
        "predicted": predicted,
        "verdict": verdict.map(|(decision, _)| decision.name()),
        "reason": reason,
        "points_used": found.map(|found| {
            let plain = |sample: &ValueSample| json!({name: sample.step, "value": sample.value});
            found.samples.iter().map(plain).collect::<Vec<Value>>()
        }),
    }))
}

fn behaviour(triple: Triple) -> &'static str {
    match triple {
        Triple::Converging { .. } => "monotone",
        Triple::Oscillating { .. } => "oscillating",
        Triple::Diverging { .. } => "divergent",
        Triple::Stationary => "stationary",
    }
}
