//! The files of a plan, below its directory.

/// Scenes, arguments and version of the plan.
pub(super) const PLAN: &str = "plan.json";
/// One row per case: its cost and job.
pub(super) const CASES: &str = "plan.csv";
/// One row per job: its cost and request.
pub(super) const JOBS: &str = "jobs.csv";
