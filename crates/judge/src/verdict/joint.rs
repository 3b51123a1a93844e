//! Judges a prediction of both orders on the whole grid.

use std::collections::BTreeMap;

use super::judgement::{HIGHER_ORDER, Judgement, claim, pair};
use super::next::next_case;
use super::selection::Selection;
use super::{Decision, FittedConstant, MeshAndSteps, Prediction};
use crate::fit::{
    Direction, GridPosterior, JointFit, Ruling, fit_constants, infer_grid, joint_fits,
};

/// Passes if both orders pass, fails if one fails.
pub(super) fn judge_grid(selection: &Selection, prediction: &Prediction) -> Judgement {
    let Some(order_k) = prediction.order_k else {
        let reason = "a joint prediction needs an order in k as well".to_owned();
        return Judgement::without_order(Decision::Unresolved, reason);
    };
    let fits = match joint_fits(&selection.points(), false) {
        Ok(fits) => fits,
        Err(error) => {
            let next = in_both(selection, prediction);
            return Judgement::without_order(Decision::Unresolved, error.to_string())
                .with_next(next);
        }
    };
    let posterior = match infer_grid(&selection.points(), None) {
        Ok(posterior) => posterior,
        Err(error) => {
            let next = in_both(selection, prediction);
            return Judgement::without_order(Decision::Unresolved, error.to_string())
                .with_next(next);
        }
    };
    let GridPosterior { order_h, order_k: in_time } = posterior;
    let order = prediction.order;
    let parts = [(Direction::Space, &order_h, order), (Direction::Time, &in_time, order_k)].map(
        |(direction, found, order)| Part {
            direction,
            ruling: found.decide(&claim(prediction, order)),
        },
    );
    let decision = parts[0].ruling.decision.and(parts[1].ruling.decision);
    let next = parts.iter().flat_map(|part| part.next(selection, prediction)).collect();
    let [in_h, in_k] = parts.each_ref().map(|part| part.sentence(selection, prediction));
    let best = fits.best;
    Judgement {
        orders: Some((order_h.order, order_h.interval)),
        orders_k: Some((in_time.order, in_time.interval)),
        probability: Some(parts[0].ruling.probability.min(parts[1].ruling.probability)),
        contradicted_by: None,
        constants: constants(selection, &best, (order, order_k)),
        decision,
        reason: format!("in h: {in_h}; in k: {in_k}"),
        next: if decision == Decision::Unresolved { next } else { Vec::new() },
    }
}

fn in_both(selection: &Selection, prediction: &Prediction) -> Vec<MeshAndSteps> {
    let cases = |direction| next_case(selection, direction, prediction).cases;
    [cases(Direction::Space), cases(Direction::Time)].concat()
}

struct Part {
    direction: Direction,
    ruling: Ruling,
}

impl Part {
    fn next(&self, selection: &Selection, prediction: &Prediction) -> Vec<MeshAndSteps> {
        match self.ruling.decision {
            Decision::Unresolved if !self.ruling.too_high => {
                next_case(selection, self.direction, prediction).cases
            }
            _ => Vec::new(),
        }
    }

    fn sentence(&self, selection: &Selection, prediction: &Prediction) -> String {
        let Ruling { decision, reason, too_high, .. } = &self.ruling;
        match (decision, too_high) {
            (Decision::Unresolved, true) => format!("{reason}: {HIGHER_ORDER}"),
            (Decision::Unresolved, false) => {
                let next = next_case(selection, self.direction, prediction).text;
                format!("{reason}: {next}")
            }
            _ => reason.clone(),
        }
    }
}

fn constants(
    selection: &Selection,
    best: &JointFit,
    orders: (f64, f64),
) -> BTreeMap<&'static str, FittedConstant> {
    let Ok([space, time]) = fit_constants(&selection.points(), best.model, orders) else {
        return BTreeMap::new();
    };
    [("C_h", space, orders.0), ("C_k", time, orders.1)]
        .into_iter()
        .map(|(name, fitted, order)| {
            (name, FittedConstant::fitted(fitted.value, pair(fitted.interval), order))
        })
        .collect()
}
