//! What other n and N cost, from a run and its companions.

use std::collections::BTreeSet;

use super::{Companions, RunTime};
use crate::trade::{Composition, CostSample};
use run::sweep::run_cost;
use scene::setup::{Setup, SetupError};

/// Least CPU seconds that can be told from noise: page faults and a cold cache take about a millisecond, a tenth of it.
const TIMED: f64 = 0.01;

/// Where predicted seconds come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum CostSource {
    /// The CPU times of the run and its companions.
    #[serde(rename = "times")]
    Timed,
    /// Counts of `sweep explain` with the rates of another machine: the runs are too short for a clock.
    #[serde(rename = "counts")]
    Counted,
}

/// The cost of runs: parts fitted to the CPU times of the companions, or to their counts where one is too short to
/// time. None where nothing fits.
///
/// # Errors
/// A mesh that cannot be made.
pub fn costs(
    setup: &Setup,
    found: &Companions,
) -> Result<Option<(Composition, CostSource)>, SetupError> {
    let sample = |run: &RunTime| CostSample {
        h: setup.body.domain.h(run.n),
        k: setup.grid(run.steps).largest_step(),
        seconds: run.seconds,
    };
    let shortest = found.times.iter().map(|run| run.seconds).fold(f64::INFINITY, f64::min);
    let (runs, source) = match shortest >= TIMED {
        true => (found.times.clone(), CostSource::Timed),
        false => (counted(setup, &found.times)?, CostSource::Counted),
    };
    let samples: Vec<CostSample> = runs.iter().map(sample).collect();
    let (dimension, horizon) = (setup.scene.dimension, setup.scene.time.horizon);
    let fitted = Composition::fit(&samples, dimension, horizon);
    Ok(fitted.map(|composition| (composition, source)))
}

/// Counted costs of all pairs of the n and N that were run.
fn counted(setup: &Setup, times: &[RunTime]) -> Result<Vec<RunTime>, SetupError> {
    let (meshes, numbers): (BTreeSet<u32>, BTreeSet<u32>) =
        times.iter().map(|run| (run.n, run.steps)).unzip();
    let mut found = Vec::new();
    for n in meshes {
        let space = setup.space(n)?;
        for &steps in &numbers {
            found.push(RunTime { n, steps, seconds: run_cost(setup, &space, steps).seconds });
        }
    }
    Ok(found)
}
