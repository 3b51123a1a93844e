//! Source: problems of one to three unknowns with answers by hand or by trying all pieces; mesh-free.
//! Goal: the active-set Newton method finds exact solutions in few iterations, and ends in a typed error where there
//!   is none to be found: never in a wrong answer, never in a loop.
//! Data: A u + Σ w c s e = f, c in the graph of ∂j + ∂I(≤ g); γ = 1/a scales complementarity.

use std::sync::Arc;

use algebra::linalg::{FactorError, signed_unit};
use nalgebra::{DMatrix, DVector};
use vhi::law::{NoPotential, PiecewiseLinear, Potential};
use vhi::{BoundaryGraph, Coordinate, Newton, Scratch, StepError, StepInequality, StepState};

/// Solutions are accepted at 16 units of rounding of the forces; two more digits for the condition of A.
const EXACT: f64 = 1e-13;

/// A small problem with a graph on every unknown.
struct Small {
    matrix: DMatrix<f64>,
    load: DVector<f64>,
    graph: BoundaryGraph,
    /// What the last residual adds: noise or NaN.
    flaw: fn(u32) -> f64,
    evaluations: u32,
    tangent: DMatrix<f64>,
    prescribed: Vec<Option<f64>>,
}

/// u_ν = sign · u ≤ gap with weight 2 (a weight of 1 would hide a missing one).
const WEIGHT: f64 = 2.0;

fn small(
    matrix: &[f64],
    load: &[f64],
    gap: f64,
    sign: f64,
    potential: Arc<dyn Potential>,
) -> Small {
    let order = load.len();
    let matrix = DMatrix::from_row_slice(order, order, matrix);
    let coordinate = |i: usize| Coordinate {
        dof: i as u32,
        sign,
        weight: WEIGHT,
        gap,
        floor: f64::NEG_INFINITY,
        law: 0,
        shift: 0.0,
        gamma: WEIGHT / matrix[(i, i)],
        span: 1,
    };
    let coordinates = (0..order).map(coordinate).collect();
    Small {
        load: DVector::from_row_slice(load),
        graph: BoundaryGraph { coordinates, potentials: vec![potential] },
        flaw: |_| 0.0,
        evaluations: 0,
        tangent: matrix.clone(),
        prescribed: vec![None; order],
        matrix,
    }
}

impl StepInequality for Small {
    fn dofs(&self) -> usize {
        self.load.len()
    }

    fn graph(&self) -> &BoundaryGraph {
        &self.graph
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        self.evaluations += 1;
        let force = &self.matrix * DVector::from_row_slice(u) - &self.load;
        out.copy_from_slice(force.as_slice());
        out[0] += (self.flaw)(self.evaluations);
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        self.tangent = self.matrix.clone();
        self.prescribed = prescribed.to_vec();
        for (i, slope) in slopes.iter().enumerate() {
            self.tangent[(i, i)] += slope;
            if prescribed[i].is_none() && self.tangent[(i, i)] <= 0.0 {
                return Err(FactorError::NotPositiveDefinite { dof: i });
            }
        }
        Ok(())
    }

    fn solve(&mut self, rhs: &mut [f64], _: f64) -> Result<(), FactorError> {
        let mut matrix = self.tangent.clone();
        for (i, increment) in self.prescribed.iter().enumerate() {
            if let Some(increment) = *increment {
                matrix.row_mut(i).fill(0.0);
                matrix[(i, i)] = 1.0;
                rhs[i] = increment;
            }
        }
        let x = matrix.lu().solve(&DVector::from_row_slice(rhs));
        rhs.copy_from_slice(x.ok_or(FactorError::NotPositiveDefinite { dof: 0 })?.as_slice());
        Ok(())
    }

    fn force_scale(&self, u: &[f64]) -> f64 {
        (&self.matrix * DVector::from_row_slice(u)).norm() + self.load.norm()
    }
}

fn solve_from(problem: &mut Small, start: f64) -> Result<(StepState, u32), StepError> {
    let order = problem.dofs();
    let mut state = StepState { u: vec![start; order], pressure: vec![0.0; order] };
    let info = Newton::default().solve(problem, &mut state, &mut Scratch::default())?;
    assert!(info.residual <= info.tolerance, "{info:?}");
    Ok((state, info.iterations))
}

/// Solves from several starts, each of which must end at (u, c).
#[track_caller]
fn must_find(make: impl Fn() -> Small, u: &[f64], pressure: &[f64], most: u32) {
    for start in [0.0, -3.0, 0.1, 0.9, 5.0] {
        let (state, iterations) = solve_from(&mut make(), start).expect("a solution");
        for (found, exact) in state.u.iter().zip(u).chain(state.pressure.iter().zip(pressure)) {
            let close = (found - exact).abs() <= EXACT * exact.abs().max(1.0);
            assert!(close, "from {start}: {found} is not {exact}");
        }
        assert!(iterations <= most, "from {start}: {iterations} iterations");
    }
}

fn law(points: &[(f64, f64)]) -> Arc<dyn Potential> {
    Arc::new(PiecewiseLinear::new(points.to_vec(), 0.0, 0.0).expect("a law"))
}

#[test]
fn unilateral_contact_open_and_closed() {
    for sign in [1.0, -1.0] {
        let one = |load: f64| small(&[2.0], &[sign * load], 1.0, sign, Arc::new(NoPotential));
        // One iteration on the right piece, one more to leave the wrong one.
        must_find(|| one(1.0), &[sign * 0.5], &[0.0], 2);
        must_find(|| one(5.0), &[sign], &[1.5], 2);
    }
}

/// Full steps can alternate between the two sides of a kink. Steps are halved after 8 iterations without a new best
/// residual, and then need less than as many again.
const HALVED: u32 = 16;

#[test]
fn a_jump_holds_the_solution_or_is_passed() {
    let jump = || law(&[(0.25, 0.0), (0.25, 1.0)]);
    let one = |load: f64| small(&[2.0], &[load], f64::INFINITY, 1.0, jump());
    // 2 u + 2 c = f, c ∈ [0, 1] at u = 1/4: inside for 1/2 ≤ f ≤ 5/2.
    // A step that would cross the jump stops there, so that passing it takes one iteration more and nothing alternates.
    must_find(|| one(1.5), &[0.25], &[0.5], 4);
    must_find(|| one(0.3), &[0.15], &[0.0], 4);
    must_find(|| one(4.0), &[1.0], &[1.0], 4);
    // The ends of the interval.
    must_find(|| one(0.5), &[0.25], &[0.0], 4);
    must_find(|| one(2.5), &[0.25], &[1.0], 4);
}

/// States at the very ends of a jump, in numbers that round: the residual decides between two branches by its last digit.
#[test]
fn ends_of_a_jump_are_found_in_numbers_that_round() {
    let mut seed = 7;
    for case in 0..500 {
        let mut random = || signed_unit(&mut seed);
        let (a, b, c) = (2.0 + random(), 0.7 * random(), 2.0 + random());
        let (at, shift, height) = (0.3 * random(), 0.3 * random(), 0.5 + 0.4 * random());
        let jump = law(&[(at, 0.0), (at, height)]);
        let ends = [random() > 0.0, random() > 0.0].map(|top| if top { height } else { 0.0 });
        let (u, matrix) = (at + shift, [a, b, b, c]);
        let load = [0, 1].map(|i| (matrix[2 * i] + matrix[2 * i + 1]) * u + WEIGHT * ends[i]);
        let mut problem = small(&matrix, &load, f64::INFINITY, 1.0, jump);
        problem.graph.coordinates.iter_mut().for_each(|at| at.shift = shift);
        for start in [0.0, -3.0, u, 5.0] {
            let (state, iterations) = solve_from(&mut problem, start)
                .unwrap_or_else(|error| panic!("{case}, from {start}: {error}"));
            for i in 0..2 {
                // The smallest eigenvalue of the matrix is 0.3 or more.
                assert!((state.u[i] - u).abs() < 10.0 * EXACT && iterations <= HALVED, "{case}");
                assert!((state.pressure[i] - ends[i]).abs() < 10.0 * EXACT, "{case}");
            }
        }
    }
}

#[test]
fn nonmonotone_laws_have_their_one_solution() {
    // Up to 1 at 1/2, down with slope -1/2 to 3/4 at 1, flat beyond; 2 u + 2 p(u) = f is monotone as 2 > 2·½.
    let bump = || law(&[(0.0, 0.0), (0.5, 1.0), (1.0, 0.75)]);
    let one = |load: f64| small(&[2.0], &[load], f64::INFINITY, 1.0, bump());
    must_find(|| one(-1.0), &[-0.5], &[0.0], 4);
    must_find(|| one(1.5), &[0.25], &[0.5], HALVED);
    // 2 u + 2 (1 - (u - ½)/2) = 13/4 at u = 3/4, p = 7/8.
    must_find(|| one(3.25), &[0.75], &[0.875], 4);
    must_find(|| one(5.5), &[2.0], &[0.75], 4);
    // Exactly at the kinks.
    must_find(|| one(3.0), &[0.5], &[1.0], 4);
    must_find(|| one(3.5), &[1.0], &[0.75], 4);
}

#[test]
fn grazing_on_both_unknowns_does_not_cycle() {
    // A (1, 1) = f: both touch g = 1 with c = 0, so that either piece is right for either.
    must_find(
        || small(&[2.0, -1.0, -1.0, 2.0], &[1.0, 1.0], 1.0, 1.0, Arc::new(NoPotential)),
        &[1.0, 1.0],
        &[0.0, 0.0],
        4,
    );
    // Touching g = 1 where the law jumps from 0 to 1 just there: c at either end of its interval.
    let jump = || law(&[(1.0, 0.0), (1.0, 1.0)]);
    must_find(|| small(&[2.0], &[2.0], 1.0, 1.0, jump()), &[1.0], &[0.0], 4);
    must_find(|| small(&[2.0], &[4.0], 1.0, 1.0, jump()), &[1.0], &[1.0], 4);
}

#[test]
fn a_residual_that_is_no_number_is_an_error() {
    let mut problem = small(&[2.0], &[5.0], 1.0, 1.0, Arc::new(NoPotential));
    problem.flaw = |evaluation| if evaluation == 2 { f64::NAN } else { 0.0 };
    let error = solve_from(&mut problem, 0.0).expect_err("NaN");
    assert!(
        matches!(error, StepError::NotFinite { iteration: 1, value } if value.is_nan()),
        "{error}"
    );
    problem.flaw = |_| f64::INFINITY;
    let error = solve_from(&mut problem, 0.0).expect_err("infinite");
    assert!(matches!(error, StepError::NotFinite { iteration: 0, .. }), "{error}");
}

#[test]
fn an_indefinite_jacobian_is_an_error() {
    // Slope -2 with weight 2 against a = 2: (2.9) fails.
    let cliff = law(&[(0.0, 0.0), (0.1, 1.0), (0.6, 0.0)]);
    let mut problem = small(&[2.0], &[2.1], f64::INFINITY, 1.0, cliff);
    let error = solve_from(&mut problem, 0.3).expect_err("no positive definite tangent");
    let source = FactorError::NotPositiveDefinite { dof: 0 };
    assert_eq!(error, StepError::Factor { iteration: 0, source });
}

#[test]
fn an_unreachable_tolerance_is_an_error_with_its_numbers() {
    let mut problem = small(&[2.0], &[1.0], f64::INFINITY, 1.0, Arc::new(NoPotential));
    problem.flaw = |evaluation| if evaluation % 2 == 0 { 1e-6 } else { -1e-6 };
    match solve_from(&mut problem, 0.0).expect_err("noise above the tolerance") {
        StepError::NotConverged { iterations, residual, tolerance } => {
            assert_eq!(iterations as usize, Newton::default().max_iterations);
            assert!(
                (1e-7..1e-5).contains(&residual) && tolerance < 1e-13,
                "{residual} {tolerance}"
            );
        }
        other => panic!("{other}"),
    }
}

/// All solutions of A u + w c = f, u ≤ g, c ≥ 0, c (u - g) = 0, by trying every active set.
fn by_trial(problem: &Small) -> Vec<Vec<f64>> {
    let order = problem.dofs();
    let mut found = Vec::new();
    for active in 0..1u32 << order {
        let mut matrix = problem.matrix.clone();
        let mut rhs = problem.load.clone();
        let is_active = |i: usize| active >> i & 1 == 1;
        for i in (0..order).filter(|&i| is_active(i)) {
            matrix.row_mut(i).fill(0.0);
            matrix[(i, i)] = 1.0;
            rhs[i] = problem.graph.coordinates[i].gap;
        }
        let Some(u) = matrix.lu().solve(&rhs) else { continue };
        let force = &problem.load - &problem.matrix * &u;
        let feasible = (0..order).all(|i| {
            if is_active(i) { force[i] >= 0.0 } else { u[i] <= problem.graph.coordinates[i].gap }
        });
        if feasible {
            found.push(u.as_slice().to_vec());
        }
    }
    found
}

/// A solution that is one of those by trial, or a typed error; returns whether it was solved.
#[track_caller]
fn solved_or_said(mut problem: Small, start: f64) -> bool {
    let solutions = by_trial(&problem);
    match solve_from(&mut problem, start) {
        Ok((state, _)) => {
            // Random matrices have conditions up to 1e3.
            let close = |exact: &Vec<f64>| {
                exact.iter().zip(&state.u).all(|(a, b)| (a - b).abs() <= 1e3 * EXACT)
            };
            assert!(solutions.iter().any(close), "{:?} is none of {solutions:?}", state.u);
            true
        }
        Err(StepError::NotConverged { .. } | StepError::Factor { .. }) => false,
        Err(other) => panic!("{other}"),
    }
}

/// Ben Gharbia and Gilbert (2012): on this P-matrix the full-step method visits {1}, {2}, {3} in turn for ever.
#[test]
fn a_cycle_ends_in_a_solution_or_an_error() {
    for coupling in [1.5, 2.0, 4.0] {
        let matrix = [1.0, 0.0, coupling, coupling, 1.0, 0.0, 0.0, coupling, 1.0];
        for start in [0.0, 1.0, -1.0] {
            let problem = small(&matrix, &[1.0, 1.0, 1.0], 0.0, 1.0, Arc::new(NoPotential));
            solved_or_said(problem, start);
        }
    }
}

/// Symmetric positive definite problems of three unknowns: what the contact problem poses.
#[test]
fn random_obstacle_problems_are_solved() {
    let (mut seed, mut solved) = (11, 0);
    for _ in 0..500 {
        let b = DMatrix::from_fn(3, 3, |_, _| signed_unit(&mut seed));
        let matrix: DMatrix<f64> = &b * b.transpose() + 0.05 * DMatrix::identity(3, 3);
        let load: Vec<f64> = (0..3).map(|_| signed_unit(&mut seed)).collect();
        let problem = small(matrix.as_slice(), &load, 0.1, 1.0, Arc::new(NoPotential));
        solved += usize::from(solved_or_said(problem, 0.0));
    }
    // Newton-min may cycle on matrices that are no M-matrices; damping has to solve nearly all of them.
    assert!(solved >= 495, "{solved} of 500");
}
