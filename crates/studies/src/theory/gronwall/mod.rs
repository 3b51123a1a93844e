//! Gronwall's inequality of (3.24) on runs: truncation errors, envelopes, effectivities and
//! the growth of perturbations.
//!
//! Only purely temporal errors are put under the envelopes: the truth is the exact u(t) of an abstract
//! problem, an exact u(t) ∈ V^h, or a run on the same mesh.

mod recurrence;
mod scenes;
mod study;
#[cfg(test)]
mod tests;

pub use recurrence::{Envelopes, Estimate, HistoryPart, InTime, Solved, StepTooLarge, Weights};
pub use scenes::{ContactInTime, GronwallConstants, TemporalTruth, TruthAtLevel};
pub use study::{of_scene, prepare, study_runs};
