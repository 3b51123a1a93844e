//! From scenes to a plan: predicted costs, jobs with their requests, and the files that an engine reads.

use std::path::Path;

use super::bundle::{Job, PlannedCases, bundle};
use super::error::DistributedError;
use super::names::PLAN;
use super::plan::{CaseRow, JobRow, SweepPlan, id};
use super::slurm;
use crate::sweep::Overrides;
use files::{make_directory, replace_file};

/// What runs the jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// By a `Snakefile`.
    Snakemake,
    /// By job arrays.
    Slurm,
    /// Any other reader of the tables.
    Tables,
}

/// The jobs of a plan, and the plan itself.
pub struct Planning {
    pub plan: SweepPlan,
    /// One row per job, the longest first.
    pub jobs: Vec<JobRow>,
    /// Longest job first, and in it the longest case.
    cases: Vec<CaseRow>,
}

impl Planning {
    /// Bundles the cases of `scenes` into jobs of about `seconds`.
    pub fn new(scenes: Vec<PlannedCases>, overrides: Overrides, seconds: f64) -> Self {
        let bundles = bundle(&scenes, seconds);
        let jobs: Vec<JobRow> =
            bundles.iter().enumerate().map(|(number, job)| request(number, job)).collect();
        let row = |job: usize, (s, c): (usize, usize)| {
            let (key, cost) = (&scenes[s].cases[c], &scenes[s].costs.cases[c]);
            CaseRow {
                id: id(key),
                scene: key.scene.clone(),
                n: key.n,
                steps: key.steps,
                seconds: cost.seconds,
                bytes: cost.memory_bytes,
                job,
            }
        };
        let of_job = |(number, job): (usize, &Job)| {
            job.cases.iter().map(|&case| row(number, case)).collect::<Vec<CaseRow>>()
        };
        let cases: Vec<CaseRow> = bundles.iter().enumerate().flat_map(of_job).collect();
        let plan = SweepPlan {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            overrides,
            bundle_seconds: seconds,
            cases: cases.len(),
            jobs: jobs.len(),
            scenes: scenes.into_iter().map(|planned| planned.scene).collect(),
        };
        Self { plan, jobs, cases }
    }

    /// Writes the plan for an engine into `dir`. Repeating it with the same plan changes only the engine's files.
    pub fn write(&self, dir: &Path, engine: Engine) -> Result<(), DistributedError> {
        make_directory(dir)?;
        if dir.join(PLAN).exists() && SweepPlan::read(dir)? != self.plan {
            return Err(DistributedError::OtherPlan { path: dir.join(PLAN) });
        }
        let put = |name: &str, text: &str| replace_file(&dir.join(name), text.as_bytes());
        match engine {
            Engine::Snakemake => put("Snakefile", include_str!("workflow/Snakefile"))?,
            Engine::Slurm => {
                let arrays = slurm::arrays(&self.jobs);
                make_directory(&dir.join("arrays"))?;
                for array in &arrays {
                    let lines: String = array.jobs.iter().map(|job| format!("{job}\n")).collect();
                    put(&array.file, &lines)?;
                }
                put("array.sh", slurm::ARRAY)?;
                put("submit.sh", &slurm::submit(&arrays))?;
            }
            Engine::Tables => {}
        }
        if !dir.join(PLAN).exists() {
            self.plan.write(dir, &self.cases, &self.jobs)?;
        }
        Ok(())
    }
}

/// Measured over predicted memory is at most 1/0.67 (docs/HOW-WE-KNOW.md), and the plan with its texts is held as well.
const MEMORY: f64 = 1.5;
const BESIDE: f64 = 64.0 * MEBIBYTE;
/// Predicted seconds are coarse (`sweep/cost.rs`), and another machine may be half as fast. The minute is for the start
/// of the process and reading over a network.
const TIME: f64 = 4.0;
const START: f64 = 60.0;

const MEBIBYTE: f64 = 1_048_576.0;
/// Granularity of requests in MB: schedulers group jobs of equal size.
const STEP: f64 = 64.0;

/// The row of a job. Its request has a margin, since a job that exceeds it is killed.
fn request(number: usize, job: &Job) -> JobRow {
    let mem_mb = (MEMORY * job.bytes + BESIDE) / MEBIBYTE;
    let minutes = (TIME * job.seconds + START) / 60.0;
    JobRow {
        job: number,
        cases: job.cases.len(),
        seconds: job.seconds,
        bytes: job.bytes,
        mem_mb: (STEP * (mem_mb / STEP).ceil()) as u64,
        runtime: minutes.ceil() as u64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_above_predictions_and_in_whole_units() {
        let job = Job { cases: vec![(0, 0)], seconds: 600.0, bytes: 1e9 };
        let row = request(3, &job);
        // 1.5 · 954 MB + 64 MB = 1494.5 MB; 4 · 10 min + 1 min.
        assert_eq!((row.job, row.cases, row.mem_mb, row.runtime), (3, 1, 1536, 41));
        let none = request(0, &Job::default());
        assert_eq!((none.mem_mb, none.runtime), (64, 1));
    }
}
