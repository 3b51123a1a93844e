//! Problem 9 in X = ℝ^m: an instance of [`crate`] without mesh or error in space.

mod error;
mod evolution;
mod frozen;
mod load;
mod march;
mod model;

pub use error::FiniteError;
pub use evolution::FiniteEvolution;
pub use load::FiniteLoad;
pub use march::{FiniteInfo, FiniteView, march};
pub use model::{ComponentLaw, FiniteKernel, FiniteModel, Functional};
