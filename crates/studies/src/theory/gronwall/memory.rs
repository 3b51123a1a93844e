//! What the study of a body takes of the memory.

use super::horizon::whole_steps;
use super::study::StudyRuns;
use super::truth::REFERENCE_STEPS;
use fem::contact::Discretization;
use run::sweep::{Runs, lowest_common_multiple};
use scene::setup::Setup;

/// Nodal vectors of a level that the perturbations hold: f, δf in two sizes, f + δf, and u of f and of f + δf.
const PERTURBED: f64 = 6.0;

/// The runs of a study of `setup` on the mesh n. Whether u(t) lies in V^h is known on the mesh alone: unless the scene
/// says so, the truth counts as a run with more steps.
pub fn study_runs<'a>(setup: &'a Setup, n: u32, plan: &StudyRuns) -> Runs<'a> {
    let finest = plan.steps.iter().copied().max().unwrap_or(1);
    let common = plan.steps.iter().copied().fold(1, lowest_common_multiple);
    let k = setup.scene.time.horizon / f64::from(finest);
    // Horizons that cannot be are refused by the study.
    let longest = plan.horizons.iter().filter_map(|&horizon| whole_steps(horizon, k).ok()).max();
    let in_space = setup.body.data.is_interpolated();
    let finer = |steps: u32| if in_space { steps } else { REFERENCE_STEPS.saturating_mul(steps) };
    let grid = [Some(common), longest].into_iter().flatten().map(|steps| (n, finer(steps)));
    // u and its histories at the levels of the truth, of another with half the steps, and of the grid itself.
    let a_level = 1.0 + setup.body.material.memory.len() as f64;
    let truth = f64::from(common.max(longest.unwrap_or(0))) + 1.0;
    let truth = if in_space { 0.0 } else { 2.0 * truth };
    let of_grid = f64::from(finest.max(longest.unwrap_or(0))) + 1.0;
    let vectors = a_level * (truth + of_grid) + PERTURBED * (f64::from(finest) + 1.0);
    let beside = move |space: &Discretization, _| 8.0 * space.nodes.len() as f64 * vectors;
    Runs { setup, grid: grid.collect(), beside: Box::new(beside) }
}
