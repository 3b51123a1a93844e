//! Sparse symmetric matrices over node blocks, their assembly, Cholesky factorization and eigenvalues.

mod cholesky;
mod complement;
mod dense;
mod dissection;
mod eigen;
mod jacobian;
mod pattern;
mod random;
mod tangent;
mod vectors;

pub use cholesky::{Analysis, Factor, FactorError, Front, Workspace};
pub use complement::complement;
pub use dense::DenseCholesky;
pub use dissection::nested_dissection;
pub use eigen::{
    EigenError, Extreme, KRYLOV_VECTORS, LinearMap, Spectrum, largest_eigenvalue, spectrum,
};
pub use jacobian::{Jacobian, NonsymmetricEntry, RankOne};
pub use pattern::BlockPattern;
pub use random::signed_unit;
pub use tangent::{LinearWork, TangentSolver};
pub use vectors::{axpy, dot, is_sound_sum, larger, largest, norm, root_of_squares};
