//! Data shared by the cases of one scene: its reference run, and a mesh with its exact solution for each n.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::plan::{CasePlan, ScenePlan, without_panic};
use super::{run_abstract_case, run_contact_case};
use fem::norms::ReferenceRun;
use judge::record::CaseRecord;
use scene::setup::{MeshData, Setup, Subject, reference_run};

/// Made at first use, dropped after the last one.
type Slot<T> = Mutex<Arc<OnceLock<Result<T, String>>>>;

pub(crate) struct Shared<'a> {
    pub(super) plan: &'a ScenePlan,
    reference: Slot<Arc<ReferenceRun>>,
    meshes: Vec<(u32, Slot<MeshData>)>,
}

impl<'a> Shared<'a> {
    pub(super) fn new(plan: &'a ScenePlan) -> Self {
        let ns: BTreeSet<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
        let meshes = ns.into_iter().map(|n| (n, Slot::default())).collect();
        Self { plan, reference: Slot::default(), meshes }
    }

    pub(super) fn record(&self, case: &CasePlan) -> CaseRecord {
        self.plan.record(case, || match &self.plan.subject {
            Subject::Abstract(setup) => Ok(run_abstract_case(setup, case)),
            Subject::Contact(setup) => {
                let n = case.n.ok_or("a body needs a mesh, but n is missing")?;
                self.on_mesh(setup, n, |data| run_contact_case(setup, data, case))
            }
        })
    }

    pub(super) fn reference(&self, setup: &Setup) -> Result<Arc<ReferenceRun>, String> {
        let run = || {
            let Some(reference) = self.plan.reference else {
                return Err("the scene has neither an exact solution nor a reference".into());
            };
            let every = (reference.steps / self.plan.kept_steps()).max(1);
            without_panic(|| {
                reference_run(setup, reference.n, reference.steps, every)
                    .map(Arc::new)
                    .map_err(|error| error.to_string())
            })
        };
        content(&self.reference).get_or_init(run).clone()
    }

    /// Applies `run` to mesh n with its exact solution.
    pub(super) fn on_mesh<T>(
        &self,
        setup: &Setup,
        n: u32,
        run: impl FnOnce(&MeshData) -> T,
    ) -> Result<T, String> {
        let Some((_, slot)) = self.meshes.iter().find(|(mesh, _)| *mesh == n) else {
            return Err(format!("no mesh n = {n} in the plan"));
        };
        let cell = content(slot);
        let data = cell.get_or_init(|| {
            let reference = match setup.exact {
                Some(_) => None,
                None => Some(self.reference(setup)?),
            };
            MeshData::new(setup, n, reference).map_err(|error| error.to_string())
        });
        data.as_ref().map(run).map_err(Clone::clone)
    }

    /// Drops mesh n, or the reference run.
    pub(super) fn let_go(&self, n: Option<u32>) {
        match n {
            None => empty(&self.reference),
            Some(n) => {
                self.meshes.iter().filter(|(mesh, _)| *mesh == n).for_each(|(_, slot)| empty(slot))
            }
        }
    }
}

/// The present content of a slot, made or not.
fn content<T>(slot: &Slot<T>) -> Arc<OnceLock<Result<T, String>>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

fn empty<T>(slot: &Slot<T>) {
    *slot.lock().unwrap_or_else(PoisonError::into_inner) = Arc::default();
}
