//! Source: Problem 9 and Theorems 6, 7 in R^m; exact solutions of the abstract scenes and closed forms by hand.
//! Goal: tangent, histories, solvers and orders of the problem without a mesh, each shown to fail on a seeded defect.
//! Data: manufactured/abstract-*.toml, and small scenes written here.

use crate::differences::order;
use crate::shipped::{abstract_of, edited, refusal, text};
use algebra::linalg::signed_unit;
use nalgebra::DVector;
use scene::setup::{AbstractLoad, AbstractSetup};
use studies::theory::bound::BoundStudy;
use vhi::finite::{FiniteError, FiniteEvolution, FiniteLoad, FiniteModel, FiniteView, march};
use vhi::history::TimeGrid;
use vhi::{FixedPoint, HistoryInequality, Newton, StepInequality, StepSolver, StepState};

fn shipped(name: &str) -> AbstractSetup {
    abstract_of(text(name))
}

/// The text of a small scene.
fn small(body: &str) -> String {
    format!(
        "[scene]\nname = \"small\"\nkind = \"abstract\"\nquestion = \"?\"\n{body}\n[[predicts]]\nnorm = \"V_max\"\nvariable = \"k\"\norder = 2.0\nwhy = \"Theorem 7\"\n"
    )
}

/// max_n ‖u(t_n) - u_n‖_X.
fn error(setup: &AbstractSetup, model: &FiniteModel, steps: u32, solver: &dyn StepSolver) -> f64 {
    let mut largest = 0f64;
    let mut observe = |view: &FiniteView<'_>| {
        let exact = DVector::from_column_slice(&setup.state(view.t).u);
        let distance = model.norm(&(exact - view.u));
        assert!(!distance.is_nan());
        largest = largest.max(distance);
    };
    march(model, &setup.grid(steps), &mut AbstractLoad(setup), solver, &mut observe)
        .unwrap_or_else(|error| panic!("N = {steps}: {error}"));
    largest
}

fn observed(setup: &AbstractSetup, model: &FiniteModel, steps: &[u32]) -> f64 {
    let measured =
        |&n: &u32| (setup.grid(n).largest_step(), error(setup, model, n, &Newton::default()));
    let (k, errors): (Vec<f64>, Vec<f64>) = steps.iter().map(measured).unzip();
    order(&k, &errors)
}

/// From N = 64 over six halvings.
const LADDER: [u32; 7] = [64, 128, 256, 512, 1024, 2048, 4096];

#[test]
fn smooth_problems_have_order_two_on_every_grid() {
    for name in ["abstract-smooth", "abstract-graded"] {
        let setup = shipped(name);
        let order = observed(&setup, &setup.model, &LADDER);
        assert!((order - 2.0).abs() <= 0.01, "{name}: {order}");
    }
    // Each grid draws its steps anew: the constant changes from N to N.
    let setup = shipped("abstract-random");
    let order = observed(&setup, &setup.model, &LADDER);
    assert!((order - 2.0).abs() <= 0.05, "abstract-random: {order}");
}

#[test]
fn contact_events_keep_order_two_in_the_mean() {
    let setup = shipped("abstract-contact");
    let order = observed(&setup, &setup.model, &LADDER);
    assert!((order - 2.0).abs() <= 0.1, "{order}");
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

/// A load that is not asked for.
struct NoLoad(usize);
impl FiniteLoad for NoLoad {
    fn at(&mut self, _: f64) -> Result<DVector<f64>, FiniteError> {
        Ok(DVector::zeros(self.0))
    }
}

/// ‖J⁻¹(F(w + s d) - F(w - s d))/2s - d‖/‖d‖ in the level after two committed ones.
fn mismatch(model: &FiniteModel, seen: &FiniteModel) -> f64 {
    let grid = TimeGrid::graded(1.0, 4, 1.5);
    let m = model.dimension();
    let (mut load, mut other) = (NoLoad(m), NoLoad(m));
    let mut problem = FiniteEvolution::new(model, &grid, &mut load).expect("coordinates");
    let mut tangent = FiniteEvolution::new(seen, &grid, &mut other).expect("coordinates");
    let (mut seed, step, mut worst) = (5, 1e-5, 0f64);
    let mut draw =
        |scale: f64| -> Vec<f64> { (0..m).map(|_| scale * signed_unit(&mut seed)).collect() };
    for _ in 0..2 {
        let u = StepState { u: draw(0.5), pressure: Vec::new() };
        for one in [&mut problem, &mut tangent] {
            one.open().expect("a level");
            one.commit(&u);
        }
    }
    problem.open().expect("a level");
    tangent.open().expect("a level");
    let slots = problem.graph().coordinates.len();
    for _ in 0..5 {
        let (w, d) = (draw(0.5), draw(1.0));
        let mut force = |sign: f64| {
            let at: Vec<f64> = w.iter().zip(&d).map(|(w, d)| w + sign * step * d).collect();
            let mut out = vec![0.0; m];
            problem.residual(&at, &mut out);
            out
        };
        let (plus, minus) = (force(1.0), force(-1.0));
        let mut x: Vec<f64> =
            plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * step)).collect();
        tangent.residual(&w, &mut vec![0.0; m]);
        tangent.linearize(&vec![0.0; slots], &vec![None; slots]).expect("regular");
        tangent.solve(&mut x, 0.0).expect("regular");
        let off: f64 = x.iter().zip(&d).map(|(x, d)| (x - d).powi(2)).sum();
        worst = worst.max(off.sqrt() / DVector::from_vec(d).norm());
    }
    worst
}

#[test]
fn the_tangent_agrees_with_differences() {
    // Central differences with 1e-5: truncation 1e-10, rounding 1e-11.
    for name in ["abstract-smooth", "abstract-contact"] {
        let setup = shipped(name);
        let off = mismatch(&setup.model, &setup.model);
        assert!(off < 1e-8, "{name}: {off}");
        // A tangent that forgets the last slot of the history is seen.
        let mut forgetful = shipped(name);
        forgetful.model.kernels.clear();
        assert!(mismatch(&setup.model, &forgetful.model) > 1e-3, "{name}");
    }
}

#[test]
fn the_fixed_point_finds_the_same_solution() {
    for name in ["abstract-smooth", "abstract-contact"] {
        let setup = shipped(name);
        let newton = error(&setup, &setup.model, 32, &Newton::default());
        let fixed = error(&setup, &setup.model, 32, &FixedPoint::default());
        // Both solve to rounding; the error is the same number to what 1e-13 of u leaves of it.
        assert!((newton - fixed).abs() < 1e-11, "{name}: {newton} {fixed}");
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
