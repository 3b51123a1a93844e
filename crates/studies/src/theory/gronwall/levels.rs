//! Every level of a study as a table.

use super::estimate::Judged;
use super::study::Study;
use crate::table;

impl Study {
    /// Every level of every run: `SCENE-gronwall.csv`.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        table::csv(self.judged().flat_map(|(name, _, judged)| levels(&name, judged)))
    }
}

fn levels(
    part: &str,
    Judged { estimate, envelopes, .. }: &Judged,
) -> Vec<[(&'static str, String); 15]> {
    let grid = &estimate.grid;
    let [zeta, memory] = &estimate.truncation;
    let number = |value: f64| format!("{value:e}");
    let level = |n: usize| {
        let at_n = |values: &[f64]| values.get(n).map_or_else(String::new, |value| number(*value));
        let bounds = envelopes.map(|values| at_n(values));
        [
            ("part", part.to_string()),
            ("steps", grid.steps().to_string()),
            ("k", number(grid.largest_step())),
            ("n", n.to_string()),
            ("t", number(grid.time(n))),
            ("error", at_n(&estimate.error)),
            ("g_zeta", at_n(zeta)),
            ("g_memory", at_n(memory)),
            ("source", at_n(&estimate.source)),
            ("weighted", bounds.weighted),
            ("primed", bounds.primed),
            ("closed", bounds.closed),
            ("limit", bounds.limit),
            ("printed", bounds.printed.unwrap_or_default()),
            ("printed_closed", bounds.printed_closed.unwrap_or_default()),
        ]
    };
    (0..=grid.steps()).map(level).collect()
}
