//! The theory, executable: every constant, bound and inequality of the paper as something that runs.

pub mod audit;
pub mod bound;
pub mod corner;
pub mod estimators;
pub mod gronwall;
pub mod norms;
