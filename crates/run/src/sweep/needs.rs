//! What the cases of a sweep ask of the machine, and which of them ask for more than there is.

use super::cost::{predict, predict_abstract, predict_some, run_cost};
use super::memory_limit::{MemoryLimit, TooLarge};
use super::plan::{CasePlan, ScenePlan, without_panic};
use fem::contact::Discretization;
use scene::ContactScene;
use scene::setup::{AbstractSetup, Setup, SetupError, Subject, side_numbers, trace_levels};

/// What one run is predicted to take.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Need {
    /// CPU seconds.
    pub seconds: f64,
    /// Peak memory.
    pub bytes: f64,
    /// What stays of it for others.
    pub kept: f64,
}

/// What one case takes in a process of its own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Demand {
    /// Seconds without a reference run; bytes with it.
    pub need: Need,
    /// Of the seconds those for loads and moments of the truth, which cases with the same mesh and times share.
    pub truth_seconds: f64,
    /// Of what is kept that which a mesh has once, whatever the times.
    pub kept_once: f64,
}

/// What the cases of a plan take when each of them runs in a process of its own.
#[derive(Default)]
pub struct Demands {
    /// CPU seconds of the reference run, which every such process repeats; zero without one.
    pub reference_seconds: f64,
    /// One a case, in the plan's order.
    pub cases: Vec<Demand>,
}

/// What the cases of `plan` take in processes of their own, on whatever machine: nothing is refused for its size.
///
/// # Errors
/// [`SetupError::Mesh`]: the meshes are made and analysed, one at a time.
pub fn demands(plan: &ScenePlan) -> Result<Demands, SetupError> {
    match &plan.subject {
        Subject::Contact(setup) => {
            let costs = predict(setup, plan)?;
            let demand = |cost: &super::Cost| {
                let [seconds, truth_seconds] = cost.alone;
                let need = Need { seconds, bytes: cost.memory_bytes, kept: cost.kept_bytes };
                Demand { need, truth_seconds, kept_once: cost.kept_once }
            };
            Ok(Demands {
                reference_seconds: costs.reference.map_or(0.0, |cost| cost.seconds),
                cases: costs.cases.iter().map(demand).collect(),
            })
        }
        Subject::Abstract(setup) => {
            let demand = |case| Demand { need: abstract_need(setup, case), ..Demand::default() };
            let cases = plan.cases.iter().map(demand).collect();
            Ok(Demands { reference_seconds: 0.0, cases })
        }
    }
}

/// What a plan takes: the reference run, and some of its cases in their order. An error is the reason of a refusal.
pub(super) struct Needs {
    pub(super) reference: Option<Result<Need, TooLarge>>,
    pub(super) cases: Vec<Result<Need, TooLarge>>,
}

/// Cells a unit length, in the plane and in space, of the mesh by which others are judged before they are made.
const COARSE: [u32; 2] = [16, 8];
/// A mesh with no more cells is made in a moment.
const MOMENT: [f64; 2] = [8_192.0, 196_608.0];
/// Bytes a cell, where the coarsest mesh of all has more than that: less than its matrices take without a factor.
const CELL: f64 = 400.0;
/// The part of the bytes a coarse mesh would take, scaled by the number of cells, that a finer one surely takes: its
/// factor is the larger one, but large boxes have multigrid in place of a factor.
const SURELY: f64 = 0.5;

/// The needs of `cases` of `plan`, computed before any of them begins.
pub(super) fn needs(plan: &ScenePlan, cases: &[CasePlan], limit: &MemoryLimit) -> Needs {
    let setup = match &plan.subject {
        Subject::Contact(setup) => setup,
        Subject::Abstract(setup) => {
            let need = |case: &CasePlan| {
                let need = abstract_need(setup, case);
                limit.admit(need.bytes, false).map(|()| need)
            };
            return Needs { reference: None, cases: cases.iter().map(need).collect() };
        }
    };
    // A mesh that would not fit is not made.
    let early = |n: u32, steps: u32| limit.admit(least_bytes(setup, n, steps), true);
    let reference = plan.reference.filter(|_| !plan.subject.has_exact());
    let too_large = reference.and_then(|own| early(own.n as u32, own.steps as u32).err());
    if let Some(reason) = too_large {
        let cases = cases.iter().map(|_| Err(reason.clone())).collect();
        return Needs { reference: Some(Err(reason)), cases };
    }
    let first = |case: &CasePlan| early(case.n.unwrap_or_default(), case.steps);
    let refused: Vec<Option<TooLarge>> = cases.iter().map(|case| first(case).err()).collect();
    let open = cases.iter().zip(&refused).filter(|(_, refused)| refused.is_none());
    let open: Vec<CasePlan> = open.map(|(case, _)| case.clone()).collect();
    let predicted = without_panic(|| {
        predict_some(setup, plan, &open, reference).map_err(|error| error.to_string())
    });
    let Ok(predicted) = predicted else {
        // What is wrong with a mesh is said by the case that makes it.
        let any = || Ok(Need::default());
        let cases = refused.into_iter().map(|refused| refused.map_or_else(any, Err)).collect();
        return Needs { reference: reference.map(|_| any()), cases };
    };
    // Alone a case finds nothing on its mesh; in its turn, what longer ones have left.
    let need = |cost: &super::Cost| {
        let (seconds, left) = (cost.seconds, cost.left_bytes);
        let (bytes, kept) = (cost.memory_bytes + left, cost.kept_bytes + left);
        limit.admit(cost.memory_bytes, false).map(|()| Need { seconds, bytes, kept })
    };
    let reference = predicted.reference.as_ref().map(need);
    let mut open = predicted.cases.iter().map(need);
    let cases = refused.into_iter().map(|refused| match refused {
        Some(reason) => Err(reason),
        None => open.next().unwrap_or(Ok(Need::default())),
    });
    Needs { reference, cases: cases.collect() }
}

/// Refuses a single run, without measuring of errors, that would take more than the limit: before the mesh is made
/// if that is clear by then.
///
/// # Errors
/// [`TooLarge`].
pub fn admit_run(
    setup: &Setup,
    space: Option<&Discretization>,
    (n, steps): (u32, u32),
    limit: &MemoryLimit,
) -> Result<(), TooLarge> {
    match space {
        None => limit.admit(least_bytes(setup, n, steps), true),
        Some(space) => limit.admit(run_cost(setup, space, n, steps).memory_bytes, false),
    }
}

/// A lower bound for the bytes of a run on the mesh n: those on a coarse mesh times the ratio of cells, and less.
fn least_bytes(setup: &Setup, n: u32, steps: u32) -> f64 {
    let (domain, place) = (&setup.body.domain, usize::from(setup.scene.dimension == 3));
    let cells = domain.cells(n);
    if cells <= MOMENT[place] {
        return 0.0;
    }
    let known = |&m: &u32| domain.cells(m) <= MOMENT[place] && setup.scene.check_cells(m).is_ok();
    let Some(coarse) = (1..=COARSE[place]).rev().find(known) else { return CELL * cells };
    let bytes = || -> Result<f64, SetupError> {
        let space = setup.space(coarse)?;
        Ok(super::cost::march_bytes(setup, &space, coarse, steps))
    };
    // A coarse mesh that cannot be made says nothing of a finer one.
    SURELY * cells / domain.cells(coarse) * bytes().unwrap_or(0.0)
}

/// Bytes of the trace constants that a scene is judged by, before its model is made: a lower bound of them if they are
/// above the limit by that.
pub(super) fn constants_bytes(body: &ContactScene, limit: &MemoryLimit) -> Result<f64, TooLarge> {
    let domain = &body.domain;
    let Some(&finest) = trace_levels(domain).last() else { return Ok(0.0) };
    let cells = domain.cells(finest);
    // Of small meshes as of small runs.
    if cells <= MOMENT[0] {
        return Ok(0.0);
    }
    limit.admit(CELL * cells, true)?;
    let sides = [&domain.clamped, &domain.contact].map(|sides| side_numbers(sides));
    // What is wrong with a mesh is said by what makes it.
    let space = Discretization::new(domain.mesh(finest), &sides[0], &sides[1]);
    Ok(space.map_or(0.0, |space| super::cost::eigenvalue_bytes(&space)))
}

/// An abstract problem keeps all of its states, and a kernel value for each pair of times is computed, not kept.
fn abstract_need(setup: &AbstractSetup, case: &CasePlan) -> Need {
    let states = 4.0 * (f64::from(case.steps) + 1.0);
    let bytes = super::cost::PROGRAM + 8.0 * states * setup.model.dimension() as f64;
    Need { seconds: predict_abstract(setup, case.steps), bytes, kept: 0.0 }
}
