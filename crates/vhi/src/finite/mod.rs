//! Problem 9 in X = ℝ^m: an instance of [`crate`] without mesh or error in space.

mod evolution;
mod frozen;
mod march;
mod model;

pub use evolution::FiniteEvolution;
pub use march::{FiniteError, FiniteInfo, FiniteLoad, FiniteView, march};
pub use model::{ComponentLaw, FiniteKernel, FiniteModel, Functional};
