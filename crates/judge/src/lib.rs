#![doc = include_str!("../README.md")]

pub mod claim;
pub mod fit;
mod order;
pub mod record;
pub mod table;
pub mod verdict;

pub use order::{Order, OrderError, Predicted, Verdict};
