//! `sweep solve --estimate`: the error of one run from its coarser companions, and the n and N of another error.

use serde_json::{Value, json};

use super::target::Wanted;
use super::{CliError, print_json, print_text};
use files::{digits, megabytes};
use judge::fit::Interval;
use run::sweep::MemoryLimit;
use scene::setup::Setup;
use scene::{Extension, Norm};
use studies::guarantee::Guarantee;
use studies::trade::NoAnswer;
use studies::trade::estimate::{
    Advice, Advised, Companions, CostSource, Estimate, Goal, Part, QuantityEstimate, advise,
    companions_and_bound, norm_estimate,
};

/// Runs a case with its companions; prints its estimated error, and the recommendation for a wanted error.
pub(super) fn execute(
    setup: &Setup,
    [n, steps]: [u32; 2],
    wanted: Wanted,
    limit: MemoryLimit,
    as_json: bool,
) -> Result<u8, CliError> {
    let command = "sweep solve --estimate";
    let singular = "its extrapolation takes the order of the time rule for granted";
    setup.scene.without(&[Extension::SingularKernel], command, singular)?;
    let (found, bound) = companions_and_bound(setup, n, steps).map_err(CliError::other)?;
    let estimates: Vec<(Norm, Estimate)> = found
        .norms
        .iter()
        .map(|measured| (measured.norm, norm_estimate(setup, &found, measured)))
        .collect();
    let norm = wanted.norm;
    let goal = |target| Goal { setup, run: [n, steps], norm, target, limit };
    let advice = wanted.error(found.size).map(|target| advise(&goal(target), &found));
    if as_json {
        let mut document = json!({
            "scene": setup.scene.name,
            "n": n,
            "steps": steps,
            "norms": estimates.iter().map(|(norm, estimate)| norm_json(&found, *norm, estimate)).collect::<Vec<_>>(),
            "quantities": found.quantities,
            "state": found.state,
            "bound": bound_json(&bound),
        });
        if let Some(advice) = &advice {
            document["recommendation"] = advice_json(advice, &found, norm);
        }
        print_json(&document)?;
    } else {
        let name = &setup.scene.name;
        print_text(&format!("{name} n = {n}, N = {steps}: estimated error of this run"));
        print(&found, &estimates);
        print_text(&format!("\n{}", bound_words(&bound)));
    }
    // The estimate is printed before a target is refused.
    let Some(advice) = advice else { return Ok(0) };
    let advice = advice.map_err(|none| CliError::other(refusal(&none)))?;
    let wanted_estimate = estimates.iter().find(|(of, _)| *of == norm);
    if let Some((_, estimate)) = wanted_estimate.filter(|_| !as_json) {
        print_advice(&advice, &found, norm, estimate);
    }
    Ok(0)
}

fn print(found: &Companions, estimates: &[(Norm, Estimate)]) {
    estimates.iter().for_each(|(norm, of)| print_text(&norm_words(found, *norm, of)));
    print_text(
        "\nquantities at t = T: value, bound of its distance to the limit, extrapolated value, orders in h and k",
    );
    found.quantities.iter().for_each(|quantity| print_text(&quantity_words(quantity)));
}

fn part_words(part: &Part) -> String {
    match (part, part.order().zip(part.at(1.0))) {
        (Part::Below(0.0), _) => "none".into(),
        (Part::Below(bound), _) => format!("below {bound:.1e} (rounding)"),
        (_, Some((order, (value, interval)))) => {
            format!("{value:.3e} in {} (order {order:.2})", bracketed(interval))
        }
        _ => "unknown".into(),
    }
}

/// The V error relative to ‖ε(u(T))‖.
fn relative(found: &Companions, norm: Norm, value: f64) -> Option<f64> {
    let size = found.state.strain_norm;
    (norm == Norm::VMax && size > 0.0).then(|| value / size)
}

fn norm_words(found: &Companions, norm: Norm, estimate: &Estimate) -> String {
    let parts = format!("h: {}; k: {}", part_words(&estimate.space), part_words(&estimate.time));
    match estimate.total() {
        Some((value, interval)) => {
            let part = relative(found, norm, value)
                .map_or(String::new(), |part| format!(", {:.2} % of |eps(u(T))|", 100.0 * part));
            format!("{:<17} {value:.3e} in {}{part}  ({parts})", norm.name(), bracketed(interval))
        }
        None => format!("{:<17} unknown: {}", norm.name(), estimate.reasons().join("; ")),
    }
}

fn quantity_words(estimate: &QuantityEstimate) -> String {
    let order = |order: Option<f64>| order.map_or("-".into(), |order| format!("{order:.2}"));
    let [h, k] = estimate.orders.map(order);
    let value = format!("{:<24} {}", estimate.name, digits(estimate.value, 9));
    let reason = estimate.reason.as_deref().unwrap_or("no companions");
    match (estimate.uncertainty, estimate.extrapolated) {
        (Some(bound), Some(limit)) => format!("{value}  ± {bound:.1e}  {limit:.8}  {h} {k}"),
        _ => format!("{value}  unknown: {reason}"),
    }
}

/// The guaranteed bound where it is largest, or why there is none.
fn bound_words(bound: &Result<Guarantee, String>) -> String {
    let Some((found, level)) =
        bound.as_ref().ok().and_then(|found| Some((found, found.largest()?)))
    else {
        let reason = bound.as_ref().err().map_or("no level was solved", String::as_str);
        return format!("no guaranteed bound: {reason}");
    };
    let part = match level.size > 0.0 {
        true => format!(", {:.2} % of the norm of u", 100.0 * level.bound / level.size),
        false => String::new(),
    };
    let mut words = format!(
        "guaranteed: error in space <= {:.3e} in the energy norm at all t_n (largest at t = {}{part}); not bounded: the error in time",
        level.bound,
        digits(level.t, 4)
    );
    if let (Some(error), Some(quotient)) = (level.error, found.effectivity()) {
        // The bound knows nothing of the error in time.
        words += &match error > level.bound {
            true => format!("\nexact solution: error {error:.3e} there, most of it in time"),
            false => format!(
                "\nexact solution: error {error:.3e} there, time included; bound / error {quotient:.2} in the median over t_n"
            ),
        };
    }
    words
}

fn bound_json(bound: &Result<Guarantee, String>) -> Value {
    match bound {
        Ok(found) => json!({
            "largest": found.largest(),
            "effectivity": found.effectivity(),
            "levels": found.levels,
        }),
        Err(reason) => json!({ "refused": reason }),
    }
}

fn norm_json(found: &Companions, norm: Norm, estimate: &Estimate) -> Value {
    let part = |part: &Part| match (part, part.order().zip(part.at(1.0))) {
        (Part::Below(bound), _) => json!({ "value": 0.0, "interval": [0.0, bound] }),
        (Part::Unknown(reason), _) => json!({ "reason": reason }),
        (_, Some((order, (value, interval)))) => {
            json!({ "order": order, "value": value, "interval": interval })
        }
        _ => json!({ "reason": "no admissible order" }),
    };
    let (value, interval) = estimate.total().unzip();
    json!({
        "norm": norm,
        "value": value,
        "interval": interval,
        "relative": value.and_then(|value| relative(found, norm, value)),
        "space": part(&estimate.space),
        "time": part(&estimate.time),
        "unknown": estimate.reasons(),
    })
}

/// Prints the recommendation with its estimate.
fn print_advice(advice: &Advice, found: &Companions, norm: Norm, estimate: &Estimate) {
    let percent = 100.0 * advice.target / found.size;
    let part = match norm {
        Norm::VMax => format!(" ({percent:.3} % of the largest |eps(u)|)"),
        _ => String::new(),
    };
    print_text(&format!("\ntarget {:.4e} in {}{part}", advice.target, norm.name()));
    print_text(&format!("  recommended: {}", advised_words(&advice.choice)));
    let cautious = advice.cautious.as_ref().map_or_else(refusal, advised_words);
    print_text(&format!("  cautious:    {cautious}"));
    print_text(&format!("  orders counted on: {}", orders_words(estimate)));
    print_text(&format!("  seconds: {}", source_words(advice.source)));
    let [n, steps] = advice.check;
    print_text(&format!(
        "  to check: --n {n} --steps {steps} --estimate, a run whose own companions narrow the interval"
    ));
}

fn advised_words(advised: &Advised) -> String {
    let (choice, far) = (advised.run, advised.extrapolates.as_ref());
    let warning = far.map_or(String::new(), |text| format!("\n    far: {text}"));
    format!(
        "n = {}, N = {} (h = {:.5}, k = {:.5}), predicted: error {:.3e} in {}, {:.3} CPU s, {}{warning}",
        choice.n,
        choice.steps,
        choice.h,
        choice.k,
        choice.error,
        bracketed(advised.interval),
        choice.seconds,
        megabytes(advised.bytes),
    )
}

fn orders_words(estimate: &Estimate) -> String {
    let of = |(name, part): (&str, &Part)| match part.order().zip(part.counted_on()) {
        Some((order, [counted, _])) => format!("{counted:.2} in {name} ({order:.2} observed)"),
        None => format!("none in {name}, which does not show"),
    };
    [("h", &estimate.space), ("k", &estimate.time)].map(of).join(", ")
}

fn source_words(source: CostSource) -> &'static str {
    match source {
        CostSource::Timed => "fitted to the CPU times of this run and its companions",
        CostSource::Counted => "by cells times levels: a companion is too short to time",
    }
}

/// The key `recommendation`.
fn advice_json(advice: &Result<Advice, NoAnswer>, found: &Companions, norm: Norm) -> Value {
    let advice = match advice {
        Ok(advice) => advice,
        Err(none) => return json!({ "norm": norm, "refused": refusal(none) }),
    };
    json!({
        "norm": norm,
        "target": advice.target,
        "relative": (norm == Norm::VMax && found.size > 0.0).then(|| advice.target / found.size),
        "choice": advice.choice,
        "cautious": advice.cautious.as_ref().ok(),
        "cautious_refused": advice.cautious.as_ref().err().map(refusal),
        "seconds_from": advice.source,
        "check": { "n": advice.check[0], "steps": advice.check[1] },
        "refused": null,
    })
}

fn refusal(none: &NoAnswer) -> String {
    format!("no recommendation: {none}")
}

fn bracketed(interval: Interval) -> String {
    format!("[{:.3e}, {:.3e}]", interval.lo, interval.hi)
}
