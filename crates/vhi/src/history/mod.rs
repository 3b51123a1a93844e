//! The history operator S_n^k: time grids, weights of time rules, and the sums Σ' over the past.

mod accumulated;
mod endpoint;
mod fast;
mod gregory;
mod grid;
mod memory;
mod powers;
mod rules;

pub use accumulated::Accumulated;
pub use endpoint::{Left, Right};
pub use fast::FastConvolution;
pub use gregory::{Gregory, GregoryOrder};
pub use grid::{ClosedForm, GridError, GridFamily, TimeGrid, TimeRule, Trapezoid};
pub use memory::{Memory, last_weight};
pub use rules::{CorrectedEnd, ProductIntegration};
