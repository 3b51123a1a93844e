//! Source: static bilateral contact with a bound of friction that falls with the slip, docs/estimates/STATIC.md.
//! Goal: u_ν = 0 holds and takes part in c_τ²; what the smallness condition forbids is refused with its numbers; an error that
//!   does not tend to zero is not taken for one that does; a functional of u can be fixed.
//! Mesh: n = 4 to 32, structured and of a polygon.
//! Data: static-bilateral, static-oblique, static-rough, abstract-bilateral.

use std::sync::Arc;

use crate::judged::verdict;
use crate::shipped::{edited, on_mesh, refusal, run, setup, setup_of, text};
use fem::contact::{Friction, StepView, TracePart};
use judge::verdict::Decision;
use scene::setup::{Setup, TraceConstant, weighted_trace_constant};
use vhi::law::{PiecewiseLinear, TensorField};

#[test]
fn the_normal_displacement_is_zero_and_the_side_slips() {
    for name in ["static-bilateral", "static-oblique"] {
        let setup = setup(name);
        let data = on_mesh(&setup, 8);
        let (mut across, mut along) = (0.0f64, 0.0f64);
        let see = |view: &StepView<'_>| {
            for (i, point) in data.space.trace.points.iter().enumerate() {
                across = across.max(data.space.trace.normal(i, view.u).abs());
                along = along.max(point.slip(view.u)[0].abs());
            }
        };
        run(&setup, &setup.model, &data, 1, see).unwrap_or_else(|error| panic!("{error}"));
        // Rounding of a turn by 30 degrees of displacements below 0.1.
        assert!(across < 1e-16 && along > 0.05, "{name}: {across:e} {along}");
    }
}

fn c_tau(setup: &Setup) -> TraceConstant {
    let identity = TensorField::identity();
    weighted_trace_constant(&setup.body.domain, &identity, TracePart::Tangential, &[])
        .expect("a constant")
}

/// u = (1 - y, 0) has |u_τ|² = 1 and ‖ε(u)‖² = 1/2: c_τ² ≥ 2 with u_ν = 0. Without it there are more functions.
#[test]
fn the_trace_constant_is_that_of_the_space_with_u_nu_zero() {
    let sound = setup("static-bilateral");
    let with = c_tau(&sound);
    let slower = edited(&text("static-bilateral"), "[0.1, 0.03]", "[0.1, 0.06]");
    let slower = edited(&slower, "0.08 - 0.5*V", "0.08 - 0.2*V");
    let free = edited(&slower, "bilateral = true ", "# ");
    let without = c_tau(&setup_of(free));
    assert!(with.value > 2.0 && with.range()[1] < 0.6 * without.range()[0], "{with:?}");
    assert_eq!(
        weighted_trace_constant(
            &sound.body.domain,
            &TensorField::identity(),
            TracePart::Normal,
            &[]
        )
        .expect("0"),
        TraceConstant::ZERO
    );
}

/// A slope of 0.61 is too steep for m_A = 2, and one of 0.5 is without u_ν = 0.
#[test]
fn a_bound_that_falls_too_fast_is_refused_with_numbers() {
    let sound = text("static-bilateral");
    let steep = edited(&sound, "[0.0, 0.08], [0.1, 0.03]", "[0.0, 0.08], [0.1, 0.019]");
    let said = refusal(edited(&steep, "0.08 - 0.5*V", "0.08 - 0.61*V"));
    for part in ["the smallness condition (2.9) fails", "0.61 * 3.34", "is not below m_A = 2"] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let said = refusal(edited(&sound, "bilateral = true ", "# "));
    for part in ["the smallness condition (2.9) fails", "0.5 * 6.4"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

#[test]
fn bilateral_contact_leaves_nothing_to_a_normal_law() {
    let sound = text("static-bilateral");
    for (key, more) in [
        ("gap", "gap = \"0.1\""),
        ("shift", "shift = \"0.1\""),
        ("law", "law = { kind = \"linear\", stiffness = 1.0 }"),
    ] {
        let said =
            refusal(edited(&sound, "bilateral = true ", &format!("{more}\nbilateral = true ")));
        assert!(said.contains(&format!("bilateral contact, and `{key}`")), "{said}");
    }
    let moved = refusal(edited(&sound, "\"beta*y*(1 - y)\"", "\"beta*(1 - y)\""));
    assert!(moved.contains("with bilateral contact"), "{moved}");
    let both =
        edited(&text("static-rough"), "tends_to_zero = true", "tends_to_zero = true\norder = 1.0");
    assert!(refusal(both).contains("both tends_to_zero and order"));
}

/// A solver that does not know that the bound falls converges to the solution of another problem: the error levels off.
#[test]
fn an_error_that_levels_off_is_not_said_to_tend_to_zero() {
    let sound = verdict(setup("static-rough"));
    assert_eq!(sound.decision, Decision::Pass, "{}", sound.reason);
    assert!(sound.constants.is_empty() && sound.interval.expect("an interval")[0] > 0.05);
    let mut constant = setup("static-rough");
    let points = vec![(0.0, -0.08), (0.0, 0.08)];
    let graph = Arc::new(PiecewiseLinear::new(points, 0.0, 0.0).expect("a graph"));
    constant.model.friction = constant.model.friction.map(|sound| Friction { graph, ..sound });
    let wrong = verdict(constant);
    assert_ne!(wrong.decision, Decision::Pass, "{}", wrong.reason);
}
