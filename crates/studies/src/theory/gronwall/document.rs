//! A study as JSON and as a table of all levels.

use serde_json::{Value, json};

use super::estimate::{Envelopes, Estimate, maximum};
use super::horizon::Horizons;
use super::stability::Perturbation;
use super::study::{StudiedGrid, Study};

impl Study {
    /// The study without its curves, which the table of all levels holds.
    pub fn json(&self) -> Value {
        let violations: Vec<Value> = self
            .violations()
            .into_iter()
            .map(|(part, violation)| {
                let mut value = json!(violation);
                value["part"] = part.into();
                value
            })
            .collect();
        json!({
            "scene": self.scene,
            "n": self.plan.n,
            "truth": self.truth,
            "constants": self.constants_json(),
            "grids": self.grids.iter().map(grid).collect::<Vec<_>>(),
            "horizons": self.horizons.as_ref().map(horizons),
            "perturbations": self.perturbations.iter().map(perturbation).collect::<Vec<_>>(),
            "violations": violations,
            "verdict": if violations.is_empty() { "pass" } else { "fail" },
        })
    }

    fn constants_json(&self) -> Value {
        let c = &self.constants;
        let mut value = json!({
            "m0": c.m0,
            "beta_phi": c.beta,
            "lipschitz": c.lipschitz,
            "C1": c.c1(),
            "C2": c.c2(),
        });
        for (name, number) in &c.details {
            value[*name] = json!(number);
        }
        value
    }

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
        for own in &self.grids {
            let run = &own.run;
            let truncation = Some([run.truncation_zeta.as_slice(), &run.truncation_memory]);
            rows(&mut writer, "time", &run.estimate, &own.envelopes, truncation)?;
        }
        if let Some(horizons) = &self.horizons {
            let run = &horizons.run;
            let truncation = Some([run.truncation_zeta.as_slice(), &run.truncation_memory]);
            rows(&mut writer, "horizon", &run.estimate, &horizons.envelopes, truncation)?;
        }
        for own in &self.perturbations {
            let part = format!("{}-{:e}", own.shape.name(), own.size);
            rows(&mut writer, &part, &own.estimate, &own.envelopes, None)?;
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
        let own = |index: usize| truncation.map_or_else(String::new, |all| number(all[index][n]));
        writer.write_record([
            part.to_string(),
            grid.steps().to_string(),
            number(grid.largest_step()),
            n.to_string(),
            number(grid.time(n)),
            number(estimate.error[n]),
            own(0),
            own(1),
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

fn grid(own: &StudiedGrid) -> Value {
    let estimate = &own.run.estimate;
    let envelopes = &own.envelopes;
    let effectivity = |bound: &[f64]| json!(own.effectivity(bound));
    json!({
        "steps": own.run.steps,
        "k": estimate.grid.largest_step(),
        "C2_k": estimate.c2() * estimate.grid.largest_step(),
        "error_end": estimate.error.last(),
        "error_max": maximum(&estimate.error),
        "truncation_end": own.run.truncation().last(),
        "truncation_max": maximum(&own.run.truncation()),
        "floor": estimate.floor,
        "effectivity": {
            "weighted": effectivity(&envelopes.weighted),
            "primed": effectivity(&envelopes.primed),
            "closed": effectivity(&envelopes.closed),
            "limit": effectivity(&envelopes.limit),
            "printed": envelopes.printed.as_deref().map(effectivity),
            "printed_closed": envelopes.printed_closed.as_deref().map(effectivity),
        },
    })
}

fn horizons(own: &Horizons) -> Value {
    json!({ "k": own.k, "truth": own.truth, "rows": own.rows })
}

fn perturbation(own: &Perturbation) -> Value {
    json!({
        "shape": own.shape.name(),
        "size": own.size,
        "steps": own.estimate.grid.steps(),
        "load": own.load,
        "difference": maximum(&own.estimate.error),
        "growth": own.growth(),
        "weighted": maximum(&own.envelopes.weighted),
        "primed": maximum(&own.envelopes.primed),
        "least_effectivity": own.least_effectivity(),
    })
}
