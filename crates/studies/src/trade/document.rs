//! A trade in words, tables and a picture.

use super::bench::{EXTRAPOLATED, Outcome, Trial};
use super::extrapolation::{Extrapolated, LastOrder};
use super::study::{AS_WRITTEN, Equal, Price, Rival, plain};
use super::{Answered, Choice, Study, Term};
use files::{counted, megabytes};
use judge::fit::Interval;
use judge::record::norm_label;
use report::{
    Axis, Chapter, Chart, Datum, Mark, Part, Row, Run, Scale, Series, StudyDocument, Tone, digits,
};

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
        let price = |price: &Price| [("what a setting changes", Run::plain(&*price.words))];
        document.table(
            "One setting at a time, against the run as written. Seconds are those of single runs on this machine.",
            self.prices.iter().map(price),
        );
        self.elements.iter().for_each(|rival| at_equal_error(&mut document, rival));
        self.extrapolated.iter().for_each(|found| extrapolated(&mut document, found));
        document.table(
            "Error, CPU seconds of one run on this machine, the share of the loads, predicted memory; front: no run here is both faster and better, errors within 1 % being one; tie: the run as written within 1.25 times the time and 1 % of the error.",
            self.trials.iter().map(trial),
        );
        let caption = "Error against CPU seconds, with the Pareto front (sweep trade).";
        document.figure("trade", caption, self.svg(answer));
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
            Ok(cost) => {
                let [constant, cell, level, factor, factors] = cost.parts;
                format!(
                    "Cost: {constant:.1e} s + {cell:.1e} s a cell + {level:.1e} s a cell and level + {factor:.1e} s an operation of a factorization + {factors:.1e} s one and level (cells h^-d, operations h^-3(d-1); off by {:.0} % at most).",
                    100.0 * cost.residual.exp_m1()
                )
            }
            Err(reason) => format!("Cost: no model; the reason: {reason}."),
        });
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

fn trial(trial: &Trial) -> Row<'static, 9> {
    let of_run = |cell: fn(&Outcome) -> String| Run::plain(trial.done().map_or("–".into(), cell));
    let front = match (&trial.outcome, trial.front, trial.tie) {
        (Err(_), ..) => "–",
        (_, true, _) => "on it",
        (.., true) => "tie",
        _ => "",
    };
    let status = match &trial.outcome {
        Ok(_) => Run::plain("converged"),
        Err(reason) => Run::of(format!("failed: {reason}"), Tone::Miss),
    };
    [
        ("setting", Run::plain(trial.change.clone())),
        (">n", Run::plain(trial.n.to_string())),
        (">N", Run::plain(trial.steps.to_string())),
        (">error", of_run(|run| format!("{:.4e}", run.error))),
        (">CPU s", of_run(|run| format!("{:.4}", run.seconds))),
        (">in loads", of_run(|run| format!("{:.0} %", 100.0 * run.load_share))),
        (">memory", of_run(|run| megabytes(run.bytes))),
        ("front", Run::plain(front)),
        ("status", status),
    ]
}

fn at_equal_error(document: &mut StudyDocument, rival: &Rival) {
    document.words(format!("{}.", rival.words));
    let run = |answer: &Choice, beyond: bool| {
        let sign = if beyond { "*" } else { "" };
        format!("n = {}, N = {}, {:.2e} s{sign}", answer.n, answer.steps, answer.seconds)
    };
    let change = &rival.change;
    let head = format!(">{change}");
    let row = |at: &Equal| {
        let [plain, other] = at.extrapolates;
        let faster = match at.speed >= 1.0 {
            true => format!("{change}, {:.1} times", at.speed),
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
        format!("{change} at equal error: the cheapest runs by the models of error and cost; * finer than what was run."),
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

impl Study {
    /// Error against CPU time, a marker per run, with the Pareto front; none without two runs.
    fn svg(&self, answer: Option<&Answered>) -> Option<String> {
        let mut chart = Chart::new(
            &format!("{}: speed against accuracy", self.scene),
            "The error that is reached in a given time. Lines: one mesh each, from few steps to many. CPU time of one thread on this machine: mesh, loads and march.",
            Axis::new("CPU time in seconds", Scale::Log),
            Axis::new(format!("error {}", norm_label(self.norm.name())), Scale::Log),
        );
        let place = |trial: &Trial| trial.done().map(|run| (run.seconds, run.error));
        let mut ns: Vec<u32> = plain(&self.trials).map(|trial| trial.n).collect();
        ns.dedup();
        for n in ns {
            let runs = plain(&self.trials).filter(|trial| trial.n == n);
            let data: Vec<Datum> = runs.filter_map(place).collect();
            let parts = vec![Part::Line(data.clone()), Part::Points(data)];
            chart.series.push(Series::new(format!("n = {n}"), parts));
        }
        let elements = self.elements.iter().map(|rival| rival.change.as_str());
        let named: Vec<&str> = std::iter::once(EXTRAPOLATED).chain(elements).collect();
        let those = |wanted: &dyn Fn(&str) -> bool| -> Vec<Datum> {
            self.trials.iter().filter(|t| wanted(&t.change)).filter_map(place).collect()
        };
        for &name in &named {
            let data = those(&|change| change == name);
            if !data.is_empty() {
                chart.series.push(Series::new(name, vec![Part::Points(data)]));
            }
        }
        let settings = those(&|change| change != AS_WRITTEN && !named.contains(&change));
        if !settings.is_empty() {
            let hollow = Series::new("", vec![Part::Hollow(settings)]);
            chart.series.push(Series { grey: true, ..hollow });
            chart.keys.push((Part::Hollow(Vec::new()), "another setting".into()));
        }
        let mut best: Vec<&Trial> = self.trials.iter().filter(|trial| trial.front).collect();
        best.sort_by(|a, b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
        let label = |trial: &&Trial| {
            let grid = format!("n = {}, N = {}", trial.n, trial.steps);
            let other = format!("{grid}, {}", trial.change);
            Some((place(trial)?, if trial.change == AS_WRITTEN { grid } else { other }))
        };
        chart.labels = best.iter().filter_map(label).collect();
        let front = Part::Dashed(chart.labels.iter().map(|(place, _)| *place).collect());
        chart.series.push(Series { grey: true, ..Series::new("Pareto front", vec![front]) });
        let failed = self.trials.iter().filter(|trial| trial.done().is_none()).count();
        if failed > 0 {
            chart.note = format!("{} failed, in the table", counted(failed, "run"));
        }
        if let Some(Answered { target, choice, .. }) = answer {
            let label = format!("target {}", digits(*target, 4));
            chart.horizontals.push(Mark { at: *target, label });
            let name = format!("recommended, predicted: n = {}, N = {}", choice.n, choice.steps);
            let place = vec![(choice.seconds, choice.error)];
            chart.series.push(Series::new(name, vec![Part::Points(place)]));
        }
        chart.svg()
    }
}
