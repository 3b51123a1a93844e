//! The theory, executable: bounds and inequalities of the paper, evaluated on runs.

pub mod gronwall;
