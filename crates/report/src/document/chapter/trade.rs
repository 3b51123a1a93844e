//! Speed against accuracy, as `sweep trade` measured it.

use super::{Pen, digits, id, number};
use crate::document::{Run, Tone};
use crate::studies::Studies;
use crate::studies::practice::{Trade, Trial};

pub(super) fn write(pen: &mut Pen<'_>, studies: &mut Studies) {
    pen.chapter(
        "chapter-trade",
        "Speed against accuracy",
        "What the mesh, the step and every other knob of a scene cost and buy. Times are CPU seconds of one thread on the machine of the study, \
         from nothing, the least of several runs; errors are the same everywhere.",
    );
    if studies.trades.is_empty() {
        pen.absent("There is no such study", "trade SCENE");
    }
    for found in std::mem::take(&mut studies.trades) {
        study(pen, &found);
        pen.figures(studies.take(&found.scene, "-trade"));
    }
    pen.figures(studies.rest_of("-trade"));
}

fn study(pen: &mut Pen<'_>, study: &Trade) {
    pen.section(&id("trade", &study.scene), &format!("Cost and error: {}", study.scene));
    pen.of_this_text(&study.scene, &study.fingerprint);
    pen.table(
        format!("{}: error in {}, CPU seconds and predicted memory; front: no run here is both faster and better.", study.scene, study.norm),
        &["knob", ">n", ">N", ">error", ">CPU s", ">MiB", "front", "status"],
        study.trials.iter().map(trial).collect(),
    );
    pen.words(&error_model(study));
    pen.words(&cost_model(study));
    if let Some(path) = &study.coupling {
        pen.words(&format!(
            "Cheapest coupling: k = {} h^{:.2}, where space has {:.0} % of the error; an error E then costs E^-{:.2}.",
            digits(path.factor),
            path.exponent,
            100.0 * path.space_share,
            path.cost_exponent
        ));
    }
    pen.table(
        format!("{}: price list, one knob at a time.", study.scene),
        &["what a knob costs and buys"],
        study.prices.iter().map(|price| vec![Run::plain(&*price.words)]).collect(),
    );
    if let Some(answer) = &study.answer {
        let real = study.confirmed.as_ref().map_or_else(String::new, |real| {
            let [error, seconds] =
                [real.error, real.cpu_seconds].map(|v| v.map_or_else(|| "–".into(), digits));
            format!(" Run, it has the error {error} and takes {seconds} CPU s.")
        });
        let [error, seconds] =
            [answer.error, answer.cpu_seconds].map(|v| v.map_or_else(|| "–".into(), digits));
        pen.words(&format!(
            "For an error of {} the cheapest is n = {}, N = {}, knob: {}; predicted error {error}, {seconds} CPU s.{real}",
            digits(answer.target),
            answer.n,
            answer.steps,
            answer.knob
        ));
    }
}

fn trial(trial: &Trial) -> Vec<Run> {
    let done = trial.status == "converged";
    let status = match (done, &trial.reason) {
        (true, _) => Run::plain("converged"),
        (false, reason) => Run::of(
            format!("failed: {}", reason.as_deref().unwrap_or("no reason given")),
            Tone::Miss,
        ),
    };
    vec![
        Run::plain(&*trial.knob),
        Run::plain(trial.n.to_string()),
        Run::plain(trial.steps.to_string()),
        number(trial.error),
        number(trial.cpu_seconds),
        number(trial.predicted_bytes.map(|bytes| (bytes / (1024.0 * 1024.0)).round())),
        Run::plain(if trial.front { "on it" } else { "" }),
        status,
    ]
}

fn error_model(study: &Trade) -> String {
    let model = &study.error_model;
    let Some(name) = &model.model else {
        let why = model.reason.as_deref().unwrap_or("none given");
        return format!("Error: no model; the reason: {why}.");
    };
    let term = |of: &str, power: &Option<crate::studies::practice::Power>| match power {
        Some(p) => format!("{} {of}^{:.2}", digits(p.constant), p.order),
        None => format!("no term of {of}"),
    };
    format!("Error: {} and {} as {name}.", term("h", &model.space), term("k", &model.time))
}

fn cost_model(study: &Trade) -> String {
    let model = &study.cost_model;
    match (model.constant, &model.space, &model.time) {
        (Some(constant), Some(space), Some(time)) => format!(
            "Cost: {}{} s h^-{:.2} k^-{:.2}.",
            model
                .base
                .filter(|base| *base > 0.0)
                .map_or_else(String::new, |base| format!("{} s + ", digits(base))),
            digits(constant),
            space.exponent,
            time.exponent
        ),
        _ => format!(
            "Cost: no model; the reason: {}.",
            model.reason.as_deref().unwrap_or("none given")
        ),
    }
}
