//! The plan of a scene, Newton's method in the volume with old factors, with factors in single precision, and with a
//! factor in double precision of every Jacobian.

use algebra::linalg::Precision;
use fem::contact::{BoundaryRule, Plan};
use scene::setup::{MeshData, Setup};
use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::{Newton, Polished, StepSolver};

use super::anew::{Anew, OFF, defective};
use super::{AGREE, Run, Where, agree, distance, in_volume, run, same_bits, shortest};
use crate::shipped::{bodies, on_a_mesh, on_mesh, setup};

const STEPS: u32 = 8;

/// Whether Jacobians are all the same but for pieces of graphs and weights of last slots: an iteration may then find the
/// factor of its very matrix.
fn one_jacobian(setup: &Setup) -> bool {
    let facets = setup.model.boundary.as_ref().is_some_and(|boundary| {
        boundary.rule != BoundaryRule::Vertex && !boundary.potential.is_absent()
    });
    setup.model.projection.is_none() && !facets
}

fn anew(setup: &Setup, data: &MeshData, steps: u32, off: f64) -> Run {
    let solver = Anew { off, ..Anew::default() };
    let run = run(setup, data, steps, Where::Volume, &solver);
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

/// Runs with factors kept in double and in single precision.
fn in_both(setup: &mut Setup, solver: &dyn StepSolver) -> [Run; 2] {
    [Precision::Double, Precision::Single].map(|precision| {
        setup.precision = Some(precision);
        let data = on_a_mesh(setup);
        assert_eq!(data.space.precision, Some(precision));
        run(setup, &data, STEPS, Where::Volume, solver)
    })
}

/// Passes over the factor in double and in single precision, which lead to the same solution.
fn passes_of_both(mut setup: Setup) -> [u32; 2] {
    let name = setup.scene.name.clone();
    let [double, single] = in_both(&mut setup, &Newton::default());
    let off = distance(&double, &single);
    assert!(off <= agree(&setup), "{name}: {off:e}");
    // Rounding of the factor leaves its bits in the solution. With stiffnesses a million apart single precision may
    // find the matrix indefinite, and one more factor, in double precision, serves.
    let factors = [&double, &single].map(|run| run.info.work.linear.factorizations);
    let served = name.starts_with("locking") && factors[1] > factors[0];
    assert!(served || !same_bits(&double, &single), "{name}");
    // What is not asked for is double precision on these meshes.
    setup.precision = None;
    let data = on_a_mesh(&setup);
    assert!(same_bits(&double, &in_volume(&setup, &data, STEPS)), "{name}");
    [double, single].map(|run| run.info.work.linear.solves)
}

#[test]
fn both_precisions_have_the_same_solution() {
    for name in ["punch", "pure-box"] {
        let [double, single] = passes_of_both(setup(name));
        assert!(single > double, "{name}: {single} {double}");
    }
}

#[test]
#[ignore = "every scene: make test-long"]
fn long_both_precisions_of_all_scenes_have_the_same_solution() {
    let (mut more, mut fewer) = (0, 0);
    for setup in bodies() {
        let [double, single] = passes_of_both(setup);
        more += usize::from(single > double);
        fewer += usize::from(single < double);
    }
    // A factor in single precision is followed by iterations: more passes over it, where they are not one or two less
    // by the way residuals fall.
    assert!(more >= 40 && more > 8 * fewer, "{more} {fewer}");
}

#[test]
fn a_seeded_defect_in_the_equations_of_a_level_is_seen() {
    for name in ["punch", "affine", "law-exponential", "linear-punch", "elastic-punch"] {
        let mut setup = crate::shipped::setup(name);
        let data = on_a_mesh(&setup);
        let right = shortest(&setup, &data, STEPS);
        let [_, single] = in_both(&mut setup, &defective());
        for wrong in [anew(&setup, &data, STEPS, OFF), single] {
            let off = distance(&right, &wrong);
            assert!(off > 2.0 * AGREE, "{name}: {off:e}");
        }
    }
}

/// What is claimed of fresh factors does not hold of old ones: this solver does not pass for the other.
#[test]
fn old_factors_do_not_pass_for_fresh_ones() {
    let setup = crate::shipped::setup("punch");
    let data = on_a_mesh(&setup);
    let solver = Anew { old: true, ..Anew::default() };
    let old = run(&setup, &data, STEPS, Where::Volume, &solver);
    assert!(old.info.work.linear.factorizations < solver.solves.get());
    assert!(same_bits(&old, &in_volume(&setup, &data, STEPS)));
    assert!(!same_bits(&old, &anew(&setup, &data, STEPS, 0.0)));
}

/// n of `punch` with 4,704 unknowns: factors are kept in single precision and serve several Jacobians.
const LARGE: u32 = 48;

#[test]
fn what_large_runs_take_is_what_fresh_factors_give() {
    let mut setup = crate::shipped::setup("punch");
    let data = on_mesh(&setup, LARGE);
    assert!(data.space.dofs() >= 4000 && data.space.precision.is_none());
    let taken = shortest(&setup, &data, STEPS);
    let (linear, iterations) = (taken.info.work.linear, taken.info.newton_iterations);
    assert!(2 * linear.factorizations < iterations, "{linear:?}");
    let fresh = anew(&setup, &data, STEPS, 0.0);
    let off = distance(&fresh, &taken);
    println!("punch, n = {LARGE}: {off:.1e}");
    assert!(off <= AGREE, "{off:e}");
    let wrong = run(&setup, &data, STEPS, Where::Volume, &defective());
    assert!(distance(&fresh, &wrong) > 2.0 * AGREE, "{:e}", distance(&fresh, &wrong));
    // The precision is what it is by the size alone.
    let mut by = |precision| {
        setup.precision = Some(precision);
        shortest(&setup, &on_mesh(&setup, LARGE), STEPS)
    };
    assert!(same_bits(&taken, &by(Precision::Single)));
    assert!(!same_bits(&taken, &by(Precision::Double)));
}

/// The comparison sees a weight of the last slot that is off by 1e-6.
#[test]
fn a_seeded_defect_in_one_plan_is_seen() {
    struct Heavy;
    impl TimeRule for Heavy {
        fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
            let plain = Trapezoid.weight(grid, n, j);
            if j == n { plain * (1.0 + 1e-6) } else { plain }
        }
    }
    for name in ["elastic-punch", "linear-punch"] {
        let mut setup = setup(name);
        let data = on_mesh(&setup, 6);
        let right = in_volume(&setup, &data, STEPS);
        setup.model.time_rule = Box::new(Heavy);
        let wrong = shortest(&setup, &data, STEPS);
        assert!(distance(&right, &wrong) > 10.0 * AGREE, "{name}");
    }
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
        let polished = run(&setup, &data, STEPS, Where::Shortest, &Polished::default());
        assert!(polished.info.work.residuals > STEPS, "{name}");
    }
}

/// One factor serves levels until its extra iterations have cost a new one: fewer than one a level.
#[test]
fn old_factors_serve_and_the_answer_stays() {
    let setup = setup("punch");
    let data = on_mesh(&setup, 12);
    let info = shortest(&setup, &data, 48).info;
    assert!(info.work.linear.factorizations < 40, "{}", info.work.linear.factorizations);
    assert!(info.kkt_residual < 1e-11);
}
