//! Predictions against each other; comparisons with measured memory are tested with the program.

use super::*;
use crate::sweep::{Overrides, ScenePlan};
use scene::Scene;
use scene::setup::Subject;

fn plan(scene: &str, n: u32, steps: &[u32]) -> ScenePlan {
    let path = format!("{}/../../manufactured/{scene}.toml", env!("CARGO_MANIFEST_DIR"));
    let scene = Scene::read(path.as_ref()).unwrap_or_else(|error| panic!("{error}"));
    let subject = Subject::new(scene).unwrap_or_else(|error| panic!("{error}"));
    let n = subject.scene().as_contact().map(|_| vec![n]);
    ScenePlan::new(subject, &Overrides { n, steps: Some(steps.to_vec()) })
}

fn costs(plan: &ScenePlan) -> PlanCost {
    plan.costs().unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn cases_are_predicted_as_if_alone() {
    let [alone, together] =
        [&[4][..], &[4, 16][..]].map(|steps| costs(&plan("pure-mild", 16, steps)));
    assert_eq!(alone.cases[0], Cost { left_bytes: 0.0, ..together.cases[0] });
    let (short, long) = (together.cases[0], together.cases[1]);
    assert!(long.memory_bytes > short.memory_bytes && long.work == 4.0 * short.work);
    // Moments (12 numbers of a cell) and the exact loads (544 unknowns) at twelve more times.
    assert_eq!(long.kept_bytes - short.kept_bytes, 12.0 * 8.0 * (512.0 * 12.0 + 544.0));
    assert_eq!((short.dofs, together.reference), (544, None));
    // The longer case begins first; two of the times for 3 steps are not among its times.
    assert_eq!([short.left_bytes, long.left_bytes], [long.kept_bytes - short.kept_bytes, 0.0]);
    let kept = |plan: &PlanCost| kept_by_meshes(plan.cases.iter().map(|cost| (16, cost)));
    assert_eq!(kept(&together), long.kept_bytes);
    let apart = costs(&plan("pure-mild", 16, &[3, 16]));
    let more = 8.0 * (512.0 * 12.0 + 544.0);
    assert!((kept(&apart) - long.kept_bytes - 2.0 * more).abs() < 1.0, "{}", kept(&apart));
    // A problem without a mesh has a few numbers per level.
    let states = costs(&plan("abstract-smooth", 0, &[4, 16])).cases;
    assert!(states[0].memory_bytes < states[1].memory_bytes);
    assert!(states[1].memory_bytes < 1.01 * PROGRAM && states[1].kept_bytes == 0.0);
}

/// The factor of 𝒜 is kept for other grids in time only if all of them have it.
#[test]
fn a_factor_that_serves_all_grids_in_time_is_kept() {
    let factor = |scene: &str| {
        let plan = plan(scene, 8, &[4]);
        let Subject::Contact(setup) = &plan.subject else { panic!("no body") };
        let space = setup.space(8).unwrap_or_else(|error| panic!("{error}"));
        march(setup, &space, 4).kept_bytes / space.factor_size()[0]
    };
    // Eight bytes per number, and those of the matrix.
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
    assert!(cost.cases.iter().all(|case| case.work < reference.work));
    assert!(cost.cases.iter().all(|case| case.memory_bytes > reference.memory_bytes));
}

/// Numbers of steps without a useful common grid still have a prediction.
#[test]
fn grids_without_a_common_one_are_predicted() {
    let plan = plan("elastic-punch", 8, &[1009, 1013, 1019, 1021]);
    assert_eq!(plan.kept_steps(), u32::MAX);
    let cost = costs(&plan);
    assert!(cost.cases.iter().all(|case| case.memory_bytes > PROGRAM));
    assert!(cost.reference.is_some_and(|reference| reference.kept_bytes > 0.0));
}
