//! Speed against accuracy, measured: runs over h, k and the settings that a scene offers, models of error and cost, the
//! cheapest way to an error, and what each setting saves; and the error of a single run from coarser ones. Seconds are
//! those of single runs on one machine.

mod answer;
mod bench;
mod cost;
mod document;
mod error_model;
pub mod estimate;
mod extrapolation;
mod grid;
mod optimum;
mod settings;
mod study;

pub use answer::Answered;
pub use bench::{Bench, Outcome, Table, Trial};
pub use cost::Cost;
pub(crate) use error_model::{ErrorModel, Term};
pub use grid::{admit_trade, element_meshes, scene_grid};
pub use optimum::{Choice, NoAnswer};
pub use run::sweep::NORMS;
pub use settings::elements;
pub use study::{Study, TradeError, TradeRuns, front};

/// Companions of a run go down to a fourth of n and N, and meshes up to four times the n of a run are made to foresee
/// another one.
pub(crate) const SPAN: u32 = 4;
