//! Source: Problem 9 and Theorems 6, 7 in R^m; exact solutions of the abstract scenes and closed forms by hand.
//! Goal: histories, inclusions, refusals and the bound on the step of the problem without a mesh. Orders, constants and work of its
//!   scenes: the main job. Wrong parts of it: docs/SABOTAGE.md.
//! Data: manufactured/abstract-*.toml, and small scenes written here.

use crate::shipped::{abstract_of, edited, refusal, text};
use scene::setup::{AbstractLoad, AbstractSetup};
use studies::theory::bound::BoundStudy;
use vhi::Newton;
use vhi::finite::{FiniteView, march};

fn shipped(name: &str) -> AbstractSetup {
    abstract_of(text(name))
}

/// The text of a small scene.
fn small(body: &str) -> String {
    format!(
        "[scene]\nname = \"small\"\nkind = \"abstract\"\nquestion = \"?\"\n{body}\n[[predicts]]\nnorm = \"V_max\"\nvariable = \"k\"\norder = 2.0\nwhy = \"Theorem 7\"\n"
    )
}

/// ∫_0^t e^{-(t-s)} sin s ds = (sin t - cos t + e^{-t})/2, and a square root at either end.
#[test]
fn histories_have_their_closed_forms() {
    let setup = abstract_of(small(
        "dimension = 2\n[time]\nhorizon = 2.0\n[operator]\nmatrix = [[3.0, 0.0], [0.0, 3.0]]\n[history]\nkernels = [{ q = \"exp(-(t - s))\", matrix = [[1.0, 0.0], [0.0, 0.0]] }, { q = \"sqrt(t - s)\", matrix = [[0.0, 0.0], [0.0, 1.0]] }]\n[exact]\nu = [\"sin(t)\", \"sqrt(t)\"]\n[sweep]\nsteps = [4]",
    ));
    for t in [0.0, 1e-3, 0.7, 2.0] {
        let history = &setup.state(t).history;
        let first = 0.5 * (t.sin() - t.cos() + (-t).exp());
        // B(3/2, 3/2) = π/8.
        let second = std::f64::consts::PI / 8.0 * t * t;
        // Sums of a few hundred terms of size up to t.
        assert!((history[0] - first).abs() < 1e-14, "{t}: {} {first}", history[0]);
        assert!((history[1] - second).abs() < 1e-13, "{t}: {} {second}", history[1]);
    }
}

/// A rigid-plastic law, ∂j(0) = [0, 1]: the selection is a true unknown of the inclusion.
const STUCK: &str = "dimension = 1\n[time]\nhorizon = 1.0\n[operator]\nmatrix = [[2.0]]\n[history]\nkernels = [{ q = \"-0.5*exp(-(t - s))\" }]\n[[trace]]\nfunctional = [1.0]\nlaw = { kind = \"piecewise-linear\", points = [[0.0, 0.0], [0.0, 1.0]], slope_before = 0.0, slope_after = -0.2 }\n[exact]\nu = [\"max(0, t - 0.5)\"]\nselection = [\"if(t < 0.5, 2*t, 1 - 0.2*(t - 0.5))\"]\n[sweep]\nsteps = [4]";

#[test]
fn set_valued_laws_are_solved_as_inclusions() {
    let setup = abstract_of(small(STUCK));
    let mut pressures = Vec::new();
    let mut observe = |view: &FiniteView<'_>| pressures.push((view.t, view.u[0], view.pressure[0]));
    march(
        &setup.model,
        &setup.grid(20),
        &mut AbstractLoad(&setup),
        &Newton::default(),
        &mut observe,
    )
    .unwrap_or_else(|error| panic!("{error}"));
    for (t, u, xi) in pressures.into_iter().filter(|(t, _, _)| *t < 0.49) {
        assert_eq!(u, 0.0, "{t}");
        assert!((xi - 2.0 * t).abs() < 1e-14, "{t}: {xi}");
    }
}

#[test]
fn what_is_no_solution_is_refused_with_its_place() {
    for (from, to, said) in [
        ("1 - 0.2*(t - 0.5))", "1.4)", "is not in"),
        ("slope_after = -0.2", "slope_after = -2.5", "(2.9)"),
        ("matrix = [[2.0]]", "matrix = [[2.0, 1.0]]", "2 entries, but 1 are expected"),
        ("functional = [1.0]", "functional = [0.0]", "zero"),
        ("functional = [1.0]", "functional = [1.0]\nupper = 0.2", "leaves"),
        ("functional = [1.0]", "functional = [1.0]\nupper = 0.2\nlower = 0.3", "lower <= upper"),
        ("-0.5*exp(-(t - s))", "-0.5/(t - s)^2", "singular = a"),
        ("-0.5*exp(-(t - s))", "-0.5*sqrt(0.7 - t + s)", "q(t, s) has no bound near"),
        ("u = [\"max(0, t - 0.5)\"]", "u = [\"x\"]", "not allowed"),
        ("dimension = 1", "dimension = 0", "no dimension"),
        ("kind = \"abstract\"", "kind = \"abstrct\"", "did you mean"),
    ] {
        let message = refusal(edited(&small(STUCK), from, to));
        assert!(message.contains(said) && message.contains("edited.toml:"), "{to}: {message}");
    }
}

/// DΛ by solves against differences of Λ, its adjoint, and the bounds of its norm.
#[test]
fn the_study_of_the_step_size_holds_and_its_defects_are_seen() {
    for name in ["abstract-smooth", "abstract-contact"] {
        let mut setup = shipped(name);
        let bound = BoundStudy::of_abstract(&setup, 8).unwrap_or_else(|error| panic!("{error}"));
        assert!(bound.holds(), "{name}: {:?}", bound.claims);
        let smallest = &bound.study.rungs[0];
        // Finite perturbations of 1e-6 have seven digits.
        assert!((smallest.finite_worst / smallest.norm - 1.0).abs() < 1e-5, "{name}: {smallest:?}");
        assert!(smallest.norm > 0.0);
        let samples = crate::samples::finite(&setup.model, &setup.constants);
        assert!(samples.iter().all(|row| row.reason().is_none()), "{name}: {samples:?}");
        // A constant that promises ten times too much is caught.
        setup.constants.m0 *= 10.0;
        setup.constants.m_a *= 10.0;
        let wrong = BoundStudy::of_abstract(&setup, 8).unwrap_or_else(|error| panic!("{error}"));
        assert!(!wrong.holds(), "{name}");
        let samples = crate::samples::finite(&setup.model, &setup.constants);
        assert!(samples.iter().any(|row| row.reason().is_some()), "{name}");
    }
}

/// One unknown, A = 2, q = 0.6: Λ has the factor (k/2)·0.6/2, the sharpened bound itself.
#[test]
fn a_single_unknown_attains_the_sharpened_bound() {
    let setup = abstract_of(small(
        "dimension = 1\n[time]\nhorizon = 1.0\n[operator]\nmatrix = [[2.0]]\n[history]\nkernels = [{ q = \"0.6 + 0*t\" }]\n[exact]\nu = [\"sin(t)\"]\n[sweep]\nsteps = [4]",
    ));
    let bound = BoundStudy::of_abstract(&setup, 4).unwrap_or_else(|error| panic!("{error}"));
    assert!(bound.holds(), "{:?}", bound.claims);
    let rung = &bound.study.rungs[3];
    assert!((rung.norm - 0.5 * rung.k * 0.6 / 2.0).abs() < 1e-12, "{rung:?}");
}
