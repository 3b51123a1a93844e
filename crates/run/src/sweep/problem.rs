//! What a sweep asks of scenes with a body and of problems in ℝ^m.

use super::case::run_contact_case;
use super::cost::{Cost, PROGRAM, PlanCost, contact_costs};
use super::floors::{FloorError, FloorRow, contact_floors_of_case};
use super::needs::least_bytes_of_mesh;
use super::plan::CasePlan;
use super::shared::Shared;
use super::{abstract_floors, run_abstract_case};
use judge::record::CaseRecord;
use scene::Reference;
use scene::setup::{AbstractSetup, SetupError, Subject};

/// Predicts cases and a reference run, of which every `kept_steps`-th part of the horizon is kept.
///
/// # Errors
/// A cell that the boundary of a region cuts.
pub(super) fn costs(
    subject: &Subject,
    cases: &[CasePlan],
    reference: Option<Reference>,
    kept_steps: u32,
) -> Result<PlanCost, SetupError> {
    match subject {
        Subject::Contact(setup) => contact_costs(setup, cases, reference, kept_steps),
        Subject::Abstract(setup) => Ok(abstract_costs(setup, cases)),
    }
}

/// Seconds per level of an abstract scene, and per pair of levels and kernel in its direct sums.
const LEVEL: [f64; 2] = [2e-4, 5e-8];

fn abstract_costs(setup: &AbstractSetup, cases: &[CasePlan]) -> PlanCost {
    let dofs = setup.model.dimension();
    let kernels = setup.problem.kernels.len() as f64;
    let cost = |case: &CasePlan| {
        let levels = f64::from(case.steps) + 1.0;
        Cost {
            dofs,
            seconds: LEVEL[0] * levels + LEVEL[1] * levels * levels * kernels,
            // All states are kept; a kernel value is computed for each pair of times.
            memory_bytes: PROGRAM + 8.0 * 4.0 * levels * dofs as f64,
            ..Cost::UNKNOWN
        }
    };
    PlanCost { cases: cases.iter().map(cost).collect(), reference: None }
}

/// A lower bound for the bytes of a run, before its mesh is made.
pub(super) fn least_bytes(subject: &Subject, n: Option<u32>, steps: u32) -> f64 {
    match subject {
        Subject::Contact(setup) => least_bytes_of_mesh(setup, n.unwrap_or_default(), steps),
        Subject::Abstract(_) => 0.0,
    }
}

/// Runs a case, with what the cases of the scene share.
pub(super) fn run(
    subject: &Subject,
    case: &CasePlan,
    shared: &Shared<'_>,
) -> Result<CaseRecord, String> {
    match subject {
        Subject::Contact(setup) => {
            let n = case.n.ok_or("a body needs a mesh: no n")?;
            shared.on_mesh(setup, n, |data| run_contact_case(setup, data, case))
        }
        Subject::Abstract(setup) => Ok(run_abstract_case(setup, case)),
    }
}

/// Measures every part of the floor of a case.
///
/// # Errors
/// A run that fails.
pub(super) fn floors(subject: &Subject, case: &CasePlan) -> Result<Vec<FloorRow>, FloorError> {
    match subject {
        Subject::Contact(setup) => contact_floors_of_case(setup, case),
        Subject::Abstract(setup) => Ok(abstract_floors(setup, case.steps)?),
    }
}
