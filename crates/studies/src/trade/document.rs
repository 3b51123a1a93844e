//! A trade in words and tables.

use super::extrapolation::{Extrapolated, LastOrder};
use super::picture::AGAINST;
use super::{Answer, Answered, Equal, Outcome, Price, Rival, Study, Term, Trial};
use files::megabytes;
use judge::fit::Interval;
use report::{Chapter, Row, Run, StudyDocument, Tone, digits};

impl Study {
    /// The trade as a document; its pictures mark the answer, where a target was named.
    pub fn document(&self, answer: Option<&Answered>) -> StudyDocument {
        let title = format!("Cost and error: {}", self.scene);
        let mut document =
            StudyDocument::new(Chapter::Trade, title).of_scene(&self.scene, &self.fingerprint);
        document.words(format!(
            "Errors in {}; the largest strain norm of the truth is {}.",
            self.norm.name(),
            digits(self.size, 5)
        ));
        self.models(&mut document);
        let price = |price: &Price| [("what a knob changes", Run::plain(&*price.words))];
        document.table(
            "Price list, one knob at a time: times within a round, with the 95 % interval over the rounds.",
            self.prices.iter().map(price),
        );
        let cost = |value: Option<f64>| {
            Run::plain(value.map_or("unknown".into(), |value| format!("E^-{value:.2}")))
        };
        document.table(
            "What an error E costs along k ~ h^s: by the models, and between the ends of the grid.",
            self.paths.iter().map(|path| {
                let s = Run::plain(format!("{:.2}", path.exponent));
                [(">s", s), (">models", cost(path.modelled)), (">measured", cost(path.measured))]
            }),
        );
        self.elements.iter().for_each(|rival| at_equal_error(&mut document, rival));
        self.extrapolated.iter().for_each(|found| extrapolated(&mut document, found));
        document.table(
            "Error, CPU seconds, spread of the repeats, the share of the loads, predicted memory; front: no run here is both faster and better, errors within 1 % being one; memory: none that takes less memory too; tie: the run as written within noise.",
            self.trials.iter().map(trial),
        );
        for against in &AGAINST {
            let caption = format!("{}, with the Pareto front (sweep trade).", against.shows);
            document.figure(against.stem, &caption, self.svg(against, answer));
        }
        document
    }

    fn models(&self, document: &mut StudyDocument) {
        let models = &self.models;
        document.words(match &models.error {
            Ok(error) => format!(
                "Error: {} and {} as {} ({}; off by {:.1} % at most).",
                term("h", &error.space),
                term("k", &error.time),
                error.model.name(),
                error.source,
                100.0 * error.residual.exp_m1()
            ),
            Err(reason) => format!("Error: no model; the reason: {reason}."),
        });
        document.words(match &models.cost {
            Ok(cost) => format!(
                "Cost: t = {:.2e} s + {:.2e} s h^-a k^-b, a = {:.2} in {}, b = {:.2} in {} (off by {:.0} % at most).",
                cost.base,
                cost.constant,
                cost.space.exponent,
                bracketed(cost.space.interval),
                cost.time.exponent,
                bracketed(cost.time.interval),
                100.0 * cost.residual.exp_m1()
            ),
            Err(reason) => format!("Cost: no model; the reason: {reason}."),
        });
        if let Some(sum) = &models.composition {
            let [constant, cell, level, factor, factors] = sum.parts;
            document.words(format!(
                "For predictions {constant:.1e} s + {cell:.1e} s a cell + {level:.1e} s a cell and level + {factor:.1e} s an operation of a factorization + {factors:.1e} s one and level (cells h^-d, operations h^-3(d-1))."
            ));
        }
        if let Some(path) = &self.coupling {
            document.words(format!(
                "Cheapest coupling: k = {} h^{:.3}, where space has {:.0} % of the error (of its square, for root-sum-square); an error E costs E^-{:.2}.",
                digits(path.factor, 4),
                path.exponent,
                100.0 * path.space_share,
                path.cost_exponent
            ));
        }
    }
}

fn term(step: &str, term: &Option<Term>) -> String {
    let Some(Term { constant, order, interval }) = term else {
        return format!("no term of {step}");
    };
    format!("{constant:.4e} {step}^{order:.3} {}", bracketed(*interval))
}

/// An interval in brackets; of two runs it is not known.
fn bracketed(interval: Interval) -> String {
    match interval.half_width().is_finite() {
        true => format!("[{:.2}, {:.2}]", interval.lo, interval.hi),
        false => "[interval unknown: too few levels]".into(),
    }
}

fn trial(trial: &Trial) -> Row<'static, 10> {
    let of_run = |cell: fn(&Outcome) -> String| Run::plain(trial.done().map_or("–".into(), cell));
    let front = match (&trial.outcome, trial.front, trial.front_memory, trial.tie) {
        (Err(_), ..) => "–",
        (_, true, ..) => "on it",
        (_, _, true, _) => "memory",
        (.., true) => "tie",
        _ => "",
    };
    let status = match &trial.outcome {
        Ok(_) => Run::plain("converged"),
        Err(reason) => Run::of(format!("failed: {reason}"), Tone::Miss),
    };
    [
        ("knob", Run::plain(trial.knob.name())),
        (">n", Run::plain(trial.n.to_string())),
        (">N", Run::plain(trial.steps.to_string())),
        (">error", of_run(|run| format!("{:.4e}", run.error))),
        (">CPU s", of_run(|run| format!("{:.4}", run.seconds))),
        (">spread", of_run(|run| format!("+{:.0} %", 100.0 * (run.slowest / run.seconds - 1.0)))),
        (">in loads", of_run(|run| format!("{:.0} %", 100.0 * run.load_share))),
        (">memory", of_run(|run| megabytes(run.bytes))),
        ("front", Run::plain(front)),
        ("status", status),
    ]
}

fn at_equal_error(document: &mut StudyDocument, rival: &Rival) {
    document.words(format!("{}.", rival.words));
    let run = |answer: &Answer, beyond: bool| {
        let sign = if beyond { "*" } else { "" };
        format!("n = {}, N = {}, {:.2e} s{sign}", answer.n, answer.steps, answer.seconds)
    };
    let knob = rival.knob.name();
    let head = format!(">{knob}");
    let row = |at: &Equal| {
        let [plain, other] = at.extrapolates;
        let faster = match at.speed >= 1.0 {
            true => format!("{knob}, {:.1} times", at.speed),
            false => format!("as written, {:.1} times", 1.0 / at.speed),
        };
        [
            (">error", Run::plain(format!("{:.2e}", at.error))),
            (">as written", Run::plain(run(&at.as_written, plain))),
            (head.as_str(), Run::plain(run(&at.rival, other))),
            ("faster", Run::plain(faster)),
        ]
    };
    document.table(
        format!("{knob} at equal error: the cheapest runs by the models of error and cost; * finer than what was run."),
        rival.equal_error.iter().map(row),
    );
}

fn extrapolated(document: &mut StudyDocument, found: &Extrapolated) {
    let [plain, better] = found.orders.map(|order| match order {
        Some(LastOrder { last, interval: Some(i) }) => format!("{last:.2} in {}", bracketed(i)),
        Some(LastOrder { last, interval: None }) => format!("{last:.2}"),
        None => "unknown".into(),
    });
    let head = format!(">{}", found.step);
    let row = |(step, plain, better): &(f64, f64, Option<f64>)| {
        let better = better.map_or_else(|| "–".into(), |error| format!("{error:.3e}"));
        [
            (head.as_str(), Run::plain(digits(*step, 7))),
            (">error", Run::plain(format!("{plain:.3e}"))),
            (">extrapolated", Run::plain(better)),
        ]
    };
    document.table(
        format!("Extrapolated: {}; last order {plain}, extrapolated {better}.", found.what),
        found.rows.iter().map(row),
    );
}
