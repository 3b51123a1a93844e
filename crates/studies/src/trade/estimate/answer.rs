//! The estimate of a run in words, tables and JSON.

use super::super::optimum::{Choice, Choices, Law, MOST, NoAnswer};
use super::super::{SPAN, Wanted};
use super::{Companions, NormDifferences, Part, RunTime, Watch, companions, norm_estimate};
use crate::study::StudyError;
use judge::fit::Interval;
use report::{Chapter, StudyDocument};
use run::sweep::MemoryLimit;
use scene::Norm;
use scene::setup::Setup;
use serde_json::{Value, json};

/// What is known of the error of a run.
pub struct Estimated {
    pub document: StudyDocument,
    pub json: Value,
    /// Why no n and N have the error that is wanted.
    pub refused: Option<NoAnswer>,
}

/// Runs a case with its companions: its estimated error, and the recommendation for a wanted error.
///
/// # Errors
/// The run itself; a bound that the theorem covers.
pub fn estimate(
    setup: &Setup,
    [n, steps]: [u32; 2],
    wanted: Wanted,
    limit: &MemoryLimit,
    watch: &mut Watch<'_>,
) -> Result<Estimated, StudyError> {
    let found = companions(setup, n, steps, watch)?;
    let part = |part: &Result<Part, String>| match part {
        Err(reason) => json!({ "reason": reason }),
        Ok(part) => {
            let (value, interval) = part.at(1.0).unzip();
            json!({ "order": part.order, "value": value, "interval": interval })
        }
    };
    let of = |differences: &NormDifferences| {
        let (norm, estimate) = (differences.norm, norm_estimate(setup, &found, differences));
        let (value, interval) = estimate.total().unzip();
        let size = found.state.strain_norm;
        let relative = value.filter(|_| norm == Norm::VMax && size > 0.0);
        json!({
            "norm": norm,
            "value": value,
            "interval": interval,
            "relative": relative.map(|value| value / size),
            "space": part(&estimate.space),
            "time": part(&estimate.time),
            "unknown": estimate.reasons(),
        })
    };
    let norms: Vec<Value> = found.norms.iter().map(of).collect();
    let mut json = json!({
        "scene": setup.scene.name,
        "n": n,
        "steps": steps,
        "norms": norms,
        "quantities": found.quantities,
        "state": found.state,
        "bound": match &found.bound {
            Err(reason) => json!({ "refused": reason }),
            Ok(found) => json!({
                "largest": found.largest(),
                "effectivity": found.effectivity(),
                "levels": found.levels,
            }),
        },
    });
    let title = format!("{} n = {n}, N = {steps}: estimated error of this run", setup.scene.name);
    let mut document = StudyDocument::new(Chapter::Trade, title);
    document.rows(
        "Errors, with their intervals.",
        &json!(norms),
        "norm = norm; >error = value 3; >from = interval/0 3; >to = interval/1 3; >of |eps(u(T))| = relative 2; \
         >in h = space/value 3; >order = space/order 3; >in k = time/value 3; >order = time/order 3; \
         unknown because = unknown/0; and = unknown/1",
    );
    document.rows(
        "Quantities at t = T.",
        &json!(found.quantities),
        "quantity = name; >value = value 6; >off by about = uncertainty 2; >limit = extrapolated 6; \
         >order in h = orders/0 3; >in k = orders/1 3; unknown because = reason",
    );
    match &found.bound {
        Err(reason) => document.words(format!("No guaranteed bound: {reason}.")),
        Ok(bound) => document.rows(
            "The largest guaranteed bound of the error in space, in the energy norm; errors hold that in time.",
            &json!([{ "of": bound.largest(), "effectivity": bound.effectivity() }]),
            ">t = of/t; >bound = of/bound 4; >norm of u = of/size 4; >error = of/error 4; >bound/error, median = effectivity 3",
        ),
    }
    let mut refused = None;
    if let Some(target) = wanted.error(found.size) {
        let norm = wanted.norm;
        let advised = |target| {
            let goal = Goal { setup, norm, target, limit: *limit };
            Ok((target, advise(&goal, &found)?))
        };
        json["recommendation"] = match target.and_then(advised) {
            Ok((target, advice)) => {
                let cautious = advice.cautious.as_ref().map_or_else(refusal, words);
                let [n, steps] = advice.check;
                document.words(format!("Target {target:.4e} in {}:", norm.name()));
                document.code(format!(
                    "recommended: {}\ncautious:    {cautious}\nto check: --n {n} --steps {steps} --estimate, a run whose own companions narrow the interval",
                    words(&advice.choice),
                ));
                let relative = norm == Norm::VMax && found.size > 0.0;
                json!({
                    "norm": norm,
                    "target": target,
                    "relative": relative.then(|| target / found.size),
                    "choice": advice.choice,
                    "cautious": advice.cautious.as_ref().ok(),
                    "cautious_refused": advice.cautious.as_ref().err().map(refusal),
                    "check": { "n": n, "steps": steps },
                    "refused": null,
                })
            }
            Err(none) => {
                let none = refused.insert(none);
                json!({ "norm": norm, "refused": refusal(none) })
            }
        };
    }
    Ok(Estimated { document, json, refused })
}

fn words(Advised { run, interval, .. }: &Advised) -> String {
    run.words("", &format!(" in [{:.3e}, {:.3e}]", interval.lo, interval.hi))
}

fn refusal(none: &NoAnswer) -> String {
    format!("no recommendation: {none}")
}

// Which n and N have the error that is wanted, from one run and its companions alone.
//
// The law of [`Estimate::at`] carries the error of the run to other steps,
// E(h, k)² = (e_h (h/h₀)^p)² + (e_k (k/k₀)^q)², with an interval from the hull over all readings of the differences;
// towards finer steps no reading falls faster than elements, rule or theorem allow. [`Choices::cheapest`] takes the pair of
// least cost with E ≤ target, and once more with the upper end of the interval in place of E.

/// No pair is proposed with more than so many times the n or N of the run: twice the span of the companions, on
/// logarithms. Farther away, an order uncertain by 1/2 means more than a factor of 4.
const REACH: u32 = 16;
/// An order that exceeds what elements and rule can have by more than this shows that companions are too coarse: the half
/// that is admitted around an order, and another one as in [`super::Part::of`].
const ABOVE: f64 = 1.0;
/// What is wanted of a run.
pub struct Goal<'a> {
    /// The scene.
    pub setup: &'a Setup,
    /// The norm of the error.
    pub norm: Norm,
    /// The error.
    pub target: f64,
    /// Memory that may be taken.
    pub limit: MemoryLimit,
}

/// A pair that is proposed.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Advised {
    #[serde(flatten)]
    pub run: Choice,
    /// The interval of its error.
    pub interval: Interval,
    /// h₀/h and k₀/k, the steps of the run over these.
    pub finer: [f64; 2],
}

/// The recommendation.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// The cheapest pair whose predicted error is the target or less.
    pub choice: Advised,
    /// The cheapest pair at which the upper end of the interval is the target or less, or why there is none.
    pub cautious: Result<Advised, NoAnswer>,
    /// The next n and N after the choice that have companions, so that the error can be estimated there again.
    pub check: [u32; 2],
}

/// The recommendation for a goal, from what the companions of its run show.
///
/// # Errors
/// [`NoAnswer`].
pub fn advise(goal: &Goal<'_>, found: &Companions) -> Result<Advice, NoAnswer> {
    let choices = Choices::new(goal.setup, false)?;
    let differences = found.norms.iter().find(|of_norm| of_norm.norm == goal.norm);
    let differences = differences.ok_or_else(|| unknown(goal.norm, "the scene has no contact"))?;
    let estimate = norm_estimate(goal.setup, found, differences);
    let reasons = estimate.reasons();
    if !reasons.is_empty() {
        return Err(unknown(goal.norm, &reasons.join("; ")));
    }
    for (step, part) in [("h", &estimate.space), ("k", &estimate.time)] {
        if let Ok(Part { order: Some(order), most, .. }) = part
            && *order > most + ABOVE
        {
            return Err(NoAnswer::Refused(format!(
                "pre-asymptotic in {step}: order {order:.2} observed in {}, and no more than {most} is possible; start from a run with a finer {step}",
                goal.norm.name()
            )));
        }
    }
    NoAnswer::admit(goal.target, differences.floor)?;
    let RunTime { n, steps, .. } = found.times[0];
    let [h, k] = [choices.h(n), choices.k(steps)];
    // Seconds of all runs, shared out by cells times levels.
    let (dimension, horizon) = (goal.setup.scene.dimension as i32, goal.setup.scene.time.horizon);
    let work = |h: f64, k: f64| h.powi(-dimension) * (horizon / k + 1.0);
    let done: f64 =
        found.times.iter().map(|run| work(choices.h(run.n), choices.k(run.steps))).sum();
    let taken: f64 = found.times.iter().map(|run| run.seconds).sum();
    // A clock that stands still gives no rate, and any will do.
    let rate = taken.max(f64::MIN_POSITIVE) / done;
    let nowhere = (f64::INFINITY, Interval { lo: 0.0, hi: f64::INFINITY });
    let at = |choice: [f64; 2]| estimate.at([choice[0] / h, choice[1] / k]).unwrap_or(nowhere);
    // Where a step has no error, another one is another problem, or other levels with the same error.
    let range = |i: usize, run: u32| match found.free[i] {
        true => [run; 2],
        false => [run / SPAN, run.saturating_mul(REACH).min(MOST[i])],
    };
    let [[least, most], [fewest, longest]] = [range(0, n), range(1, steps)];
    let advised = |read: fn((f64, Interval)) -> f64| {
        let law = Law {
            error: Box::new(|h, k| read(at([h, k]))),
            seconds: Box::new(|h, k| rate * work(h, k)),
            range: [[least, fewest], [most, longest]],
            made: SPAN * n,
        };
        let mut run = choices.cheapest(&law, goal.target, &goal.limit)?;
        let interval;
        (run.error, interval) = at([run.h, run.k]);
        Ok(Advised { run, interval, finer: [h / run.h, k / run.k] })
    };
    let choice = advised(|(error, _)| error)?;
    let cautious = advised(|(_, interval)| interval.hi);
    let suits =
        |n: &u32| n.is_multiple_of(SPAN) && choices.has_cells(*n) && choices.has_cells(n / SPAN);
    // The n of the run suits, and so do its multiples.
    let next = (choice.run.n..=MOST[0]).find(|n| !found.free[0] && suits(n));
    let longer = match found.free[1] {
        true => steps,
        false => choice.run.steps.next_multiple_of(SPAN),
    };
    let check = [next.unwrap_or(choice.run.n), longer];
    Ok(Advice { choice, cautious, check })
}

fn unknown(norm: Norm, reasons: &str) -> NoAnswer {
    NoAnswer::Refused(format!(
        "the error of this run in {} is unknown: {reasons}; start from a run with other n or N",
        norm.name()
    ))
}
