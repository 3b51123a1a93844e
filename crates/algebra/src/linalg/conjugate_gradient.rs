//! Preconditioned conjugate gradients that detect an indefinite matrix.
//!
//! Hestenes and Stiefel, J. Res. Natl. Bur. Stand. 49 (1952). Directions are orthogonalised with zᵀ(r - r₋) in place of
//! zᵀr (Polak and Ribière), which tolerates rounding in a single-precision preconditioner (Notay, SIAM J. Sci. Comput.
//! 22 (2000)).

use super::cholesky::FactorError;
use super::gmres::Preconditioned;
use super::{axpy, dot, norm};

/// Vectors of the iteration, kept between solves.
#[derive(Debug, Clone, Default)]
pub struct Directions {
    direction: Vec<f64>,
    image: Vec<f64>,
    corrected: Vec<f64>,
}

/// Reduces the `residual` b - Ax to a norm of at most `target`, adding to `x`; returns the iterations.
///
/// # Errors
/// [`FactorError::NotPositiveDefinite`] with the largest entry of a direction p that has pᵀAp ≤ 0;
/// [`FactorError::NotFinite`]; [`FactorError::NotReached`] after `limit` iterations. `x` is then undefined.
pub fn conjugate_gradients(
    operator: &mut dyn Preconditioned,
    residual: &mut [f64],
    x: &mut [f64],
    target: f64,
    limit: u32,
    vectors: &mut Directions,
) -> Result<u32, FactorError> {
    let start = norm(residual);
    if start <= target {
        return Ok(0);
    }
    let Directions { direction, image, corrected } = vectors;
    for vector in [&mut *direction, &mut *image, &mut *corrected] {
        vector.resize(x.len(), 0.0);
    }
    corrected.copy_from_slice(residual);
    operator.precondition(corrected);
    direction.copy_from_slice(corrected);
    let mut product = dot(residual, corrected);
    for iteration in 1..=limit {
        operator.apply(direction, image);
        let curvature = dot(direction, image);
        // Below this, pᵀAp is rounding of its sum.
        let nothing = f64::EPSILON * norm(direction) * norm(image);
        if !(curvature.is_finite() && product.is_finite()) {
            return Err(FactorError::NotFinite);
        }
        // zᵀr ≤ 0 contradicts a positive definite preconditioner, hence matrix.
        if curvature <= nothing || product <= 0.0 {
            return Err(FactorError::NotPositiveDefinite { dof: largest_entry(direction) });
        }
        let length = product / curvature;
        axpy(length, direction, x);
        axpy(-length, image, residual);
        let size = norm(residual);
        if size <= target {
            return Ok(iteration);
        }
        corrected.copy_from_slice(residual);
        operator.precondition(corrected);
        let turn = -length * dot(corrected, image) / product;
        for (entry, z) in direction.iter_mut().zip(&*corrected) {
            *entry = z + turn * *entry;
        }
        product = dot(residual, corrected);
    }
    Err(FactorError::NotReached { iterations: limit, residual: norm(residual) / start })
}

fn largest_entry(vector: &[f64]) -> usize {
    let larger = |a: &(usize, &f64), b: &(usize, &f64)| a.1.abs().total_cmp(&b.1.abs());
    vector.iter().enumerate().max_by(larger).map_or(0, |(at, _)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// diag(1, …, m) with one entry replaced; no preconditioner.
    struct Diagonal(Vec<f64>);

    impl Preconditioned for Diagonal {
        fn apply(&mut self, x: &[f64], out: &mut [f64]) {
            for ((out, d), x) in out.iter_mut().zip(&self.0).zip(x) {
                *out = d * x;
            }
        }
        fn precondition(&mut self, _: &mut [f64]) {}
    }

    fn solve(entry: f64, limit: u32) -> (Result<u32, FactorError>, Vec<f64>) {
        let mut matrix = Diagonal((1..=12).map(f64::from).collect());
        matrix.0[4] = entry;
        let (mut residual, mut x) = (vec![1.0; 12], vec![0.0; 12]);
        let vectors = &mut Directions::default();
        let outcome =
            conjugate_gradients(&mut matrix, &mut residual, &mut x, 1e-12, limit, vectors);
        (outcome, x)
    }

    #[test]
    fn twelve_eigenvalues_take_twelve_iterations() {
        let (outcome, x) = solve(5.0, 20);
        assert!(outcome.unwrap() <= 13);
        let error = |(i, x): (usize, &f64)| (x - 1.0 / (i + 1) as f64).abs();
        assert!(x.iter().enumerate().map(error).fold(0.0, f64::max) < 1e-12);
    }

    #[test]
    fn a_negative_or_missing_eigenvalue_is_an_error_and_so_is_an_unreached_target() {
        // The last direction is nearly along the negative entry.
        assert_eq!(solve(-0.5, 20).0, Err(FactorError::NotPositiveDefinite { dof: 4 }));
        assert!(matches!(solve(-500.0, 20).0, Err(FactorError::NotPositiveDefinite { .. })));
        assert!(matches!(solve(0.0, 30).0, Err(FactorError::NotPositiveDefinite { .. })));
        assert_eq!(solve(f64::NAN, 20).0, Err(FactorError::NotFinite));
        assert!(matches!(solve(5.0, 3).0, Err(FactorError::NotReached { iterations: 3, .. })));
    }
}
