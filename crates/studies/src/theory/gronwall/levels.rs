//! Every level of a study as a table.

use super::estimate::{Envelopes, Estimate};
use super::measure::TemporalRun;
use super::study::Study;
use crate::table;

impl Study {
    /// Every level of every run: `SCENE-gronwall.csv`.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut rows = Vec::new();
        let of_run = |part: &str, run: &TemporalRun, envelopes: &Envelopes| {
            let truncation = Some([&run.truncation_zeta, &run.truncation_memory]);
            levels(part, &run.estimate, envelopes, truncation)
        };
        for grid in &self.grids {
            rows.extend(of_run("time", &grid.run, &grid.envelopes));
        }
        if let Some(horizons) = &self.horizons {
            rows.extend(of_run("horizon", &horizons.run, &horizons.envelopes));
        }
        for perturbation in &self.perturbations {
            let part = format!("{}-{:e}", perturbation.shape.name(), perturbation.size);
            rows.extend(levels(&part, &perturbation.estimate, &perturbation.envelopes, None));
        }
        table::csv(rows, true)
    }
}

fn levels(
    part: &str,
    estimate: &Estimate,
    envelopes: &Envelopes,
    truncation: Option<[&Vec<f64>; 2]>,
) -> Vec<[(&'static str, String); 15]> {
    let grid = &estimate.grid;
    let number = |value: f64| format!("{value:e}");
    let level = |n: usize| {
        let at_n = |values: Option<&Vec<f64>>| values.map_or_else(String::new, |v| number(v[n]));
        [
            ("part", part.to_string()),
            ("steps", grid.steps().to_string()),
            ("k", number(grid.largest_step())),
            ("n", n.to_string()),
            ("t", number(grid.time(n))),
            ("error", number(estimate.error[n])),
            ("g_zeta", at_n(truncation.map(|[zeta, _]| zeta))),
            ("g_memory", at_n(truncation.map(|[_, memory]| memory))),
            ("source", number(estimate.source[n])),
            ("weighted", number(envelopes.weighted[n])),
            ("primed", number(envelopes.primed[n])),
            ("closed", number(envelopes.closed[n])),
            ("limit", number(envelopes.limit[n])),
            ("printed", at_n(envelopes.printed.as_ref())),
            ("printed_closed", at_n(envelopes.printed_closed.as_ref())),
        ]
    };
    (0..=grid.steps()).map(level).collect()
}
