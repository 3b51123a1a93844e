//! Cases put together to jobs: long enough that the start of a process does not dominate, no longer than asked.

use std::collections::HashSet;

use crate::sweep::{Demand, Demands};
use scene::Time;
use scene::setup::time_grid;

/// A reference run is repeated in every job that has cases of its scene. A job goes on to this many times its seconds,
/// so that what is repeated stays below a tenth of the work.
const REFERENCE_RUNS: f64 = 10.0;
/// Cases on a mesh keep loads and moments of all their times for each other. A job of several cases takes no more than
/// this (1 GiB): most machines have that much for each processor.
const MOST_BYTES: f64 = 1_073_741_824.0;

/// The cases of a scene with what they take alone.
pub struct SceneDemands {
    /// n of each case; none in an abstract scene.
    pub meshes: Vec<Option<u32>>,
    /// Number of steps of each case.
    pub steps: Vec<u32>,
    /// The grids in time.
    pub time: Time,
    /// What they take, in the same order.
    pub demands: Demands,
}

/// The cases that one process runs, one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Job {
    /// Scene and case, as indices; the longest case first.
    pub cases: Vec<(usize, usize)>,
    /// Predicted CPU seconds, reference runs included.
    pub seconds: f64,
    /// Predicted peak memory: that of its largest case, and what its meshes keep.
    pub bytes: f64,
}

/// Jobs of about `seconds` predicted CPU seconds each, the longest first. Cases of a mesh stay together as far as that
/// goes, and a longer case is a job of its own. Equal input gives equal jobs.
pub fn bundle(scenes: &[SceneDemands], seconds: f64) -> Vec<Job> {
    let mut jobs: Vec<Job> = Vec::new();
    let mut open = Open::default();
    for (s, scene) in scenes.iter().enumerate() {
        let reference = scene.demands.reference_seconds;
        let target = seconds.max(REFERENCE_RUNS * reference);
        let mut order: Vec<usize> = (0..scene.demands.cases.len()).collect();
        order.sort_by_key(|&c| std::cmp::Reverse((scene.meshes[c], scene.steps[c])));
        let all: f64 = order.iter().map(|&c| scene.demands.cases[c].need.seconds).sum();
        if reference > 0.0 && open.job.seconds + reference + all > seconds {
            jobs.extend(open.close());
        }
        for c in order {
            let with = open.with(scenes, s, c);
            let full = with.seconds > target || with.bytes > MOST_BYTES;
            let added = match full && !open.job.cases.is_empty() {
                true => {
                    jobs.extend(open.close());
                    open.with(scenes, s, c)
                }
                false => with,
            };
            open.add(added, s, c, scene.meshes[c]);
        }
    }
    jobs.extend(open.close());
    for job in &mut jobs {
        let alone = |&(s, c): &(usize, usize)| scenes[s].demands.cases[c].need.seconds;
        job.cases.sort_by(|a, b| alone(b).total_cmp(&alone(a)));
    }
    jobs.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    jobs
}

/// A job to which cases are added, mesh by mesh.
#[derive(Default)]
struct Open {
    job: Job,
    /// Scene and mesh of its last case, and the times that are known there.
    mesh: Option<(usize, Option<u32>)>,
    times: HashSet<u64>,
    /// Bytes of the largest case beside what it keeps, and what all keep.
    largest: f64,
    kept: f64,
}

/// What a job comes to with one case more.
struct Added {
    seconds: f64,
    bytes: f64,
    largest: f64,
    kept: f64,
    times: Vec<u64>,
}

impl Open {
    fn with(&self, scenes: &[SceneDemands], s: usize, c: usize) -> Added {
        let SceneDemands { meshes, steps, time, demands } = &scenes[s];
        let Demand { need, truth_seconds, kept_once } = demands.cases[c];
        let same_scene = self.mesh.is_some_and(|(scene, _)| scene == s);
        let same_mesh = self.mesh == Some((s, meshes[c]));
        let grid = time_grid(time, steps[c]);
        let times: Vec<u64> = (0..=grid.steps()).map(|n| grid.time(n).to_bits()).collect();
        let known = |time: &&u64| same_mesh && self.times.contains(time);
        let fresh = 1.0 - times.iter().filter(known).count() as f64 / times.len() as f64;
        let once = if same_mesh { 0.0 } else { kept_once };
        let largest = self.largest.max(need.bytes - need.kept);
        let kept = self.kept + once + fresh * (need.kept - kept_once);
        let reference = if same_scene { 0.0 } else { demands.reference_seconds };
        Added {
            seconds: self.job.seconds + reference + need.seconds - (1.0 - fresh) * truth_seconds,
            bytes: largest + kept,
            largest,
            kept,
            times,
        }
    }

    fn add(&mut self, added: Added, s: usize, c: usize, mesh: Option<u32>) {
        if self.mesh != Some((s, mesh)) {
            self.times.clear();
        }
        self.times.extend(added.times);
        self.mesh = Some((s, mesh));
        (self.largest, self.kept) = (added.largest, added.kept);
        (self.job.seconds, self.job.bytes) = (added.seconds, added.bytes);
        self.job.cases.push((s, c));
    }

    /// The job, if it has a case; another one begins.
    fn close(&mut self) -> Option<Job> {
        let job = std::mem::take(self).job;
        (!job.cases.is_empty()).then_some(job)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Need;
    use scene::{TimeGrid, TimeRule};

    fn scene(reference_seconds: f64, cases: &[(u32, u32, f64)]) -> SceneDemands {
        let demand = |&(_, _, seconds): &(u32, u32, f64)| Demand {
            need: Need { seconds, bytes: 100.0, kept: 10.0 },
            truth_seconds: 0.0,
            kept_once: 10.0,
        };
        SceneDemands {
            meshes: cases.iter().map(|(n, _, _)| Some(*n)).collect(),
            steps: cases.iter().map(|(_, steps, _)| *steps).collect(),
            demands: Demands { reference_seconds, cases: cases.iter().map(demand).collect() },
            time: Time { horizon: 1.0, grid: TimeGrid::Uniform, rule: TimeRule::Trapezoid },
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
        // What three meshes keep is there at once.
        assert_eq!([jobs[1].bytes, jobs[2].bytes], [120.0, 100.0]);
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

    /// Times of 1, 2 and 4 steps: 2, then 1 and 2 more. Longest first: 5, and no more.
    #[test]
    fn what_cases_on_a_mesh_share_counts_once() {
        let mut own = scene(0.0, &[(8, 1, 1.0), (8, 2, 1.0), (8, 4, 1.0), (8, 3, 1.0)]);
        for demand in &mut own.demands.cases {
            *demand = Demand {
                need: Need { seconds: 3.0, bytes: 1e8, kept: 6e7 },
                truth_seconds: 2.0,
                kept_once: 1e7,
            };
        }
        let alone = bundle(std::slice::from_ref(&own), 0.0);
        assert!(alone.iter().all(|job| (job.seconds, job.bytes) == (3.0, 1e8)), "{alone:?}");
        let jobs = bundle(std::slice::from_ref(&own), 100.0);
        // N = 3 adds 1/3 and 2/3 to the five times of N = 4, half of its own; 1 and 2 add none.
        let (shared, kept) = (3.0 + (3.0 - 1.0) + 1.0 + 1.0, 1e7 + 5e7 * 1.5);
        assert_eq!(jobs.len(), 1);
        assert!((jobs[0].seconds - shared).abs() < 1e-12, "{jobs:?}");
        assert!((jobs[0].bytes - (4e7 + kept)).abs() < 1e-3, "{jobs:?}");
        // Where more would be kept than a job may take, another one begins.
        own.demands.cases.iter_mut().for_each(|demand| demand.need.kept = 0.7e9);
        own.demands.cases.iter_mut().for_each(|demand| demand.need.bytes = 0.8e9);
        assert_eq!(sizes(&bundle(&[own], 100.0)), [3, 1]);
    }
}
