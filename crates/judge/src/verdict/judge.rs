//! Judges one prediction from records.

use files::without_digits;
use std::collections::BTreeMap;

use super::constants::{ConstantComparison, compare_constant, correction, refined};
use super::joint::judge_grid;
use super::next::{Next, next_case};
use super::ruling::{claim, with_help};
use super::selection::{Cases, JudgedPoint, Selection};
use super::{
    ConstantClaim, FittedConstant, FloorSource, Foreseen, LeadingLine, MeshAndSteps, Prediction,
    Variable, Verdict,
};
use crate::record::{CaseRecord, Key, V_TIME_MAX};
use fit::{
    Decision, Direction, Exclusion, Known, LARGEST_OTHER_SHARE, LineReading, Point, Sample,
    TOLERANCE, constant_under, joint_fits, screen, zeros_in_words,
};

/// Judges a prediction for a scene. Every expected case has to be there, converged and with a finite error; else the
/// verdict is `fail` and names the gaps.
pub fn judge(
    scene: &str,
    records: &[CaseRecord],
    expected_cases: &[Key],
    prediction: &Prediction,
    expect: Decision,
) -> Verdict {
    judge_foreseen(scene, records, expected_cases, prediction, None, expect)
}

/// Judges with a predicted constant: the right order with a wrong constant is a `fail`.
pub fn judge_foreseen(
    scene: &str,
    records: &[CaseRecord],
    expected_cases: &[Key],
    prediction: &Prediction,
    foreseen: Option<&Foreseen>,
    expect: Decision,
) -> Verdict {
    let cases = Cases::new(scene, records, expected_cases);
    let selection = cases.select(prediction);
    let open = Verdict::open(scene, prediction, expect);
    let mut verdict = match prediction.variable.direction() {
        _ if !selection.gaps.is_empty() => Verdict {
            order: Decision::Fail,
            reason: gaps_in_words(&selection.gaps),
            complete: false,
            ..open
        },
        Some(direction) => judge_line(open, &cases, &selection, prediction, direction),
        None => judge_grid(open, &selection, prediction),
    };
    // A constant is one of a predicted order.
    if let (Some(Foreseen::Leading(line)), false) = (foreseen, prediction.tends_to_zero()) {
        compare_with(&mut verdict, &selection, prediction, line);
    }
    verdict.settle();
    let Selection { used: points_used, left_out: points_left_out, .. } = selection;
    Verdict { points_used, points_left_out, foreseen: foreseen.cloned(), ..verdict }
}

fn compare_with(
    finding: &mut Verdict,
    selection: &Selection,
    prediction: &Prediction,
    line: &LeadingLine,
) {
    let direction = match prediction.variable {
        Variable::H => Direction::Space,
        Variable::K => Direction::Time,
        Variable::Joint | Variable::Path => return,
    };
    let name = direction.constant();
    let Some(&fitted) = finding.constants.get(name) else { return };
    let in_the_way = match foreseen_share(selection, prediction) {
        Some((share, _)) if share > LARGEST_OTHER_SHARE => direction.other(),
        _ => direction,
    };
    let used = &selection.used;
    let compared = compare_constant(fitted, used, line, prediction, direction, in_the_way);
    let Some(ConstantComparison { constant, decision, sentence, blame, leading_order }) = compared
    else {
        return;
    };
    finding.constants.insert(name, constant);
    // Errors of another order are off by another factor on every case, and no factor is to blame.
    let blame = if finding.order == Decision::Fail { String::new() } else { blame };
    finding.reason = format!("{}; {sentence}{blame}", finding.reason);
    finding.constant = Some(ConstantClaim {
        name,
        decision,
        reason: format!("{sentence}{blame}"),
        owed: prediction.constant_owed,
        decides: false,
    });
    let order_alone = finding.order;
    let Some(leading) = leading_order else { return };
    // A bound is met by a higher order.
    let short = match prediction.at_least {
        true => prediction.order - leading,
        false => (leading - prediction.order).abs(),
    };
    match order_alone {
        // Errors that follow the leading error of a sound scheme have its order, whatever their slopes alone show.
        Decision::Unresolved if finding.complete && short <= TOLERANCE => {
            finding.reason = format!(
                "{sentence} on each of the finest cases, and the predicted errors have the order {leading:.2}; the slopes alone leave it open"
            );
            (finding.order, finding.next) = (Decision::Pass, Vec::new());
            if let Some(claim) = &mut finding.constant {
                claim.decides = true;
            }
        }
        Decision::Pass => {}
        _ if short > TOLERANCE => {
            finding.contradicted_by = Some(leading);
            finding.reason += &format!(
                " on each of the finest cases, and the predicted errors have the order {leading:.2}: the prediction {} is wrong, not the program",
                prediction.order
            );
        }
        _ => {}
    }
}

const NAMED_GAPS: usize = 3;

/// Gaps by place; a reason shared by several cases, but for its numbers, is stated once.
fn gaps_in_words(gaps: &[String]) -> String {
    let reason = |gap: &str| gap.split_once(" failed: ").map(|(_, reason)| without_digits(reason));
    let mut said: Vec<(&String, Option<String>, usize)> = Vec::new();
    for gap in gaps {
        let shared = reason(gap);
        match said.iter_mut().find(|(_, other, _)| shared.is_some() && *other == shared) {
            Some((_, _, others)) => *others += 1,
            None => said.push((gap, shared, 0)),
        }
    }
    let words = |(gap, _, others): &(&String, Option<String>, usize)| match others {
        0 => (*gap).clone(),
        others => format!("{gap}; {others} more for the same reason"),
    };
    let named = said.iter().take(NAMED_GAPS).map(words).collect::<Vec<_>>().join("; ");
    let left: usize = said.iter().skip(NAMED_GAPS).map(|(_, _, others)| 1 + others).sum();
    match left {
        0 => named,
        more => format!("{named}; and {more} more"),
    }
}

fn judge_line(
    open: Verdict,
    cases: &Cases<'_>,
    selection: &Selection,
    prediction: &Prediction,
    direction: Direction,
) -> Verdict {
    let next = next_case(selection, direction, prediction);
    let points: Vec<_> = selection.points().into_iter().map(|point| (point, None)).collect();
    let reference = reference_step(selection, prediction, direction);
    let read = LineReading::of(&points, direction, &Known { reference, ..Known::default() });
    let LineReading { posterior, samples } = match read {
        Ok(read) => read,
        Err(error) => {
            let zero = |point: &Point| screen(point) == Err(Exclusion::Zero);
            let zeros = selection.screened_out.iter().filter(|point| zero(point)).count();
            let reason = format!("{error}{}: {}", zeros_in_words(zeros), next.text);
            return Verdict { reason, next: next.cases, ..open };
        }
    };
    let mut ruling = match prediction.tends_to_zero() {
        true => posterior.tends_to_zero(),
        false => posterior.decide(&claim(prediction, prediction.order)),
    };
    let other = other_term(&cases.points(&prediction.norm), selection, prediction, direction);
    let other = other.filter(|other| !other.foreseen || ruling.decision != Decision::Pass);
    if ruling.decision == Decision::Fail && other.as_ref().is_some_and(OtherTerm::hides_the_order) {
        ruling.decision = Decision::Unresolved;
    }
    let helped = ruling.is_helped();
    let next = match (&other, posterior.floor_from) {
        (Some(other), _) if helped => other.lowered(selection, direction),
        (None, Some(_)) if helped => flattening(prediction),
        _ => next,
    };
    let reason = format!("{}{}", ruling.reason, posterior.left_out_in_words());
    let mut reason = with_help(reason, &ruling, &next.text);
    if let Some(other) = other.filter(|_| !helped) {
        reason = format!("{reason}; {}", other.in_words(direction));
    }
    Verdict {
        observed: Some(posterior.order),
        interval: Some(posterior.interval.into()),
        probability: Some(ruling.probability),
        constants: constants(&samples, prediction, direction),
        order: ruling.decision,
        reason,
        complete: !ruling.unexplained,
        next: if helped { next.cases } else { Vec::new() },
        ..open
    }
}

/// The step of the reference run, with meshes that are finer by their n; 0 where the solution is known.
fn reference_step(
    selection: &Selection,
    prediction: &Prediction,
    direction: Direction,
) -> Option<f64> {
    match (prediction.floor, prediction.reference, selection.used.last()) {
        // Each level has a run of its own, in the same ratio of steps.
        _ if prediction.norm == V_TIME_MAX => Some(0.0),
        (FloorSource::Reference, Some(run), Some(used)) => {
            let [cells, finer] = [used.place, run].map(|at| match direction {
                Direction::Space => at.n.unwrap_or(1),
                Direction::Time => at.steps,
            });
            // What is not refined beyond the cases says nothing of this direction.
            let step = direction.step(&used.point) * f64::from(cells) / f64::from(finer);
            Some(step).filter(|_| finer > cells)
        }
        (FloorSource::Reference | FloorSource::Unknown, ..) => None,
        _ => Some(0.0),
    }
}

/// Finer cases lie deeper in a floor.
fn flattening(prediction: &Prediction) -> Next {
    Next { cases: Vec::new(), text: prediction.floor.remedy().to_owned() }
}

fn constants(
    samples: &[Sample],
    prediction: &Prediction,
    direction: Direction,
) -> BTreeMap<&'static str, FittedConstant> {
    if prediction.tends_to_zero() {
        return BTreeMap::new();
    }
    let order = prediction.order;
    let fitted = constant_under(order, samples, correction(prediction, direction));
    let named = fitted.map(|(value, interval)| {
        (direction.constant(), FittedConstant::fitted(value, interval, order))
    });
    named.into_iter().collect()
}

/// The term of the direction that is not refined, where it bends a line.
struct OtherTerm {
    share: f64,
    place: MeshAndSteps,
    /// From the predicted errors, not from the grid.
    foreseen: bool,
}

/// Where the term of the other direction bends this line: if the grid can tell, by its fit, else as predicted.
fn other_term(
    grid: &[Point],
    selection: &Selection,
    prediction: &Prediction,
    direction: Direction,
) -> Option<OtherTerm> {
    let fitted = joint_fits(grid, false).ok().and_then(|fits| {
        let share = |used: &JudgedPoint| fits.best.share(direction.other(), &used.point);
        selection
            .used
            .iter()
            .map(|used| (share(used), used.place))
            .max_by(|a, b| a.0.total_cmp(&b.0))
    });
    let foreseen = fitted.is_none();
    let (share, place) = fitted.or_else(|| foreseen_share(selection, prediction))?;
    (share > LARGEST_OTHER_SHARE).then_some(OtherTerm { share, place, foreseen })
}

/// The share of the finest error that is predicted of the direction that is not refined.
fn foreseen_share(selection: &Selection, prediction: &Prediction) -> Option<(f64, MeshAndSteps)> {
    let finest = selection.used.last()?;
    Some((prediction.other_error? / finest.point.error, finest.place))
}

impl OtherTerm {
    /// Then the order of the line is that of no term: it does not refute a prediction.
    fn hides_the_order(&self) -> bool {
        self.foreseen && self.share >= 0.5
    }

    fn in_words(&self, direction: Direction) -> String {
        let name = match direction {
            Direction::Space => "time",
            Direction::Time => "space",
        };
        let cure = refined(direction.other());
        let (percent, place) = (100.0 * self.share.min(1.0), self.place);
        let source = if self.foreseen { ", as predicted" } else { "" };
        format!(
            "the {name} term is {percent:.0} % of the error at {place}{source}, which bends the slope: use {cure} to decide"
        )
    }

    /// The cases of the line with four times the steps, or twice the cells: 16 times less where the rule is of order 2.
    fn lowered(&self, selection: &Selection, direction: Direction) -> Next {
        let finer = |MeshAndSteps { n, steps }: MeshAndSteps| match direction {
            Direction::Space => MeshAndSteps { n, steps: steps.saturating_mul(4) },
            Direction::Time => MeshAndSteps { n: n.map(|n| n.saturating_mul(2)), steps },
        };
        let cases = selection.used.iter().map(|used| finer(used.place)).collect();
        Next { cases, text: self.in_words(direction) }
    }
}

#[cfg(test)]
mod tests;
