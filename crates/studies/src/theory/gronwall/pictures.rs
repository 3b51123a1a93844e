//! The pictures of a study. Error and bounds stand on a logarithmic axis, where the distance of two curves is their
//! ratio. For small k the bounds of the printed sum cover those with halved ends: one picture shows by how much they
//! differ.

use super::HorizonRow;
use super::bounds::Bounds;
use super::estimate::Effectivity;
use super::horizon::Horizons;
use super::study::{StudiedGrid, Study};
use report::{Axis, Chart, Datum, Part, Scale, Series};

/// A picture: the stem of its file name, what it shows, and the chart, which may have nothing to show.
pub(crate) type Picture = (&'static str, &'static str, Chart);

impl Study {
    /// Bounds over t, effectivities over k, what the printed sum loses over k, bounds over the horizon.
    pub(crate) fn pictures(&self) -> Vec<Picture> {
        let finest = self.grids.iter().max_by_key(|grid| grid.steps);
        let mut pictures: Vec<Picture> =
            finest.map(|grid| self.over_time(grid)).into_iter().collect();
        pictures.extend([self.ratios_over_step(), self.printed_over_step()]);
        pictures.extend(self.horizons.as_ref().map(|horizons| self.over_horizon(horizons)));
        pictures
    }

    fn mesh(&self) -> String {
        self.n.map_or_else(String::new, |n| format!(", n = {n}"))
    }

    fn chart(&self, question: &str, x: Axis, y: &str, series: Vec<Series>) -> Chart {
        let title = format!("{}: Gronwall", self.scene);
        let y = Axis::new(y, Scale::Log);
        Chart { direct: true, series, ..Chart::new(&title, question, x, y) }
    }

    fn over_time(&self, grid: &StudiedGrid) -> Picture {
        let question = format!(
            "Error in time and its bounds on [0, T], N = {}{}. From the weighted envelope to the closed form each bound lies above the one before.",
            grid.steps,
            self.mesh()
        );
        let (estimate, envelopes) = (&grid.judged.estimate, &grid.judged.envelopes);
        let data = |values: &[f64]| -> Vec<Datum> {
            estimate.grid.times().iter().copied().zip(values.iter().copied()).skip(1).collect()
        };
        let line = |i: usize| Series::new(SHOWN[i], vec![Part::Line(data(envelopes.shown()[i]))]);
        let error = measured(vec![Part::Dashed(data(&estimate.error))]);
        let series = vec![line(0), line(1), line(2), error];
        let time = Axis::new("time t_n", Scale::Linear);
        (
            "gronwall-envelope",
            "measured error and the envelopes of (3.24) over t (sweep gronwall).",
            self.chart(&question, time, "norm of the error", series),
        )
    }

    fn ratios_over_step(&self) -> Picture {
        let question = format!(
            "How far are the bounds above the measured error at t = T{}? 1 means attained.",
            self.mesh()
        );
        let ratio = |i: usize| self.over_step(SHOWN[i], |grid| grid.effectivity.shown()[i].at_end);
        let series = vec![ratio(0), ratio(1), ratio(2)];
        let step = Axis::new("time step k = T/N", Scale::Steps);
        (
            "gronwall-effectivity-k",
            "bound over measured error, over k (sweep gronwall).",
            self.chart(&question, step, "effectivity: bound / measured error at T", series),
        )
    }

    /// What the printed sum loses: its bounds over those with halved ends, less one.
    fn printed_over_step(&self) -> Picture {
        let question = format!(
            "By how much is the bound of the printed sum above that with halved ends, at t = T{}? It falls like k.",
            self.mesh()
        );
        let lost = |printed: &Option<Effectivity>, halved: &Effectivity| {
            Some(printed.as_ref()?.at_end? / halved.at_end? - 1.0)
        };
        let of = |name, lost: &dyn Fn(&Bounds<Effectivity>) -> Option<f64>| {
            self.over_step(name, |grid| lost(&grid.effectivity))
        };
        let series = vec![
            of("envelopes", &|e| lost(&e.printed, &e.primed)),
            of("closed forms", &|e| lost(&e.printed_closed, &e.closed)),
        ];
        let step = Axis::new("time step k = T/N", Scale::Steps);
        (
            "gronwall-printed-k",
            "what the printed sum of (3.24) loses against halved ends, over k (sweep gronwall).",
            self.chart(&question, step, "printed sum / halved ends − 1", series),
        )
    }

    /// A value of each grid over its step, from the smallest step.
    fn over_step(&self, name: &str, value: impl Fn(&StudiedGrid) -> Option<f64>) -> Series {
        let mut grids: Vec<&StudiedGrid> = self.grids.iter().collect();
        grids.sort_by_key(|grid| std::cmp::Reverse(grid.steps));
        curve(name, grids.iter().filter_map(|grid| Some((grid.k, value(grid)?))).collect())
    }

    fn over_horizon(&self, horizons: &Horizons) -> Picture {
        let question = format!(
            "Error and bounds over the horizon at the fixed step k = {}: uniform in T, or like exp(C₂T)?",
            horizons.k
        );
        let data = |value: &dyn Fn(&HorizonRow) -> f64| -> Vec<Datum> {
            horizons.rows.iter().map(|row| (row.horizon, value(row))).collect()
        };
        let bound = |i: usize| curve(SHOWN[i], data(&|row| *row.bounds.shown()[i]));
        let error = data(&|row| row.error);
        // Above the bounds: where one is attained, both are seen.
        let error = measured(vec![Part::Dashed(error.clone()), Part::Hollow(error)]);
        let (x, series) =
            (Axis::new("horizon T", Scale::Log), vec![bound(0), bound(1), bound(2), error]);
        (
            "gronwall-horizon",
            "error and bounds over the horizon (sweep gronwall --horizons).",
            self.chart(&question, x, "maximum over [0, T]", series),
        )
    }
}

fn curve(name: &str, data: Vec<Datum>) -> Series {
    Series::new(name, vec![Part::Line(data.clone()), Part::Points(data)])
}

fn measured(parts: Vec<Part>) -> Series {
    Series { grey: true, ..Series::new("measured error", parts) }
}

/// The names of [`Bounds::shown`].
const SHOWN: [&str; 3] = ["weighted envelope", "primed envelope", "its closed form"];
