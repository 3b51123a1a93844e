//! Abstract scenes: A, S, φ, j and K at given vectors of ℝ².

use formula::EvaluationPoint;

use nalgebra::DVector;
use scene::setup::AbstractSetup;
use scene::{AbstractScene, Body, Scene};

use super::{ORIGIN, Tie, near, scene, value, with};
use crate::shipped::abstract_of;

pub const TIES: &[Tie] = &[
    (&["abstract.space.inner_product"], inner_product),
    (&["abstract.operator.matrix", "abstract.operator.nonlinear"], operator),
    (
        &[
            "abstract.history.kernels.q",
            "abstract.history.kernels.matrix",
            "abstract.history.R",
            "abstract.history.a_S",
        ],
        history,
    ),
    (&["abstract.history.kernels.singular"], singular),
    (&["abstract.history.kernels.inner", "abstract.history.start"], inner),
    (&["abstract.phi.force"], force),
    (
        &[
            "abstract.trace.functional",
            "abstract.trace.weight",
            "abstract.trace.law",
            "abstract.trace.upper",
            "abstract.trace.lower",
        ],
        traces,
    ),
    (
        &[
            "abstract.exact.u",
            "abstract.exact.multiplier",
            "abstract.exact.selection",
            "abstract.exact.parameters",
            "abstract.exact.define",
            "abstract.sweep.steps",
        ],
        exact,
    ),
];

/// Nothing symmetric that need not be. a·u = 2 u_1 = 0.2 at the upper bound, and in the jump of the law.
const PROBLEM: &str = r#"
[scene]
name = "finite"
kind = "abstract"
question = "Which number is read as which?"
dimension = 2
judge = false
[time]
horizon = 1.5
[space]
inner_product = [[2.0, 0.5], [0.5, 3.0]]
[operator]
matrix = [[5.0, 1.0], [2.0, 7.0]]
nonlinear = ["0.1*r", "0.2*r^3"]
[history]
kernels = [{ q = "t + 2*s", matrix = [[0.1, 0.2], [0.3, 0.4]] }]
R = [[1.0, 0.5], [0.25, 2.0]]
a_S = [0.6, -0.7]
[phi]
force = ["2*y + 0.1*r", "3*y"]
[[trace]]
functional = [2.0, 0.0]
weight = 0.5
law = { kind = "piecewise-linear", points = [[0.2, 0.0], [0.2, 0.05]], slope_before = 0.0, slope_after = 0.0 }
upper = 0.2
lower = -0.4
[exact]
u = ["a", "b*t"]
multiplier = ["c*t"]
selection = ["0.03"]
[exact.parameters]
c = 2.0
[exact.define]
a = "0.1"
b = "0.3"
[sweep]
steps = [4, 8]
"#;

fn read() -> (Scene, AbstractScene) {
    let read = scene(PROBLEM);
    let Body::Abstract(problem) = read.body.clone() else { panic!("an abstract scene") };
    (read, *problem)
}

fn setup() -> AbstractSetup {
    abstract_of(PROBLEM.to_owned())
}

fn vector(a: f64, b: f64) -> DVector<f64> {
    DVector::from_vec(vec![a, b])
}

/// ‖(1, 2)‖² = 2 + 2 · 0.5 · 2 + 3 · 4.
fn inner_product() {
    near(setup().model.norm(&vector(1.0, 2.0)), 16f64.sqrt());
}

/// A(1, 2) = (5 + 2 + 0.1, 2 + 14 + 1.6).
fn operator() {
    let found = setup().model.operator(&vector(1.0, 2.0));
    near(found[0], 7.1);
    near(found[1], 17.6);
}

/// q(t, s) = t + 2 s at t = 1, s = 0.25 is 1.5; Q, R and a_S row by row.
fn history() {
    let model = setup().model;
    near(model.kernels[0].kernel.at(1.0, 0.25), 1.5);
    let q = &model.kernels[0].matrix * vector(1.0, 10.0);
    near(q[0], 2.1);
    near(q[1], 4.3);
    let r = &model.r * vector(1.0, 10.0);
    near(r[0], 6.0);
    near(r[1], 20.25);
    near(model.a_s[0], 0.6);
    near(model.a_s[1], -0.7);
}

/// (t - s)^{-1/2} (t + 2 s) at t = 1, s = 0.75 is 2 · 2.5.
fn singular() {
    let edits = [
        ("horizon = 1.5", "horizon = 1.5\nrule = \"product-integration\""),
        ("q = \"t + 2*s\"", "q = \"t + 2*s\", singular = 0.5"),
    ];
    let setup = abstract_of(with(PROBLEM, &edits));
    let kernel = &setup.model.kernels[0].kernel;
    near(kernel.at(1.0, 0.75), 5.0);
    near(kernel.row(1.0, &[0.75])[0], 5.0);
    near(kernel.power(), 0.5);
    near(kernel.factor(1.0, 1.0), 3.0);
}

/// r(s, τ) = s + 3 τ at s = 1, τ = 0.25, and where v begins.
fn inner() {
    let edits = [
        ("q = \"t + 2*s\"", "q = \"t + 2*s\", inner = \"s + 3*tau\""),
        ("a_S = [0.6, -0.7]", "a_S = [0.6, -0.7]\nstart = [0.8, -0.9]"),
    ];
    let setup = abstract_of(with(PROBLEM, &edits));
    let model = setup.model;
    near(model.kernels[0].kernel.at(1.0, 0.25), 1.5);
    near(model.kernels[0].inner.as_ref().expect("an inner kernel").at(1.0, 0.25), 1.75);
    near(model.start[0], 0.8);
    near(model.start[1], -0.9);
}

/// N(y, u) = (2 · 3 + 0.1 · 5, 3 · 4) for y = (3, 4), u = (5, 6).
fn force() {
    let found = setup().model.force_of(&vector(3.0, 4.0), &vector(5.0, 6.0));
    near(found[0], 6.5);
    near(found[1], 12.0);
}

fn traces() {
    let model = setup().model;
    let [functional] = &model.functionals[..] else { panic!("one functional") };
    near(functional.a.dot(&vector(3.0, 10.0)), 6.0);
    near(functional.weight, 0.5);
    assert_eq!((functional.upper, functional.lower), (0.2, -0.4));
    assert_eq!(functional.potential.subdifferential(0.2), (0.0, 0.05));
    assert_eq!(functional.potential.subdifferential(0.1), (0.0, 0.0));
}

fn exact() {
    let (read, problem) = read();
    let at = EvaluationPoint { t: 0.7, ..ORIGIN };
    near(value(&read, problem.u[0], at), 0.1);
    near(value(&read, problem.u[1], at), 0.21);
    near(value(&read, problem.multiplier.as_ref().expect("a multiplier")[0], at), 1.4);
    near(value(&read, problem.selection.as_ref().expect("a selection")[0], at), 0.03);
    assert_eq!(read.sweep.as_ref().expect("a sweep").steps, [4, 8]);
}
