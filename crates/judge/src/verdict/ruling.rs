//! What a prediction claims, and what would help an open ruling.

use super::Prediction;
use fit::{Claim, Decision, Ruling, TOLERANCE};

/// A reason and, if the ruling is open, what would help.
pub(super) fn with_help(reason: String, ruling: &Ruling, next: &str) -> String {
    match ruling.decision {
        Decision::Unresolved if ruling.too_high => format!("{reason}: {HIGHER_ORDER}"),
        _ if ruling.is_helped() => format!("{reason}: {next}"),
        _ => reason,
    }
}

pub(super) fn claim(prediction: &Prediction, order: f64) -> Claim {
    let Prediction { at_least, exact, .. } = *prediction;
    Claim { order, at_least, exact, tolerance: TOLERANCE, log: 0.0 }
}

const HIGHER_ORDER: &str = "finer cases lower it only if the slopes still fall; state the higher order with its theorem, at_least = true where the theory gives a bound, or choose a solution that excites the term";
