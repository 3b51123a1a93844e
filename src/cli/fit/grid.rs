//! Both orders of an error table with a grid of h and k.

use serde_json::{Value, json};

use super::asked::{Answer, Asked, gap_verdict, verdict_text};
use super::wording::Part;
use judge::fit::{
    Direction, FittedValue, Further, GridPosterior, JointFit, JointFits, NotIdentifiable, Point,
    fit_constants, infer_grid, joint_fits, same_level, student_quantile,
};
use judge::table::Group;

/// Residuals of logarithms below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Both orders of a grid, and its constants by least squares.
pub(super) struct Joint {
    pub(super) fits: JointFits,
    posterior: GridPosterior,
    points: Vec<Point>,
}

impl Joint {
    /// # Errors
    /// Why the grid does not determine two orders.
    pub(super) fn of(group: &Group, asked: Asked) -> Result<Self, NotIdentifiable> {
        let measured = group.measurements();
        let points: Vec<Point> = measured.iter().map(|(point, _)| *point).collect();
        // One noise for all points: the root mean square.
        let sigmas: Option<Vec<f64>> = measured.iter().map(|(_, sigma)| *sigma).collect();
        let mean =
            |all: Vec<f64>| (all.iter().map(|s| s * s).sum::<f64>() / all.len() as f64).sqrt();
        let noise = asked.noise.or(sigmas.map(mean));
        let fits = joint_fits(&points, false)?;
        Ok(Self { fits, posterior: infer_grid(&points, noise)?, points })
    }

    /// The answer for one of the orders.
    pub(super) fn answer(&self, direction: Direction, order: f64, asked: Asked) -> Answer {
        let posterior = match direction {
            Direction::Space => &self.posterior.order_h,
            Direction::Time => &self.posterior.order_k,
        };
        let mut steps: Vec<f64> = self.points.iter().map(|point| direction.step(point)).collect();
        steps.sort_by(|a, b| b.total_cmp(a));
        steps.dedup_by(|a, b| same_level(*a, *b));
        let further = Further::after(direction.name(), &steps, &[], asked.reference);
        asked.along(direction).answer(posterior, order, further)
    }
}

/// The orders, and the joint fits of both models, without and with a floor term.
pub(super) fn part(group: &Group, joint: &Result<Joint, NotIdentifiable>, asked: Asked) -> Part {
    let orders = asked.p.zip(asked.q);
    let answer = orders.map(|orders| {
        gap_verdict(group).unwrap_or_else(|| match joint {
            Ok(joint) => both(joint, orders, asked),
            Err(refused) => Answer::open(refused),
        })
    });
    let (found, points) = (joint.as_ref().ok(), group.points());
    let floor = found.and_then(|_| joint_fits(&points, true).ok());
    let constants = found
        .zip(orders)
        .and_then(|(joint, orders)| fit_constants(&points, joint.fits.best.model, orders).ok());
    let json = object(found, floor.as_ref(), constants, asked);
    let head = verdict_text(orders.map(|(p, q)| format!("{p}, {q}")), answer.as_ref());
    let text = match joint {
        Err(_) if !head.is_empty() => format!("joint: {head}"),
        Err(refused) => format!("joint: {refused}"),
        Ok(joint) => text(joint, floor.as_ref(), constants, &head),
    };
    let otherwise = joint.as_ref().err().map_or(String::new(), NotIdentifiable::to_string);
    let space = found.map(|joint| &joint.posterior.order_h);
    asked.part((text, json), space, answer, otherwise)
}

/// Passes if both orders pass, fails if one fails.
fn both(joint: &Joint, (p, q): (f64, f64), asked: Asked) -> Answer {
    let space = joint.answer(Direction::Space, p, asked);
    let time = joint.answer(Direction::Time, q, asked);
    let probability = space.probability.zip(time.probability).map(|(a, b)| a.min(b));
    Answer {
        decision: space.decision.and(time.decision),
        reason: format!("in h: {}; in k: {}", space.reason, time.reason),
        probability,
        next: Vec::new(),
    }
}

fn text(
    joint: &Joint,
    floor: Option<&JointFits>,
    constants: Option<[FittedValue; 2]>,
    verdict: &str,
) -> String {
    let GridPosterior { order_h, order_k } = &joint.posterior;
    let best = &joint.fits.best;
    let mut lines = vec![format!(
        "joint: order {:.3} in {} in h, {:.3} in {} in k",
        order_h.order, order_h.interval, order_k.order, order_k.interval
    )];
    lines.extend((!verdict.is_empty()).then(|| format!("   {verdict}")));
    let models = [Some(best), joint.fits.other.as_ref()].into_iter().flatten();
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
        let range = |c: FittedValue| {
            format!("{:.4e} in [{:.4e}, {:.4e}]", c.value, c.interval.lo, c.interval.hi)
        };
        lines.push(format!("   under the predicted orders: C_h {}, C_k {}", range(h), range(k)));
    }
    lines.extend(floor.and_then(|floor| floor_line(best, &floor.best, joint.points.len())));
    lines.join("\n")
}

/// The effect of a floor term, if it reduces the residual significantly: F of one more parameter at 95 % is the square
/// of Student's quantile. Bends of the error terms reduce it as well, so this is only a hint at a floor.
fn floor_line(plain: &JointFit, with: &JointFit, points: usize) -> Option<String> {
    let floor = with.floor?;
    // An exact table leaves nothing to explain.
    if plain.residual_norm < ROUNDING {
        return None;
    }
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
    found: Option<&Joint>,
    floor: Option<&JointFits>,
    constants: Option<[FittedValue; 2]>,
    asked: Asked,
) -> Value {
    let fits = found.map(|joint| &joint.fits);
    let time = found.map(|joint| &joint.posterior.order_k);
    let all = fits.into_iter().chain(floor);
    let all = all.flat_map(|fits| [Some(&fits.best), fits.other.as_ref()]).flatten();
    let constant = |c: FittedValue, order: Option<f64>| json!({"value": c.value, "interval": c.interval, "order": order});
    json!({
        "variable": "joint",
        "observed_k": time.map(|posterior| posterior.order),
        "interval_k": time.map(|posterior| posterior.interval),
        "models": all.map(model).collect::<Vec<Value>>(),
        "better": fits.map(|fits| fits.best.model.name()),
        "constants": constants.map(|[h, k]| json!({
            "C_h": constant(h, asked.p), "C_k": constant(k, asked.q)
        })),
        "predicted": asked.p,
        "predicted_k": asked.q,
    })
}

fn model(fit: &JointFit) -> Value {
    json!({
        "model": fit.model.name(),
        "order_h": fit.order_h.value,
        "interval_h": fit.order_h.interval,
        "order_k": fit.order_k.value,
        "interval_k": fit.order_k.interval,
        "C_h": fit.constant_h,
        "C_k": fit.constant_k,
        "floor": fit.floor,
        "residual": fit.residual_norm,
    })
}
