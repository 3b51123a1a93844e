//! Error against CPU time or memory, a marker per run, with the Pareto front of both.

use super::pareto::{TIE, front};
use super::{Answered, Knob, Resource, Study, Trial};
use judge::record::norm_label;
use report::digits;
use report::{Axis, Chart, Datum, LegendKey, Mark, Part, ReportError, Scale, Series};

impl Study {
    /// The picture; none without two runs.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub(crate) fn svg(
        &self,
        resource: Resource,
        answer: Option<&Answered>,
    ) -> Result<Option<String>, ReportError> {
        let mut chart = self.chart(resource);
        if let Some(answer) = answer {
            mark(&mut chart, resource, answer);
        }
        chart.svg()
    }

    fn chart(&self, resource: Resource) -> Chart {
        let (title, question, axis) = match resource {
            Resource::Time => (
                "speed against accuracy",
                "The error that is reached in a given time. Lines: one mesh each, from few steps to many. CPU time of one thread, the least of the repeats: mesh, loads and march.",
                "CPU time in seconds",
            ),
            Resource::Memory => (
                "memory against accuracy",
                "Which error does a megabyte buy? Lines: one mesh each, from few steps to many. Peak memory of a process that does the run alone, predicted, with its history as it was counted.",
                "memory in MB",
            ),
        };
        let label = norm_label(self.norm.name());
        let mut chart = Chart::new(
            &format!("{}: {title}", self.scene),
            question,
            Axis::new(axis, Scale::Log),
            Axis::new(format!("error {label}"), Scale::Log),
        );
        self.add_trials(&mut chart, resource);
        self.add_front(&mut chart, resource);
        let failed = self.trials.iter().filter(|trial| trial.done().is_none()).count();
        if failed > 0 {
            chart.note = format!("{} failed, in the table", files::counted(failed, "run"));
        }
        chart
    }

    /// A line for each mesh; other knobs and elements as points.
    fn add_trials(&self, chart: &mut Chart, resource: Resource) {
        let place = |trial: &Trial| place(trial, resource);
        let mut ns: Vec<u32> = self.plain().map(|trial| trial.n).collect();
        ns.dedup();
        for n in ns {
            let data: Vec<Datum> =
                self.plain().filter(|trial| trial.n == n).filter_map(place).collect();
            let series =
                Series::new(format!("n = {n}"), vec![Part::Line(data.clone()), Part::Points(data)]);
            chart.series.push(series);
        }
        let name = Knob::Extrapolated.name();
        let extrapolated: Vec<Datum> =
            self.trials.iter().filter(|t| t.knob == name).filter_map(place).collect();
        if !extrapolated.is_empty() {
            chart.series.push(Series::new("Richardson in k", vec![Part::Points(extrapolated)]));
        }
        let mut apart = vec![name, Knob::AsWritten.name()];
        for element in self.elements.iter().map(|rival| rival.knob.name()) {
            let data = self.trials.iter().filter(|t| t.knob == element).filter_map(place).collect();
            chart.series.push(Series::new(element.clone(), vec![Part::Points(data)]));
            apart.push(element);
        }
        let turned: Vec<Datum> =
            self.trials.iter().filter(|t| !apart.contains(&t.knob)).filter_map(place).collect();
        if !turned.is_empty() {
            let hollow = Series::new("", vec![Part::Hollow(turned)]);
            chart.series.push(Series { grey: true, ..hollow });
            chart.keys.push(LegendKey::Hollow("another knob turned".into()));
        }
    }

    /// The runs that no other beats in both, labelled.
    fn add_front(&self, chart: &mut Chart, resource: Resource) {
        let run = |trial: &Trial| Some((place(trial, resource)?, label_of(trial)));
        let all: Vec<(Datum, String)> =
            self.trials.iter().filter(|trial| !trial.tie).filter_map(run).collect();
        let places: Vec<Datum> = all.iter().map(|(place, _)| *place).collect();
        chart.labels = front(&places, TIE).into_iter().map(|i| all[i].clone()).collect();
        let best: Vec<Datum> = chart.labels.iter().map(|(place, _)| *place).collect();
        let front = Series { grey: true, ..Series::new("Pareto front", vec![Part::Dashed(best)]) };
        chart.series.push(front);
    }
}

/// The error that was asked for, and the run that is to have it.
fn mark(chart: &mut Chart, resource: Resource, answer: &Answered) {
    let cost = match resource {
        Resource::Time => answer.choice.seconds,
        Resource::Memory => 1e-6 * answer.bytes,
    };
    let label = format!("target {}", digits(answer.target, 4));
    chart.horizontals.push(Mark { at: answer.target, label });
    let name =
        format!("recommended, predicted: n = {}, N = {}", answer.choice.n, answer.choice.steps);
    let place = vec![(cost, answer.choice.error)];
    chart.series.push(Series::new(name, vec![Part::Points(place)]));
}

/// Grid and, where it is not as written, the knob.
fn label_of(trial: &Trial) -> String {
    let grid = format!("n = {}, N = {}", trial.n, trial.steps);
    match trial.knob == Knob::AsWritten.name() {
        true => grid,
        false => format!("{grid}, {}", trial.knob),
    }
}

fn place(trial: &Trial, resource: Resource) -> Option<Datum> {
    trial.done().map(|run| match resource {
        Resource::Time => (run.seconds, run.error),
        Resource::Memory => (1e-6 * run.bytes, run.error),
    })
}
