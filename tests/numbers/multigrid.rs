//! Source: Problem 14; W. Hackbusch, Multi-Grid Methods and Applications (1985).
//! Goal: runs by conjugate gradients with multigrid are those by factors, at every step and with contact present, in
//!   space, in the plane, with oblique contact, without projection and without contact; an indefinite tangent is the
//!   same error; where a mesh refines nothing, factors stay. The cycle itself is tested in `linalg`.
//! Mesh: n = 8 (two levels) in space, up to three in the plane.
//! Data: shipped scenes.

use crate::shipped::{edited, on_mesh, run, setup, setup_of, text};
use algebra::linalg::FactorError;
use fem::contact::{CaseInfo, ContactProblem, LastSlot, LinearSolver};
use scene::setup::{MeshData, Setup};
use vhi::StepInequality;

/// Displacements and contact pressures of all steps.
struct Run {
    u: Vec<Vec<f64>>,
    pressure: Vec<Vec<f64>>,
    info: CaseInfo,
}

fn solve(setup: &mut Setup, n: u32, steps: u32, solver: LinearSolver) -> Run {
    setup.linear_solver = Some(solver);
    let data = on_mesh(setup, n);
    assert_eq!(LinearSolver::of(&data.space, &setup.model, steps as usize), solver);
    let (mut u, mut pressure) = (Vec::new(), Vec::new());
    let info = run(setup, &setup.model, &data, steps, |view| {
        u.push(view.u.to_vec());
        pressure.push(view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b).collect());
    });
    Run { u, pressure, info: info.unwrap_or_else(|error| panic!("{error}")) }
}

/// Largest distance at any step over the largest number, of u and of the pressure.
fn distance(a: &Run, b: &Run) -> [f64; 2] {
    let largest = |rows: &[Vec<f64>]| rows.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    let apart = |a: &[Vec<f64>], b: &[Vec<f64>]| {
        assert_eq!(a.len(), b.len());
        let pairs = a.iter().flatten().zip(b.iter().flatten());
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        most / largest(a).max(f64::MIN_POSITIVE)
    };
    [apart(&a.u, &b.u), apart(&a.pressure, &b.pressure)]
}

fn both(setup: &mut Setup, n: u32, steps: u32) -> (Run, [f64; 2]) {
    let direct = solve(setup, n, steps, LinearSolver::Direct);
    let multigrid = solve(setup, n, steps, LinearSolver::Multigrid);
    assert_eq!((direct.info.work.linear.iterations, direct.u.len()), (0, steps as usize + 1));
    assert!(multigrid.info.work.linear.iterations > 0);
    let distance = distance(&direct, &multigrid);
    (multigrid, distance)
}

/// Newton's tolerance is 16 units of rounding of the forces; the condition number of some n² times that.
const SAME: f64 = 1e-11;

#[test]
fn both_solvers_give_the_same_steps_in_space() {
    for (scene, steps) in [("punch-box", 3), ("pure-box", 2), ("sourced-box", 2)] {
        let (run, [u, pressure]) = both(&mut setup(scene), 8, steps);
        println!("{scene}: {u:.1e} {pressure:.1e} {:?}", run.info.work.linear);
        let pressed = |step: &Vec<f64>| step.iter().any(|p| *p > 1e-3);
        assert!(run.pressure[1..].iter().all(pressed), "{scene}: no contact");
        assert!(u < SAME && pressure < 1e2 * SAME, "{scene}: {u:e} {pressure:e}");
    }
    // A wrong right side is seen.
    let one = solve(&mut setup("pure-box"), 8, 2, LinearSolver::Multigrid);
    let changed = edited(&text("pure-box"), "mu_L = 1.0", "mu_L = 1.00000001");
    let other = solve(&mut setup_of(changed), 8, 2, LinearSolver::Direct);
    assert!(distance(&one, &other)[0] > SAME);
}

#[test]
fn both_solvers_give_the_same_steps_in_the_plane() {
    // Oblique unknowns held and free, a unilateral constraint, a linear scene, one whose memory is no multiple.
    for (scene, n) in
        [("oblique-trapezium", 32), ("v-groove", 32), ("signorini", 32), ("linear-punch", 32)]
    {
        let (run, [u, pressure]) = both(&mut setup(scene), n, 3);
        println!("{scene}: {u:.1e} {pressure:.1e} {:?}", run.info.work.linear);
        assert!(u < 10.0 * SAME && pressure < 1e3 * SAME, "{scene}: {u:e} {pressure:e}");
    }
}

/// What linearizing and solving say with this slope of the law under every vertex, and u = 0.
fn with_slope(
    data: &MeshData,
    setup: &Setup,
    slope: f64,
    solver: LinearSolver,
) -> Option<FactorError> {
    let mut problem = ContactProblem::new(&data.space, &setup.model, solver).expect("an analysis");
    let dofs = problem.dofs();
    problem.begin(&LastSlot::default(), 0.0, &vec![1.0; dofs], &[]);
    let mut residual = vec![0.0; dofs];
    problem.residual(&vec![0.0; dofs], &mut residual);
    let weights = problem.graph().coordinates.iter().map(|at| slope * at.weight);
    let slopes: Vec<f64> = weights.collect();
    let outcome = problem.linearize(&slopes, &vec![None; slopes.len()]);
    outcome.and_then(|()| problem.solve(&mut residual, 1e-4)).err()
}

#[test]
fn an_indefinite_tangent_is_the_same_error() {
    let setup = setup("punch-box");
    let data = on_mesh(&setup, 8);
    // A cube of side 1 with μ_L = 1: vertical stiffness about 3 an area.
    for slope in [-4.0, -10.0, -100.0, -1e4] {
        for solver in [LinearSolver::Direct, LinearSolver::Multigrid] {
            let error = with_slope(&data, &setup, slope, solver);
            let indefinite = matches!(error, Some(FactorError::NotPositiveDefinite { .. }));
            assert!(indefinite, "{slope} {solver:?}: {error:?}");
        }
    }
    for solver in [LinearSolver::Direct, LinearSolver::Multigrid] {
        assert_eq!(with_slope(&data, &setup, -0.5, solver), None);
    }
}

#[test]
fn a_mesh_that_refines_nothing_keeps_its_factors() {
    let mut setup = setup("punch-box");
    setup.linear_solver = Some(LinearSolver::Multigrid);
    for (n, solver) in [(8, LinearSolver::Multigrid), (9, LinearSolver::Direct)] {
        let space = setup.space(n).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(LinearSolver::of(&space, &setup.model, 4), solver);
    }
}

/// `yielding-box` with λ/μ_L = `lambda`.
fn stiff_to_pressure(lambda: &str) -> Setup {
    setup_of(edited(&text("yielding-box"), "lambda = 1.0", &format!("lambda = {lambda}")))
}

/// M/m = 1 + 3λ/(2μ_L): 7,501 is below the limit of single precision, 150,001 above it, and from 1,000 on factors are
/// faster.
#[test]
fn nearly_incompressible_bodies_keep_their_factors() {
    let mut setup = stiff_to_pressure("5e3");
    let direct = solve(&mut setup, 8, 1, LinearSolver::Direct);
    let multigrid = solve(&mut setup, 8, 1, LinearSolver::Multigrid);
    // Both end at the residual that Newton's method asks for, 10⁻¹⁰ of the forces, whose effect on pressures grows with
    // λ/μ_L.
    let apart = distance(&direct, &multigrid);
    assert!(apart[0] < 1e-9 && apart[1] < 1e-6, "{apart:?}");

    for (lambda, chosen, forced) in [
        ("1.0", LinearSolver::Multigrid, LinearSolver::Multigrid),
        ("5e3", LinearSolver::Direct, LinearSolver::Multigrid),
        ("1e5", LinearSolver::Direct, LinearSolver::Direct),
    ] {
        let mut setup = stiff_to_pressure(lambda);
        for (asked, solver) in [(None, chosen), (Some(LinearSolver::Multigrid), forced)] {
            setup.linear_solver = asked;
            let space = setup.space(12).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(LinearSolver::of(&space, &setup.model, 1), solver, "{lambda} {asked:?}");
        }
    }
}
