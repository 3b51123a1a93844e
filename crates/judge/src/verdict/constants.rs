//! A fitted constant against the predicted one.

use serde::{Deserialize, Serialize};

use super::selection::JudgedPoint;
use super::{FittedConstant, MeshAndSteps, Prediction, Variable};
use fit::{Correction, Decision, Direction, FEWEST, Sample, constant_under, local_slopes};

/// Leading error of a sound scheme on one case.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LeadingPoint {
    pub n: Option<u32>,
    pub steps: u32,
    pub h: Option<f64>,
    pub k: f64,
    pub error: f64,
}

/// Leading errors along one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeadingLine {
    /// One per case that has a leading error.
    pub points: Vec<LeadingPoint>,
    /// Limit of error over step, if known independently of the points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Allowed relative difference on the finest case.
    pub tolerance: f64,
}

/// What is known beforehand of the constant of one prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Foreseen {
    Leading(LeadingLine),
    Nothing { not_predicted: String },
}

/// What is known beforehand, with the prediction to which it belongs.
#[derive(Debug, Clone, PartialEq)]
pub struct ForeseenConstant {
    pub scene: String,
    pub norm: String,
    pub variable: Variable,
    pub foreseen: Foreseen,
    /// As [`Prediction::other_error`].
    pub other_error: Option<f64>,
}

/// Errors this near the leading ones, for each factor of e in the step, have their order: a ratio that stays within ±0.015 ln r
/// over a refinement by r moves a slope by at most 0.03, a fifth of the tolerance of orders.
const AGREES: f64 = 0.015;

pub(super) struct ConstantComparison {
    pub(super) constant: FittedConstant,
    pub(super) decision: Decision,
    pub(super) sentence: String,
    /// What may be wrong if the order holds; empty unless the constant fails.
    pub(super) blame: String,
    /// If the three finest cases have the leading error: its order.
    pub(super) leading_order: Option<f64>,
}

/// Compares error over step^order with that of the leading error, case by case; the finest case decides. Steps are
/// those of the record for measured errors and those of the leading point for leading errors, so that a mislabelled
/// step shows. `in_the_way` is the direction whose refinement would lower a drift. None if nothing is predicted or no used case has a leading error.
pub(super) fn compare_constant(
    fitted: FittedConstant,
    used: &[JudgedPoint],
    line: &LeadingLine,
    prediction: &Prediction,
    direction: Direction,
    in_the_way: Direction,
) -> Option<ConstantComparison> {
    let order = prediction.order;
    let mut pairs: Vec<(Sample, f64)> = Vec::new();
    for point in &line.points {
        let place = MeshAndSteps { n: point.n, steps: point.steps };
        let Some(used) = used.iter().find(|used| used.place == place) else { continue };
        let step = match direction {
            Direction::Space => point.h.unwrap_or(f64::NAN),
            Direction::Time => point.k,
        };
        let under = |error: f64, step: f64| error / step.powf(order);
        let measured = under(used.point.error, direction.step(&used.point));
        let leading = under(point.error, step);
        pairs.push((Sample { step, error: point.error }, measured / leading));
    }
    pairs.sort_by(|a, b| b.0.step.total_cmp(&a.0.step));
    let (_, ratio) = *pairs.last()?;
    let samples: Vec<Sample> = pairs.iter().map(|(sample, _)| *sample).collect();
    let of_line =
        constant_under(order, &samples, correction(prediction, direction)).map(|(value, _)| value);
    let last = samples.last().map(|sample| sample.error / sample.step.powf(order));
    let constant = FittedConstant {
        predicted: of_line.or(last),
        limit: line.limit,
        ratio: Some(ratio),
        tolerance: Some(line.tolerance),
        ..fitted
    };
    let previous = pairs.len().checked_sub(2).map(|at| pairs[at].1);
    let (decision, sentence, blame) =
        decide(ratio, previous, line.tolerance, direction, in_the_way, prediction.unique);
    let finest = &pairs[pairs.len().saturating_sub(FEWEST)..];
    let ratio_of_steps = finest[0].0.step / finest[finest.len() - 1].0.step;
    let near = line.tolerance.max(AGREES * ratio_of_steps.ln());
    let within = |(_, ratio): &(Sample, f64)| (ratio - 1.0).abs() <= near;
    let agree = finest.len() == FEWEST && finest.iter().all(within);
    let leading_order = local_slopes(&samples).last().copied().filter(|_| agree);
    Some(ConstantComparison { constant, decision, sentence, blame, leading_order })
}

/// The trapezoidal rule on smooth data has even terms, k² (1 + D k²): where order 2 is predicted in time. Elsewhere the
/// next power follows.
pub(super) fn correction(prediction: &Prediction, direction: Direction) -> Correction {
    if direction == Direction::Time && prediction.order == 2.0 {
        Correction::Quadratic
    } else {
        Correction::Linear
    }
}

/// Pass if the ratio is within tolerance of one; unresolved if twice its last change on the logarithm may bring it
/// there; else fail.
fn decide(
    ratio: f64,
    previous: Option<f64>,
    tolerance: f64,
    direction: Direction,
    in_the_way: Direction,
    unique: bool,
) -> (Decision, String, String) {
    let (name, cause) = match direction {
        Direction::Space => ("C_h", "h, a load, a rule or a norm"),
        Direction::Time => ("C_k", "k, a weight or the kernel"),
    };
    let cure = refined(in_the_way);
    // Enough digits to differ from one.
    let digits = if (ratio - 1.0).abs() < 2e-3 { 6 } else { 4 };
    let sentence = format!("{name} is {ratio:.digits$} times the predicted one");
    let percent = percent(tolerance);
    let off = ratio.ln();
    let drift = previous.map_or(0.0, |previous| 2.0 * (off - previous.ln()).abs());
    if (ratio - 1.0).abs() <= tolerance {
        (Decision::Pass, sentence, String::new())
    } else if off.abs() - drift <= tolerance.ln_1p() && off.is_finite() {
        let open = format!("beyond {percent} % and still drifting: use {cure} to decide");
        (Decision::Unresolved, format!("{sentence}, {open}"), String::new())
    } else {
        let blame = match unique {
            true => format!(": {cause} is off by a factor"),
            // With several solutions each may be right, with a different error.
            false => format!(
                ": uniqueness is not guaranteed, (2.9) or (3.4) is violated, and another solution may have been followed; else {cause} is off by a factor"
            ),
        };
        (Decision::Fail, format!("{sentence}, beyond {percent} %"), blame)
    }
}

pub(super) fn refined(direction: Direction) -> &'static str {
    match direction {
        Direction::Space => "more cells n",
        Direction::Time => "more steps",
    }
}

/// A share in percent with its significant digits: 3, 0.5, 0.01.
fn percent(share: f64) -> f64 {
    format!("{:.1e}", 100.0 * share).parse().unwrap_or(100.0 * share)
}

#[cfg(test)]
mod tests;
