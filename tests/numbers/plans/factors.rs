//! The plan of a scene, Newton's method in the volume with lagged factors, and with a factor of every Jacobian.

use fem::contact::{BoundaryRule, Plan};
use scene::setup::{MeshData, Setup};
use vhi::Polished;

use super::anew::{Anew, OFF, defective};
use super::{AGREE, Run, agree, distance, in_volume, run, same_bits, shortest};
use crate::shipped::{bodies, on_a_mesh, on_mesh, setup};

const STEPS: u32 = 8;

/// Whether Jacobians are all the same but for pieces of graphs and weights of last slots: an iteration may then find the
/// factor of its very matrix.
fn one_jacobian(setup: &Setup) -> bool {
    let facets =
        setup.model.boundary.iter().any(|boundary| {
            boundary.rule != BoundaryRule::Vertex && !boundary.potential.is_absent()
        });
    setup.model.projection.is_none() && !facets
}

fn anew(setup: &Setup, data: &MeshData, steps: u32, off: f64) -> Run {
    let solver = Anew { off, ..Anew::default() };
    let run = run(setup, data, steps, &solver);
    let (made, asked) = (run.info.work.linear.factorizations, solver.solves.get());
    let name = &setup.scene.name;
    assert_eq!(asked, run.info.newton_iterations, "{name}");
    if one_jacobian(setup) {
        assert!(made >= 1, "{name}: {made} factors");
    } else {
        assert!(made >= asked, "{name}: {made} factors for {asked} Jacobians");
    }
    run
}

/// The plan of a scene, whose solution is that of fresh factors; and whether a factor of Newton's method in the volume
/// served more than one Jacobian, where those differ.
fn same_solution(setup: &Setup) -> (Plan, Option<bool>) {
    let (data, name) = (on_a_mesh(setup), &setup.scene.name);
    let plan = Plan::of(&data.space, &setup.model);
    let short = shortest(setup, &data, STEPS);
    let volume = in_volume(setup, &data, STEPS);
    let fresh = anew(setup, &data, STEPS, 0.0);
    for (way, other) in [("shortest", &short), ("old factors", &volume)] {
        let off = distance(&fresh, other);
        assert!(off <= agree(setup), "{name} {plan:?} {way}: {off:e}");
    }
    match plan {
        Plan::Newton => assert!(same_bits(&short, &volume), "{name}"),
        // One factor, and none of the walks over the volume that Newton's method takes.
        _ => {
            assert_eq!(short.info.work.residuals, 0, "{name}");
            assert!(volume.info.work.residuals > STEPS, "{name}");
            if !Plan::changes_factor(&setup.model) {
                assert_eq!(short.info.work.linear.factorizations, 1, "{name}");
            }
        }
    }
    let served = volume.info.work.linear.factorizations < volume.info.newton_iterations;
    (plan, (!one_jacobian(setup)).then_some(served))
}

#[test]
fn each_plan_has_the_same_solution() {
    let plans = ["linear-punch", "compliance", "punch"].map(|name| same_solution(&setup(name)).0);
    println!("{plans:?}");
    for (i, plan) in plans.iter().enumerate() {
        assert!(!plans[..i].contains(plan), "{plans:?}");
    }
}

#[test]
#[ignore = "every scene: make test-long"]
fn long_all_plans_of_all_scenes_have_the_same_solution() {
    let (mut taken, mut old, mut never) = ([0; 3], 0, Vec::new());
    for setup in bodies() {
        let (plan, served) = same_solution(&setup);
        taken[plan as usize] += 1;
        match served {
            Some(true) => old += 1,
            Some(false) => never.push(setup.scene.name),
            None => (),
        }
    }
    // Each way has scenes; that of condensation is the way of all scenes with contact at the vertices alone.
    assert!(taken.iter().all(|&count| count >= 4), "{taken:?}");
    // Of scenes whose Jacobians differ, a factor served several of them; but where one iteration is all there is.
    assert!(old >= 20, "{old}");
    assert_eq!(never, ["law-linear"]);
}

#[test]
fn a_seeded_defect_in_the_equations_of_a_level_is_seen() {
    for name in ["punch", "affine", "law-exponential", "linear-punch", "elastic-punch"] {
        let setup = setup(name);
        let data = on_a_mesh(&setup);
        let right = shortest(&setup, &data, STEPS);
        let lagged = run(&setup, &data, STEPS, &defective());
        for wrong in [anew(&setup, &data, STEPS, OFF), lagged] {
            let off = distance(&right, &wrong);
            assert!(off > 2.0 * AGREE, "{name}: {off:e}");
        }
    }
}

/// What is claimed of fresh factors does not hold of old ones: this solver does not pass for the other.
#[test]
fn old_factors_do_not_pass_for_fresh_ones() {
    let setup = setup("punch");
    let data = on_a_mesh(&setup);
    let solver = Anew { old: true, ..Anew::default() };
    let old = run(&setup, &data, STEPS, &solver);
    assert!(old.info.work.linear.factorizations < solver.solves.get());
    assert!(same_bits(&old, &in_volume(&setup, &data, STEPS)));
    assert!(!same_bits(&old, &anew(&setup, &data, STEPS, 0.0)));
}

/// n of `punch` with 4,704 unknowns, where a factor is worth many solves.
const LARGE: u32 = 48;

#[test]
fn what_large_runs_take_is_what_fresh_factors_give() {
    let setup = setup("punch");
    let data = on_mesh(&setup, LARGE);
    let taken = shortest(&setup, &data, STEPS);
    let (linear, iterations) = (taken.info.work.linear, taken.info.newton_iterations);
    assert!(2 * linear.factorizations < iterations, "{linear:?}");
    let fresh = anew(&setup, &data, STEPS, 0.0);
    let off = distance(&fresh, &taken);
    println!("punch, n = {LARGE}: {off:.1e}");
    assert!(off <= AGREE, "{off:e}");
    let wrong = run(&setup, &data, STEPS, &defective());
    assert!(distance(&fresh, &wrong) > 2.0 * AGREE, "{:e}", distance(&fresh, &wrong));
}

/// A solver that is not Newton's method alone is not replaced.
#[test]
fn plans_are_those_of_the_terms() {
    for (name, expected) in [
        ("linear-punch", Plan::Linear),
        ("elastic-punch", Plan::Condensed),
        ("punch", Plan::Newton),
        ("punch-box", Plan::Newton),
    ] {
        let setup = setup(name);
        let data = on_mesh(&setup, 4);
        assert_eq!(Plan::of(&data.space, &setup.model), expected, "{name}");
        let polished = run(&setup, &data, STEPS, &Polished::default());
        assert!(polished.info.work.residuals > STEPS, "{name}");
    }
}
