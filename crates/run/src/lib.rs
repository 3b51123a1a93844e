//! Sweeps of a scene over its grids: cases, threads, records, resume; solvers in other programs; many processes.

pub mod distributed;
pub mod external;
pub mod leading_error;
pub mod sweep;
