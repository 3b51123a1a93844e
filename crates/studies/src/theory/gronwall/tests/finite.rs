//! Abstract scenes: the chain on every kind of grid.

use super::super::scenes::FiniteInTime;
use super::super::*;
use super::{subject, violations};
use scene::setup::{AbstractSetup, Subject};
use vhi::history::{CorrectedEnd, TimeRule, Trapezoid};

fn abstract_setup(name: &str) -> AbstractSetup {
    match subject(name) {
        Subject::Abstract(setup) => *setup,
        Subject::Contact(_) => panic!("{name} has a body"),
    }
}

/// Uniform, graded and random steps, convolutions and general kernels, contact events.
#[test]
fn the_chain_holds_on_uniform_graded_and_random_grids() {
    for name in ["abstract-smooth", "abstract-contact", "abstract-graded", "abstract-random"] {
        let setup = abstract_setup(name);
        let scene = FiniteInTime::new(&setup).unwrap();
        for steps in [16, 64, 128] {
            let run = scene.measure(steps).unwrap();
            assert_eq!(violations(&run), [], "{name} {steps}");
            let last = steps as usize;
            assert!(run.error[last] > 1e3 * run.floor, "{name} {steps}");
            // Truncation is of order 2: k² times a constant that the scenes keep below 1.
            let k = run.grid.largest_step();
            assert!(run.truncation[1][last] < k * k, "{name} {steps}");
        }
    }
}

/// For one kernel κ(n, j) = |q(t_n, t_j)| ‖RQ‖ attains ‖R‖‖q‖ at q = 1, R = I: C2 is that of (3.4).
#[test]
fn constants_are_those_of_the_step_bound() {
    let setup = abstract_setup("abstract-contact");
    let scene = FiniteInTime::new(&setup).unwrap();
    let run = scene.measure(64).unwrap();
    let c2 = run.c2();
    assert!(
        (c2 * setup.constants.step_bounds(setup.model.time_rule.as_ref()).limit() - 1.0).abs()
            < 1e-12,
        "{c2}"
    );
    let part = &run.parts[0];
    let kappa = |n: usize| part.rows[n][n] / Trapezoid.weight(&run.grid, n, n);
    let largest = (1..=64).map(kappa).fold(0.0, f64::max);
    assert!((largest / part.supremum - 1.0).abs() < 1e-12);
}

#[test]
fn other_rules_are_refused() {
    let mut setup = abstract_setup("abstract-contact");
    setup.scene.time.rule = scene::TimeRule::CorrectedEnd { exponent: 0.5 };
    setup.model.time_rule = Box::new(CorrectedEnd { exponent: 0.5 });
    let refused = FiniteInTime::new(&setup).err().unwrap();
    assert!(refused.to_string().contains("corrects its last weight"), "{refused}");
}
