//! Memory needs of the cases of a sweep, and refusal of those that exceed the limit.

use super::cost::{Cost, PlanCost, run_cost};
use super::memory_limit::{MemoryLimit, TooLarge};
use super::plan::{CasePlan, ScenePlan, without_panic};
use fem::contact::Discretization;
use scene::ContactScene;
use scene::setup::{Setup, SetupError, trace_cells};

/// Costs of the reference run of a plan, and of some of its cases in order or why they are refused: all of them, if the
/// reference run is too large, which each counts as its own.
pub(super) type Needs = (Option<Cost>, Vec<Result<Cost, TooLarge>>);

/// Cells per unit length, in the plane and in space, of the coarse mesh for estimates.
const COARSE: [u32; 2] = [16, 8];
/// Meshes with at most so many cells are made at once.
const MOMENT: [f64; 2] = [8_192.0, 196_608.0];
/// Bytes per cell if even the coarsest mesh has more cells than that: less than its matrices take without a factor.
const CELL: f64 = 400.0;
/// Share of the bytes of a coarse mesh, scaled by the number of cells, that is a lower bound: factors grow faster.
const SURELY: f64 = 0.5;

/// The needs of `cases` of `plan`, computed before any of them begins.
pub(super) fn needs(plan: &ScenePlan, cases: &[CasePlan], limit: &MemoryLimit) -> Needs {
    // A mesh that would not fit is not made.
    let early = |n: Option<u32>, steps: u32| limit.admit(plan.least_bytes(n, steps), true);
    let too_large = plan.reference.and_then(|run| early(Some(run.n), run.steps).err());
    if let Some(reason) = too_large {
        return (None, vec![Err(reason); cases.len()]);
    }
    let refused: Vec<Option<TooLarge>> =
        cases.iter().map(|case| early(case.n, case.steps).err()).collect();
    let open = cases.iter().zip(&refused).filter(|(_, refused)| refused.is_none());
    let open: Vec<CasePlan> = open.map(|(case, _)| case.clone()).collect();
    let predicted = without_panic(|| plan.costs_of(&open).map_err(|error| error.to_string()));
    // The case that makes the mesh reports its errors.
    let PlanCost { cases: costs, reference } = predicted.unwrap_or_else(|_| PlanCost {
        cases: vec![Cost::UNKNOWN; open.len()],
        reference: plan.reference.map(|_| Cost::UNKNOWN),
    });
    // Alone a case finds nothing on its mesh; in its turn, what longer ones have left.
    let need = |cost: &Cost| {
        let memory_bytes = cost.memory_bytes + cost.left_bytes;
        let kept_bytes = cost.kept_bytes + cost.left_bytes;
        limit.admit(cost.memory_bytes, false).map(|()| Cost { memory_bytes, kept_bytes, ..*cost })
    };
    let mut open = costs.iter().map(need);
    let cases = refused.into_iter().map(|refused| match refused {
        Some(reason) => Err(reason),
        None => open.next().unwrap_or(Ok(Cost::UNKNOWN)),
    });
    (reference, cases.collect())
}

/// Refuses a single run, without measuring errors, that would exceed the limit; if possible before the mesh is made.
/// [`TooLarge`].
pub fn admit_run(
    setup: &Setup,
    space: Option<&Discretization>,
    (n, steps): (u32, u32),
    limit: &MemoryLimit,
) -> Result<(), TooLarge> {
    match space {
        None => limit.admit(least_bytes_of_mesh(setup, n, steps), true),
        Some(space) => limit.admit(run_cost(setup, space, steps).memory_bytes, false),
    }
}

/// A lower bound for the bytes of a run on mesh n: those on a coarse mesh times the ratio of cells, reduced.
pub(super) fn least_bytes_of_mesh(setup: &Setup, n: u32, steps: u32) -> f64 {
    let (domain, place) = (&setup.body.domain, usize::from(setup.scene.dimension == 3));
    let cells = domain.cells(n);
    if cells <= MOMENT[place] {
        return 0.0;
    }
    let known = |&m: &u32| domain.cells(m) <= MOMENT[place] && setup.scene.check_cells(m).is_ok();
    let Some(coarse) = (1..=COARSE[place]).rev().find(known) else { return CELL * cells };
    let bytes = || -> Result<f64, SetupError> {
        let space = setup.space(coarse)?;
        Ok(run_cost(setup, &space, steps).march_bytes)
    };
    // If the coarse mesh cannot be made there is no bound.
    SURELY * cells / domain.cells(coarse) * bytes().unwrap_or(0.0)
}

/// Refuses a scene on so many simplices that not even the matrices of its trace constants fit, before its model is made.
pub(super) fn constants_fit(body: &ContactScene, limit: &MemoryLimit) -> Result<(), TooLarge> {
    let cells = trace_cells(&body.domain);
    // Small meshes are made at once, as for runs.
    if cells <= MOMENT[1] { Ok(()) } else { limit.admit(CELL * cells, true) }
}
