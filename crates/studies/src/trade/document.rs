//! A trade in words and tables.

use super::extrapolation::{Extrapolated, LastOrder};
use super::picture::AGAINST;
use super::{Answer, Answered, Equal, Price, Rival, Study, Term, Trial};
use files::megabytes;
use judge::fit::Interval;
use report::{Chapter, Run, StudyDocument, Tone, digits};

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
        document.table(
            "Price list, one knob at a time: times within a round, with the 95 % interval over the rounds.",
            &["what a knob changes"],
            self.prices.iter().map(|price: &Price| vec![Run::plain(&*price.words)]).collect(),
        );
        let cost = |value: Option<f64>| {
            Run::plain(value.map_or("unknown".into(), |value| format!("E^-{value:.2}")))
        };
        document.table(
            "What an error E costs along k ~ h^s: by the models, and between the ends of the grid.",
            &[">s", ">models", ">measured"],
            self.paths
                .iter()
                .map(|path| {
                    let s = Run::plain(format!("{:.2}", path.exponent));
                    vec![s, cost(path.modelled), cost(path.measured)]
                })
                .collect(),
        );
        self.elements.iter().for_each(|rival| at_equal_error(&mut document, rival));
        self.extrapolated.iter().for_each(|found| extrapolated(&mut document, found));
        document.table(
            "Error, CPU seconds, spread of the repeats, the share of the loads, predicted memory; front: no run here is both faster and better, errors within 1 % being one; memory: none that takes less memory too; tie: the run as written within noise.",
            &[
                "knob", ">n", ">N", ">error", ">CPU s", ">spread", ">in loads", ">memory", "front",
                "status",
            ],
            self.trials.iter().map(trial).collect(),
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
                "Cheapest coupling: k = {:.3} h^{:.3}, where space has {:.0} % of the error (of its square, for root-sum-square); an error E costs E^-{:.2}.",
                path.factor,
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

fn trial(trial: &Trial) -> Vec<Run> {
    let [n, steps] = [trial.n, trial.steps].map(|count| count.to_string());
    let mut cells: Vec<Run> = [trial.knob.name(), n, steps].map(Run::plain).into();
    match &trial.outcome {
        Ok(run) => cells.extend(
            [
                format!("{:.4e}", run.error),
                format!("{:.4}", run.seconds),
                format!("+{:.0} %", 100.0 * (run.slowest / run.seconds - 1.0)),
                format!("{:.0} %", 100.0 * run.load_share),
                megabytes(run.bytes),
                match (trial.front, trial.front_memory, trial.tie) {
                    (true, ..) => "on it".into(),
                    (_, true, _) => "memory".into(),
                    (.., true) => "tie".into(),
                    _ => String::new(),
                },
                "converged".into(),
            ]
            .map(Run::plain),
        ),
        Err(reason) => {
            cells.extend((0..6).map(|_| Run::plain("–")));
            cells.push(Run::of(format!("failed: {reason}"), Tone::Miss));
        }
    }
    cells
}

fn at_equal_error(document: &mut StudyDocument, rival: &Rival) {
    document.words(format!("{}.", rival.words));
    let run = |answer: &Answer, beyond: bool| {
        let sign = if beyond { "*" } else { "" };
        format!("n = {}, N = {}, {:.2e} s{sign}", answer.n, answer.steps, answer.seconds)
    };
    let row = |at: &Equal| {
        let [plain, other] = at.extrapolates;
        let cells = [
            format!("{:.2e}", at.error),
            run(&at.as_written, plain),
            run(&at.rival, other),
            match at.speed >= 1.0 {
                true => format!("{}, {:.1} times", rival.knob.name(), at.speed),
                false => format!("as written, {:.1} times", 1.0 / at.speed),
            },
        ];
        cells.map(Run::plain).into()
    };
    document.table(
        format!(
            "{} at equal error: the cheapest runs by the models of error and cost; * finer than what was run.",
            rival.knob.name()
        ),
        &[">error", ">as written", &format!(">{}", rival.knob.name()), "faster"],
        rival.equal_error.iter().map(row).collect(),
    );
}

fn extrapolated(document: &mut StudyDocument, found: &Extrapolated) {
    let [plain, better] = found.orders.map(|order| match order {
        Some(LastOrder { last, interval: Some(i) }) => format!("{last:.2} in {}", bracketed(i)),
        Some(LastOrder { last, interval: None }) => format!("{last:.2}"),
        None => "unknown".into(),
    });
    let row = |(step, plain, better): &(f64, f64, Option<f64>)| {
        let better = better.map_or_else(|| "–".into(), |error| format!("{error:.3e}"));
        [format!("{step:.6}"), format!("{plain:.3e}"), better].map(Run::plain).into()
    };
    let step = format!(">{}", found.step);
    document.table(
        format!("Extrapolated: {}; last order {plain}, extrapolated {better}.", found.what),
        &[&step, ">error", ">extrapolated"],
        found.rows.iter().map(row).collect(),
    );
}
