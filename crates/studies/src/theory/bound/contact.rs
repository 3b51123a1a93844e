//! The step-size study of a contact scene.

use super::ladder::BoundError;
use super::linear::linear_loss;
use super::run::{self, ContractionStudy, FactorAtLevel};
use ::run::sweep::Runs;
use algebra::linalg::KRYLOV_VECTORS;
use fem::contact::{Discretization, Evolution};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::{StepBounds, StepState};

/// Runs the scene on the mesh `n` with `steps` steps and studies its worst level.
///
/// # Errors
/// [`BoundError`].
pub fn study(
    setup: &Setup,
    bounds: &StepBounds,
    n: u32,
    steps: u32,
) -> Result<ContractionStudy, BoundError> {
    let levels = levels_of_run(setup, bounds, n, steps)?;
    let mut study = ContractionStudy::of_levels(levels, steps)?;
    let worst = study.worst.level;
    for other in meshes_beside(setup, n) {
        let all = levels_of_run(setup, bounds, other, steps)?;
        study.meshes.extend(all.get(worst - 1));
    }
    let data = MeshData::new(setup, n, None)?;
    study.linear = linear_loss(&data.space, &setup.model)?;
    at_level(setup, &data, steps, worst, |level, state| study.climb(level, state, bounds))?;
    Ok(study)
}

/// The mesh n and its neighbours, as far as the domain has them.
fn meshes_beside(setup: &Setup, n: u32) -> impl Iterator<Item = u32> {
    let fits = |&other: &u32| other > 0 && setup.scene.check_cells(other).is_ok();
    [n / 2, n, 2 * n].into_iter().filter(fits)
}

/// The runs of a study.
pub fn study_runs(setup: &Setup, n: u32, steps: u32) -> Runs<'_> {
    let grid = meshes_beside(setup, n).map(|n| (n, steps)).collect();
    // The factors of the volume's tangent and of the inner product, and the vectors of an eigenvalue.
    let beside = |space: &Discretization, _| {
        8.0 * (2.0 * space.factor_size()[0] + (KRYLOV_VECTORS * space.dofs()) as f64)
    };
    Runs { setup, grid, beside: Box::new(beside) }
}

/// The factor at every level n ≥ 1 of a run.
fn levels_of_run(
    setup: &Setup,
    bounds: &StepBounds,
    n: u32,
    steps: u32,
) -> Result<Vec<FactorAtLevel>, BoundError> {
    let data = MeshData::new(setup, n, None)?;
    on_run(setup, &data, steps, |level| run::all_levels(level, bounds, Some(n)))
}

/// Runs to level `number`, leaves it open, and shows it with its solution.
///
/// # Errors
/// The run's, and those of `see`.
pub fn at_level<T>(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    number: usize,
    see: impl FnOnce(&mut Evolution<'_>, StepState) -> Result<T, BoundError>,
) -> Result<T, BoundError> {
    on_run(setup, data, steps, |level| {
        let state = run::run_to(level, number)?;
        see(level, state)
    })
}

/// Shows a run before its first level.
fn on_run<T>(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    see: impl FnOnce(&mut Evolution<'_>) -> Result<T, BoundError>,
) -> Result<T, BoundError> {
    let grid = setup.grid(steps);
    let mut load = TruthLoad(&*data.truth);
    see(&mut Evolution::new(&data.space, &setup.model, &grid, &mut load)?)
}
