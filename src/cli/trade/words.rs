//! A study on the terminal and as JSON.

use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{LineStyle, Table};
use serde_json::{Value, json};

use super::super::{megabytes, print_text};
use super::finite;
use judge::fit::Interval;
use studies::trade::{Extrapolated, Study, Term, Trial, front, front_of_three};

/// A finished run on stderr.
pub(super) fn row(trial: &Trial) -> String {
    let place = format!("{} n={} N={}", trial.knob, trial.n, trial.steps);
    match &trial.outcome {
        Ok(run) => format!("{place} error {:.4e} in {:.4} s", run.error, run.seconds),
        Err(reason) => format!("{place} failed: {reason}"),
    }
}

/// Indices of the rows on the Pareto front of time and error, and on that with memory as a third axis.
fn best(trials: &[Trial]) -> [Vec<usize>; 2] {
    let place = |trial: &Trial| match trial.done() {
        Some(run) => [run.seconds, run.bytes, run.error],
        None => [f64::NAN; 3],
    };
    let places: Vec<[f64; 3]> = trials.iter().map(place).collect();
    let flat: Vec<(f64, f64)> =
        places.iter().map(|&[seconds, _, error]| (seconds, error)).collect();
    [front(&flat), front_of_three(&places)]
}

/// An interval in brackets; of two runs it is not known.
fn bracketed(interval: Interval) -> String {
    if interval.half_width().is_finite() {
        format!("[{:.2}, {:.2}]", interval.lo, interval.hi)
    } else {
        "[interval unknown: too few levels]".into()
    }
}

fn table(trials: &[Trial]) -> Table {
    let mut table = Table::new();
    table.force_no_tty();
    table.load_style(UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()));
    table.set_header(["knob", "n", "N", "error", "CPU s", "spread", "in loads", "memory", "front"]);
    let [fast, small] = best(trials);
    for (i, trial) in trials.iter().enumerate() {
        let mut cells = vec![trial.knob.clone(), trial.n.to_string(), trial.steps.to_string()];
        match &trial.outcome {
            Ok(run) => cells.extend([
                format!("{:.4e}", run.error),
                format!("{:.4}", run.seconds),
                format!("+{:.0} %", 100.0 * (run.slowest / run.seconds - 1.0)),
                format!("{:.0} %", 100.0 * run.load_share),
                megabytes(run.bytes),
                match (fast.contains(&i), small.contains(&i)) {
                    (true, _) => "*".into(),
                    (_, true) => "memory".into(),
                    _ => String::new(),
                },
            ]),
            Err(reason) => {
                let short: String = reason.chars().take(48).collect();
                cells.push(format!("failed: {short}"));
            }
        }
        table.add_row(cells);
    }
    table
}

/// The study on stdout.
pub(super) fn print(study: &Study, extrapolations: &[Extrapolated]) {
    print_text(&format!("{}: errors in {}", study.scene, study.norm.name()));
    print_text(&table(&study.trials).trim_fmt());
    print_models(study);
    print_paths(study);
    for found in extrapolations {
        print_text(&format!("\nextrapolated: {}", found.what));
        for (step, plain, better) in &found.rows {
            let better = better.map_or("-".into(), |error| format!("{error:.3e}"));
            print_text(&format!("  {} = {step:.6}  {plain:.3e}  {better}", found.step));
        }
        let [plain, better] = found.orders.map(|order| match order {
            Some((last, Some(interval))) => format!("{last:.2} in {}", bracketed(interval)),
            Some((last, None)) => format!("{last:.2}"),
            None => "unknown".into(),
        });
        print_text(&format!("  last order {plain}, extrapolated {better}"));
    }
    print_text("\nprice list, one knob at a time:");
    study.prices.iter().for_each(|price| print_text(&format!("  {}", price.words())));
}

fn print_models(study: &Study) {
    let term = |name: &str, term: &Option<Term>| match term {
        Some(term) => {
            format!("{:.4e} {name}^{:.3} {}", term.constant, term.order, bracketed(term.interval))
        }
        None => format!("no term of {name}"),
    };
    match &study.error {
        Ok(error) => print_text(&format!(
            "\nerror: {} and {} as {} ({}; off by {:.1} % at most)",
            term("h", &error.space),
            term("k", &error.time),
            error.model.name(),
            error.source,
            100.0 * error.residual.exp_m1()
        )),
        Err(reason) => print_text(&format!("\nerror: no model, {reason}")),
    }
    match &study.cost {
        Ok(cost) => print_text(&format!(
            "cost: t = {:.2e} s + {:.2e} s h^-a k^-b, a = {:.2} in {}, b = {:.2} in {} (off by {:.0} % at most)",
            cost.base,
            cost.constant,
            cost.space.value,
            bracketed(cost.space.interval),
            cost.time.value,
            bracketed(cost.time.interval),
            100.0 * cost.residual.exp_m1()
        )),
        Err(reason) => print_text(&format!("cost: no model, {reason}")),
    }
    if let Some(sum) = &study.composition {
        let [constant, cell, level, factor, factors] = sum.parts;
        print_text(&format!(
            "      for predictions {constant:.1e} s + {cell:.1e} s a cell + {level:.1e} s a cell and level + {factor:.1e} s an operation of a factorization + {factors:.1e} s one and level (cells h^-d, operations h^-3(d-1))"
        ));
    }
    if let Some(path) = &study.coupling {
        print_text(&format!(
            "cheapest coupling: k = {:.3} h^{:.3}, where space has {:.0} % of the error (of its square, for root-sum-square); an error E costs E^-{:.2}",
            path.factor,
            path.exponent,
            100.0 * path.space_share,
            path.cost_exponent
        ));
    }
}

fn print_paths(study: &Study) {
    let text =
        |value: Option<f64>| value.map_or("unknown".into(), |value| format!("E^-{value:.2}"));
    for (s, model, measured) in &study.paths {
        print_text(&format!(
            "  along k ~ h^{s:.2}: cost {} by the models, {} between the ends of the grid",
            text(*model),
            text(*measured)
        ));
    }
}

/// The study as JSON.
pub(super) fn document(study: &Study, extrapolations: &[Extrapolated]) -> Value {
    let [fast, small] = best(&study.trials);
    let interval = |i: Interval| json!([finite(i.lo), finite(i.hi)]);
    let term = |term: &Option<Term>| {
        term.map(|t| json!({ "constant": t.constant, "order": t.order, "interval": interval(t.interval) }))
    };
    let estimate =
        |e: &judge::fit::Estimate| json!({ "exponent": e.value, "interval": interval(e.interval) });
    json!({
        "scene": study.scene,
        "norm": study.norm.name(),
        "size": study.size,
        "trials": study.trials.iter().enumerate().map(|(i, t)| trial(t, [&fast, &small].map(|front| front.contains(&i)))).collect::<Vec<_>>(),
        "error_model": match &study.error {
            Ok(error) => json!({
                "model": error.model.name(),
                "space": term(&error.space),
                "time": term(&error.time),
                "source": error.source,
                "residual": error.residual,
            }),
            Err(reason) => json!({ "reason": reason }),
        },
        "cost_model": match &study.cost {
            Ok(cost) => json!({
                "base": cost.base,
                "constant": cost.constant,
                "space": estimate(&cost.space),
                "time": estimate(&cost.time),
                "residual": cost.residual,
            }),
            Err(reason) => json!({ "reason": reason }),
        },
        "composition": study.composition.as_ref().map(|sum| sum.parts),
        "coupling": study.coupling.map(|path| json!({
            "exponent": path.exponent,
            "factor": path.factor,
            "space_share": path.space_share,
            "cost_exponent": path.cost_exponent,
        })),
        "paths": study.paths.iter().map(|(s, modelled, measured)| {
            json!({ "exponent": s, "modelled": modelled, "measured": measured })
        }).collect::<Vec<_>>(),
        "prices": study.prices.iter().map(|price| json!({
            "what": price.what,
            "n": price.n,
            "steps": price.steps,
            "speed": finite(price.speed),
            "range": price.range.map(finite),
            "error": finite(price.error),
            "bytes": finite(price.bytes),
            "words": price.words(),
        })).collect::<Vec<_>>(),
        "extrapolation": extrapolations.iter().map(|found| json!({
            "what": found.what,
            "step": found.step,
            "rows": found.rows,
            "orders": found.orders.map(|order| order.map(|(last, i)| {
                json!({ "last": last, "interval": i.map(interval) })
            })),
        })).collect::<Vec<_>>(),
    })
}

fn trial(trial: &Trial, [front, front_memory]: [bool; 2]) -> Value {
    let mut row = json!({
        "knob": trial.knob,
        "n": trial.n,
        "steps": trial.steps,
        "h": trial.h,
        "k": trial.k,
        "dofs": trial.dofs,
        "front": front,
        "front_memory": front_memory,
    });
    let more = match &trial.outcome {
        Ok(run) => json!({
            "status": "converged",
            "error": finite(run.error),
            "floor": finite(run.floor),
            "cpu_seconds": run.seconds,
            "cpu_slowest": run.slowest,
            "repeats": run.repeats,
            "load_share": run.load_share,
            "predicted_bytes": run.bytes,
            "history_bytes": run.history_bytes,
            "newton_iterations": run.newton_iterations,
            "factorizations": run.factorizations,
        }),
        Err(reason) => json!({ "status": "failed", "reason": reason }),
    };
    if let (Some(row), Value::Object(more)) = (row.as_object_mut(), more) {
        row.extend(more);
    }
    row
}
