//! What a caller claims of a table and knows of its errors, and the answer.

use std::fmt::Display;

use judge::fit::{Claim, Direction, Posterior, Ruling};
use judge::table::Group;
use judge::verdict::Decision;
use serde_json::{Map, Value, json};

use super::wording::run;

/// Predicted orders and their meaning.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    pub(super) p: Option<f64>,
    pub(super) q: Option<f64>,
    /// What is claimed of either order, whatever it is.
    pub(super) claim: Claim,
    pub(super) noise: Option<f64>,
}

/// The judgement of an order, before it is printed.
pub(super) struct Answer {
    pub(super) decision: Decision,
    pub(super) reason: String,
    /// Probability that the order is as predicted.
    pub(super) probability: Option<f64>,
    /// Steps that would help an open decision.
    pub(super) next: Vec<f64>,
}

impl Answer {
    pub(super) fn of(decision: Decision, reason: String) -> Self {
        Self { decision, reason, probability: None, next: Vec::new() }
    }

    pub(super) fn open(why: impl Display) -> Self {
        Self::of(Decision::Unresolved, why.to_string())
    }
}

impl Asked {
    pub(super) fn order(self, direction: Direction) -> Option<f64> {
        match direction {
            Direction::Space => self.p,
            Direction::Time => self.q,
        }
    }

    /// Judges an order; `next` are the steps of one more level.
    pub(super) fn answer(
        self,
        posterior: &Posterior,
        order: f64,
        (name, next): (&str, Vec<f64>),
    ) -> Answer {
        let Ruling { decision, reason, probability, too_high } =
            posterior.decide(&Claim { order, ..self.claim });
        let reason = format!("{reason}{}", posterior.left_out_in_words());
        let (help, next) = match (decision, too_high, posterior.floor_from) {
            (Decision::Unresolved, true, _) => (
                ": finer levels would not lower it; --at-least takes it for a lower bound".into(),
                Vec::new(),
            ),
            (Decision::Unresolved, false, Some(_)) => (
                ": lower the floor (tolerance of the solver, quadrature, reference), or add coarser levels".into(),
                Vec::new(),
            ),
            (Decision::Unresolved, false, None) => (format!(": {}", run(name, &next)), next),
            _ => (String::new(), Vec::new()),
        };
        Answer { decision, reason: reason + &help, probability: Some(probability), next }
    }

    /// The JSON entries of what was asked, found and answered, and the reason why nothing was; `further` go beside.
    pub(super) fn json(
        self,
        found: Option<&Posterior>,
        answer: Option<&Answer>,
        otherwise: impl Display,
        further: Value,
    ) -> Map<String, Value> {
        let mut object = map(json!({
            "at_least": self.claim.at_least,
            "exact": self.claim.exact,
            "tolerance": self.claim.tolerance,
            "order": found.map(|found| found.order),
            "observed": found.map(|found| found.order),
            "interval": found.map(|found| [found.interval.lo, found.interval.hi]),
            "verdict": answer.map(|answer| answer.decision),
            "probability": answer.and_then(|answer| answer.probability),
            "reason": answer.map_or_else(|| otherwise.to_string(), |answer| answer.reason.clone()),
        }));
        object.extend(map(further));
        object
    }
}

/// The steps that would help, for JSON.
pub(super) fn next(answer: Option<&Answer>) -> &[f64] {
    answer.map_or(&[], |answer| &answer.next)
}

fn map(object: Value) -> Map<String, Value> {
    match object {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

/// The verdict for gaps: as in a sweep, a missing case is a failure.
pub(super) fn gap_verdict(group: &Group) -> Option<Answer> {
    group.gaps_in_words().map(|gaps| Answer::of(Decision::Fail, gaps))
}

/// `; predicted 1: pass, 1 lies in …`, to end a line.
pub(super) fn verdict_text(predicted: Option<impl Display>, answer: Option<&Answer>) -> String {
    match (predicted, answer) {
        (Some(order), Some(Answer { decision, reason, .. })) => {
            format!("predicted {order}: {}, {reason}", decision.name())
        }
        (None, Some(answer)) => answer.reason.clone(),
        _ => String::new(),
    }
}
