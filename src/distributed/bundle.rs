//! Cases put together to jobs: long enough that the start of a process does not dominate, no longer than asked.

use crate::sweep::{Demands, Need};

/// A reference run is repeated in every job that has cases of its scene. A job goes on to this many times its seconds,
/// so that what is repeated stays below a tenth of the work.
const REFERENCE_RUNS: f64 = 10.0;

/// The cases of a scene with what they take alone.
pub struct SceneDemands {
    /// n of each case; none in an abstract scene.
    pub meshes: Vec<Option<u32>>,
    /// Number of steps of each case.
    pub steps: Vec<u32>,
    /// What they take, in the same order.
    pub demands: Demands,
}

/// The cases that one process runs, one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Job {
    /// Scene and case, as indices; the longest case first.
    pub cases: Vec<(usize, usize)>,
    /// Predicted CPU seconds, reference runs included. Loads that its cases share are counted for each: an upper bound.
    pub seconds: f64,
    /// Predicted peak memory: that of its largest case, and what is kept meanwhile of its other meshes.
    pub bytes: f64,
}

/// Jobs of about `seconds` predicted CPU seconds each, the longest first. Cases of a mesh stay together as far as that
/// goes, and a longer case is a job of its own. Equal input gives equal jobs.
pub fn bundle(scenes: &[SceneDemands], seconds: f64) -> Vec<Job> {
    let mut jobs: Vec<Job> = Vec::new();
    let mut open = Job::default();
    for (s, scene) in scenes.iter().enumerate() {
        let need = |c: usize| scene.demands.cases[c];
        let reference = scene.demands.reference_seconds;
        let target = seconds.max(REFERENCE_RUNS * reference);
        let mut order: Vec<usize> = (0..scene.demands.cases.len()).collect();
        order.sort_by_key(|&c| std::cmp::Reverse((scene.meshes[c], scene.steps[c])));
        let all: f64 = order.iter().map(|&c| need(c).seconds).sum();
        if reference > 0.0 && open.seconds + reference + all > seconds {
            jobs.push(std::mem::take(&mut open));
        }
        let mut begun = false;
        for c in order {
            let own = need(c).seconds + if begun { 0.0 } else { reference };
            if !open.cases.is_empty() && open.seconds + own > target {
                jobs.push(std::mem::take(&mut open));
                begun = false;
            }
            open.seconds += need(c).seconds + if begun { 0.0 } else { reference };
            open.cases.push((s, c));
            begun = true;
        }
    }
    jobs.push(open);
    jobs.retain(|job| !job.cases.is_empty());
    for job in &mut jobs {
        let need = |&(s, c): &(usize, usize)| scenes[s].demands.cases[c];
        job.bytes = bytes(&job.cases, scenes);
        job.cases.sort_by(|a, b| need(b).seconds.total_cmp(&need(a).seconds));
    }
    jobs.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    jobs
}

/// Peak memory of a process that runs `cases` one after the other, in an order by mesh.
fn bytes(cases: &[(usize, usize)], scenes: &[SceneDemands]) -> f64 {
    let need = |&(s, c): &(usize, usize)| -> Need { scenes[s].demands.cases[c] };
    let largest = |of: fn(&Need) -> f64, cases: &[(usize, usize)]| {
        cases.iter().map(|case| of(&need(case))).fold(0.0, f64::max)
    };
    let mesh = |&(s, c): &(usize, usize)| (s, scenes[s].meshes[c]);
    let kept = |cases: &[(usize, usize)]| largest(|need| need.kept, cases);
    let meshes: Vec<f64> = cases.chunk_by(|a, b| mesh(a) == mesh(b)).map(kept).collect();
    // The mesh of the running case is in its own bytes; with one mesh nothing else is kept.
    let others = if meshes.len() > 1 { meshes.iter().sum() } else { 0.0 };
    largest(|need| need.bytes, cases) + others
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(reference_seconds: f64, cases: &[(u32, u32, f64)]) -> SceneDemands {
        let need = |&(_, _, seconds): &(u32, u32, f64)| Need { seconds, bytes: 100.0, kept: 10.0 };
        SceneDemands {
            meshes: cases.iter().map(|(n, _, _)| Some(*n)).collect(),
            steps: cases.iter().map(|(_, steps, _)| *steps).collect(),
            demands: Demands { reference_seconds, cases: cases.iter().map(need).collect() },
        }
    }

    fn sizes(jobs: &[Job]) -> Vec<usize> {
        jobs.iter().map(|job| job.cases.len()).collect()
    }

    #[test]
    fn small_cases_share_a_job_and_long_ones_do_not() {
        let scenes = [
            scene(0.0, &[(8, 4, 1.0), (8, 8, 2.0), (16, 4, 4.0), (16, 8, 30.0)]),
            scene(0.0, &[(8, 4, 3.0), (8, 8, 3.0)]),
        ];
        let jobs = bundle(&scenes, 10.0);
        // The longest alone, then 4 + 2 + 1 + 3 of two scenes, then what is left.
        assert_eq!(jobs[0].cases, [(0, 3)]);
        assert_eq!(jobs[1].cases, [(0, 2), (1, 1), (0, 1), (0, 0)]);
        assert_eq!(jobs[2].cases, [(1, 0)]);
        let seconds: Vec<f64> = jobs.iter().map(|job| job.seconds).collect();
        assert_eq!(seconds, [30.0, 10.0, 3.0]);
        // Three meshes are kept beside the largest case, and none where there is one mesh.
        assert_eq!([jobs[1].bytes, jobs[2].bytes], [130.0, 100.0]);
        assert_eq!(bundle(&scenes, 10.0), jobs);
        // Every case once, whatever the size.
        for target in [0.0, 1.0, 5.0, 1e9] {
            let mut all: Vec<_> =
                bundle(&scenes, target).iter().flat_map(|j| j.cases.clone()).collect();
            all.sort_unstable();
            assert_eq!(all, [(0, 0), (0, 1), (0, 2), (0, 3), (1, 0), (1, 1)], "{target}");
        }
        assert_eq!(sizes(&bundle(&scenes, 0.0)), [1; 6]);
        assert_eq!(bundle(&[], 10.0), []);
    }

    #[test]
    fn a_reference_run_is_not_repeated_for_a_handful_of_cases() {
        let cases: Vec<(u32, u32, f64)> = (1..=30).map(|n| (n, 4, 10.0)).collect();
        // A reference run of 20 s: jobs of up to 200 s, though 40 s are asked for.
        let jobs = bundle(&[scene(20.0, &cases)], 40.0);
        assert_eq!(sizes(&jobs), [18, 12]);
        assert_eq!([jobs[0].seconds, jobs[1].seconds], [200.0, 140.0]);
        // Where all of the scene fits in a new job, it is not split over two.
        let short = [scene(0.0, &[(4, 4, 30.0)]), scene(1.0, &cases[..3])];
        assert_eq!(sizes(&bundle(&short, 40.0)), [3, 1]);
    }
}
