//! Refinement sweeps: the cases, their order and parallel execution, and their records.

mod abstract_case;
mod admission;
mod case;
mod circumstances;
mod cost;
mod floors;
mod judging;
mod memory_limit;
mod needs;
mod output;
mod plan;
mod planned;
mod provenance;
mod reference_error;
mod resume;
mod run;
mod schedule;
mod shared;

pub use abstract_case::{run_abstract_case, run_abstract_under};
pub use admission::{Beside, Refused, Runs, admit_constants, admit_plan};
pub use case::{as_floors, floor_in, run_contact_case, scene_reference};
pub use circumstances::{Build, Circumstances};
pub use cost::{Cost, PlanCost, RunCost, kept_by_meshes, run_cost};
pub use floors::{
    FloorPart, FloorRow, NORMS, abstract_floors, contact_floors, direct_history, floors_beside,
};
pub use judging::{foresee, foresee_plan, judge_plan, judge_scene, judge_subject};
pub use memory_limit::{MemoryLimit, TooLarge};
pub use needs::admit_run;
pub use output::{OutputDirectory, OutputError};
pub use plan::{CasePlan, Overrides, ScenePlan, lowest_common_multiple, without_panic};
pub(crate) use planned::is_complete;
pub use planned::{Block, blocks, missing_cases, planned};
pub use provenance::Provenance;
pub use reference_error::{reference_error, reference_in_words};
pub(crate) use resume::first_named;
pub use resume::{ResumeError, Resumed, resume};
pub use run::{Machine, Progress, SweepError, replace_records, run_more, run_sweep};
