//! Bundles cases into jobs, long enough to amortise the start of a process.

use std::collections::BTreeMap;

use super::plan::PlannedScene;
use crate::sweep::{PlanCost, ScenePlan};
use judge::record::Key;
use scene::setup::SetupError;

/// Every job with cases of a scene repeats its reference run. A job may take this many times its seconds, so that
/// repetition stays below a tenth of the work.
const REFERENCE_RUNS: f64 = 10.0;
/// Memory limit of a job of several cases (1 GiB, which most machines have per processor): cases on a mesh keep loads
/// and moments of all their times for each other.
const MOST_BYTES: f64 = 1_073_741_824.0;

/// A scene of a plan, and what its cases take.
pub struct PlannedCases {
    pub(super) scene: PlannedScene,
    pub(super) cases: Vec<Key>,
    /// What they take, in the same order.
    pub(super) costs: PlanCost,
}

impl PlannedCases {
    /// Predicts the cases of a scene; its meshes are made and analysed.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    pub fn new(plan: &ScenePlan) -> Result<Self, SetupError> {
        let scene = PlannedScene::new(plan.scene());
        Ok(Self { scene, cases: plan.keys(), costs: plan.costs()? })
    }
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
pub(crate) fn bundle(scenes: &[PlannedCases], seconds: f64) -> Vec<Job> {
    let mut jobs: Vec<Job> = Vec::new();
    let (mut cases, mut needs) = (Vec::new(), Needs::default());
    for (s, scene) in scenes.iter().enumerate() {
        let reference = scene.costs.reference_seconds();
        let target = seconds.max(REFERENCE_RUNS * reference);
        let mut order: Vec<usize> = (0..scene.cases.len()).collect();
        order.sort_by_key(|&c| std::cmp::Reverse(&scene.cases[c]));
        let all: f64 = order.iter().map(|&c| scene.costs.cases[c].seconds).sum();
        if reference > 0.0 && needs.seconds + reference + all > seconds {
            jobs.push(std::mem::take(&mut needs).job(std::mem::take(&mut cases)));
        }
        for c in order {
            let mut with = needs.clone();
            with.add(scene, s, c);
            if (with.seconds > target || with.bytes > MOST_BYTES) && !cases.is_empty() {
                jobs.push(needs.job(std::mem::take(&mut cases)));
                with = Needs::default();
                with.add(scene, s, c);
            }
            needs = with;
            cases.push((s, c));
        }
    }
    jobs.push(needs.job(cases));
    jobs.retain(|job| !job.cases.is_empty());
    let of = |&(s, c): &(usize, usize)| scenes[s].costs.cases[c].seconds;
    for job in &mut jobs {
        job.cases.sort_by(|a, b| of(b).total_cmp(&of(a)));
    }
    jobs.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    jobs
}

/// What a job needs, to which cases are added mesh by mesh.
#[derive(Clone, Default)]
struct Needs {
    seconds: f64,
    bytes: f64,
    /// The scene of the last case.
    scene: Option<usize>,
    /// Bytes of the largest case beyond what it keeps, and what each mesh keeps.
    largest: f64,
    kept: BTreeMap<(usize, Option<u32>), f64>,
}

impl Needs {
    fn add(&mut self, scene: &PlannedCases, s: usize, c: usize) {
        let cost = &scene.costs.cases[c];
        if self.scene.replace(s) != Some(s) {
            self.seconds += scene.costs.reference_seconds();
        }
        self.seconds += cost.seconds;
        self.largest = self.largest.max(cost.memory_bytes - cost.kept_bytes);
        let kept = self.kept.entry((s, scene.cases[c].n)).or_default();
        *kept = kept.max(cost.kept_bytes + cost.left_bytes);
        self.bytes = self.largest + self.kept.values().sum::<f64>();
    }

    fn job(self, cases: Vec<(usize, usize)>) -> Job {
        Job { cases, seconds: self.seconds, bytes: self.bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Cost;

    fn cost(seconds: f64, memory_bytes: f64, kept_bytes: f64) -> Cost {
        Cost { seconds, memory_bytes, kept_bytes, ..Cost::UNKNOWN }
    }

    fn scene(reference_seconds: f64, cases: &[(u32, u32, f64)]) -> PlannedCases {
        let one = |&(_, _, seconds): &(u32, u32, f64)| cost(seconds, 100.0, 10.0);
        let reference = (reference_seconds > 0.0).then(|| cost(reference_seconds, 0.0, 0.0));
        let key =
            |&(n, steps, _): &(u32, u32, f64)| Key { scene: String::new(), n: Some(n), steps };
        PlannedCases {
            scene: PlannedScene::default(),
            cases: cases.iter().map(key).collect(),
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
