//! The history operator S_n^k: time grids, trapezoidal weights, and the sums Σ' over the past.

mod accumulated;
mod fast;
mod grid;
mod memory;
mod rules;

pub use accumulated::Accumulated;
pub use fast::FastConvolution;
pub use grid::{TimeGrid, TimeRule, Trapezoid};
pub use memory::{Memory, Storage};
pub use rules::{CorrectedEnd, ProductIntegration};
