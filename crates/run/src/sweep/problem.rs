//! Common interface of scenes with a body and of problems in ℝ^m.

use super::case::run_contact_case;
use super::cost::{Cost, PROGRAM, PlanCost, contact_costs};
use super::floors::{FloorError, FloorRow, contact_floors_of_case};
use super::needs::least_bytes;
use super::plan::CasePlan;
use super::shared::Shared;
use super::{abstract_floors, run_abstract_case};
use fem::contact::{LinearSolver, Plan};
use judge::record::CaseRecord;
use scene::Reference;
use scene::setup::{AbstractSetup, Setup, SetupError, Subject};

/// A computable scene, as a sweep sees it.
pub(crate) trait Problem: Sync {
    /// Predicts cases and a reference run, of which every `kept_steps`-th part of the horizon is kept.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    fn costs(
        &self,
        cases: &[CasePlan],
        reference: Option<Reference>,
        kept_steps: u32,
    ) -> Result<PlanCost, SetupError>;

    /// A lower bound for the bytes of a run, before its mesh is made.
    fn least_bytes(&self, n: Option<u32>, steps: u32) -> f64;

    /// Runs a case, with what the cases of the scene share.
    fn run(&self, case: &CasePlan, shared: &Shared<'_>) -> Result<CaseRecord, String>;

    /// Makes the reference run of the scene, if it has one. Its failure becomes that of each case.
    fn refer(&self, shared: &Shared<'_>);

    /// Measures every part of the floor of a case.
    ///
    /// # Errors
    /// A run that fails.
    fn floors(&self, case: &CasePlan) -> Result<Vec<FloorRow>, FloorError>;
}

pub(crate) fn problem(subject: &Subject) -> &dyn Problem {
    match subject {
        Subject::Contact(setup) => &**setup,
        Subject::Abstract(setup) => &**setup,
    }
}

impl Problem for Setup {
    fn costs(
        &self,
        cases: &[CasePlan],
        reference: Option<Reference>,
        kept_steps: u32,
    ) -> Result<PlanCost, SetupError> {
        contact_costs(self, cases, reference, kept_steps)
    }

    fn least_bytes(&self, n: Option<u32>, steps: u32) -> f64 {
        least_bytes(self, n.unwrap_or_default(), steps)
    }

    fn run(&self, case: &CasePlan, shared: &Shared<'_>) -> Result<CaseRecord, String> {
        let n = case.n.ok_or("a body needs a mesh: no n")?;
        shared.on_mesh(self, n, |data| run_contact_case(self, data, case))
    }

    fn refer(&self, shared: &Shared<'_>) {
        let _ = shared.reference(self);
    }

    fn floors(&self, case: &CasePlan) -> Result<Vec<FloorRow>, FloorError> {
        contact_floors_of_case(self, case)
    }
}

/// Seconds per level of an abstract scene, and per pair of levels and kernel in its direct sums.
const LEVEL: [f64; 2] = [2e-4, 5e-8];

impl Problem for AbstractSetup {
    fn costs(
        &self,
        cases: &[CasePlan],
        _: Option<Reference>,
        _: u32,
    ) -> Result<PlanCost, SetupError> {
        let dofs = self.model.dimension();
        let kernels = self.problem.kernels.len() as f64;
        let cost = |case: &CasePlan| {
            let levels = f64::from(case.steps) + 1.0;
            Cost {
                dofs,
                plan: Plan::Newton,
                linear_solver: LinearSolver::Direct,
                work: None,
                seconds: LEVEL[0] * levels + LEVEL[1] * levels * levels * kernels,
                // All states are kept; a kernel value is computed for each pair of times.
                memory_bytes: PROGRAM + 8.0 * 4.0 * levels * dofs as f64,
                kept_bytes: 0.0,
                left_bytes: 0.0,
            }
        };
        Ok(PlanCost { cases: cases.iter().map(cost).collect(), reference: None })
    }

    fn least_bytes(&self, _: Option<u32>, _: u32) -> f64 {
        0.0
    }

    fn run(&self, case: &CasePlan, _: &Shared<'_>) -> Result<CaseRecord, String> {
        Ok(run_abstract_case(self, case))
    }

    fn refer(&self, _: &Shared<'_>) {}

    fn floors(&self, case: &CasePlan) -> Result<Vec<FloorRow>, FloorError> {
        Ok(abstract_floors(self, case.steps)?)
    }
}
