//! Bundles cases into jobs, long enough to amortise the start of a process.

use std::collections::BTreeMap;

use crate::sweep::PlanCost;

/// Every job with cases of a scene repeats its reference run. A job may take this many times its seconds, so that
/// repetition stays below a tenth of the work.
const REFERENCE_RUNS: f64 = 10.0;
/// Memory limit of a job of several cases (1 GiB, which most machines have per processor): cases on a mesh keep loads
/// and moments of all their times for each other.
const MOST_BYTES: f64 = 1_073_741_824.0;

pub(crate) struct SceneCosts {
    /// n of each case, none in an abstract scene, and its number of steps.
    pub cases: Vec<(Option<u32>, u32)>,
    /// What they take, in the same order.
    pub costs: PlanCost,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Job {
    /// Indices of scene and case, longest case first.
    pub cases: Vec<(usize, usize)>,
    /// Predicted CPU seconds, including reference runs.
    pub seconds: f64,
    /// Predicted peak memory: that of the largest case, and what its meshes keep.
    pub bytes: f64,
}

/// Jobs of about `seconds` predicted CPU seconds, longest first. Cases of a mesh stay together if possible; a longer
/// case is a job by itself. Deterministic.
pub(crate) fn bundle(scenes: &[SceneCosts], seconds: f64) -> Vec<Job> {
    let of = |&(s, c): &(usize, usize)| &scenes[s].costs.cases[c];
    let mut jobs: Vec<Job> = Vec::new();
    let mut open = Open::default();
    for (s, scene) in scenes.iter().enumerate() {
        let reference = scene.costs.reference_seconds();
        let target = seconds.max(REFERENCE_RUNS * reference);
        let mut order: Vec<usize> = (0..scene.cases.len()).collect();
        order.sort_by_key(|&c| std::cmp::Reverse(scene.cases[c]));
        let all: f64 = order.iter().map(|&c| scene.costs.cases[c].seconds).sum();
        if reference > 0.0 && open.job.seconds + reference + all > seconds {
            jobs.push(std::mem::take(&mut open).job);
        }
        for c in order {
            let mut with = open.clone();
            with.add(scene, s, c);
            if (with.job.seconds > target || with.job.bytes > MOST_BYTES)
                && !open.job.cases.is_empty()
            {
                jobs.push(open.job);
                with = Open::default();
                with.add(scene, s, c);
            }
            open = with;
        }
    }
    jobs.push(open.job);
    jobs.retain(|job| !job.cases.is_empty());
    for job in &mut jobs {
        job.cases.sort_by(|a, b| of(b).seconds.total_cmp(&of(a).seconds));
    }
    jobs.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    jobs
}

/// A job to which cases are added, mesh by mesh.
#[derive(Clone, Default)]
struct Open {
    job: Job,
    /// Bytes of the largest case beyond what it keeps, and what each mesh keeps.
    largest: f64,
    kept: BTreeMap<(usize, Option<u32>), f64>,
}

impl Open {
    fn add(&mut self, scene: &SceneCosts, s: usize, c: usize) {
        let cost = &scene.costs.cases[c];
        if self.job.cases.last().is_none_or(|(last, _)| *last != s) {
            self.job.seconds += scene.costs.reference_seconds();
        }
        self.job.seconds += cost.seconds;
        self.largest = self.largest.max(cost.memory_bytes - cost.kept_bytes);
        let kept = self.kept.entry((s, scene.cases[c].0)).or_default();
        *kept = kept.max(cost.kept_bytes + cost.left_bytes);
        self.job.bytes = self.largest + self.kept.values().sum::<f64>();
        self.job.cases.push((s, c));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Cost;

    fn cost(seconds: f64, memory_bytes: f64, kept_bytes: f64) -> Cost {
        Cost { seconds, memory_bytes, kept_bytes, ..Cost::UNKNOWN }
    }

    fn scene(reference_seconds: f64, cases: &[(u32, u32, f64)]) -> SceneCosts {
        let one = |&(_, _, seconds): &(u32, u32, f64)| cost(seconds, 100.0, 10.0);
        let reference = (reference_seconds > 0.0).then(|| cost(reference_seconds, 0.0, 0.0));
        SceneCosts {
            cases: cases.iter().map(|&(n, steps, _)| (Some(n), steps)).collect(),
            costs: PlanCost { reference, cases: cases.iter().map(one).collect() },
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
        // The longest alone, then 4 + 2 + 1 + 3 of two scenes, then the rest.
        assert_eq!(jobs[0].cases, [(0, 3)]);
        assert_eq!(jobs[1].cases, [(0, 2), (1, 1), (0, 1), (0, 0)]);
        assert_eq!(jobs[2].cases, [(1, 0)]);
        let seconds: Vec<f64> = jobs.iter().map(|job| job.seconds).collect();
        assert_eq!(seconds, [30.0, 10.0, 3.0]);
        // Three meshes keep their data at the same time.
        assert_eq!([jobs[1].bytes, jobs[2].bytes], [120.0, 100.0]);
        assert_eq!(bundle(&scenes, 10.0), jobs);
        // Every case once, for any size.
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
        // A scene that fits in a new job is not split over two.
        let short = [scene(0.0, &[(4, 4, 30.0)]), scene(1.0, &cases[..3])];
        assert_eq!(sizes(&bundle(&short, 40.0)), [3, 1]);
    }

    #[test]
    fn what_cases_on_a_mesh_keep_counts_once() {
        let mut on_two_meshes = scene(0.0, &[(8, 1, 1.0), (8, 2, 1.0), (8, 4, 1.0), (16, 4, 1.0)]);
        let kept = [1e7, 2e7, 4e7, 8e7];
        on_two_meshes.costs.cases.iter_mut().zip(kept).for_each(|(cost, kept)| {
            (cost.memory_bytes, cost.kept_bytes) = (1e6 + kept, kept);
        });
        let jobs = bundle(std::slice::from_ref(&on_two_meshes), 100.0);
        assert_eq!((jobs.len(), jobs[0].bytes), (1, 1e6 + 4e7 + 8e7));
        // If more would be kept than a job may take, another one begins.
        on_two_meshes.costs.cases[3].kept_bytes = 1.05e9;
        on_two_meshes.costs.cases[3].memory_bytes = 1.06e9;
        assert_eq!(sizes(&bundle(&[on_two_meshes], 100.0)), [3, 1]);
    }
}
