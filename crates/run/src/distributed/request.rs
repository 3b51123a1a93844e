//! What a job asks the engine for: the predictions with a margin, since a job that exceeds its request is killed.

use super::bundle::Job;
use super::plan::JobRow;

/// Measured over predicted memory is at most 1/0.67 (docs/FAULTS.md), and the plan with its texts is held as well.
const MEMORY: f64 = 1.5;
const BESIDE: f64 = 64.0 * MEBIBYTE;
/// Measured over predicted seconds is at most 1/0.49 on the machine of the rates (`sweep/cost.rs`); another one may be
/// half as fast. A minute for the start of the process and for reading over a network.
const TIME: f64 = 4.0;
const START: f64 = 60.0;

const MEBIBYTE: f64 = 1_048_576.0;
/// Requests are multiples of so many MB: a scheduler keeps jobs of one size together.
const STEP: f64 = 64.0;

/// The row of a job with its request.
pub fn request(number: usize, job: &Job) -> JobRow {
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
