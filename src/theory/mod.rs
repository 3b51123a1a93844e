//! The theory as programs: every line of a proof that has two sides is computed on both.

pub mod audit;
pub mod ledger;
