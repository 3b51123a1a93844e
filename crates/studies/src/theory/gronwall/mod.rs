//! Gronwall's inequality of (3.24) on runs: truncation errors, envelopes, effectivities, horizons and
//! the growth of perturbations.
//!
//! Only purely temporal errors are put under the envelopes: the truth is the exact u(t) of an abstract
//! problem, an exact u(t) ∈ V^h, or a run on the same mesh.

mod bounds;
mod constants;
mod contact_scene;
mod document;
mod error;
mod estimate;
mod finite_scene;
mod horizon;
mod in_time;
mod levels;
mod memory;
mod mittag_leffler;
mod pictures;
mod prepare;
mod recurrence;
mod rule;
mod stability;
mod study;
#[cfg(test)]
mod tests;
mod truth;

pub use bounds::Bounds;
pub use constants::{GronwallConstants, InequalityConstants};
pub use contact_scene::ContactInTime;
pub use error::GronwallError;
pub use estimate::{Effectivity, Envelopes, Estimate, Judged, LinkViolation};
pub use horizon::{HorizonRow, Horizons};
pub use in_time::InTime;
pub use memory::study_runs;
pub use prepare::prepare;
pub use recurrence::{HistoryPart, KernelNorms, Solved, StepTooLarge};
pub use rule::Weights;
pub use stability::{LoadShape, Perturbation};
pub use study::{FailedLink, StudiedGrid, Study, StudyRuns};
pub use truth::{ReferenceLevels, TemporalTruth, TruthAtLevel};
