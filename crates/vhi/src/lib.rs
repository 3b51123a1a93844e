//! The discrete inequality (4.3) over a time grid, and its solution level by level: a semismooth Newton method with
//! primal-dual active set, the fixed-point iteration Λ of Theorem 6, or the decomposition of Remark 3. Independent of
//! any mesh.

mod decomposition;
mod extrapolation;
pub mod finite;
mod fixed_point;
mod frozen_derivative;
mod graph;
pub mod history;
mod history_inequality;
pub mod law;
mod line;
mod newton;
mod polished;
mod repeated;
mod state;
mod step;
mod step_bounds;
mod stepper;

pub use decomposition::Decomposition;
pub use extrapolation::Extrapolation;
pub use fixed_point::FixedPoint;
pub use frozen_derivative::FrozenDerivative;
pub use graph::{BoundaryGraph, Coordinate, GraphPiece};
pub use history_inequality::{FailedStep, HistoryInequality, OpenInequality};
pub use line::rounding_of;
pub use newton::{Newton, Scratch, StepError, StepInfo};
pub use polished::Polished;
pub use state::StepState;
pub use step::StepInequality;
pub use step_bounds::{SingularSlot, StepBounds, StepPlace, monotonicity};
pub use stepper::{InVolume, StepSolver, Stepper};
