//! Source: the generalized derivative of the projection term and its rank-one part from ζ (docs/THEORY.md, section 3).
//! Goal: the Jacobian that the solver factorizes is the derivative of its residual: J⁻¹(F(u + s d) - F(u - s d))/2s
//!   must give back d, with yielding, ζ and compliance active; a tangent without one of its parts is caught.
//! Mesh: 4 × 4 squares; state: an affine field times a wave, about half of the cells beyond κ, Γ3 on both branches.
//! Data: punch, with the vertex, the Gauss and the exact rule of compliance, and with pinned vertices.

use crate::shipped::{edited, on_mesh, setup_of, text};
use algebra::linalg::signed_unit;
use algebra::tensor::{deviator, norm};
use fem::contact::{BoundaryRule, ContactProblem, Discretization, LastSlot, Model};
use fem::space::strain_of;
use scene::setup::Setup;
use vhi::StepInequality;
use vhi::law::Projection;

/// Step of the differences, relative to directions of size 1 while u is about 0.2.
const STEP: f64 = 1e-6;
/// Truncation is s² times the third derivative, κ‖ε(d)‖³/‖ε^D‖³ ≈ 0.1·(8/0.1)³ at worst: 5e-8 of forces of size 1
/// and less on average; rounding is 2⁻⁵²·0.2/s = 4e-11 times the condition, 1e2 in this norm. 1e-7 is above both.
const AGREEMENT: f64 = 1e-7;
/// Implicit weight k/2 of a step k = 1/4, and ζ of the past.
const WEIGHT: f64 = 0.125;
const PAST: f64 = 0.1;

fn punch(quadrature: &str) -> Setup {
    let rule = format!("quadrature = \"{quadrature}\"");
    setup_of(edited(&text("punch"), "quadrature = \"vertex\"", &rule))
}

/// A state of the body: clamped at the top, pressed at the bottom, with both branches of the law in use.
fn state(space: &Discretization) -> Vec<f64> {
    let field = |x: f64, y: f64| {
        let wave = 1.0 + 0.3 * (2.0 * x + y).sin();
        [(1.0 - y) * (0.25 * x - 0.02) * wave, -(1.0 - y) * (0.013 + 0.06 * x) * wave]
    };
    let free = &space.nodes.vertex[..space.nodes.free];
    free.iter().flat_map(|&v| field(space.mesh.vertex(v)[0], space.mesh.vertex(v)[1])).collect()
}

/// Strains of the cells (the state has no values on clamped nodes: they are zero).
fn strains(space: &Discretization, u: &[f64]) -> Vec<[f64; 3]> {
    let mut nodal = u.to_vec();
    nodal.resize(space.nodes.len(), 0.0);
    let cells = 0..space.mesh.cell_count();
    cells
        .map(|c| strain_of::<3>(space.geometry.gradients(c), space.cell_nodes(c), &nodal))
        .collect()
}

/// F(u), with the pressures of the vertex rule where the graphs carry the compliance.
fn forces(problem: &mut ContactProblem<'_>, u: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; u.len()];
    problem.residual(u, &mut out);
    let graph = problem.graph();
    for (i, at) in graph.coordinates.iter().enumerate() {
        let pressure = graph.value_and_slope(i, 0, graph.normal(i, u)).0;
        out[at.dof as usize] += at.sign * at.weight * pressure;
    }
    out
}

/// ‖J⁻¹(F(u + s d) - F(u - s d))/2s - d‖/‖d‖, the worst of five directions; every second vertex of Γ3 has its
/// increment prescribed if `pin`. With `aged`, the factor is that of another state, with iterations on the true Jacobian.
fn mismatch(space: &Discretization, model: &Model, pin: bool, aged: bool) -> f64 {
    let u = state(space);
    let mut problem = ContactProblem::new(space, model).expect("an analysis");
    let load = vec![0.0; space.dofs()];
    let memory = model.memory.iter().map(|term| WEIGHT * term.kernel.value(0.0)).collect();
    let slot = LastSlot { zeta: WEIGHT, memory };
    let (mut seed, mut worst) = (7, 0f64);
    for _ in 0..5 {
        let d: Vec<f64> = u.iter().map(|_| signed_unit(&mut seed)).collect();
        let shifted = |sign: f64| -> Vec<f64> {
            u.iter().zip(&d).map(|(u, d)| u + sign * STEP * d).collect()
        };
        problem.begin(&slot, PAST, &load, &[]);
        let plus = forces(&mut problem, &shifted(1.0));
        let minus = forces(&mut problem, &shifted(-1.0));
        let mut x: Vec<f64> =
            plus.iter().zip(&minus).map(|(p, m)| (p - m) / (2.0 * STEP)).collect();
        let linearize = |problem: &mut ContactProblem<'_>, u: &[f64]| {
            forces(problem, u);
            let graph = problem.graph();
            let (mut slopes, mut prescribed) = (Vec::new(), Vec::new());
            for (i, at) in graph.coordinates.iter().enumerate() {
                let slope = at.weight * graph.value_and_slope(i, 0, graph.normal(i, u)).1;
                let pinned = pin && i % 2 == 0;
                slopes.push(if pinned { 0.0 } else { slope });
                prescribed.push(pinned.then(|| d[at.dof as usize]));
            }
            problem.linearize(&slopes, &prescribed).expect("a positive definite tangent");
        };
        if aged {
            let other: Vec<f64> = u.iter().map(|u| 0.9 * u).collect();
            linearize(&mut problem, &other);
            let mut nothing = vec![0.0; u.len()];
            problem.solve(&mut nothing, 1e-4).expect("a solve");
        }
        linearize(&mut problem, &u);
        // A thousandth of the agreement, so that the forcing of an iterative solve does not count.
        problem.solve(&mut x, 1e-10).expect("a solve");
        let off: f64 = x.iter().zip(&d).map(|(x, d)| (x - d).powi(2)).sum();
        let size: f64 = d.iter().map(|d| d * d).sum();
        let here = (off / size).sqrt();
        worst = if here.is_nan() { f64::NAN } else { worst.max(here) };
    }
    worst
}

/// The state is what the header says, and no cell or vertex crosses a kink within the difference.
#[test]
fn the_state_yields_in_part_and_keeps_off_kinks() {
    let setup = punch("vertex");
    let space = on_mesh(&setup, 4).space;
    let u = state(&space);
    let strains = strains(&space, &u);
    let mut sum = 0.0;
    for (strain, measure) in strains.iter().zip(&space.geometry.measure) {
        sum += measure * norm(strain).powi(2);
    }
    let limit = setup.model.projection.limit().expect("a projection");
    let kappa = limit.value(PAST + WEIGHT * sum.sqrt());
    let excess: Vec<f64> = strains.iter().map(|e| norm(&deviator(e)) - kappa).collect();
    let yielding = excess.iter().filter(|e| **e > 0.0).count();
    assert!((6..=26).contains(&yielding), "{yielding} of 32 cells yield");
    // ‖ε(d)‖ ≤ 4·4 for nodal directions of size 1 on this mesh.
    assert!(excess.iter().all(|e| e.abs() > 16.0 * 2.0 * STEP), "{excess:?}");
    let trace = &space.trace;
    let normals: Vec<f64> = (0..trace.points.len()).map(|i| trace.normal(i, &u)).collect();
    let rising = normals.iter().filter(|r| (0.0..0.04).contains(*r)).count();
    let falling = normals.iter().filter(|r| (0.04..0.10).contains(*r)).count();
    assert!(rising >= 1 && falling >= 2, "{normals:?}");
    let kinks = [0.0, 0.04, 0.10];
    assert!(normals.iter().all(|r| kinks.iter().all(|k| (r - k).abs() > 2.0 * STEP)));
}

#[test]
fn the_jacobian_is_the_derivative() {
    for (quadrature, rule) in [
        ("vertex", BoundaryRule::Vertex),
        ("gauss", BoundaryRule::Gauss),
        ("exact", BoundaryRule::Exact),
    ] {
        let setup = punch(quadrature);
        let boundary = setup.model.boundary.first().expect("contact");
        assert_eq!(boundary.rule, rule);
        let space = on_mesh(&setup, 4).space;
        for pin in [false, true] {
            let off = mismatch(&space, &setup.model, pin, false);
            assert!(off <= AGREEMENT, "{quadrature}, pinned vertices {pin}: {off:e}");
        }
    }
}

/// With an older factor the solve is iterative, on the Jacobian of the present state.
#[test]
fn an_older_factor_solves_with_the_present_jacobian() {
    let setup = punch("gauss");
    let space = on_mesh(&setup, 4).space;
    for pin in [false, true] {
        let off = mismatch(&space, &setup.model, pin, true);
        assert!(off <= AGREEMENT, "pinned vertices {pin}: {off:e}");
    }
}
