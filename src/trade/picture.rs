//! Error against CPU time, a marker a run, with the Pareto front.

use super::{Knob, Study, Trial, front};
use crate::record::norm_label;
use crate::report::{Axis, Chart, Datum, Key, Part, ReportError, Scale, Series};

impl Study {
    /// The picture; none without two runs.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        self.chart().svg()
    }

    fn chart(&self) -> Chart {
        let question = "Which error does a second buy? Lines: one mesh each, from few steps to many. CPU time of one thread, the least of the repeats: mesh, loads and march.";
        let label = norm_label(self.norm.name());
        let mut chart = Chart::new(
            &format!("{}: speed against accuracy", self.scene),
            question,
            Axis::new("CPU time in seconds", Scale::Log),
            Axis::new(format!("error {label}"), Scale::Log),
        );
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
        let turned: Vec<Datum> = self
            .trials
            .iter()
            .filter(|t| t.knob != name && t.knob != Knob::AsWritten.name())
            .filter_map(place)
            .collect();
        if !turned.is_empty() {
            let hollow = Series::new("", vec![Part::Hollow(turned)]);
            chart.series.push(Series { grey: true, ..hollow });
            chart.keys.push(Key::Hollow("another knob turned".into()));
        }
        let all: Vec<Datum> = self.trials.iter().filter_map(place).collect();
        let best: Vec<Datum> = front(&all).into_iter().map(|i| all[i]).collect();
        let front = Series { grey: true, ..Series::new("Pareto front", vec![Part::Dashed(best)]) };
        chart.series.push(front);
        let failed = self.trials.iter().filter(|trial| trial.done().is_none()).count();
        if failed > 0 {
            chart.note = format!("{} failed, in the table", crate::record::counted(failed, "run"));
        }
        chart
    }
}

/// CPU time and error.
fn place(trial: &Trial) -> Option<Datum> {
    trial.done().map(|run| (run.seconds, run.error))
}
