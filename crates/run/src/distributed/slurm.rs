//! Slurm job arrays from a plan. All tasks of an array have the same request, so jobs of similar requests share one.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::plan::JobRow;

/// The script of a task.
pub(crate) const ARRAY: &str = include_str!("workflow/array.sh");

/// Slurm's default MaxArraySize is 1001, the largest index 1000.
const LARGEST_ARRAY: usize = 1000;
/// Factors within which requests of an array differ, in memory and time.
const MEMORY_CLASS: f64 = 2.0;
const TIME_CLASS: f64 = 4.0;

/// An array: its file of job numbers, one per line, and the request of each task.
#[derive(Debug, PartialEq)]
pub(crate) struct JobArray {
    /// Relative to the directory of the plan.
    pub file: String,
    pub jobs: Vec<usize>,
    /// The largest request of its jobs, in MB.
    pub mem_mb: u64,
    /// The longest, in minutes.
    pub runtime: u64,
}

/// The arrays of a plan, longest jobs first.
pub(crate) fn arrays(jobs: &[JobRow]) -> Vec<JobArray> {
    let class = |value: u64, factor: f64| (value.max(1) as f64).log(factor).floor() as i64;
    let mut classes: BTreeMap<(i64, i64), Vec<&JobRow>> = BTreeMap::new();
    for job in jobs {
        let class_of_job = (-class(job.runtime, TIME_CLASS), -class(job.mem_mb, MEMORY_CLASS));
        classes.entry(class_of_job).or_default().push(job);
    }
    let chunks = classes.values().flat_map(|jobs| jobs.chunks(LARGEST_ARRAY));
    let array = |(number, jobs): (usize, &[&JobRow])| JobArray {
        file: format!("arrays/{number}.jobs"),
        jobs: jobs.iter().map(|job| job.job).collect(),
        mem_mb: jobs.iter().map(|job| job.mem_mb).max().unwrap_or_default(),
        runtime: jobs.iter().map(|job| job.runtime).max().unwrap_or_default(),
    };
    chunks.enumerate().map(array).collect()
}

/// The script that submits them.
pub(crate) fn submit(arrays: &[JobArray]) -> String {
    let mut text = String::from(
        "#!/usr/bin/env bash\n\
         # Written by `sweep plan --format slurm`: submits the jobs of this plan. SWEEP=/path/to/sweep names a program\n\
         # that is not on the PATH; arguments go to sbatch (--partition, --account). Submitted again after failures,\n\
         # it runs what is missing. When all have ended: sweep merge parts --plan . --out merged\n\
         set -euo pipefail\n\
         cd \"$(dirname \"$0\")\"\n\
         mkdir -p log parts\n",
    );
    for JobArray { file, jobs, mem_mb, runtime } in arrays {
        let last = jobs.len().saturating_sub(1);
        let _ = writeln!(
            text,
            "sbatch --job-name=sweep --array=0-{last} --mem={mem_mb}M --time={runtime} --ntasks=1 --cpus-per-task=1 \
             --output=log/%A-%a.txt \"$@\" array.sh {file}"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(job: usize, mem_mb: u64, runtime: u64) -> JobRow {
        JobRow { job, cases: 1, seconds: 1.0, bytes: 1.0, mem_mb, runtime }
    }

    #[test]
    fn arrays_hold_like_requests_and_every_job_once() {
        let mut jobs = vec![row(0, 9000, 70), row(1, 600, 60), row(2, 1000, 50), row(3, 900, 3)];
        jobs.extend((4..1504).map(|job| row(job, 128, 1)));
        let arrays = arrays(&jobs);
        let shape: Vec<_> = arrays.iter().map(|a| (a.jobs.len(), a.mem_mb, a.runtime)).collect();
        let expected =
            [(1, 9000, 70), (2, 1000, 60), (1, 900, 3), (LARGEST_ARRAY, 128, 1), (500, 128, 1)];
        assert_eq!(shape, expected);
        let mut all: Vec<usize> = arrays.iter().flat_map(|array| array.jobs.clone()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..1504).collect::<Vec<_>>());
        let text = submit(&arrays);
        assert!(text.contains("--array=0-999 --mem=128M --time=1 "), "{text}");
        assert_eq!(text.matches("\nsbatch").count(), 5, "{text}");
    }
}
