//! Truncation errors and errors in time against closed forms.

use super::super::*;
use super::setup;
use crate::study::StudyError;
use scene::setup::MeshData;
use vhi::history::{TimeGrid, TimeRule, Trapezoid};

/// The run of a scene, and the constants.
fn measured(name: &str, n: u32, steps: u32) -> (Estimate, GronwallConstants) {
    let setup = setup(name);
    let scene = ContactInTime::new(&setup, n, &[steps]).unwrap();
    (scene.measure(steps).unwrap(), scene.constants)
}

/// ∫_0^{t_n} f minus its trapezoidal sum, from an antiderivative.
fn defect(grid: &TimeGrid, n: usize, f: fn(f64) -> f64, integral: fn(f64) -> f64) -> f64 {
    let sum: f64 = (0..=n).map(|j| Trapezoid.weight(grid, n, j) * f(grid.time(j))).sum();
    integral(grid.time(n)) - integral(0.0) - sum
}

/// long-growing: 𝒜ε = 2ε, ℬε = -½ε, u = (b, -a)(1 - y), so that 2(ε_n - ε_n^k) = ½(D_n + Σ'(ε_j -
/// ε_j^k)), D_n the truncation of ∫ε: a scalar recurrence for each component, with the antiderivatives
/// of b = 0.3 sin 2t and a = 0.05(1 - cos t) known. ‖ε((p, q)(1 - y))‖² = p²/2 + q².
#[test]
fn truncation_and_error_of_a_linear_scene_are_those_of_a_scalar_recurrence() {
    let (run, constants) = measured("long-growing", 4, 32);
    assert_eq!((constants.m0, constants.beta, constants.lipschitz()), (2.0, 1.0, 0.5));
    let grid = &run.grid;
    let size = |p: f64, q: f64| (0.5 * p * p + q * q).sqrt();
    let (mut p, mut q): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    for n in 0..=32 {
        let b = defect(grid, n, |t| 0.3 * (2.0 * t).sin(), |t| -0.15 * (2.0 * t).cos());
        let a = defect(grid, n, |t| 0.05 * (1.0 - t.cos()), |t| 0.05 * (t - t.sin()));
        // Rounding of sums of 33 terms of size 0.3 times k = 1/8: 1e-15; so below.
        assert!((run.truncation[1][n] - 0.5 * size(b, a)).abs() < 1e-13);
        let next = |defect: f64, known: &[f64]| {
            let past: f64 =
                known.iter().enumerate().map(|(j, e)| Trapezoid.weight(grid, n, j) * e).sum();
            0.25 * (defect + past) / (1.0 - 0.25 * Trapezoid.weight(grid, n, n))
        };
        let (x, y) = (next(b, &p), next(a, &q));
        p.push(x);
        q.push(y);
        assert!((run.error[n] - size(x, y)).abs() < 1e-12, "{n}");
    }
    assert!(run.truncation[0].iter().all(|g| *g == 0.0));
    assert!(run.error[32] > 1e-5);
}

/// affine: ∫e^{-(t-s)}b = 0.3 (sin 2t - 2cos 2t + 2e^{-t})/5 and ∫e^{-(t-s)}a = 0.08[2(t-1+e^{-t}) -
/// (t²-2t+2-2e^{-t})]; ℬ₀ε has the Frobenius norm of 0.5ε + 0.25 tr(ε) I.
#[test]
fn truncation_of_a_fading_memory_is_that_of_the_closed_form() {
    let (run, constants) = measured("affine", 4, 16);
    assert_eq!((constants.m0, constants.trace_bound), (1.5, Some(1.0)));
    assert!((constants.yielding - 0.05).abs() < 1e-15);
    assert!((run.c2() - 4.0 / 3.0).abs() < 1e-12);
    let grid = &run.grid;
    for n in 0..=16 {
        let t = grid.time(n);
        let fade = (-t).exp();
        let b_exact = 0.3 * ((2.0 * t).sin() - 2.0 * (2.0 * t).cos() + 2.0 * fade) / 5.0;
        let a_exact = 0.08 * (2.0 * (t - 1.0 + fade) - (t * t - 2.0 * t + 2.0 - 2.0 * fade));
        let sum = |f: fn(f64) -> f64| -> f64 {
            let term = |j: usize| {
                let s = grid.time(j);
                Trapezoid.weight(grid, n, j) * (s - t).exp() * f(s)
            };
            (0..=n).map(term).sum()
        };
        let b = b_exact - sum(|s| 0.3 * (2.0 * s).sin());
        let a = a_exact - sum(|s| 0.08 * s * (2.0 - s));
        // ε_xy = -b/2, ε_yy = a: stress 0.25 a, 0.75 a on the diagonal, -0.25 b off it.
        let stress = (0.0625 * a * a + 0.5625 * a * a + 2.0 * 0.0625 * b * b).sqrt();
        assert!((run.truncation[1][n] - stress).abs() < 1e-12, "{n}");
    }
}

/// The error that a reference states of itself is that of its order: a reference of 8·16 steps against 8·8.
#[test]
fn a_reference_knows_its_own_error() {
    let setup = setup("linear-punch");
    let data = MeshData::new(&setup, 8, None).unwrap();
    let stated_error = |steps: &[u32]| match TemporalTruth::new(&setup, &data, steps).unwrap() {
        TemporalTruth::Reference { own_error, .. } => own_error,
        TemporalTruth::Exact(_) => panic!("linear-punch has no exact solution"),
    };
    let (coarse, fine) = (stated_error(&[8]), stated_error(&[8, 16]));
    // Order 2 within 5 %: local orders of this scene are 2.00 to 2.01.
    assert!((coarse / fine - 4.0).abs() < 0.2, "{coarse} {fine}");
    let (run, _) = measured("linear-punch", 8, 8);
    // An 8 times finer run of order 2 leaves 1/64.
    assert!(coarse < run.error[8] / 32.0);
}

/// A field that is not in V^h is not taken for an exact state.
#[test]
fn only_states_in_the_space_are_exact() {
    for (name, n, exact) in
        [("affine-locked", 4, true), ("in-space", 8, true), ("sourced", 8, false)]
    {
        let setup = setup(name);
        let data = MeshData::new(&setup, n, None).unwrap();
        let truth = TemporalTruth::new(&setup, &data, &[4]).unwrap();
        assert_eq!(matches!(truth, TemporalTruth::Exact(_)), exact, "{name}");
    }
}

#[test]
fn scenes_without_history_or_bound_are_refused() {
    let refused = |setup: &scene::setup::Setup, why: &str| {
        let error = GronwallConstants::new(setup).unwrap_err();
        assert!(matches!(error, StudyError::Unbounded { .. }) && error.to_string().contains(why));
    };
    refused(&setup("steady"), "has no history");
    let mut sideways = setup("compliance");
    sideways.body.domain.clamped = vec![scene::Side(0)];
    refused(&sideways, "no bound of c_j^2");
}
