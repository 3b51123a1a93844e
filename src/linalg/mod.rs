//! Sparse symmetric matrices over node blocks, their assembly, Cholesky factorization and multigrid.

mod cholesky;
mod conjugate_gradient;
mod dense;
mod dissection;
mod gmres;
mod krylov_eigen;
mod multigrid;
mod multigrid_sequence;
mod pattern;
mod random;
mod sequence;
mod substitution;
mod tangent_solver;

pub use cholesky::{Analysis, Factor, FactorError, Real, Workspace};
pub use conjugate_gradient::{Directions, conjugate_gradients};
pub use dense::DenseCholesky;
pub use dissection::nested_dissection;
pub use gmres::{Krylov, KrylovInfo, Preconditioned, gmres};
pub use krylov_eigen::{EigenError, Extreme, LinearMap, Spectrum, largest_eigenvalue, spectrum};
pub use multigrid::{Levels, NodeFrame};
pub use multigrid_sequence::MultigridSequence;
pub use pattern::BlockPattern;
pub use random::signed_unit;
pub use sequence::{LinearWork, RankOne, SequenceSolver};
pub use substitution::Front;
pub use tangent_solver::TangentSolver;

/// Σ a_i b_i, summed in order.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// ‖a‖₂.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// The larger of two numbers; a NaN stays, which `f64::max` would forget.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// max |a_i|, 0 of nothing; a NaN stays.
pub fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |worst, value| larger(worst, value.abs()))
}

/// y ← y + α x.
pub fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
    for (target, value) in y.iter_mut().zip(x) {
        *target += alpha * value;
    }
}
