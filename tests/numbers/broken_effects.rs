//! Source: docs/BROKEN-HYPOTHESES.md.
//! Goal: what the table's orders do not show: constants that grow like 1/m0, two solutions of one load, the fixed point
//!   beyond (3.4), and penetration of a convex gap.
//! Data: broken-*.toml and edited copies. `--nocapture` prints the numbers that the chapter quotes.

use crate::shipped::{abstract_of, edited, on_mesh, run, setup, text};
use formula::{Graph, Variable};
use nalgebra::DVector;
use scene::setup::{AbstractLoad, AbstractSetup};
use vhi::finite::{FiniteError, march};
use vhi::{FixedPoint, Newton, StepError, StepSolver};

/// max over n of ‖u(t_n) - u_n‖, and u_N.
fn solve(
    setup: &AbstractSetup,
    steps: u32,
    solver: &dyn StepSolver,
) -> Result<(f64, DVector<f64>), FiniteError> {
    let (mut worst, mut last) = (0f64, DVector::zeros(0));
    march(&setup.model, &setup.grid(steps), &mut AbstractLoad(setup), solver, &mut |view| {
        let exact = DVector::from_column_slice(&setup.state(view.t).u);
        let error = setup.model.norm(&(exact - view.u));
        worst = if error.is_nan() || error > worst { error } else { worst };
        last = view.u.clone();
    })?;
    Ok((worst, last))
}

fn error(setup: &AbstractSetup, steps: u32) -> f64 {
    solve(setup, steps, &Newton::default()).unwrap_or_else(|error| panic!("{error}")).0
}

/// Memory so weak that it adds no stiffness to m0.
#[test]
fn constants_grow_like_one_over_m0() {
    let weak = |m0: f64| {
        let scene = edited(&text("broken-m0-near"), "[[0.1]]", "[[0.0001]]");
        abstract_of(edited(&scene, "[[0.52]]", &format!("[[{}]]", 0.5 + m0)))
    };
    let scaled: Vec<f64> = [1.0, 0.3, 0.1, 0.03, 0.01]
        .into_iter()
        .map(|m0| {
            let error = error(&weak(m0), 128);
            println!("m0 = {m0}: error {error:.4e}, times m0 {:.4e}", m0 * error);
            m0 * error
        })
        .collect();
    // The memory is 1 % of the smallest m0.
    assert!(scaled.iter().all(|value| (value / scaled[0] - 1.0).abs() < 0.02), "{scaled:?}");
}

/// Rounding of a load of size 0.1, times ten for the stiffness 0.1 of the falling branch, and some.
const ROUNDING: f64 = 1e-14;

/// broken-m0-beyond without history, with another matrix and another u.
fn static_scene(matrix: &str, u: &str) -> AbstractSetup {
    let scene = edited(&text("broken-m0-beyond"), "[[0.40]]", matrix);
    let scene =
        edited(&scene, "[history]\nkernels = [{ q = \"exp(-(t - s))\", matrix = [[0.1]] }]\n", "");
    abstract_of(edited(&scene, "0.09*sin(1.5*t)", u))
}

/// The load rises from 0 to 0.093 or falls from 0.12 to 0.093: one load, two solutions; a third lies between.
#[test]
fn beyond_the_limit_two_solutions_are_found_from_both_sides() {
    let up = static_scene("[[0.40]]", "0.093*t/2.4");
    let down = static_scene("[[0.40]]", "(0.07 - 0.027*t)/0.40");
    let load = |setup: &AbstractSetup, t: f64| setup.state(t).load[0];
    for (setup, begin) in [(&up, 0.0), (&down, 0.12)] {
        assert!((load(setup, 0.0) - begin).abs() < 1e-15);
        assert!((load(setup, 1.0) - 0.093).abs() < 1e-15);
    }
    let end = |setup: &AbstractSetup| {
        let (error, u) = solve(setup, 16, &Newton::default()).unwrap_or_else(|e| panic!("{e}"));
        assert!(error < ROUNDING, "{error:e}");
        u[0]
    };
    let (low, high) = (end(&up), end(&down));
    println!("load 0.093: u = {low} from below, {high} from above");
    assert!((low - 0.03875).abs() < ROUNDING && (high - 0.1075).abs() < ROUNDING);
}

/// At the fold, load 0.096, the lower solution ends; the next one is far away, and Newton's method gives up. With
/// m0 = 0.1 the same path has no fold.
#[test]
fn the_march_ends_at_the_fold() {
    let beyond = static_scene("[[0.40]]", "if(t < 0.8, 0.05*t, 0.3*t - 0.125)");
    match solve(&beyond, 16, &Newton::default()) {
        Err(FiniteError::Step(failed)) => {
            assert_eq!(failed.n, 13, "the fold is at t = 0.8");
            assert!(matches!(failed.source, StepError::NotConverged { .. }), "{failed}");
        }
        other => panic!("{other:?}"),
    }
    let within = static_scene("[[0.60]]", "0.12*t");
    assert!(error(&within, 16) < ROUNDING);
}

/// Λ contracts for k/2·25 < 1, N ≥ 13; Newton's method does not need it.
#[test]
fn beyond_the_step_bound_only_the_fixed_point_fails() {
    let setup = abstract_of(text("broken-step"));
    for steps in [4, 12, 16, 64] {
        let newton = solve(&setup, steps, &Newton::default()).unwrap_or_else(|e| panic!("{e}"));
        match solve(&setup, steps, &FixedPoint::default()) {
            Ok((_, u)) => {
                assert!(steps >= 13, "{steps}");
                assert!((u - newton.1).norm() < 1e-11);
            }
            Err(FiniteError::Step(failed)) => {
                assert!(steps < 13, "{steps}: {failed}");
                assert!(matches!(failed.source, StepError::NotContracting { .. }), "{failed}");
            }
            Err(other) => panic!("{other}"),
        }
    }
}

/// Largest u_ν - g at midpoints of the edges of Γ3, at t = T: h²/8 g'' = 0.025 h² where both ends touch a convex gap.
#[test]
fn a_convex_gap_is_penetrated_by_its_chords() {
    let penetration = |name: &str, n: u32, gap: fn(f64) -> f64| {
        let setup = setup(name);
        let data = on_mesh(&setup, n);
        let (mesh, nodes) = (&data.space.mesh, &data.space.nodes);
        let mut bottom: Vec<(f64, usize)> = (0..nodes.of_vertex.len())
            .filter(|&v| mesh.vertex(v as u32)[1] == 0.0)
            .map(|v| (mesh.vertex(v as u32)[0], nodes.of_vertex[v] as usize))
            .collect();
        bottom.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut worst = f64::NEG_INFINITY;
        run(&setup, &setup.model, &data, 4, |view| {
            for ends in bottom.windows(2) {
                let normal = -0.5 * (view.u[2 * ends[0].1 + 1] + view.u[2 * ends[1].1 + 1]);
                worst = worst.max(normal - gap(0.5 * (ends[0].0 + ends[1].0)));
            }
        })
        .unwrap_or_else(|error| panic!("{error}"));
        worst
    };
    for n in [8, 16] {
        let bound = 0.025 / f64::from(n * n);
        let convex = penetration("broken-gap", n, |x| 0.08 + 0.1 * (x - 0.5).powi(2));
        println!("convex gap, n = {n}: penetration {convex:.4e}, h^2/8 g'' = {bound:.4e}");
        assert!((convex / bound - 1.0).abs() < 1e-9, "{convex:e} {bound:e}");
        assert!(penetration("sourced", n, |_| 0.08) < 1e-15);
    }
}

/// ε(u) of broken-zeta vanishes at T/3, where nothing else happens.
#[test]
fn the_strain_of_broken_zeta_vanishes_at_a_third() {
    let setup = setup("broken-zeta");
    let exact = setup.exact.as_ref().expect("an exact solution");
    let mut graph: Graph = exact.data.graph.clone();
    for &u in &exact.data.u {
        let by_y = graph.derivative(u, Variable::Y);
        let at =
            |t: f64| graph.evaluate(by_y, &formula::EvaluationPoint { t, ..Default::default() });
        assert!(at(1.0 / 3.0).abs() < 1e-15 && at(0.32) * at(0.35) < 0.0);
    }
}
