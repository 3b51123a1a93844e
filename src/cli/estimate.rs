//! `sweep solve --estimate`: the error of one run from its coarser companions, and the n and N of another error.

use serde_json::{Value, json};

use super::{CliError, TABLE_WIDTH, print_json, print_text, width};
use files::{digits, megabytes};
use run::sweep::MemoryLimit;
use scene::setup::Setup;
use scene::{Extension, Norm};
use studies::guarantee::Guarantee;
use studies::trade::estimate::{
    Advised, Companions, CostSource, Estimate, Goal, Part, advise, companions_and_bound,
    norm_estimate,
};
use studies::trade::{Choice, NoAnswer, Wanted};

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
    let target = wanted.error(found.size);
    let goal = |target| Goal { setup, run: [n, steps], norm, target, limit };
    let advice = target.map(|target| advise(&goal(target), &found));
    let recommended = match &advice {
        None => Value::Null,
        Some(Err(none)) => json!({ "norm": norm, "refused": refusal(none) }),
        Some(Ok(advice)) => json!({
            "norm": norm,
            "target": target,
            "relative": (norm == Norm::VMax && found.size > 0.0).then(|| advice.target / found.size),
            "choice": advice.choice,
            "cautious": advice.cautious.as_ref().ok(),
            "cautious_refused": advice.cautious.as_ref().err().map(refusal),
            "seconds_from": advice.source,
            "check": { "n": advice.check[0], "steps": advice.check[1] },
            "refused": null,
        }),
    };
    let mut document = json!({
        "scene": setup.scene.name,
        "n": n,
        "steps": steps,
        "norms": estimates.iter().map(|(norm, of)| norm_json(&found, *norm, of)).collect::<Value>(),
        "quantities": found.quantities,
        "state": found.state,
        "bound": bound.as_ref().map_or_else(|reason| json!({ "refused": reason }), |found| json!({
            "largest": found.largest(),
            "effectivity": found.effectivity(),
            "levels": found.levels,
        })),
    });
    if advice.is_some() {
        document["recommendation"] = recommended;
    }
    if as_json {
        print_json(&document)?;
    } else {
        print_text(&format!(
            "{} n = {n}, N = {steps}: estimated error of this run",
            setup.scene.name
        ));
        print_text(&tables(&document));
        print_text(&bound_words(&bound));
    }
    // The estimate is printed before a target is refused.
    let Some(advice) = advice else { return Ok(0) };
    let advice = advice.map_err(|none| CliError::other(refusal(&none)))?;
    let estimate = estimates.iter().find(|(of, _)| *of == norm);
    if let Some((_, estimate)) = estimate.filter(|_| !as_json) {
        let cautious = advice.cautious.as_ref().map_or_else(refusal, advised_words);
        let [n, steps] = advice.check;
        let seconds = match advice.source {
            CostSource::Timed => "fitted to the CPU times of this run and its companions",
            CostSource::Counted => "by cells times levels: a companion is too short to time",
        };
        print_text(&format!(
            "\ntarget {:.4e} in {}\n  recommended: {}\n  cautious:    {cautious}\n  orders counted on: {}\n  seconds: {seconds}\n  to check: --n {n} --steps {steps} --estimate, a run whose own companions narrow the interval",
            advice.target,
            norm.name(),
            advised_words(&advice.choice),
            orders_words(estimate),
        ));
    }
    Ok(0)
}

fn norm_json(found: &Companions, norm: Norm, estimate: &Estimate) -> Value {
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

/// Norms and quantities in tables; below them what is unknown, and why.
fn tables(document: &Value) -> String {
    let norms = [
        ("norm", "/norm"),
        (">error", "/value"),
        ("in", "/interval"),
        (">of |eps(u(T))|", "/relative"),
        (">in h", "/space/value"),
        (">order", "/space/order"),
        (">in k", "/time/value"),
        (">order", "/time/order"),
    ];
    let quantities = [
        ("quantity at t = T", "/name"),
        (">value", "/value"),
        (">bound of its distance to the limit", "/uncertainty"),
        (">limit", "/extrapolated"),
        (">order in h", "/orders/0"),
        (">order in k", "/orders/1"),
    ];
    let number = |value: &Value, sure| value.as_f64().map_or("–".into(), |v| digits(v, sure));
    let cell = |value: Option<&Value>| match value {
        Some(Value::String(text)) => text.clone(),
        Some(Value::Array(ends)) => {
            format!("[{}, {}]", number(&ends[0], 4), number(&ends[1], 4))
        }
        value => number(value.unwrap_or(&Value::Null), 6),
    };
    let mut text = String::new();
    for (key, columns, why) in
        [("norms", &norms[..], "/unknown"), ("quantities", &quantities[..], "/reason")]
    {
        let (mut rows, mut unknown) = (Vec::new(), String::new());
        for row in document[key].as_array().into_iter().flatten() {
            let cells = columns.iter().map(|(_, at)| cell(row.pointer(at)));
            let reasons: Vec<&str> = match row.pointer(why) {
                Some(Value::Array(all)) => all.iter().filter_map(Value::as_str).collect(),
                one => one.and_then(Value::as_str).into_iter().collect(),
            };
            match reasons.is_empty() {
                true => rows.push(cells.collect()),
                false => {
                    let name = cell(row.pointer(columns[0].1));
                    unknown += &format!("{name} unknown: {}\n", reasons.join("; "));
                }
            }
        }
        let heads: Vec<&str> = columns.iter().map(|(head, _)| *head).collect();
        if !rows.is_empty() {
            text +=
                &format!("{}\n", report::text_table(&heads, &rows, width(TABLE_WIDTH)).trim_end());
        }
        text += &unknown;
    }
    text
}

/// The guaranteed bound where it is largest, or why there is none.
fn bound_words(bound: &Result<Guarantee, String>) -> String {
    let (found, level) = match bound.as_ref().map(|found| (found, found.largest())) {
        Ok((found, Some(level))) => (found, level),
        Ok((_, None)) => return "no guaranteed bound: no level was solved".into(),
        Err(reason) => return format!("no guaranteed bound: {reason}"),
    };
    let mut words = format!(
        "guaranteed: error in space <= {:.3e} in the energy norm at all t_n (largest at t = {}, where u has {:.3e}); not bounded: the error in time",
        level.bound,
        digits(level.t, 4),
        level.size
    );
    if let (Some(error), Some(quotient)) = (level.error, found.effectivity()) {
        // The bound knows nothing of the error in time.
        words += &format!(
            "\nexact solution: error {error:.3e} there, time included; bound / error {quotient:.2} in the median over t_n"
        );
    }
    words
}

fn advised_words(advised: &Advised) -> String {
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
