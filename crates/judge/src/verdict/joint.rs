//! Judges a prediction of both orders on the whole grid.

use std::collections::BTreeMap;

use super::next::next_case;
use super::ruling::{claim, with_help};
use super::selection::Selection;
use super::{FittedConstant, MeshAndSteps, Prediction, Verdict};
use fit::{
    Decision, Direction, ErrorCombination, GridPosterior, Posterior, fit_constants, infer_grid,
    joint_fits,
};

/// Passes if both orders pass, fails if one fails.
pub(super) fn judge_grid(open: Verdict, selection: &Selection, prediction: &Prediction) -> Verdict {
    let Some(order_k) = prediction.order_k else {
        let reason = "a joint prediction needs an order in k as well".to_owned();
        return Verdict { reason, ..open };
    };
    let points = selection.points();
    let found = joint_fits(&points, false).and_then(|fits| Ok((fits, infer_grid(&points, None)?)));
    let (fits, GridPosterior { order_h: space, order_k: time }) = match found {
        Ok(found) => found,
        Err(error) => {
            let cases = |direction| next_case(selection, direction, prediction).cases;
            let next = Direction::BOTH.map(cases).concat();
            return Verdict { reason: error.to_string(), next, ..open };
        }
    };
    let part = |direction, found: &Posterior, order| {
        let ruling = found.decide(&claim(prediction, order));
        let next = next_case(selection, direction, prediction);
        let sentence = with_help(ruling.reason.clone(), &ruling, &next.text);
        let next: Vec<MeshAndSteps> = if ruling.is_helped() { next.cases } else { Vec::new() };
        (ruling, sentence, next)
    };
    let (in_h, words_h, next_h) = part(Direction::Space, &space, prediction.order);
    let (in_k, words_k, next_k) = part(Direction::Time, &time, order_k);
    let decision = in_h.decision.and(in_k.decision);
    Verdict {
        observed: Some(space.order),
        observed_k: Some(time.order),
        interval: Some(space.interval.into()),
        interval_k: Some(time.interval.into()),
        probability: Some(in_h.probability.min(in_k.probability)),
        constants: constants(selection, fits.best.model, (prediction.order, order_k)),
        order: decision,
        complete: !in_h.unexplained,
        reason: format!("in h: {words_h}; in k: {words_k}"),
        next: if decision == Decision::Unresolved { [next_h, next_k].concat() } else { Vec::new() },
        ..open
    }
}

fn constants(
    selection: &Selection,
    model: ErrorCombination,
    orders: (f64, f64),
) -> BTreeMap<&'static str, FittedConstant> {
    let fitted = fit_constants(&selection.points(), model, orders).into_iter().flatten();
    let named = fitted.zip([("C_h", orders.0), ("C_k", orders.1)]);
    named
        .map(|(fitted, (name, order))| {
            (name, FittedConstant::fitted(fitted.value, fitted.interval, order))
        })
        .collect()
}
