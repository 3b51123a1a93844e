//! The estimate of a run in words, tables and JSON.

use super::advice::{Advised, CostSource, Goal, advise};
use super::{Companions, Estimate, Part, Watch, companions_and_bound, norm_estimate};
use crate::guarantee::{Guarantee, GuaranteeError};
use crate::table;
use crate::trade::{Choice, NoAnswer, Wanted};
use files::{digits, megabytes};
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
) -> Result<Estimated, GuaranteeError> {
    let (found, bound) = companions_and_bound(setup, n, steps, watch)?;
    let of = |of: &super::NormDifferences| (of.norm, norm_estimate(setup, &found, of));
    let estimates: Vec<(Norm, Estimate)> = found.norms.iter().map(of).collect();
    let norms: Vec<Value> = estimates.iter().map(|(norm, of)| json_of(&found, *norm, of)).collect();
    let mut json = json!({
        "scene": setup.scene.name,
        "n": n,
        "steps": steps,
        "norms": norms,
        "quantities": found.quantities,
        "state": found.state,
        "bound": match &bound {
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
    let columns = [
        ("norm", "/norm", 0),
        (">error", "/value", 3),
        (">from", "/interval/0", 3),
        (">to", "/interval/1", 3),
        (">of |eps(u(T))|", "/relative", 2),
        (">in h", "/space/value", 3),
        (">order", "/space/order", 3),
        (">in k", "/time/value", 3),
        (">order", "/time/order", 3),
        ("unknown because", "/unknown", 0),
    ];
    let in_words = |(row, (_, of)): (&Value, &(Norm, Estimate))| {
        let (mut row, reasons) = (row.clone(), of.reasons().join("; "));
        row["unknown"] = json!(Some(reasons).filter(|reasons| !reasons.is_empty()));
        row
    };
    let rows: Vec<Value> = norms.iter().zip(&estimates).map(in_words).collect();
    document.table("Errors, with their intervals.", table::rows(&rows, columns));
    let quantities: Vec<Value> = found.quantities.iter().map(|found| json!(found)).collect();
    let columns = [
        ("quantity", "/name", 0),
        (">value", "/value", 6),
        (">at most off by", "/uncertainty", 2),
        (">limit", "/extrapolated", 6),
        (">order in h", "/orders/0", 3),
        (">in k", "/orders/1", 3),
        ("unknown because", "/reason", 0),
    ];
    document.table("Quantities at t = T.", table::rows(&quantities, columns));
    document.words(bound_words(&bound));
    let mut refused = None;
    if let Some(target) = wanted.error(found.size) {
        let norm = wanted.norm;
        let goal = Goal { setup, run: [n, steps], norm, target, limit: *limit };
        json["recommendation"] = match advise(&goal, &found) {
            Ok(advice) => {
                let estimate = estimates.iter().find(|(of, _)| *of == norm);
                let orders = estimate.map_or(String::new(), |(_, of)| orders_words(of));
                let cautious = advice.cautious.as_ref().map_or_else(refusal, words);
                let [n, steps] = advice.check;
                let seconds = match advice.source {
                    CostSource::Timed => "fitted to the CPU times of this run and its companions",
                    CostSource::Counted => {
                        "by cells times levels: a companion is too short to time"
                    }
                };
                document.words(format!("Target {target:.4e} in {}:", norm.name()));
                document.code(format!(
                    "recommended: {}\ncautious:    {cautious}\norders counted on: {orders}\nseconds: {seconds}\nto check: --n {n} --steps {steps} --estimate, a run whose own companions narrow the interval",
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
                    "seconds_from": advice.source,
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

fn json_of(found: &Companions, norm: Norm, estimate: &Estimate) -> Value {
    let part = |part: &Part| match (part, part.at(1.0)) {
        (Part::Unknown(reason), _) => json!({ "reason": reason }),
        (_, Some((value, interval))) => {
            json!({ "order": part.order(), "value": value, "interval": interval })
        }
        _ => json!({ "reason": "no admissible order" }),
    };
    let (value, interval) = estimate.total().unzip();
    let size = found.state.strain_norm;
    json!({
        "norm": norm,
        "value": value,
        "interval": interval,
        "relative": value.filter(|_| norm == Norm::VMax && size > 0.0).map(|value| value / size),
        "space": part(&estimate.space),
        "time": part(&estimate.time),
        "unknown": estimate.reasons(),
    })
}

/// The guaranteed bound where it is largest, or why there is none.
fn bound_words(bound: &Result<Guarantee, String>) -> String {
    let (found, level) = match bound.as_ref().map(|found| (found, found.largest())) {
        Ok((found, Some(level))) => (found, level),
        Ok((_, None)) => return "No guaranteed bound: no level was solved.".into(),
        Err(reason) => return format!("No guaranteed bound: {reason}."),
    };
    // The bound knows nothing of the error in time.
    let truth = match (level.error, found.effectivity()) {
        (Some(error), Some(quotient)) => format!(
            " The exact solution is {error:.3e} away there, time included; bound / error is {quotient:.2} in the median over t_n."
        ),
        _ => String::new(),
    };
    format!(
        "Guaranteed: error in space <= {:.3e} in the energy norm at all t_n (largest at t = {}, where u has {:.3e}); the error in time is not bounded.{truth}",
        level.bound,
        digits(level.t, 4),
        level.size
    )
}

fn words(advised: &Advised) -> String {
    let Choice { n, steps, h, k, error, seconds, bytes, .. } = advised.run;
    let far = advised.extrapolates.as_ref().map_or(String::new(), |far| format!("; far: {far}"));
    format!(
        "n = {n}, N = {steps} (h = {h:.5}, k = {k:.5}), predicted: error {error:.3e} in [{:.3e}, {:.3e}], {seconds:.3} CPU s, {}{far}",
        advised.interval.lo,
        advised.interval.hi,
        megabytes(bytes),
    )
}

fn orders_words(estimate: &Estimate) -> String {
    let of = |(name, part): (&str, &Part)| match part.order().zip(part.counted_on()) {
        Some((order, [counted, _])) => format!("{counted:.2} in {name} ({order:.2} observed)"),
        None => format!("none in {name}, which does not show"),
    };
    [("h", &estimate.space), ("k", &estimate.time)].map(of).join(", ")
}

fn refusal(none: &NoAnswer) -> String {
    format!("no recommendation: {none}")
}
