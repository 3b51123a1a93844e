//! The discrete inequality (4.3) at one time level, and its solution by a semismooth Newton method
//! with primal-dual active set. Nothing here knows a mesh.

mod graph;
mod newton;
mod step;

pub use graph::{BoundaryGraph, Coordinate, Piece};
pub use newton::{Newton, Scratch, StepError, StepInfo};
pub use step::{StepInequality, StepState};
