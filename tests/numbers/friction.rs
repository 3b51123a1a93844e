//! Source: -σ_τ ∈ S ∂|u_τ| as φ of Problem 1; tests/fixtures/tresca.json by tests/independent/tresca.py, which knows
//!   nothing of this program.
//! Goal: friction is what another program finds; the KKT rows, the slopes, the constants and the refusals are what they say.
//!   A wrong sign, bound or stick set: docs/SABOTAGE.md.
//! Mesh: n × n squares cut from lower left to upper right; the same turned by an angle.
//! Data: the scenes friction-…, and a block that is pulled along a layer.

use crate::program::repository;
use std::sync::Arc;

use crate::coulomb::Slipping;
use crate::shipped::{edited, fixture, on_mesh, refusal, run, setup, setup_of, text};
use fem::contact::{Friction, StepView, TraceMass, TracePart, trace_constants};
use scene::setup::{Setup, constants};
use studies::diagnose::diagnose;
use studies::theory::audit::audit;
use vhi::law::{PiecewiseLinear, TensorField};

fn independent() -> Setup {
    setup_of(repository("tests/independent/tresca.toml"))
}

/// u and s of the last level.
fn last(setup: &Setup, n: u32, steps: u32) -> (Vec<f64>, Vec<f64>) {
    let (data, mut seen) = (on_mesh(setup, n), (Vec::new(), Vec::new()));
    let see = |view: &StepView<'_>| seen = (view.u.to_vec(), view.friction.to_vec());
    run(setup, &setup.model, &data, steps, see).unwrap_or_else(|error| panic!("{error}"));
    seen
}

/// Every displacement and every friction stress, to 1e-9 of the largest: both solve the same discrete problem, to 1e-13.
#[test]
fn another_program_finds_the_same() {
    let known = fixture("tresca");
    let [n, steps] = ["n", "steps"].map(|key| known[key].as_u64().expect("a count") as u32);
    let setup = independent();
    let (u, s) = last(&setup, n, steps);
    let space = on_mesh(&setup, n).space;
    let rows = |key: &str| known[key].as_array().expect("rows").clone();
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let largest = |all: &[f64]| all.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for (vertex, row) in rows("u").iter().enumerate() {
        for i in 0..2 {
            let found = u[2 * space.nodes.of_vertex[vertex] as usize + i];
            assert!((found - number(&row[i])).abs() <= 1e-9 * largest(&u), "u at vertex {vertex}");
        }
    }
    // The bottom row of vertices from left to right.
    for (point, found) in space.trace.points.iter().zip(&s) {
        let known = number(&rows("friction")[point.vertex as usize]);
        assert!((found - known).abs() <= 1e-9 * largest(&s), "s at vertex {}", point.vertex);
    }
    let bound = |x: f64| 0.05 * (1.0 + 6.0 * x) * 1.5;
    let at = |p: &fem::contact::TracePoint| space.mesh.vertex(p.vertex)[0];
    let sticks = space.trace.points.iter().zip(&s).filter(|(p, s)| s.abs() < 0.99 * bound(at(p)));
    let sticks = sticks.count();
    assert!(sticks >= 2 && sticks + 2 <= s.len(), "{sticks} of {} stick", s.len());
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

/// A vertex with a frame takes the second unknown of it: the same body, turned, has the same answer.
#[test]
fn a_turned_body_has_the_same_friction() {
    let polygon = |angle: f64| {
        let (c, s) = (angle.cos(), angle.sin());
        let corner = |[x, y]: [f64; 2]| format!("[{:?}, {:?}]", c * x - s * y, s * x + c * y);
        let corners: Vec<String> =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(corner).into();
        let domain = format!(
            "shape = \"polygon\"\nvertices = [{}]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]",
            corners.join(", ")
        );
        let text = repository("tests/independent/tresca.toml");
        let text = edited(&text, "shape = \"rectangle\"\nsize = [1.0, 1.0]", &domain);
        let (bound, body) = ("0.05*(1 + 6*x)*(1 + t/2)", "[\"0.4*t\", \"-0.2\"]");
        let text = edited(&text, bound, &format!("0.05*(1 + 6*({c:?}*x + {s:?}*y))*(1 + t/2)"));
        let turned_body = format!("[\"{c:?}*0.4*t + {s:?}*0.2\", \"{s:?}*0.4*t - {c:?}*0.2\"]");
        setup_of(edited(&text, body, &turned_body))
    };
    let (straight, turned) = (polygon(0.0), polygon(0.5));
    let ((u, s), (v, r)) = (last(&straight, 4, 3), last(&turned, 4, 3));
    let (c, sine) = (0.5f64.cos(), 0.5f64.sin());
    let largest = u.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for (a, b) in u.chunks(2).zip(v.chunks(2)) {
        let image = [c * a[0] - sine * a[1], sine * a[0] + c * a[1]];
        assert!((0..2).all(|i| (image[i] - b[i]).abs() < 1e-11 * largest), "{image:?} {b:?}");
    }
    assert!(s.iter().zip(&r).all(|(s, r)| (s - r).abs() < 1e-11), "{s:?} {r:?}");
    assert!(s.iter().any(|s| *s > 0.0));
}

/// c_τ² of the unit square is 6.444 by elements of degree 2 on n = 32 (scipy); P1 lies below and comes near.
#[test]
fn the_tangential_trace_constant_is_large() {
    let setup = setup("friction-front");
    let found = constants(&setup).expect("constants");
    assert!((found.c_tau_squared - 6.444).abs() < 0.005, "{}", found.c_tau_squared);
    for mass in [TraceMass::Consistent, TraceMass::Lumped] {
        let value = |n| {
            let (space, square) = (on_mesh(&setup, n).space, (TracePart::Tangential, mass));
            trace_constants(&space, &TensorField::identity(), [square]).expect("one")[0].value
        };
        let [coarse, fine] = [8, 16].map(value);
        assert!((fine - 6.444).abs() < 0.3 * (coarse - 6.444).abs(), "{coarse} {fine}");
    }
    let falling = constants(&crate::shipped::setup("friction-falling")).expect("constants");
    let m0 = 2.0 - 0.2 * falling.c_tau_squared;
    assert!((falling.m0 - m0).abs() < 1e-12 && falling.m0 > 0.0, "{}", falling.m0);
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
