//! What is asked of a scene beside its orders: the theorems as runs, speed against accuracy, extremes, diagnosis, solutions, portraits.

pub mod diagnose;
pub mod extremes;
pub mod portrait;
pub mod solution;
pub mod study;
pub mod theory;
pub mod trade;

pub use ::guarantee;
