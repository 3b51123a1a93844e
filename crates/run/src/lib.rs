//! Sweeps of a scene over its grids: cases, threads, records, resume; solvers in other programs; many processes.

pub mod distributed;
pub mod external;
mod front;
pub mod leading_error;
pub mod sweep;

pub use front::{FrontError, Sweep, Swept};
