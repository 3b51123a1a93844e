//! The pictures of a study. For small k the bounds of the printed sum cover those with halved ends: one picture shows
//! by how much they differ.

use super::estimate::{Envelopes, Estimate, effectivities};
use super::horizon::Horizons;
use super::study::{Effectivity, StudiedGrid, Study};
use report::{Axis, Chart, Datum, Part, Scale, Series};

/// A picture: the stem of its file name, what it shows, and the chart, which may have nothing to show.
pub(crate) type Picture = (&'static str, &'static str, Chart);

impl Study {
    /// Bounds over t, effectivities over t, over k and over the horizon, bounds over the horizon.
    pub(crate) fn pictures(&self) -> Vec<Picture> {
        let mut charts = Vec::new();
        let finest = self.grids.iter().max_by_key(|grid| grid.run.steps);
        if let Some(grid) = finest {
            let (estimate, envelopes) = (&grid.run.estimate, &grid.envelopes);
            charts.push((
                "gronwall-envelope",
                "measured error and the envelopes of (3.24) over t (sweep gronwall).",
                self.over_time(estimate, envelopes),
            ));
            charts.push((
                "gronwall-effectivity-t",
                "bound over measured error, over t (sweep gronwall).",
                self.ratios_over_time(estimate, envelopes),
            ));
        }
        charts.push((
            "gronwall-effectivity-k",
            "bound over measured error, over k (sweep gronwall).",
            self.ratios_over_step(),
        ));
        charts.push((
            "gronwall-printed-k",
            "what the printed sum of (3.24) loses against halved ends, over k (sweep gronwall).",
            self.printed_over_step(),
        ));
        if let Some(horizons) = &self.horizons {
            charts.push((
                "gronwall-horizon",
                "error and bounds over the horizon (sweep gronwall --horizons).",
                self.over_horizon(horizons),
            ));
            charts.push((
                "gronwall-effectivity-horizon",
                "bound over measured error, over the horizon (sweep gronwall --horizons).",
                self.ratios_over_horizon(horizons),
            ));
        }
        charts
    }

    fn mesh(&self) -> String {
        self.n.map_or_else(String::new, |n| format!(", n = {n}"))
    }

    fn chart(&self, question: &str, x: Axis, y: &str) -> Chart {
        let title = format!("{}: Gronwall", self.scene);
        Chart { direct: true, ..Chart::new(&title, question, x, Axis::new(y, Scale::Log)) }
    }

    fn over_time(&self, estimate: &Estimate, envelopes: &Envelopes) -> Chart {
        let question = format!(
            "Error in time and its bounds on [0, T], N = {}{}. From the weighted envelope to the closed form each bound lies above the one before.",
            estimate.grid.steps(),
            self.mesh()
        );
        let mut chart =
            self.chart(&question, Axis::new("time t_n", Scale::Linear), "norm of the error");
        let times = estimate.grid.times();
        let data = |values: &[f64]| -> Vec<Datum> {
            times.iter().copied().zip(values.iter().copied()).skip(1).collect()
        };
        for (name, values) in bounds(envelopes) {
            chart.series.push(Series::new(name, vec![Part::Line(data(values))]));
        }
        let measured = Part::Dashed(data(&estimate.error));
        chart.series.push(Series { grey: true, ..Series::new(MEASURED, vec![measured]) });
        chart
    }

    fn ratios_over_time(&self, estimate: &Estimate, envelopes: &Envelopes) -> Chart {
        let question = format!(
            "How far are the bounds above the measured error on [0, T], N = {}{}? 1 means attained.",
            estimate.grid.steps(),
            self.mesh()
        );
        let mut chart = self.chart(
            &question,
            Axis::new("time t_n", Scale::Linear),
            "effectivity: bound / measured error",
        );
        for (name, values) in bounds(envelopes) {
            let ratios = effectivities(values, estimate).into_iter();
            let data = estimate.grid.times().iter().zip(ratios);
            let data = data.map(|(t, ratio)| (*t, ratio.unwrap_or(f64::NAN))).collect();
            chart.series.push(Series::new(name, vec![Part::Line(data)]));
        }
        chart
    }

    fn ratios_over_step(&self) -> Chart {
        let question = format!(
            "How far are the bounds above the measured error at t = T{}? 1 means attained.",
            self.mesh()
        );
        let mut chart = self.chart(
            &question,
            Axis::new("time step k = T/N", Scale::Steps),
            "effectivity: bound / measured error at T",
        );
        let [weighted, primed, closed] = [
            self.over_step(|grid| grid.effectivity.weighted.at_end),
            self.over_step(|grid| grid.effectivity.primed.at_end),
            self.over_step(|grid| grid.effectivity.closed.at_end),
        ];
        chart.series =
            vec![curve(WEIGHTED, weighted), curve(PRIMED, primed), curve(CLOSED, closed)];
        chart
    }

    /// What the printed sum loses: its bounds over those with halved ends, less one.
    fn printed_over_step(&self) -> Chart {
        let question = format!(
            "By how much is the bound of the printed sum above that with halved ends, at t = T{}? It falls like k.",
            self.mesh()
        );
        let mut chart = self.chart(
            &question,
            Axis::new("time step k = T/N", Scale::Steps),
            "printed sum / halved ends − 1",
        );
        let lost = |printed: Option<&Effectivity>, halved: &Effectivity| {
            Some(printed?.at_end? / halved.at_end? - 1.0)
        };
        let envelope = self
            .over_step(|grid| lost(grid.effectivity.printed.as_ref(), &grid.effectivity.primed));
        let closed = self.over_step(|grid| {
            lost(grid.effectivity.printed_closed.as_ref(), &grid.effectivity.closed)
        });
        chart.series = vec![curve("envelopes", envelope), curve("closed forms", closed)];
        chart
    }

    /// A value of each grid over its step, from the smallest step.
    fn over_step(&self, value: impl Fn(&StudiedGrid) -> Option<f64>) -> Vec<Datum> {
        let mut grids: Vec<&StudiedGrid> = self.grids.iter().collect();
        grids.sort_by_key(|grid| std::cmp::Reverse(grid.run.steps));
        let datum =
            |grid: &&StudiedGrid| Some((grid.run.estimate.grid.largest_step(), value(grid)?));
        grids.iter().filter_map(datum).collect()
    }

    fn over_horizon(&self, horizons: &Horizons) -> Chart {
        let question = format!(
            "Error and bounds over the horizon at the fixed step k = {}: uniform in T, or like exp(C₂T)?",
            horizons.k
        );
        let mut chart =
            self.chart(&question, Axis::new("horizon T", Scale::Log), "maximum over [0, T]");
        chart.series = horizon_curves(horizons, |_| 1.0);
        let rows = horizons.rows.iter();
        let error: Vec<Datum> = rows.map(|row| (row.horizon, row.error)).collect();
        // Above the bounds: where one is attained, both are seen.
        let parts = vec![Part::Dashed(error.clone()), Part::Hollow(error)];
        chart.series.push(Series { grey: true, ..Series::new(MEASURED, parts) });
        chart
    }

    fn ratios_over_horizon(&self, horizons: &Horizons) -> Chart {
        let question = format!(
            "How far are the bounds above the measured error over [0, T], k = {}? 1 means attained.",
            horizons.k
        );
        let mut chart = self.chart(
            &question,
            Axis::new("horizon T", Scale::Log),
            "effectivity: ratio of the maxima over [0, T]",
        );
        chart.series = horizon_curves(horizons, |error| error);
        chart
    }
}

fn curve(name: &str, data: Vec<Datum>) -> Series {
    Series::new(name, vec![Part::Line(data.clone()), Part::Points(data)])
}

const MEASURED: &str = "measured error";

const WEIGHTED: &str = "weighted envelope";
const PRIMED: &str = "primed envelope";
const CLOSED: &str = "its closed form";

fn bounds(envelopes: &Envelopes) -> [(&'static str, &[f64]); 3] {
    [(WEIGHTED, &envelopes.weighted), (PRIMED, &envelopes.primed), (CLOSED, &envelopes.closed)]
}

fn horizon_curves(horizons: &Horizons, divisor: fn(f64) -> f64) -> Vec<Series> {
    let data = |value: fn(&super::HorizonRow) -> f64| -> Vec<Datum> {
        let rows = horizons.rows.iter();
        rows.map(|row| (row.horizon, value(row) / divisor(row.error))).collect()
    };
    vec![
        curve(WEIGHTED, data(|row| row.weighted)),
        curve(PRIMED, data(|row| row.primed)),
        curve(CLOSED, data(|row| row.closed)),
    ]
}
