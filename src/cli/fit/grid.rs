//! Both orders of an error table with a grid of h and k.

use serde_json::{Value, json};

use super::{Part, Predicted, gap_verdict, verdict_text};
use judge::fit::{
    Estimate, JointFit, JointFits, NotIdentifiable, fit_constants, joint_fits, student_quantile,
};
use judge::table::Group;
use judge::verdict::{Decision, compare};

/// The joint fits of both models, without and with a floor term.
pub(super) fn part(
    group: &Group,
    joint: &Result<JointFits, NotIdentifiable>,
    predicted: Predicted,
) -> Part {
    let orders = predicted.p.zip(predicted.q);
    let verdict = orders.map(|orders| {
        gap_verdict(group).unwrap_or_else(|| match joint {
            Ok(fits) => decide(&fits.best, orders, predicted),
            Err(refused) => (Decision::Unresolved, refused.to_string()),
        })
    });
    let points = group.points();
    let floor = joint.is_ok().then(|| joint_fits(&points, true).ok()).flatten();
    let constants = joint
        .as_ref()
        .ok()
        .zip(orders)
        .and_then(|(fits, orders)| fit_constants(&points, fits.best.model, orders).ok());
    let json = object(joint, floor.as_ref(), constants, predicted, verdict.as_ref());
    let head = verdict_text(orders.map(|(p, q)| format!("{p}, {q}")), verdict.as_ref());
    let text = match joint {
        Err(_) if !head.is_empty() => format!("joint: {head}"),
        Err(refused) => format!("joint: {refused}"),
        Ok(fits) => {
            let head = if head.is_empty() { head } else { format!("; {head}") };
            text(fits, floor.as_ref(), constants, points.len(), &head)
        }
    };
    Part { text, json, decision: verdict.map(|(decision, _)| decision) }
}

/// Passes if both orders pass, fails if one fails.
fn decide(best: &JointFit, (p, q): (f64, f64), predicted: Predicted) -> (Decision, String) {
    let one = |found: Estimate, order: f64| compare(found.interval, predicted.aim(order));
    let (space, time) = (one(best.order_h, p), one(best.order_k, q));
    (space.0.and(time.0), format!("in h: {}; in k: {}", space.1, time.1))
}

fn text(
    fits: &JointFits,
    floor: Option<&JointFits>,
    constants: Option<[Estimate; 2]>,
    points: usize,
    verdict: &str,
) -> String {
    let best = &fits.best;
    let mut lines = vec![format!(
        "joint: order {:.3} in {} in h, {:.3} in {} in k{verdict}",
        best.order_h.value, best.order_h.interval, best.order_k.value, best.order_k.interval
    )];
    let models = [Some(best), fits.other.as_ref()].into_iter().flatten();
    lines.extend(models.enumerate().map(|(place, fit)| {
        let better = if place == 0 { " (better)" } else { "" };
        format!(
            "   {}{better}: {:.4e} h^{:.3}, {:.4e} k^{:.3}, residual {:.1e}",
            fit.model.name(),
            fit.constant_h,
            fit.order_h.value,
            fit.constant_k,
            fit.order_k.value,
            fit.residual_norm
        )
    }));
    if let Some([h, k]) = constants {
        let range = |c: Estimate| {
            format!("{:.4e} in [{:.4e}, {:.4e}]", c.value, c.interval.lo, c.interval.hi)
        };
        lines.push(format!("   under the predicted orders: C_h {}, C_k {}", range(h), range(k)));
    }
    lines.extend(floor.and_then(|floor| floor_line(best, &floor.best, points)));
    lines.join("\n")
}

/// What a floor term changes, and whether the residual falls by more than chance: F of one more
/// parameter at 95 % is the square of Student's quantile. Bends of the error terms make it fall
/// as well, so that a better fit is a hint at a floor and no proof of one.
fn floor_line(plain: &JointFit, with: &JointFit, points: usize) -> Option<String> {
    let floor = with.floor?;
    let freedom = points.checked_sub(5)?;
    let (before, after) = (plain.residual_norm.powi(2), with.residual_norm.powi(2));
    let gain = (before - after) * freedom as f64;
    let better = gain > student_quantile(freedom)?.powi(2) * after;
    let word = if better { "better" } else { "no better" };
    Some(format!(
        "   with a floor term ({word}): {}, order {:.3} in h, {:.3} in k, floor {floor:.2e}, residual {:.1e}",
        with.model.name(),
        with.order_h.value,
        with.order_k.value,
        with.residual_norm
    ))
}

fn object(
    joint: &Result<JointFits, NotIdentifiable>,
    floor: Option<&JointFits>,
    constants: Option<[Estimate; 2]>,
    predicted: Predicted,
    verdict: Option<&(Decision, String)>,
) -> serde_json::Map<String, Value> {
    let found = joint.as_ref().ok();
    let best = found.map(|fits| &fits.best);
    let all = found.into_iter().chain(floor);
    let all = all.flat_map(|fits| [Some(&fits.best), fits.other.as_ref()]).flatten();
    let constant = |c: Estimate, order: Option<f64>| json!({"value": c.value, "interval": [c.interval.lo, c.interval.hi], "order": order});
    let reason = match (verdict, joint) {
        (Some((_, reason)), _) => reason.clone(),
        (None, Err(refused)) => refused.to_string(),
        (None, Ok(_)) => String::new(),
    };
    super::map(json!({
        "variable": "joint",
        "observed": best.map(|fit| fit.order_h.value),
        "interval": best.map(|fit| [fit.order_h.interval.lo, fit.order_h.interval.hi]),
        "observed_k": best.map(|fit| fit.order_k.value),
        "interval_k": best.map(|fit| [fit.order_k.interval.lo, fit.order_k.interval.hi]),
        "models": all.map(model).collect::<Vec<Value>>(),
        "better": best.map(|fit| fit.model.name()),
        "constants": constants.map(|[h, k]| json!({
            "C_h": constant(h, predicted.p), "C_k": constant(k, predicted.q)
        })),
        "predicted": predicted.p,
        "predicted_k": predicted.q,
        "verdict": verdict.map(|(decision, _)| decision.name()),
        "reason": reason,
    }))
}

fn model(fit: &JointFit) -> Value {
    json!({
        "model": fit.model.name(),
        "order_h": fit.order_h.value,
        "interval_h": [fit.order_h.interval.lo, fit.order_h.interval.hi],
        "order_k": fit.order_k.value,
        "interval_k": [fit.order_k.interval.lo, fit.order_k.interval.hi],
        "C_h": fit.constant_h,
        "C_k": fit.constant_k,
        "floor": fit.floor,
        "residual": fit.residual_norm,
    })
}
