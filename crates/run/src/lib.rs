//! Sweeps of a scene over its grids: cases, threads, records, resume; external solvers; records of many processes as one.

pub mod external;
mod front;
pub mod merge;
pub mod sweep;

pub use ::leading_error;
pub use front::{FrontError, Sweep, Swept, plan_for};
