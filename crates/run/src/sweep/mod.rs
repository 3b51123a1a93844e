//! Refinement sweeps: the cases, their order and parallel execution, and their records.

mod admission;
mod case;
mod cost;
mod floors;
mod judging;
mod plan;
mod provenance;
mod run;

pub use admission::{
    Beside, MemoryLimit, Refused, Runs, TooLarge, admit_constants, admit_plan, admit_run,
};
pub use case::{
    as_floors, floor_in, run_abstract_case, run_abstract_under, run_contact_case, scene_reference,
};
pub use cost::{Cost, PlanCost, RunCost, kept_by_meshes, run_cost};
pub use floors::{
    FloorPart, FloorRow, NORMS, abstract_floors, contact_floors, direct_history, floors_beside,
};
pub use judging::{
    foresee, foresee_plan, judge_plan, judge_scene, judge_subject, reference_error,
    reference_in_words,
};
pub use plan::{CasePlan, Overrides, ScenePlan, lowest_common_multiple, without_panic};
pub(crate) use provenance::first_named;
pub use provenance::{
    Build, Circumstances, OutputDirectory, OutputError, Planned, Provenance, Resumed,
    missing_cases, planned, resume,
};
pub use run::{Machine, Progress, SweepError, replace_records, run_sweep};
