//! Factors in both precisions, nonsymmetric entries, and indefinite matrices.

use super::super::{NonsymmetricEntry, RankOne, nested_dissection};
use super::*;

/// A chain of 3,000 nodes with two components: large enough for single precision.
fn chain(diagonal: f64) -> (BlockPattern, Vec<f64>, Vec<f64>) {
    let nodes = 3000;
    let cells: Vec<u32> = (0..nodes - 2).flat_map(|i| [i, i + 1, i + 2]).collect();
    let pattern = BlockPattern::new(&cells, 3, 2, nodes as usize);
    let mut values = vec![0.0; pattern.entries()];
    for dof in 0..pattern.order() {
        values[pattern.diagonal(dof)] = diagonal;
        if dof >= 2 {
            values[pattern.position(dof, dof - 2).unwrap()] = -1.0;
        }
    }
    let coordinates = (0..2 * nodes).map(|i| f64::from(i / 2)).collect();
    (pattern, values, coordinates)
}

fn solve(scale: f64, indefinite: bool) -> Result<f64, FactorError> {
    let (pattern, mut values, coordinates) = chain(2.05);
    values.iter_mut().for_each(|value| *value *= scale);
    if indefinite {
        values[pattern.diagonal(77)] = -scale;
    }
    let analysis =
        Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[])).unwrap();
    let mut solver = SequenceSolver::new(&analysis, &pattern);
    let exact: Vec<f64> = (0..pattern.order()).map(|i| ((i % 13) as f64) - 6.0).collect();
    let unit = |k: f64| exact.iter().map(|x| scale * k * x.sin() / 6000.0).collect::<Vec<_>>();
    let rank_one = RankOne { a: unit(1.0), b: unit(1.0 / scale) };
    let jacobian = Jacobian { values, rank_one: Some(rank_one), ..Jacobian::default() };
    solver.prepare(&jacobian, false)?;
    let mut rhs = vec![0.0; pattern.order()];
    jacobian.multiply(&pattern, &exact, &mut rhs);
    solver.solve(&jacobian, &mut rhs, 1e-12)?;
    let error = rhs.iter().zip(&exact).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    Ok(error)
}

#[test]
fn single_precision_factors_give_double_precision_solutions_in_any_unit() {
    for scale in [1.0, 1e60, 1e-60] {
        // Residual 1e-12 times a condition number of about 80, times entries of size 6.
        assert!(solve(scale, false).unwrap() < 1e-9);
    }
}

/// K + a bᵀ + C and its transpose with a factor of K: C is as large as K's entries, and one factor suffices.
#[test]
fn entries_without_a_mirror_image_are_solved_for() {
    let (pattern, values, coordinates) = chain(2.05);
    let analysis =
        Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[])).unwrap();
    let exact: Vec<f64> = (0..pattern.order()).map(|i| ((i % 13) as f64) - 6.0).collect();
    for precision in [Precision::Double, Precision::Single] {
        let mut solver = SequenceSolver::new(&analysis, &pattern).in_precision(Some(precision));
        let couplings = (0..20).map(|i| NonsymmetricEntry {
            row: 2 * i,
            column: 2 * i + 1,
            value: 0.5 + 0.05 * i as f64,
        });
        let (values, couplings) = (values.clone(), couplings.collect());
        let mut jacobian = Jacobian { values, couplings, ..Jacobian::default() };
        solver.prepare(&jacobian, false).unwrap();
        for _ in 0..2 {
            let mut rhs = vec![0.0; pattern.order()];
            jacobian.multiply(&pattern, &exact, &mut rhs);
            solver.solve(&jacobian, &mut rhs, 1e-12).unwrap();
            let off = rhs.iter().zip(&exact).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            // A residual of 1e-12 times a condition number of about 80, times entries of size 6.
            assert!(off < 1e-9, "{off}");
            jacobian.transpose_couplings();
        }
        assert!(solver.work.factorizations <= 2);
    }
}

#[test]
fn an_indefinite_matrix_is_an_error_not_a_solution() {
    assert_eq!(solve(1.0, true), Err(FactorError::NotPositiveDefinite { dof: 77 }));
}
