//! What other n and N cost, from a run and its companions.

use std::collections::{BTreeMap, BTreeSet};

use super::{Companions, RunTime};
use crate::trade::{Composition, CostSample};
use scene::setup::{Setup, SetupError};

/// Least CPU seconds that can be told from noise: page faults and a cold cache take about a millisecond, a tenth of it.
const TIMED: f64 = 0.01;

/// Where predicted seconds come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum CostSource {
    /// The CPU times of the run and its companions.
    #[serde(rename = "times")]
    Timed,
    /// Their sum, shared out by unknowns times steps: the runs are too short for a clock.
    #[serde(rename = "counts")]
    Counted,
}

/// The cost of runs: parts fitted to the CPU times of the companions, or to unknowns times steps where one is too short
/// to time. None where nothing fits.
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

/// The times of all pairs of the n and N that were run, as if unknowns times steps took equal times.
fn counted(setup: &Setup, times: &[RunTime]) -> Result<Vec<RunTime>, SetupError> {
    let (meshes, numbers): (BTreeSet<u32>, BTreeSet<u32>) =
        times.iter().map(|run| (run.n, run.steps)).unzip();
    let mut dofs = BTreeMap::new();
    for n in meshes {
        dofs.insert(n, setup.space(n)?.dofs() as f64);
    }
    let work = |n: u32, steps: u32| dofs[&n] * f64::from(steps);
    let all: f64 = times.iter().map(|run| work(run.n, run.steps)).sum();
    // A clock that stands still gives no rate, and any will do.
    let taken = times.iter().map(|run| run.seconds).sum::<f64>().max(f64::MIN_POSITIVE);
    let pairs = dofs.keys().flat_map(|&n| numbers.iter().map(move |&steps| (n, steps)));
    let time = |(n, steps)| RunTime { n, steps, seconds: taken * work(n, steps) / all };
    Ok(pairs.map(time).collect())
}
