//! Lagged factors, nonsymmetric entries, and indefinite matrices.

use gronwall_algebra::linalg::*;

const UNKNOWNS: usize = 600;

/// A chain of 300 nodes with two components.
fn chain(diagonal: f64) -> (BlockPattern, Vec<f64>, Analysis) {
    let nodes = UNKNOWNS as u32 / 2;
    let cells: Vec<u32> = (0..nodes - 2).flat_map(|i| [i, i + 1, i + 2]).collect();
    let pattern = BlockPattern::new(&cells, 3, 2, nodes as usize);
    let mut values = vec![0.0; pattern.entries()];
    for dof in 0..UNKNOWNS {
        values[pattern.diagonal(dof)] = diagonal;
        if dof >= 2 {
            values[pattern.position(dof, dof - 2).unwrap()] = -1.0;
        }
    }
    let coordinates: Vec<f64> = (0..2 * nodes).map(|i| f64::from(i / 2)).collect();
    let analysis = Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[]));
    (pattern, values, analysis.unwrap())
}

/// Solves with `jacobian` for a known vector, and gives the largest error.
fn error(
    solver: &mut TangentSolver<'_>,
    pattern: &BlockPattern,
    jacobian: &Jacobian,
    forcing: f64,
) -> Result<f64, FactorError> {
    let exact: Vec<f64> = (0..UNKNOWNS).map(|i| ((i % 13) as f64) - 6.0).collect();
    let mut rhs = vec![0.0; UNKNOWNS];
    pattern.multiply(&jacobian.values, &exact, &mut rhs);
    if let Some(RankOne { a, b }) = &jacobian.rank_one {
        let along = dot(b, &exact);
        rhs.iter_mut().zip(a).for_each(|(entry, a)| *entry += a * along);
    }
    for coupling in &jacobian.couplings {
        rhs[coupling.row] += coupling.value * exact[coupling.column];
    }
    solver.solve(jacobian, &mut rhs, forcing)?;
    Ok(rhs.iter().zip(&exact).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max))
}

/// A residual of 1e-12 times a condition number of about 80, times entries of size 6.
const SOLVED: f64 = 1e-9;

/// A direct solve, then another matrix and rank-one part with the factor of the first, in any unit.
#[test]
fn a_lagged_factor_serves_and_a_rank_one_part_is_solved_for() {
    for scale in [1.0, 1e60, 1e-60] {
        let (pattern, values, analysis) = chain(2.05);
        let mut solver = TangentSolver::new(&analysis, &pattern);
        let unit =
            |k: f64| -> Vec<f64> { (0..UNKNOWNS).map(|i| k * (i as f64).sin() / 600.0).collect() };
        let jacobian = |change: f64| {
            let mut values: Vec<f64> = values.iter().map(|value| scale * value).collect();
            (0..90).for_each(|dof| values[pattern.diagonal(dof)] *= 1.0 + change);
            let rank_one = RankOne { a: unit(scale * (1.0 + change)), b: unit(1.0) };
            Jacobian { values, rank_one: Some(rank_one), ..Jacobian::default() }
        };
        solver.prepare(&jacobian(0.0), false).unwrap();
        assert!(error(&mut solver, &pattern, &jacobian(0.0), 1e-12).unwrap() < SOLVED);
        assert_eq!((solver.work().factorizations, solver.work().solves), (1, 2));
        let changed = jacobian(0.01);
        solver.prepare(&changed, false).unwrap();
        assert!(error(&mut solver, &pattern, &changed, 1e-12).unwrap() < SOLVED, "{scale:e}");
        assert!(solver.work().factorizations == 1 && solver.work().solves > 3);
        // No iteration reaches a negative residual: a new factor is made.
        solver.prepare(&changed, false).unwrap();
        assert!(error(&mut solver, &pattern, &changed, -1.0).unwrap() < SOLVED);
        assert_eq!(solver.work().factorizations, 2);
    }
}

/// K + a bᵀ + C and its transpose: C is as large as K's entries.
#[test]
fn entries_without_a_mirror_image_are_solved_for() {
    let (pattern, values, analysis) = chain(2.05);
    let coupling = |i: usize| NonsymmetricEntry {
        row: 2 * i,
        column: 2 * i + 1,
        value: 0.5 + 0.05 * i as f64,
    };
    for forcing in [1e-12, -1.0] {
        let couplings = (0..20).map(coupling).collect();
        let mut jacobian = Jacobian { values: values.clone(), couplings, ..Jacobian::default() };
        let mut solver = TangentSolver::new(&analysis, &pattern);
        solver.prepare(&jacobian, false).unwrap();
        for _ in 0..2 {
            let off = error(&mut solver, &pattern, &jacobian, forcing).unwrap();
            assert!(off < SOLVED, "{forcing} {off}");
            jacobian.transpose_couplings();
        }
    }
}

/// Single entries that make the Jacobian singular: row 0 is that of unknown 2 but for its own.
#[test]
fn singular_and_indefinite_matrices_are_errors_not_solutions() {
    let (pattern, mut values, analysis) = chain(2.05);
    let mut solver = TangentSolver::new(&analysis, &pattern);
    // K + C has a zero row.
    let row = |column: usize| NonsymmetricEntry {
        row: 0,
        column,
        value: -pattern.position(0, column).map_or(0.0, |at| values[at]),
    };
    let couplings = vec![row(0), row(2)];
    let jacobian = Jacobian { values: values.clone(), couplings, ..Jacobian::default() };
    solver.prepare(&jacobian, false).unwrap();
    let mut rhs = vec![1.0; UNKNOWNS];
    let refused = solver.solve(&jacobian, &mut rhs, 1e-10);
    assert!(matches!(refused, Err(FactorError::NotSolved { .. })), "{refused:?}");
    values[pattern.diagonal(77)] = -1.0;
    let jacobian = Jacobian { values, ..Jacobian::default() };
    let mut solver = TangentSolver::new(&analysis, &pattern);
    let refused = solver.prepare(&jacobian, false);
    assert_eq!(refused, Err(FactorError::NotPositiveDefinite { dof: 77 }));
}
