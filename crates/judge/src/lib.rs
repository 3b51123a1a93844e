#![doc = include_str!("../README.md")]

pub mod claim;
mod order;
pub mod record;
pub mod table;
pub mod verdict;

pub use fit;
pub use order::{Order, OrderError, Predicted, Verdict};
