//! A prediction of both orders, judged on the whole grid.

use std::collections::BTreeMap;

use super::compare::{Aim, compare};
use super::judge::{Finding, HIGHER_ORDER, clearly_above, pair};
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
    let of = |direction, found, interval, order| Part {
        direction,
        found,
        too_high: clearly_above(interval, order),
    };
    let parts = [
        of(Direction::Space, space, best.order_h.interval, order),
        of(Direction::Time, time, best.order_k.interval, order_k),
    ];
    let next = parts.iter().flat_map(|part| part.next(selection, prediction)).collect();
    let [in_h, in_k] = parts.each_ref().map(|part| part.sentence(selection, prediction));
    let reason = format!("{in_h}; {in_k}; residual {}", residuals(&best, fits.other.as_ref()));
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

/// What was found of the order in one direction.
struct Part {
    direction: Direction,
    found: (Decision, String),
    /// The order is settled above the prediction.
    too_high: bool,
}

impl Part {
    /// The cases that would help.
    fn next(&self, selection: &Selection, prediction: &Prediction) -> Vec<NextCase> {
        match self.found.0 {
            Decision::Unresolved if !self.too_high => {
                next_case(selection, self.direction, prediction).cases
            }
            _ => Vec::new(),
        }
    }

    fn sentence(&self, selection: &Selection, prediction: &Prediction) -> String {
        let name = match self.direction {
            Direction::Space => "h",
            Direction::Time => "k",
        };
        let text = &self.found.1;
        match self.found.0 {
            Decision::Unresolved if self.too_high => format!("in {name}: {text}: {HIGHER_ORDER}"),
            Decision::Unresolved => {
                let next = next_case(selection, self.direction, prediction).text;
                format!("in {name}: {text}: {next}")
            }
            _ => format!("in {name}: {text}"),
        }
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
