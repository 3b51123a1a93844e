//! What judging a line or a grid found, before it becomes a verdict.

use std::collections::BTreeMap;

use super::{Decision, FittedConstant, MeshAndSteps, Prediction};
use crate::fit::{Claim, Interval, TOLERANCE};

#[derive(Default)]
pub(super) struct Judgement {
    pub(super) orders: Option<(f64, Interval)>,
    pub(super) orders_k: Option<(f64, Interval)>,
    pub(super) probability: Option<f64>,
    /// Order of the leading errors, if they agree with the measured ones and contradict the prediction.
    pub(super) contradicted_by: Option<f64>,
    pub(super) constants: BTreeMap<&'static str, FittedConstant>,
    pub(super) decision: Decision,
    pub(super) reason: String,
    pub(super) next: Vec<MeshAndSteps>,
}

impl Judgement {
    pub(super) fn without_order(decision: Decision, reason: String) -> Self {
        Self { decision, reason, ..Self::default() }
    }

    pub(super) fn with_next(self, next: Vec<MeshAndSteps>) -> Self {
        Self { next, ..self }
    }
}

pub(super) fn claim(prediction: &Prediction, order: f64) -> Claim {
    let Prediction { at_least, exact, .. } = *prediction;
    Claim { order, at_least, exact, tolerance: TOLERANCE, log: 0.0 }
}

pub(super) const HIGHER_ORDER: &str = "finer cases would not lower it; state the higher order with its theorem, at_least = true where the theory gives a bound, or choose a solution that excites the term";

pub(super) fn pair(interval: Interval) -> [f64; 2] {
    [interval.lo, interval.hi]
}
