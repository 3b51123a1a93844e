//! Sparse symmetric matrices over node blocks, their assembly, Cholesky factorization and eigenvalues.

mod cholesky;
mod complement;
mod dense;
mod dissection;
mod gmres;
mod jacobian;
mod krylov_eigen;
mod pattern;
mod random;
mod sequence;
mod sides;
mod substitution;
mod supernode;
mod tangent_solver;
mod vectors;

pub use cholesky::{Analysis, Factor, FactorError, Real, Workspace};
pub use complement::complement;
pub use dense::DenseCholesky;
pub use dissection::nested_dissection;
pub use gmres::{Krylov, KrylovInfo, Preconditioned, gmres};
pub use jacobian::{Jacobian, NonsymmetricEntry, RankOne};
pub use krylov_eigen::{EigenError, Extreme, LinearMap, Spectrum, largest_eigenvalue, spectrum};
pub use pattern::BlockPattern;
pub use random::signed_unit;
pub use sequence::{Precision, SequenceSolver};
pub use sides::{RightSides, SIDES, Sides};
pub use substitution::Front;
pub use tangent_solver::{LinearWork, TangentSolver};
pub use vectors::{axpy, dot, is_sound_sum, larger, largest, norm, root_of_squares};
