//! What a caller claims of a table and knows of its errors, and the answer.

use std::fmt::Display;

use judge::fit::{Claim, Direction, Further, Known, Posterior};
use judge::table::Group;
use judge::verdict::Decision;
use serde_json::{Value, json};

use super::wording::Part;

/// Predicted orders and their meaning.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    pub(super) p: Option<f64>,
    pub(super) q: Option<f64>,
    /// What is claimed of the order in h, whatever it is, and of that in k.
    pub(super) claim: Claim,
    pub(super) in_time: Claim,
    pub(super) noise: Option<f64>,
    pub(super) reference: Option<f64>,
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

    pub(super) fn known(self) -> Known {
        Known { noise: self.noise, log: self.claim.log, reference: self.reference }
    }

    /// With the claim of one direction.
    pub(super) fn along(self, direction: Direction) -> Self {
        match direction {
            Direction::Space => self,
            Direction::Time => Self { claim: self.in_time, ..self },
        }
    }

    /// Judges an order; `further` is one more level.
    pub(super) fn answer(self, posterior: &Posterior, order: f64, further: Further) -> Answer {
        let ruling = posterior.decide(&Claim { order, ..self.claim });
        let left_out = posterior.left_out_in_words();
        let (help, next) = match posterior.help(&ruling, further) {
            Some(Further { steps, text }) => (format!(": {text}"), steps),
            None => (String::new(), Vec::new()),
        };
        let reason = format!("{}{left_out}{help}", ruling.reason);
        Answer { decision: ruling.decision, reason, probability: Some(ruling.probability), next }
    }

    /// The result, `json` with the entries of what was asked, found and answered, and the reason why nothing was.
    pub(super) fn part(
        self,
        (text, mut json): (String, Value),
        found: Option<&Posterior>,
        answer: Option<Answer>,
        otherwise: impl Display,
    ) -> Part {
        let decision = answer.as_ref().map(|answer| answer.decision);
        let probability = answer.as_ref().and_then(|answer| answer.probability);
        json["at_least"] = json!(self.claim.at_least);
        json["exact"] = json!(self.claim.exact);
        json["tolerance"] = json!(self.claim.tolerance);
        json["order"] = json!(found.map(|found| found.order));
        json["observed"] = json["order"].clone();
        json["interval"] = json!(found.map(|found| found.interval));
        json["verdict"] = json!(decision);
        json["probability"] = json!(probability);
        json["reason"] =
            answer.map_or_else(|| otherwise.to_string(), |answer| answer.reason).into();
        Part { text, json, decision }
    }
}

/// The steps that would help, for JSON.
pub(super) fn next(answer: Option<&Answer>) -> &[f64] {
    answer.map_or(&[], |answer| &answer.next)
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
