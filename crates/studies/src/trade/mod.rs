//! Speed against accuracy, measured: runs over h, k and the settings that a scene offers, models of error and cost, the
//! cheapest way to an error, and what each setting saves; and the error of a single run from coarser ones. Seconds are
//! those of single runs on one machine.

mod bench;
pub mod estimate;
mod models;
mod optimum;
mod study;

pub use optimum::{Choice, NoAnswer, Wanted};
pub use study::{Trade, front, measurable, trade};

/// Companions of a run go down to a fourth of n and N, and meshes up to four times the n of a run are made to foresee
/// another one.
pub(crate) const SPAN: u32 = 4;
