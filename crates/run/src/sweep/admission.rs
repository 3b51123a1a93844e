//! Memory checks of commands other than a sweep, before any of their runs.

use super::cost::{Cost, PROGRAM, PlanCost, kept_by_meshes, run_cost};
use super::memory_limit::{MemoryLimit, TooLarge};
use super::needs::{constants_fit, least_bytes_of_mesh};
use super::plan::{CasePlan, ScenePlan};
use fem::contact::Discretization;
use scene::Scene;
use scene::setup::Setup;

/// A command would exceed the memory limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what}: {source}")]
pub struct Refused {
    pub what: String,
    pub source: TooLarge,
}

/// Bytes held beside a run with so many steps on a mesh.
pub type Beside<'a> = dyn Fn(&Discretization, u32) -> f64 + 'a;

/// Consecutive runs of a body.
pub struct Runs<'a> {
    pub setup: &'a Setup,
    /// n and N of each.
    pub grid: Vec<(u32, u32)>,
    /// What is held beside each.
    pub beside: Box<Beside<'a>>,
}

impl Runs<'_> {
    /// Refuses all runs if one exceeds the limit, if possible before its mesh is made.
    ///
    /// # Errors
    /// [`Refused`], of the largest run.
    pub fn admit(&self, limit: &MemoryLimit) -> Result<(), Refused> {
        let setup = self.setup;
        let mut grid = self.grid.clone();
        grid.sort_unstable();
        grid.dedup();
        let name = &setup.scene.name;
        early(
            |n, steps| least_bytes_of_mesh(setup, n.unwrap_or_default(), steps),
            name,
            grid.iter().map(|&(n, steps)| (Some(n), steps)).collect(),
            limit,
        )?;
        let mut all = Vec::new();
        for of_mesh in grid.chunk_by(|a, b| a.0 == b.0) {
            // The run that makes the mesh reports its errors.
            let Ok(space) = setup.space(of_mesh[0].0) else { continue };
            all.extend(of_mesh.iter().map(|&(n, steps)| {
                let run = run_cost(setup, &space, steps).memory_bytes;
                ((Some(n), steps), run + (self.beside)(&space, steps))
            }));
        }
        // The first of the largest; NaN counts as one.
        let size = |bytes: f64| if bytes.is_nan() { f64::INFINITY } else { bytes };
        let dearest = all.into_iter().min_by(|a, b| size(b.1).total_cmp(&size(a.1)));
        dearest.map_or(Ok(()), |(run, bytes)| admitted(limit, bytes, false, name, run))
    }
}

/// Refuses a plan whose cases are measured `jobs` at a time while all meshes and what they keep are held; `beside` is
/// what else is held.
/// [`Refused`].
pub fn admit_plan(
    plan: &ScenePlan,
    jobs: usize,
    limit: &MemoryLimit,
    beside: impl Fn(&[(&CasePlan, &Cost)]) -> f64,
) -> Result<(), Refused> {
    let name = &plan.scene().name;
    let reference = plan.reference.map(|reference| (Some(reference.n), reference.steps));
    let runs = plan.runs().into_iter().map(|(n, steps)| (Some(n), steps));
    early(|n, steps| plan.least_bytes(n, steps), name, runs.chain(reference).collect(), limit)?;
    // The case that makes the mesh reports its errors.
    let Ok(PlanCost { cases, .. }) = plan.costs() else { return Ok(()) };
    let cases: Vec<(&CasePlan, &Cost)> = plan.cases.iter().zip(&cases).collect();
    let bytes = PROGRAM + together(&cases, jobs) + beside(&cases);
    let dearest = cases.iter().max_by(|a, b| a.1.memory_bytes.total_cmp(&b.1.memory_bytes));
    let Some((case, _)) = dearest else { return Ok(()) };
    admitted(limit, bytes, false, name, (case.n, case.steps))
}

/// Bytes of the most expensive `jobs` cases, and of what all meshes keep.
fn together(cases: &[(&CasePlan, &Cost)], jobs: usize) -> f64 {
    let mut working: Vec<f64> =
        cases.iter().map(|(_, cost)| cost.memory_bytes - PROGRAM - cost.kept_bytes).collect();
    working.sort_by(|a, b| b.total_cmp(a));
    let kept = kept_by_meshes(cases.iter().map(|(case, cost)| (case.n, *cost)));
    working.iter().take(jobs).sum::<f64>() + kept
}

/// Refuses a scene whose trace constants do not fit, before it is set up: they enter (2.9) and the step bound if the
/// law falls, and a command may need them for `any` scene with contact.
/// [`Refused`].
pub fn admit_constants(scene: &Scene, any: bool, limit: &MemoryLimit) -> Result<(), Refused> {
    let Some(body) = scene.as_contact() else { return Ok(()) };
    if body.domain.contact.is_empty() || !any && body.is_monotone() {
        return Ok(());
    }
    constants_fit(body, limit)
        .map_err(|source| Refused { what: format!("{}, c_j^2", scene.name), source })
}

/// By a coarse mesh of each, the finest first.
fn early(
    least_bytes: impl Fn(Option<u32>, u32) -> f64,
    scene: &str,
    mut runs: Vec<(Option<u32>, u32)>,
    limit: &MemoryLimit,
) -> Result<(), Refused> {
    runs.sort_unstable_by(|a, b| b.cmp(a));
    let mut runs = runs.into_iter();
    runs.try_for_each(|run| admitted(limit, least_bytes(run.0, run.1), true, scene, run))
}

/// Refuses a run of a scene, by its n and N, that takes more than the limit.
fn admitted(
    limit: &MemoryLimit,
    bytes: f64,
    at_least: bool,
    scene: &str,
    (n, steps): (Option<u32>, u32),
) -> Result<(), Refused> {
    let mesh = n.map_or(String::new(), |n| format!("n = {n}, "));
    let what = || format!("{scene} {mesh}N = {steps}");
    limit.admit(bytes, at_least).map_err(|source| Refused { what: what(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::Overrides;
    use scene::Scene;
    use scene::setup::Subject;

    fn plan(n: &[u32], steps: &[u32]) -> ScenePlan {
        let path = format!("{}/../../manufactured/signorini.toml", env!("CARGO_MANIFEST_DIR"));
        let scene = Scene::read(path.as_ref()).expect("a scene");
        let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
        ScenePlan::new(Subject::new(scene).expect("a subject"), &overrides)
    }

    fn setup(plan: &ScenePlan) -> &Setup {
        match &plan.subject {
            Subject::Contact(setup) => setup,
            Subject::Abstract(_) => panic!("no body"),
        }
    }

    /// The smallest limit in bytes that is admitted.
    fn least(admitted: impl Fn(&MemoryLimit) -> bool) -> f64 {
        let (mut low, mut high) = (0.0, 1e12);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            match admitted(&MemoryLimit::of_bytes(middle)) {
                true => high = middle,
                false => low = middle,
            }
        }
        high
    }

    #[test]
    fn runs_take_what_the_dearest_of_them_takes_and_what_is_held_beside_it() {
        let plan = plan(&[8], &[4]);
        let setup = setup(&plan);
        let runs = |grid: &[(u32, u32)], beside: f64| Runs {
            setup,
            grid: grid.to_vec(),
            beside: Box::new(move |_, _| beside),
        };
        let of = |grid: &[(u32, u32)], beside: f64| {
            least(|limit| runs(grid, beside).admit(limit).is_ok())
        };
        let (small, large) = (of(&[(8, 4)], 0.0), of(&[(16, 8)], 0.0));
        assert!(small < large);
        let near = |a: f64, b: f64| (a - b).abs() < 1.0;
        assert!(near(of(&[(16, 8), (8, 4)], 0.0), large));
        assert!(near(of(&[(8, 4)], 1e9), small + 1e9));
        let said = runs(&[(8, 4), (16, 8)], 0.0).admit(&MemoryLimit::of_bytes(small)).unwrap_err();
        assert!(said.to_string().starts_with("signorini n = 16, N = 8: about "), "{said}");
        // NaN exceeds any finite limit.
        let whatever = MemoryLimit::of_bytes(1e300);
        let unknown = |steps: u32| if steps == 4 { f64::NAN } else { 0.0 };
        let beside: Box<Beside<'_>> = Box::new(move |_, steps| unknown(steps));
        let mixed = Runs { setup, grid: vec![(8, 2), (8, 4), (16, 8)], beside };
        assert!(mixed.admit(&whatever).unwrap_err().source.bytes.is_nan());
        // A mesh that fits no machine is not made.
        let said = runs(&[(8, 4), (4096, 4)], 0.0).admit(&MemoryLimit::of_bytes(1e9)).unwrap_err();
        assert!(said.to_string().contains("n = 4096") && said.source.at_least, "{said}");
    }

    #[test]
    fn a_plan_holds_all_of_its_meshes_and_works_on_some_cases() {
        let bytes = |n: &[u32], steps: &[u32], jobs: usize| {
            let plan = plan(n, steps);
            least(|limit| admit_plan(&plan, jobs, limit, |_| 0.0).is_ok())
        };
        let costs = |n: u32, steps: u32| {
            let plan = plan(&[n], &[steps]);
            let cost = plan.costs().expect("a prediction").cases[0];
            (cost.memory_bytes, cost.kept_bytes)
        };
        let ((small, small_kept), (large, large_kept)) = (costs(8, 4), costs(16, 4));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1.0, "{a} {b}");
        near(bytes(&[16], &[4], 1), large);
        near(bytes(&[8, 16], &[4], 1), large + small_kept);
        near(bytes(&[8, 16], &[4], 2), large + small - PROGRAM);
        // Cases on one mesh share what it keeps.
        let (shared, kept) = costs(16, 2);
        near(bytes(&[16], &[2, 4], 2), large + shared - PROGRAM - kept);
        assert!(kept <= large_kept);
        let plan = plan(&[8], &[4]);
        let beside = |cases: &[(&CasePlan, &Cost)]| 1e9 * cases.len() as f64;
        let smallest = least(|limit| admit_plan(&plan, 1, limit, beside).is_ok());
        near(smallest, small + 1e9);
    }
}
