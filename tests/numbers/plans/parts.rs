//! Plans of scenes, loads in parts, and factors that serve levels.

use fem::contact::{CaseError, Discretization, Load, LoadError, Plan, march};
use scene::setup::{Setup, TruthLoad};
use vhi::Newton;
use vhi::history::{TimeGrid, TimeRule, Trapezoid};

use super::{AGREE, distance, in_volume, shortest};

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
        let mut setup = crate::shipped::setup(name);
        let data = crate::shipped::on_mesh(&setup, 6);
        let right = in_volume(&setup, &data, 8);
        setup.model.time_rule = Box::new(Heavy);
        let wrong = shortest(&setup, &data, 8);
        assert!(distance(&right, &wrong) > 10.0 * AGREE, "{name}");
    }
}

/// Parts of a load with weights that are off by so much.
struct Parts<'a>(TruthLoad<'a>, f64);

impl Load for Parts<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        self.0.assemble(t, out)
    }

    fn basis(&self) -> Option<&[Vec<f64>]> {
        self.0.basis()
    }

    fn factors(&self, t: f64, out: &mut [f64]) {
        self.0.factors(t, out);
        out.iter_mut().for_each(|factor| *factor *= 1.0 + self.1);
    }
}

/// Levels that are balanced by the parts of their load, on a mesh whose clamped nodes alone fill the last block of sums;
/// parts that are not those of the load are seen at the last level.
#[test]
fn parts_of_a_load_balance_and_wrong_ones_are_refused() {
    let setup = crate::shipped::setup("linear-punch");
    let data = crate::shipped::on_mesh(&setup, 22);
    let (short, volume) = (shortest(&setup, &data, 8), in_volume(&setup, &data, 8));
    assert!(distance(&short, &volume) <= AGREE);
    let info = short.info;
    assert!(info.kkt_residual > 0.0 && info.kkt_residual < 1e-12, "{:e}", info.kkt_residual);
    let newton = Newton::default();
    let run = |off| {
        let mut load = Parts(TruthLoad(&*data.truth), off);
        march(&data.space, &setup.model, &setup.grid(8), &mut load, &newton, &mut |_| Ok(()))
    };
    assert!(run(0.0).is_ok());
    // 1e-6 of the load is 5e-8 of the largest nodal force of these stresses.
    let error = run(1e-6).unwrap_err();
    assert!(matches!(error, CaseError::Kkt { n: 8, .. }), "{error}");
}

/// A load that is no number is named, not the balance that it spoils.
#[test]
fn a_load_in_parts_that_is_no_number_is_named() {
    struct Endless<'a>(TruthLoad<'a>);
    impl Load for Endless<'_> {
        fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
            self.0.assemble(t, out)?;
            let error = LoadError::Reference { reason: "no number".into() };
            if t > 0.4 { Err(error) } else { Ok(()) }
        }

        fn basis(&self) -> Option<&[Vec<f64>]> {
            self.0.basis()
        }

        fn factors(&self, t: f64, out: &mut [f64]) {
            self.0.factors(t, out);
            if t > 0.4 {
                out.fill(f64::INFINITY);
            }
        }
    }
    let setup = crate::shipped::setup("linear-punch");
    let data = crate::shipped::on_mesh(&setup, 4);
    let newton = Newton::default();
    let mut load = Endless(TruthLoad(&*data.truth));
    let error =
        march(&data.space, &setup.model, &setup.grid(8), &mut load, &newton, &mut |_| Ok(()));
    assert!(matches!(error, Err(CaseError::Load(_))), "{error:?}");
}

fn plan(setup: &Setup, space: &Discretization) -> Plan {
    Plan::of(space, &setup.model, 8, true)
}

#[test]
fn plans_are_those_of_the_terms() {
    for (name, expected) in [
        ("linear-punch", Plan::Recursion),
        ("elastic-punch", Plan::Condensed),
        ("punch", Plan::Newton),
    ] {
        let setup = crate::shipped::setup(name);
        let data = crate::shipped::on_mesh(&setup, 8);
        assert_eq!(plan(&setup, &data.space), expected, "{name}");
        // A solver that is not Newton's method alone is not replaced.
        assert_eq!(Plan::of(&data.space, &setup.model, 8, false), Plan::Newton);
    }
}

/// One factor serves levels until its extra iterations have cost a new one: fewer than one a level.
#[test]
fn old_factors_serve_and_the_answer_stays() {
    let setup = crate::shipped::setup("punch");
    let data = crate::shipped::on_mesh(&setup, 12);
    let info = shortest(&setup, &data, 48).info;
    assert!(info.work.linear.factorizations < 40, "{}", info.work.linear.factorizations);
    assert!(info.kkt_residual < 1e-11);
}
