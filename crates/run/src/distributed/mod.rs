//! Distributed sweeps: a plan of jobs for an engine, the cases of a job, and the merge of their records, judged like
//! those of one process.

mod bundle;
mod error;
mod merge;
mod missing;
mod names;
mod part;
mod parts;
mod plan;
mod planning;
mod slurm;

pub use bundle::PlannedCases;
pub use error::DistributedError;
pub use merge::{Merged, merge};
pub use missing::unfinished_in_words;
pub use part::{PartRun, failed_in_words, run_part};
pub use parts::Parts;
pub use plan::{CaseRow, JobRow, PlannedScene, SweepPlan, id};
pub use planning::{Engine, Planning};
