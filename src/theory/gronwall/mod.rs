//! Gronwall's inequality of (3.24) on runs: truncation errors, envelopes, effectivities, horizons and
//! the growth of perturbations.
//!
//! Only purely temporal errors are put under the envelopes: the truth is an exact u(t) ∈ V^h or a run
//! on the same mesh.

mod constants;
mod document;
mod error;
mod estimate;
mod horizon;
mod measure;
mod pictures;
mod recurrence;
mod stability;
mod study;
#[cfg(test)]
mod tests;
mod truth;

pub use constants::GronwallConstants;
pub use error::GronwallError;
pub use estimate::{Envelopes, Estimate, Violation, effectivities, maximum};
pub use horizon::{HorizonRow, Horizons, horizons};
pub use measure::TemporalRun;
pub use recurrence::{
    HistoryPart, KernelNorms, StepTooLarge, closed_limit, primed, primed_closed, unprimed,
    unprimed_closed, weighted,
};
pub use stability::{DualNorm, Perturbation, Shape, perturbations};
pub use study::{Effectivity, Plan, StudiedGrid, Study};
pub use truth::{Level, ReferenceLevels, TemporalTruth};
