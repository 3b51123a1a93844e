//! The pictures of a study.

use super::estimate::{Envelopes, Estimate, effectivities};
use super::horizon::Horizons;
use super::study::{Effectivity, StudiedGrid, Study};
use report::{Axis, Chart, Datum, Part, ReportError, Scale, Series};

/// A picture by the stem of its file name.
pub(crate) type Picture = (&'static str, String);

impl Study {
    /// The pictures that have something to show: bounds over t, effectivities over t, over k and over
    /// the horizon, bounds over the horizon.
    ///
    /// # Errors
    /// [`ReportError::Drawing`].
    pub(crate) fn pictures(&self) -> Result<Vec<Picture>, ReportError> {
        let mut charts = Vec::new();
        let finest = self.grids.iter().max_by_key(|own| own.run.steps);
        if let Some(own) = finest {
            let (estimate, envelopes) = (&own.run.estimate, &own.envelopes);
            charts.push(("gronwall-envelope", self.over_time(estimate, envelopes)));
            charts.push(("gronwall-effectivity-t", self.ratios_over_time(estimate, envelopes)));
        }
        charts.push(("gronwall-effectivity-k", self.ratios_over_step()));
        if let Some(horizons) = &self.horizons {
            charts.push(("gronwall-horizon", self.over_horizon(horizons)));
            charts.push(("gronwall-effectivity-horizon", self.ratios_over_horizon(horizons)));
        }
        let mut drawn = Vec::new();
        for (name, chart) in charts {
            if let Some(svg) = chart.svg()? {
                drawn.push((name, svg));
            }
        }
        Ok(drawn)
    }

    fn mesh(&self) -> String {
        self.n.map_or_else(String::new, |n| format!(", n = {n}"))
    }

    fn chart(&self, question: &str, x: Axis, y: Axis) -> Chart {
        Chart::new(&format!("{}: Gronwall", self.scene), question, x, y)
    }

    fn over_time(&self, estimate: &Estimate, envelopes: &Envelopes) -> Chart {
        let question = format!(
            "Error in time and its bounds on [0, T], N = {}{}. Each bound lies above the one before.",
            estimate.grid.steps(),
            self.mesh()
        );
        let mut chart = self.chart(
            &question,
            Axis::new("time t_n", Scale::Linear),
            Axis::new("norm of the error", Scale::Log),
        );
        let times = estimate.grid.times();
        let data = |values: &[f64]| -> Vec<Datum> {
            times.iter().copied().zip(values.iter().copied()).skip(1).collect()
        };
        for (name, values) in bounds(envelopes) {
            chart.series.push(Series::new(name, vec![stroke(name, data(values))]));
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
            Axis::new("effectivity: bound / measured error", Scale::Log),
        );
        for (name, values) in bounds(envelopes) {
            let ratios = effectivities(values, estimate).into_iter();
            let data: Vec<Datum> = estimate
                .grid
                .times()
                .iter()
                .zip(ratios)
                .map(|(t, ratio)| (*t, ratio.unwrap_or(f64::NAN)))
                .collect();
            chart.series.push(Series::new(name, vec![stroke(name, data)]));
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
            Axis::new("effectivity: bound / measured error at T", Scale::Log),
        );
        let mut grids: Vec<&StudiedGrid> = self.grids.iter().collect();
        grids.sort_by_key(|own| std::cmp::Reverse(own.run.steps));
        let names = grids.iter().flat_map(|own| bounds(&own.envelopes)).map(|(name, _)| name);
        let mut known: Vec<&str> = Vec::new();
        for name in names {
            if !known.contains(&name) {
                known.push(name);
            }
        }
        for name in known {
            let data = grids.iter().filter_map(|own| {
                let (_, values) = bounds(&own.envelopes).into_iter().find(|b| b.0 == name)?;
                let k = own.run.estimate.grid.largest_step();
                Some((k, Effectivity::new(values, &own.run.estimate).at_end?))
            });
            chart.series.push(curve(name, data.collect()));
        }
        chart
    }

    fn over_horizon(&self, horizons: &Horizons) -> Chart {
        let question = format!(
            "Error and bounds over the horizon at the fixed step k = {}: uniform in T, or like e^(C2 T)?",
            horizons.k
        );
        let mut chart = self.chart(
            &question,
            Axis::new("horizon T", Scale::Log),
            Axis::new("maximum over [0, T]", Scale::Log),
        );
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
            Axis::new("effectivity: ratio of the maxima over [0, T]", Scale::Log),
        );
        chart.series = horizon_curves(horizons, |error| error);
        chart
    }
}

fn curve(name: &str, data: Vec<Datum>) -> Series {
    Series::new(name, vec![stroke(name, data.clone()), Part::Points(data)])
}

/// The bounds of the printed sum are dashed: for small k they cover the others.
fn stroke(name: &str, data: Vec<Datum>) -> Part {
    if [PRINTED, PRINTED_CLOSED].contains(&name) { Part::Dashed(data) } else { Part::Line(data) }
}

const MEASURED: &str = "measured error";

const WEIGHTED: &str = "weighted envelope";
const PRIMED: &str = "envelope, halved ends";
const CLOSED: &str = "its closed form";
const PRINTED: &str = "envelope of the printed sum";
const PRINTED_CLOSED: &str = "closed form of the printed sum";

fn bounds(envelopes: &Envelopes) -> Vec<(&'static str, &[f64])> {
    let mut all: Vec<(&'static str, &[f64])> = vec![
        (WEIGHTED, &envelopes.weighted),
        (PRIMED, &envelopes.primed),
        (CLOSED, &envelopes.closed),
    ];
    all.extend(envelopes.printed.as_deref().map(|values| (PRINTED, values)));
    all.extend(envelopes.printed_closed.as_deref().map(|values| (PRINTED_CLOSED, values)));
    all
}

fn horizon_curves(horizons: &Horizons, divisor: fn(f64) -> f64) -> Vec<Series> {
    let data = |value: fn(&super::HorizonRow) -> Option<f64>| -> Vec<Datum> {
        let rows = horizons.rows.iter();
        rows.filter_map(|row| Some((row.horizon, value(row)? / divisor(row.error)))).collect()
    };
    vec![
        curve(WEIGHTED, data(|row| Some(row.weighted))),
        curve(PRIMED, data(|row| Some(row.primed))),
        curve(CLOSED, data(|row| Some(row.closed))),
        curve(PRINTED, data(|row| row.printed)),
        curve(PRINTED_CLOSED, data(|row| row.printed_closed)),
    ]
}
