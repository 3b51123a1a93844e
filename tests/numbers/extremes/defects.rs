//! Each kind of expectation fails where it must.

use crate::wrong::{scheme, solver};
use judge::claim::{Claim, Relation, Standing};
use scene::setup::Setup;
use studies::extremes::{Measured, Unanswered, UnderTest, Unitless, Units, claims, solve};
use vhi::law::{AnyProjection, FourthOrder, Isotropic, TensorField, VonMises};
use vhi::{Newton, OpenInequality, StepState};

use super::{ladder, row};

fn holds(climbed: &[Claim]) -> bool {
    Claim::all_hold(climbed)
}

/// Fine for a scene in units of one.
const TOLERANCE: f64 = 1e-11;

/// Newton's method that stops at an absolute residual.
fn absolute(mut setup: Setup) -> Setup {
    let solve = |problem: &mut dyn OpenInequality, state: &mut StepState, scratch: &mut _| {
        // The scale of the forces at the start is taken out again.
        let start = problem.force_scale(&state.u).max(f64::MIN_POSITIVE);
        let rounding_units = (TOLERANCE / (f64::EPSILON * start)).min(1e300);
        Newton { rounding_units, ..Newton::default() }.solve(problem, state, scratch)
    };
    setup.scheme = scheme(move |setup, data, steps, observe| {
        data.march(setup, steps, &solver(solve), observe)
    });
    setup
}

#[test]
fn an_absolute_tolerance_is_seen_in_every_unit_of_force() {
    let under_test = UnderTest { prepare: &absolute, ..UnderTest::default() };
    for (ladder, at) in
        [("unit-stiffness", "1e-50"), ("unit-displacement", "1e-50"), ("load", "1e-100")]
    {
        let row = row(ladder, at, &under_test);
        assert!(!holds(&row), "{row:?}");
    }
}

/// An answer that is not brought back by the unit it was computed in is not the same answer.
#[test]
fn a_wrong_unit_is_seen() {
    let units = Units { displacement: 1e10, ..Units::default() };
    for scene in Unitless::PLANE {
        let solved = |units: &Units| solve(scene.text(units), 2, 2, &|setup| setup).unwrap();
        let base = solved(&Units::default());
        let wrong = Units { displacement: 2e10, ..units };
        assert!(units.nondimensional(solved(&units), 2).distance(&base) < 1e-12, "{scene:?}");
        assert!(wrong.nondimensional(solved(&units), 2).distance(&base) > 0.1, "{scene:?}");
    }
}

fn with_lame(lambda: f64, mu: f64) -> impl Fn(Setup) -> Setup + Sync {
    move |mut setup| {
        let law = FourthOrder::Isotropic(Isotropic { lambda, mu });
        setup.model.elasticity = TensorField::new(law, []);
        setup
    }
}

#[test]
fn a_softer_body_exceeds_ceas_bound_and_a_softer_λ_the_bound_of_locking() {
    let soft = with_lame(1.0, 0.5);
    let under_test = UnderTest { prepare: &soft, ..UnderTest::default() };
    for (ladder, at) in [("mesh", "16"), ("aspect", "1e2"), ("sliver", "1e1")] {
        let row = row(ladder, at, &under_test);
        assert!(!holds(&row), "{row:?}");
    }
}

fn rest_of_the_projection(mut setup: Setup) -> Setup {
    with_mu(&mut setup, |mu| 1.0001 * mu);
    setup
}

fn with_mu(setup: &mut Setup, change: fn(f64) -> f64) {
    let changed = |sound: VonMises<_>| VonMises { mu: change(sound.mu), ..sound };
    let stated = setup.scene_projection().filter(|_| setup.model.projection.is_some());
    setup.model.projection = stated.map(|sound| AnyProjection::new(changed(sound)));
}

#[test]
fn a_projection_that_is_a_little_stiffer_is_seen() {
    let under_test = UnderTest { prepare: &rest_of_the_projection, ..UnderTest::default() };
    for (ladder, at) in [("projection", "1e0"), ("kappa", "1e-10"), ("through-zero", "1/2")] {
        let row = row(ladder, at, &under_test);
        assert!(!holds(&row), "{row:?}");
    }
}

/// A stiffness that is kept away from zero, as some programs do it.
fn kept_away_from_zero(mut setup: Setup) -> Setup {
    with_mu(&mut setup, |mu| mu.max(1e-9));
    setup
}

#[test]
fn a_subnormal_number_that_is_replaced_is_seen() {
    let under_test = UnderTest { prepare: &kept_away_from_zero, ..UnderTest::default() };
    let row = row("subnormal", "projection", &under_test);
    assert!(!holds(&row), "{row:?}");
}

#[test]
fn a_solver_that_stops_early_is_seen_near_every_bound() {
    // So coarse that the start value is accepted.
    let newton = Newton { rounding_units: 1e17, ..Newton::default() };
    let under_test = UnderTest { newton, ..UnderTest::default() };
    for (ladder, at) in [("smallness", "1e-1"), ("step-rising", "2"), ("step-falling", "1")] {
        let row = row(ladder, at, &under_test);
        assert!(!holds(&row), "{row:?}");
    }
}

#[test]
fn a_panic_is_a_failed_row_and_ends_nothing() {
    let broken = |_: Setup| -> Setup { panic!("seeded") };
    let under_test = UnderTest { prepare: &broken, ..UnderTest::default() };
    let failed = row("gap", "1e300", &under_test);
    let claim = &failed[0];
    assert!(!holds(&failed) && claim.note.contains("seeded") && claim.left.is_nan(), "{claim:?}");
    // A rung without a body goes on.
    assert!(holds(&row("step-rising", "2", &under_test)));
}

#[test]
fn refusals_answers_and_nan_are_told_apart() {
    let ladder = ladder("gap");
    let holds = |expected: Relation, outcome: Result<Measured, Unanswered>| {
        Claim::all_hold(&claims(&ladder, "1", expected, &outcome))
    };
    let refusal = Relation::Refused("(2.9)");
    let said = |text: &str| Err(Unanswered::Refused(text.to_owned()));
    assert!(holds(refusal, said("the condition (2.9) fails")));
    assert!(!holds(refusal, said("no such file")));
    assert!(!holds(refusal, Err(Unanswered::Panicked("(2.9)".into()))));
    assert!(!holds(refusal, Ok(Measured::number(0.0))));
    assert!(!holds(Relation::AtMost(1.0), said("(2.9)")));
    assert!(holds(Relation::AtMost(1.0), Ok(Measured::number(1.0))));
    for value in [1.1, f64::NAN, f64::INFINITY] {
        assert!(!holds(Relation::AtMost(1.0), Ok(Measured::number(value))));
        assert!(!holds(Relation::Within([0.0, 1.0]), Ok(Measured::number(value))));
    }
    // The residual by separate evaluation is watched whatever the number is.
    for kkt in [1e-8, f64::NAN] {
        let measured = Measured { kkt: Some(kkt), ..Measured::number(0.5) };
        let found = claims(&ladder, "1", Relation::AtMost(1.0), &Ok(measured));
        let standings: Vec<Standing> = found.iter().map(Claim::standing).collect();
        assert_eq!(standings, [Standing::Passes, Standing::Fails]);
    }
}
