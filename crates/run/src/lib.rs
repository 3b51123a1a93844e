//! Sweeps of a scene over its grids: cases, threads, records, resume; external solvers; distributed runs.

pub mod distributed;
pub mod external;
mod front;
pub mod leading_error;
pub mod sweep;

pub use front::{FrontError, Sweep, Swept, plan_for};
