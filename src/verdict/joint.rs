//! A prediction of both orders, judged on the whole grid.

use std::collections::BTreeMap;

use super::compare::{Aim, compare};
use super::judge::{Finding, pair};
use super::next::{NextCase, next_case};
use super::selection::Selection;
use super::{Constant, Decision, Prediction};
use crate::fit::{Direction, JointFit, fit_constants, joint_fits};

/// Passes if both orders pass, fails if one fails.
pub(super) fn judge_grid(selection: &Selection, prediction: &Prediction) -> Finding {
    let Some(order_k) = prediction.order_k else {
        let reason = "a joint prediction needs an order in k as well".to_owned();
        return Finding::without_order(Decision::Unresolved, reason);
    };
    let fits = match joint_fits(&selection.points(), false) {
        Ok(fits) => fits,
        Err(error) => {
            let next = in_both(selection, prediction);
            return Finding::without_order(Decision::Unresolved, error.to_string()).with_next(next);
        }
    };
    let Prediction { order, at_least, exact, .. } = *prediction;
    let best = fits.best;
    let space = compare(best.order_h.interval, Aim { order, at_least, exact });
    let time = compare(best.order_k.interval, Aim { order: order_k, at_least, exact });
    let decision = space.0.and(time.0);
    let open = |direction, (decision, _): &(Decision, String)| match decision {
        Decision::Unresolved => next_case(selection, direction, prediction).cases,
        Decision::Pass | Decision::Fail => Vec::new(),
    };
    let next = [open(Direction::Space, &space), open(Direction::Time, &time)].concat();
    let reason = format!(
        "{}; {}; residual {}",
        sentence("h", &space, selection, Direction::Space, prediction),
        sentence("k", &time, selection, Direction::Time, prediction),
        residuals(&best, fits.other.as_ref()),
    );
    Finding {
        orders: Some((best.order_h.value, best.order_h.interval)),
        orders_k: Some((best.order_k.value, best.order_k.interval)),
        parts: None,
        constants: constants(selection, &best, (order, order_k)),
        decision,
        reason,
        next: if decision == Decision::Unresolved { next } else { Vec::new() },
    }
}

/// One more level in each direction.
fn in_both(selection: &Selection, prediction: &Prediction) -> Vec<NextCase> {
    let cases = |direction| next_case(selection, direction, prediction).cases;
    [cases(Direction::Space), cases(Direction::Time)].concat()
}

fn sentence(
    name: &str,
    (decision, text): &(Decision, String),
    selection: &Selection,
    direction: Direction,
    prediction: &Prediction,
) -> String {
    match decision {
        Decision::Unresolved => {
            let next = next_case(selection, direction, prediction).text;
            format!("in {name}: {text}: {next}")
        }
        _ => format!("in {name}: {text}"),
    }
}

/// The residuals of both models, the better one first.
fn residuals(best: &JointFit, other: Option<&JointFit>) -> String {
    let text = |fit: &JointFit| format!("{:.1e} ({})", fit.residual_norm, fit.model.name());
    [Some(best), other].into_iter().flatten().map(text).collect::<Vec<_>>().join(", ")
}

fn constants(
    selection: &Selection,
    best: &JointFit,
    orders: (f64, f64),
) -> BTreeMap<&'static str, Constant> {
    let Ok([space, time]) = fit_constants(&selection.points(), best.model, orders) else {
        return BTreeMap::new();
    };
    [("C_h", space, orders.0), ("C_k", time, orders.1)]
        .into_iter()
        .map(|(name, fitted, order)| {
            (name, Constant::fitted(fitted.value, pair(fitted.interval), order))
        })
        .collect()
}
