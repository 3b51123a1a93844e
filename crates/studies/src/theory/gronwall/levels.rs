//! Every level of a study as a table.

use super::estimate::{Envelopes, Estimate};
use super::study::Study;

impl Study {
    /// Every level of every run: `SCENE-gronwall.csv`.
    ///
    /// # Errors
    /// The writer's.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record([
            "part",
            "steps",
            "k",
            "n",
            "t",
            "error",
            "g_zeta",
            "g_memory",
            "source",
            "weighted",
            "primed",
            "closed",
            "limit",
            "printed",
            "printed_closed",
        ])?;
        for grid in &self.grids {
            let run = &grid.run;
            let truncation = Some([run.truncation_zeta.as_slice(), &run.truncation_memory]);
            rows(&mut writer, "time", &run.estimate, &grid.envelopes, truncation)?;
        }
        if let Some(horizons) = &self.horizons {
            let run = &horizons.run;
            let truncation = Some([run.truncation_zeta.as_slice(), &run.truncation_memory]);
            rows(&mut writer, "horizon", &run.estimate, &horizons.envelopes, truncation)?;
        }
        for perturbation in &self.perturbations {
            let part = format!("{}-{:e}", perturbation.shape.name(), perturbation.size);
            rows(&mut writer, &part, &perturbation.estimate, &perturbation.envelopes, None)?;
        }
        writer.into_inner().map_err(|error| error.into_error().into())
    }
}

fn rows(
    writer: &mut csv::Writer<Vec<u8>>,
    part: &str,
    estimate: &Estimate,
    envelopes: &Envelopes,
    truncation: Option<[&[f64]; 2]>,
) -> Result<(), csv::Error> {
    let grid = &estimate.grid;
    let number = |value: f64| format!("{value:e}");
    for n in 0..=grid.steps() {
        let printed = |values: &Option<Vec<f64>>| {
            values.as_ref().map_or_else(String::new, |values| number(values[n]))
        };
        let truncated =
            |index: usize| truncation.map_or_else(String::new, |all| number(all[index][n]));
        writer.write_record([
            part.to_string(),
            grid.steps().to_string(),
            number(grid.largest_step()),
            n.to_string(),
            number(grid.time(n)),
            number(estimate.error[n]),
            truncated(0),
            truncated(1),
            number(estimate.source[n]),
            number(envelopes.weighted[n]),
            number(envelopes.primed[n]),
            number(envelopes.closed[n]),
            number(envelopes.limit[n]),
            printed(&envelopes.printed),
            printed(&envelopes.printed_closed),
        ])?;
    }
    Ok(())
}
