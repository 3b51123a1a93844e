//! Sparse symmetric matrices over node blocks, their assembly, and the Cholesky factorization.

mod cholesky;
mod dissection;
mod gmres;
mod krylov_eigen;
mod pattern;
mod random;
mod sequence;

pub use cholesky::{Analysis, Factor, FactorError, Real, Workspace};
pub use dissection::nested_dissection;
pub use gmres::{Krylov, KrylovInfo, Preconditioned, gmres};
pub use krylov_eigen::{EigenError, Extreme, LinearMap, Spectrum, largest_eigenvalue, spectrum};
pub use pattern::BlockPattern;
pub use random::signed_unit;
pub use sequence::{LinearWork, RankOne, SequenceSolver};

/// Σ a_i b_i, summed in order.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// ‖a‖₂.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// y ← y + α x.
pub fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
    for (target, value) in y.iter_mut().zip(x) {
        *target += alpha * value;
    }
}
