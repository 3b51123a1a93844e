//! One prediction judged from records.

use std::collections::BTreeMap;

use super::compare::{Aim, CLEAR_MISS, WIDEST_HALF_WIDTH, compare};
use super::constants::{Comparison, Foreseen, LeadingLine, compare_constant};
use super::joint::judge_grid;
use super::next::{NextCase, next_case};
use super::selection::{Cases, Selection};
use super::{Constant, Decision, Expect, IntervalParts, Prediction, Variable, Verdict};
use crate::fit::{
    Correction, Direction, Interval, LARGEST_OTHER_SHARE, OrderInterval, Point, Sample,
    constant_under, joint_fits, order_interval, samples,
};
use crate::record::{CaseRecord, Key};

/// What the data say about a prediction, before it is a verdict.
pub(super) struct Finding {
    pub(super) orders: Option<(f64, Interval)>,
    pub(super) orders_k: Option<(f64, Interval)>,
    pub(super) parts: Option<IntervalParts>,
    pub(super) constants: BTreeMap<&'static str, Constant>,
    pub(super) decision: Decision,
    pub(super) reason: String,
    /// The cases that would help an open decision.
    pub(super) next: Vec<NextCase>,
}

impl Finding {
    pub(super) fn without_order(decision: Decision, reason: String) -> Self {
        let constants = BTreeMap::new();
        let next = Vec::new();
        Self { orders: None, orders_k: None, parts: None, constants, decision, reason, next }
    }

    /// With the cases that would help.
    pub(super) fn with_next(self, next: Vec<NextCase>) -> Self {
        Self { next, ..self }
    }
}

/// Judges one prediction for one scene. Every expected case has to be there, converged, and
/// with a finite error: else the verdict is `fail`, and says which is not.
pub fn judge(
    scene: &str,
    records: &[CaseRecord],
    expected_cases: &[Key],
    prediction: &Prediction,
    expect: Expect,
) -> Verdict {
    judge_foreseen(scene, records, expected_cases, prediction, None, expect)
}

/// The same with what is known beforehand of the constant: an order that is right with a constant that is not is a
/// `fail`.
pub fn judge_foreseen(
    scene: &str,
    records: &[CaseRecord],
    expected_cases: &[Key],
    prediction: &Prediction,
    foreseen: Option<&Foreseen>,
    expect: Expect,
) -> Verdict {
    let cases = Cases::new(scene, records, expected_cases);
    let selection = cases.select(prediction);
    let complete = selection.gaps.is_empty();
    let mut finding = match prediction.variable {
        _ if !complete => Finding::without_order(Decision::Fail, gaps_in_words(&selection.gaps)),
        Variable::H | Variable::Path => {
            judge_line(&cases, &selection, prediction, Direction::Space)
        }
        Variable::K => judge_line(&cases, &selection, prediction, Direction::Time),
        Variable::Joint => judge_grid(&selection, prediction),
    };
    if let Some(Foreseen::Leading(line)) = foreseen {
        compare_with(&mut finding, &selection, prediction, line);
    }
    let ends = |orders: Option<(f64, Interval)>| orders.map(|(_, interval)| pair(interval));
    Verdict {
        scene: scene.to_owned(),
        norm: prediction.norm.clone(),
        variable: prediction.variable,
        predicted: prediction.order,
        predicted_k: prediction.order_k.filter(|_| prediction.variable == Variable::Joint),
        at_least: prediction.at_least,
        why: prediction.why.clone(),
        observed: finding.orders.map(|(order, _)| order),
        observed_k: finding.orders_k.map(|(order, _)| order),
        interval: ends(finding.orders),
        interval_k: ends(finding.orders_k),
        interval_parts: finding.parts,
        points_used: selection.points_used(),
        points_left_out: selection.points_left_out(),
        constants: finding.constants,
        foreseen: foreseen.cloned(),
        decision: finding.decision,
        reason: finding.reason,
        next: finding.next,
        complete,
        expect,
    }
}

/// Adds the comparison of the constant to what was found of the order.
fn compare_with(
    finding: &mut Finding,
    selection: &Selection,
    prediction: &Prediction,
    line: &LeadingLine,
) {
    let direction = match prediction.variable {
        Variable::H => Direction::Space,
        Variable::K => Direction::Time,
        Variable::Joint | Variable::Path => return,
    };
    let name = constant_name(direction);
    let Some(&fitted) = finding.constants.get(name) else { return };
    let compared = compare_constant(fitted, &selection.used, line, prediction, direction);
    let Some(Comparison { constant, decision, sentence }) = compared else { return };
    finding.constants.insert(name, constant);
    finding.reason = format!("{}; {sentence}", finding.reason);
    finding.decision = finding.decision.and(decision);
}

/// Gaps that are named before the rest is counted.
const NAMED_GAPS: usize = 3;

fn gaps_in_words(gaps: &[String]) -> String {
    let named = gaps.iter().take(NAMED_GAPS).cloned().collect::<Vec<_>>().join("; ");
    match gaps.len().saturating_sub(NAMED_GAPS) {
        0 => named,
        more => format!("{named}; and {more} more"),
    }
}

fn judge_line(
    cases: &Cases<'_>,
    selection: &Selection,
    prediction: &Prediction,
    direction: Direction,
) -> Finding {
    let next = next_case(selection, direction, prediction);
    let fitted = samples(&selection.points(), direction).and_then(|samples| {
        order_interval(&samples, correction(prediction, direction)).map(|found| (samples, found))
    });
    let (samples, found) = match fitted {
        Ok(fitted) => fitted,
        Err(error) => {
            let reason = format!("{error}: {}", next.text);
            return Finding::without_order(Decision::Unresolved, reason).with_next(next.cases);
        }
    };
    let (decision, mut reason) = decide(&found, prediction, &next.text);
    if let Some(note) = other_term(&cases.points(&prediction.norm), selection, direction) {
        reason = format!("{reason}; {note}");
    }
    Finding {
        orders: Some((found.law.order, found.interval)),
        orders_k: None,
        parts: Some(IntervalParts {
            student: pair(found.student),
            windows: pair(found.windows),
            drift: pair(found.drift),
            curvature: found.curvature.map(pair),
        }),
        constants: constants(&samples, prediction, direction),
        decision,
        reason,
        next: match decision {
            Decision::Unresolved if !clearly_above(found.interval, prediction.order) => next.cases,
            _ => Vec::new(),
        },
    }
}

/// The decision on one order; where it is open, with the part of the interval that keeps it
/// open and the next cases to run.
fn decide(found: &OrderInterval, prediction: &Prediction, next: &str) -> (Decision, String) {
    let Prediction { order, at_least, exact, .. } = *prediction;
    let (decision, sentence) = compare(found.interval, Aim { order, at_least, exact });
    if decision != Decision::Unresolved {
        return (decision, sentence);
    }
    if clearly_above(found.interval, order) {
        // No mesh makes a settled order smaller.
        return (decision, format!("{sentence}: {HIGHER_ORDER}"));
    }
    let wide = found.interval.half_width() > WIDEST_HALF_WIDTH;
    let part = if wide { format!(", from {}", found.widest_part()) } else { String::new() };
    (decision, format!("{sentence}{part}: {next}"))
}

/// The trapezoidal rule on smooth data has even terms only, k² (1 + D k²): where order 2 is
/// predicted in time. Space, and every other order in time, has the next power.
pub(super) fn correction(prediction: &Prediction, direction: Direction) -> Correction {
    if direction == Direction::Time && prediction.order == 2.0 {
        Correction::Quadratic
    } else {
        Correction::Linear
    }
}

/// What to do about an order that is settled above the prediction.
pub(super) const HIGHER_ORDER: &str = "finer cases would not lower it; state the higher order with its theorem, at_least = true where the theory gives a bound, or choose a solution that excites the term";

/// An order too high that is known as well as an order has to be.
pub(super) fn clearly_above(interval: Interval, order: f64) -> bool {
    interval.lo - order > CLEAR_MISS && interval.half_width() <= WIDEST_HALF_WIDTH
}

fn constant_name(direction: Direction) -> &'static str {
    match direction {
        Direction::Space => "C_h",
        Direction::Time => "C_k",
    }
}

fn constants(
    samples: &[Sample],
    prediction: &Prediction,
    direction: Direction,
) -> BTreeMap<&'static str, Constant> {
    let name = constant_name(direction);
    let order = prediction.order;
    let fitted = constant_under(order, samples, correction(prediction, direction))
        .map(|(value, interval)| (name, Constant::fitted(value, pair(interval), order)));
    fitted.into_iter().collect()
}

/// Says where the term of the other direction bends this line, if the grid can tell.
fn other_term(grid: &[Point], selection: &Selection, direction: Direction) -> Option<String> {
    let best = joint_fits(grid, false).ok()?.best;
    let (index, name, cure) = match direction {
        Direction::Space => (1, "time", "more steps"),
        Direction::Time => (0, "space", "more cells n"),
    };
    let shares = selection
        .used
        .iter()
        .map(|serving| (best.weights(serving.point.h, serving.point.k)[index], &serving.key));
    let (share, key) = shares.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let percent = 100.0 * share;
    (share > LARGEST_OTHER_SHARE).then(|| {
        format!("the {name} term is {percent:.0} % of the error at {key}, which bends the slope: {cure} would tell")
    })
}

pub(super) fn pair(interval: Interval) -> [f64; 2] {
    [interval.lo, interval.hi]
}

#[cfg(test)]
mod tests;
