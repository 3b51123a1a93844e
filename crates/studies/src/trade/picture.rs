//! Error against CPU time or memory, a marker per run, with the Pareto front of both.

use super::pareto::{TIE, front};
use super::{Answered, Knob, Outcome, Study, Trial};
use judge::record::norm_label;
use report::digits;
use report::{Axis, Chart, Datum, Mark, Part, Scale, Series};

/// What errors are drawn against.
pub(super) struct Against {
    /// Name of the picture.
    pub stem: &'static str,
    /// What it shows.
    pub shows: &'static str,
    title: &'static str,
    question: &'static str,
    axis: &'static str,
    of_run: fn(&Outcome) -> f64,
    of_answer: fn(&Answered) -> f64,
}

/// Time and memory.
pub(super) const AGAINST: [Against; 2] = [
    Against {
        stem: "trade",
        shows: "error against CPU seconds",
        title: "speed against accuracy",
        question: "The error that is reached in a given time. Lines: one mesh each, from few steps to many. CPU time of one thread, the least of the repeats: mesh, loads and march.",
        axis: "CPU time in seconds",
        of_run: |run| run.seconds,
        of_answer: |answer| answer.choice.seconds,
    },
    Against {
        stem: "trade-memory",
        shows: "error against predicted memory",
        title: "memory against accuracy",
        question: "Which error does a megabyte buy? Lines: one mesh each, from few steps to many. Peak memory of a process that does the run alone, predicted, with its history as it was counted.",
        axis: "memory in MB",
        of_run: |run| 1e-6 * run.bytes,
        of_answer: |answer| 1e-6 * answer.bytes,
    },
];

impl Study {
    /// The picture; none without two runs.
    pub(super) fn svg(&self, against: &Against, answer: Option<&Answered>) -> Option<String> {
        let mut chart = self.chart(against);
        if let Some(answer) = answer {
            mark(&mut chart, against, answer);
        }
        chart.svg()
    }

    fn chart(&self, against: &Against) -> Chart {
        let label = norm_label(self.norm.name());
        let mut chart = Chart::new(
            &format!("{}: {}", self.scene, against.title),
            against.question,
            Axis::new(against.axis, Scale::Log),
            Axis::new(format!("error {label}"), Scale::Log),
        );
        self.add_trials(&mut chart, against);
        self.add_front(&mut chart, against);
        let failed = self.trials.iter().filter(|trial| trial.done().is_none()).count();
        if failed > 0 {
            chart.note = format!("{} failed, in the table", files::counted(failed, "run"));
        }
        chart
    }

    /// A line for each mesh; other knobs and elements as points.
    fn add_trials(&self, chart: &mut Chart, against: &Against) {
        let place = |trial: &Trial| place(trial, against);
        let mut ns: Vec<u32> = self.plain().map(|trial| trial.n).collect();
        ns.dedup();
        for n in ns {
            let data: Vec<Datum> =
                self.plain().filter(|trial| trial.n == n).filter_map(place).collect();
            let series =
                Series::new(format!("n = {n}"), vec![Part::Line(data.clone()), Part::Points(data)]);
            chart.series.push(series);
        }
        let of = |knob: Knob| -> Vec<Datum> {
            self.trials.iter().filter(|t| t.knob == knob).filter_map(place).collect()
        };
        let extrapolated = of(Knob::Extrapolated);
        if !extrapolated.is_empty() {
            let name = Knob::Extrapolated.name();
            chart.series.push(Series::new(name, vec![Part::Points(extrapolated)]));
        }
        let elements: Vec<Knob> = self.elements.iter().map(|rival| rival.knob).collect();
        for &knob in &elements {
            chart.series.push(Series::new(knob.name(), vec![Part::Points(of(knob))]));
        }
        let apart = |knob| {
            [Knob::Extrapolated, Knob::AsWritten].contains(&knob) || elements.contains(&knob)
        };
        let turned: Vec<Datum> =
            self.trials.iter().filter(|t| !apart(t.knob)).filter_map(place).collect();
        if !turned.is_empty() {
            let hollow = Series::new("", vec![Part::Hollow(turned)]);
            chart.series.push(Series { grey: true, ..hollow });
            chart.keys.push((Part::Hollow(Vec::new()), "another knob turned".into()));
        }
    }

    /// The runs that no other beats in both, labelled.
    fn add_front(&self, chart: &mut Chart, against: &Against) {
        let run = |trial: &Trial| Some((place(trial, against)?, label_of(trial)));
        let all: Vec<(Datum, String)> =
            self.trials.iter().filter(|trial| !trial.tie).filter_map(run).collect();
        let places: Vec<[f64; 2]> = all.iter().map(|&((cost, error), _)| [cost, error]).collect();
        chart.labels = front(&places, TIE).into_iter().map(|i| all[i].clone()).collect();
        let best: Vec<Datum> = chart.labels.iter().map(|(place, _)| *place).collect();
        let front = Series { grey: true, ..Series::new("Pareto front", vec![Part::Dashed(best)]) };
        chart.series.push(front);
    }
}

/// The error that was asked for, and the run that is to have it.
fn mark(chart: &mut Chart, against: &Against, answer: &Answered) {
    let label = format!("target {}", digits(answer.target, 4));
    chart.horizontals.push(Mark { at: answer.target, label });
    let name =
        format!("recommended, predicted: n = {}, N = {}", answer.choice.n, answer.choice.steps);
    let place = vec![((against.of_answer)(answer), answer.choice.error)];
    chart.series.push(Series::new(name, vec![Part::Points(place)]));
}

/// Grid and, where it is not as written, the knob.
fn label_of(trial: &Trial) -> String {
    let grid = format!("n = {}, N = {}", trial.n, trial.steps);
    match trial.knob == Knob::AsWritten {
        true => grid,
        false => format!("{grid}, {}", trial.knob.name()),
    }
}

fn place(trial: &Trial, against: &Against) -> Option<Datum> {
    trial.done().map(|run| ((against.of_run)(run), run.error))
}
