//! The counters behind a prediction against those of real cases: clocks are not compared in a test.

use super::truth::{MOMENTS, ZETA};
use super::*;
use crate::sweep::{Overrides, run_contact_case};
use scene::Scene;
use scene::setup::MeshData;
use scene::setup::Subject;

fn plan(scene: &str, n: u32, steps: &[u32]) -> ScenePlan {
    let path = format!("{}/../../manufactured/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
    let scene = Scene::read(path.as_ref()).unwrap_or_else(|error| panic!("{error}"));
    let subject = Subject::new(scene).unwrap_or_else(|error| panic!("{error}"));
    ScenePlan::new(subject, &Overrides { n: Some(vec![n]), steps: Some(steps.to_vec()) })
}

fn setup(plan: &ScenePlan) -> &Setup {
    match &plan.subject {
        Subject::Contact(setup) => setup,
        Subject::Abstract(_) => panic!("no body"),
    }
}

fn costs(plan: &ScenePlan) -> PlanCost {
    predict(setup(plan), plan).unwrap_or_else(|error| panic!("{error}"))
}

/// Largest factor between predicted and counted iterations and factorizations.
fn off(scene: &str, n: u32, steps: u32, kind: Option<Kind>) -> f64 {
    let plan = plan(scene, n, &[steps]);
    let data = MeshData::new(setup(&plan), n, None).unwrap_or_else(|error| panic!("{error}"));
    let record = run_contact_case(setup(&plan), &data, &plan.cases[0]);
    assert!(record.converged());
    let mut predicted = [costs(&plan).cases[0].iterations, costs(&plan).cases[0].factorizations];
    if let Some(kind) = kind {
        let crossed = f64::from(n) * plan.scene().time.horizon / f64::from(steps);
        predicted = kind.work(crossed, f64::from(steps)).map(|w| w * (f64::from(steps) + 1.0));
    }
    let counted = [record.newton_iterations, record.factorizations].map(|count| count as f64);
    let factor = |(p, c): (&f64, f64)| (p / c).max(c / p);
    predicted.iter().zip(counted).map(factor).fold(1.0, f64::max)
}

#[test]
fn predicted_work_is_the_work_of_real_cases() {
    // A factor 2 of either is what a prediction within a factor 3 in seconds can bear.
    for (scene, n, steps) in [
        ("pure-mild", 16, 4),
        ("pure-mild", 16, 32),
        ("in-space", 16, 64),
        ("affine", 4, 16),
        ("compliance", 32, 16),
        ("signorini", 16, 16),
        ("viscoelastic", 8, 16),
    ] {
        let factor = off(scene, n, steps, None);
        assert!(factor <= 2.0, "{scene} n = {n} N = {steps}: {factor}");
    }
    // The law of another kind of scene is not within it.
    assert!(off("pure-mild", 16, 32, Some(Kind::Contact)) > 2.0);
    assert!(off("pure-mild", 16, 32, Some(Kind::Linear)) > 2.0);
}

#[test]
fn what_is_shared_is_paid_once() {
    let [alone, together] =
        [&[4][..], &[4, 16][..]].map(|steps| costs(&plan("pure-mild", 16, steps)));
    // All times of N = 4 are times of N = 16, which runs first.
    let (first, shared) = (alone.cases[0], together.cases[0]);
    // Loads have their stress of the moments.
    let rules = 2.0 * 16.0 * MOMENTS * 512.0;
    let truth = 5.0 * 12.0 * MOMENTS * 512.0 + ZETA + rules;
    assert!((first.seconds - shared.seconds - truth).abs() < 1e-12);
    assert_eq!(first.memory_bytes, shared.memory_bytes);
    assert!(together.cases[1].memory_bytes > shared.memory_bytes);
    assert_eq!((first.dofs, together.reference), (544, None));
}

#[test]
fn a_case_finds_on_its_mesh_what_longer_ones_have_left() {
    let left = |steps: &[u32]| -> Vec<f64> {
        costs(&plan("pure-mild", 16, steps)).cases.iter().map(|case| case.left_bytes).collect()
    };
    // The times of N = 4 and 8 are times of N = 16: what that keeps beyond theirs are the moments (12 numbers of a cell
    // and the exact loads, 544 unknowns) at the others.
    let a_time = 8.0 * (512.0 * 12.0 + 544.0);
    assert_eq!(left(&[4, 8, 16]), [12.0 * a_time, 8.0 * a_time, 0.0]);
    // N = 3 and 5 have the ends in common with 7, and nothing else.
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6 * b;
    let found = left(&[3, 5, 7]);
    assert!(near(found[1], 6.0 * a_time) && near(found[0], 10.0 * a_time), "{found:?}");
    // The cases alone do not know of each other.
    assert_eq!(left(&[4]), [0.0]);
}

/// The factor of 𝒜 stays for the other grids in time where all of them have it, and only there.
#[test]
fn a_factor_that_serves_all_grids_in_time_is_kept() {
    let factor = |scene: &str| {
        let plan = plan(scene, 8, &[4]);
        let space = setup(&plan).space(8).unwrap_or_else(|error| panic!("{error}"));
        march(setup(&plan), &space, 8, 4).kept_bytes / space.analysis.factor_entries() as f64
    };
    // Eight bytes a number, and those of the matrix.
    for scene in ["linear-punch", "elastic-punch"] {
        assert!(factor(scene) > 8.0 && factor(scene) < 16.0, "{scene}: {}", factor(scene));
    }
    for scene in ["punch", "bulk-shear"] {
        assert_eq!(factor(scene), 0.0, "{scene}");
    }
}

#[test]
fn a_reference_run_costs_more_than_the_cases_it_serves() {
    let plan = plan("elastic-punch", 8, &[8, 16]);
    let cost = costs(&plan);
    let reference = cost.reference.expect("a reference run");
    assert!(cost.cases.iter().all(|case| case.seconds < reference.seconds));
    assert!(cost.cases.iter().all(|case| case.memory_bytes > reference.memory_bytes));
}
