//! Distributed sweeps: a plan of jobs for an engine, the cases of a job, and the merge of their records, judged like
//! those of one process.

mod bundle;
mod comparing;
mod error;
mod merge;
mod missing;
mod part;
mod parts;
mod plan;
mod planning;
mod slurm;
mod sorted;

pub use error::DistributedError;
pub use merge::{Merged, merge};
pub use missing::Missing;
pub use part::{PartRun, failed_in_words, run_part};
pub use parts::Parts;
pub use plan::{CaseRow, JobRow, PlannedScene, SweepPlan, id};
pub use planning::{Engine, PlannedCases, Planning};
pub use sorted::AT_ONCE;

/// Scenes, arguments and version of the plan, below its directory.
const PLAN: &str = "plan.json";
/// One row per case: its cost and job.
const CASES: &str = "plan.csv";
/// One row per job: its cost and request.
const JOBS: &str = "jobs.csv";
