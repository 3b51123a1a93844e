//! Source: -σ_τ ∈ S ∂|u_τ| as φ of Problem 1.
//! Goal: the bound at a jump, the slopes and the refusals are what they say. What another program finds:
//!   friction_independent.rs. A wrong sign, bound or stick set: docs/SABOTAGE.md.
//! Mesh: n × n squares cut from lower left to upper right.
//! Data: the scenes friction-….

use std::sync::Arc;

use crate::coulomb::Slipping;
use crate::shipped::{edited, on_mesh, refusal, run, setup, text};
use fem::contact::{Friction, StepView};
use scene::setup::Setup;
use studies::diagnose::diagnose;
use studies::theory::audit::audit;
use vhi::law::PiecewiseLinear;

/// u and s of the last level.
fn last(setup: &Setup, n: u32, steps: u32) -> (Vec<f64>, Vec<f64>) {
    let (data, mut seen) = (on_mesh(setup, n), (Vec::new(), Vec::new()));
    let see = |view: &StepView<'_>| seen = (view.u.to_vec(), view.friction.to_vec());
    run(setup, &setup.model, &data, steps, see).unwrap_or_else(|error| panic!("{error}"));
    seen
}

/// What a defect makes of S at a place.
type Change = fn([f64; 3], f64) -> f64;

/// A scene with another factor of the bound.
fn with_factor(scene: &str, change: Change) -> Setup {
    let mut setup = setup(scene);
    let Friction { factor, graph, .. } = setup.model.friction.take().expect("friction");
    let factor = Box::new(move |x: [f64; 3], t: f64| change(x, factor(x, t)));
    setup.model.friction = Some(Friction { factor, graph, follows_pressure: false });
    setup
}

/// Where all slips one way the friction stress is the bound at each vertex, and u is affine in it. A bound from the wrong
/// side of the jump has the same order in h.
#[test]
fn at_a_jump_the_bound_is_the_one_at_the_vertex() {
    let changes: [Change; 3] = [
        |_, s| s,
        |x, s| if x[0] == 0.5 { 0.05 } else { s },
        |x, s| if x[0] == 0.5 { 0.1 } else { s },
    ];
    let [right, left, mean] =
        changes.map(|change| last(&with_factor("friction-jump", change), 8, 1));
    let space = on_mesh(&setup("friction-jump"), 8).space;
    let strays = |s: &[f64]| {
        let bound = |x: f64| if x < 0.5 { 0.05 } else { 0.15 };
        let at = space.trace.points.iter().map(|point| space.mesh.vertex(point.vertex)[0]);
        // To rounding of the multipliers, which are residuals of the balance.
        at.zip(s).filter(|(x, s)| (s.abs() - bound(*x)).abs() > 1e-12).count()
    };
    assert_eq!([&right, &left].map(|(_, s)| strays(s)), [0, 1]);
    let largest = right.0.iter().fold(0.0f64, |m, u| m.max(u.abs()));
    let apart = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs() / largest))
    };
    let half: Vec<f64> = right.0.iter().zip(&left.0).map(|(a, b)| 0.5 * (a + b)).collect();
    // Newton stops at 16 units of rounding of the forces.
    assert!(apart(&half, &mean.0) < 1e-12, "{:e}", apart(&half, &mean.0));
    assert!(apart(&right.0, &mean.0) > 1e-3, "{:e}", apart(&right.0, &mean.0));
}

/// With vertices that slip both ways on a falling bound.
#[test]
fn the_slopes_of_a_falling_bound_are_its_differences() {
    let points = vec![(-0.2, -0.2), (0.0, -0.3), (0.0, 0.3), (0.2, 0.2)];
    let graph = Arc::new(PiecewiseLinear::new(points, 0.0, 0.0).expect("a law"));
    let mut setup = setup("friction-falling");
    setup.model.friction =
        Some(Friction { factor: Box::new(|_, _| 1.0), graph, follows_pressure: false });
    let Slipping { off: [off, _], slopes, .. } = crate::coulomb::slipping(&setup, None);
    assert!(slopes.iter().filter(|slope| **slope < 0.0).count() >= 4, "{slopes:?}");
    // Rounding 1e-16/1e-7 times a condition of 1e2; yielding cells move by 1e-7.
    assert!(off < 1e-5, "{off}");
}

#[test]
fn what_is_wrong_is_refused() {
    let slip = "points = [[0.0, 0.05], [0.1, 0.03]]";
    let front = "bound = \"0.05*(1 + t/2)\"";
    for (name, from, to, words) in [
        ("friction-front", front, "bound = \"0.02 - 0.03*t\"", "`bound` is -0.0"),
        ("friction-front", front, "bound = \"1/x\"", "`bound` is inf"),
        ("friction-front", front, "bound = \"0.01\"", "beyond the bound"),
        ("friction-front", front, "bound = \"0.06*(1 + t/2)\"", "slips and the bound"),
        ("friction-front", "friction = \"s\"", "friction = \"-s\"", "slips and the bound"),
        ("friction-front", front, "bound = { kind = \"slide\" }", "did you mean `slip`"),
        ("friction-falling", slip, "points = [[0.0, 0.02], [0.05, -0.01]]", "must not be negative"),
        ("friction-falling", slip, "points = [[0.1, 0.02]]", "points start at r = 0"),
        ("friction-falling", slip, "points = [[0.0, 0.3], [0.1, 0.2]]", "alpha_tau c_tau^2"),
    ] {
        let said = refusal(edited(&text(name), from, to));
        assert!(said.contains(words), "{name}, {to}: {said}");
    }
    let corner = edited(
        &text("friction-time"),
        "traction = [\"left\", \"right\"]",
        "traction = [\"right\"]",
    );
    let corner = edited(&corner, "contact = [\"bottom\"]", "contact = [\"bottom\", \"left\"]");
    let said = refusal(corner);
    assert!(said.contains("two contact sides with friction meet at x = 0, y = 0"), "{said}");
}

/// From the library too, not from the command line alone.
#[test]
fn studies_that_leave_friction_out_refuse_it() {
    let scene = || setup("friction-time").scene;
    for (study, said) in [
        ("audit", audit(&setup("friction-time"), &[4], &[4]).map(drop).map_err(said)),
        ("diagnose", diagnose(&scene(), &|setup| setup, true).map(drop).map_err(said)),
    ] {
        let said = said.expect_err(study);
        assert!(said.contains(&format!("`sweep {study}` does not treat friction")), "{said}");
    }
}

fn said(error: impl std::error::Error) -> String {
    error.to_string()
}
