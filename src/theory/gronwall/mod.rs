//! Gronwall's inequality of (3.24) on runs: truncation errors, envelopes, effectivities, horizons and
//! the growth of perturbations.

mod constants;
mod error;
mod estimate;
mod measure;
mod recurrence;
#[cfg(test)]
mod tests;
mod truth;

pub use constants::GronwallConstants;
pub use error::GronwallError;
pub use estimate::{Envelopes, Estimate, Violation, effectivities, maximum};
pub use measure::TemporalRun;
pub use recurrence::{
    HistoryPart, KernelNorms, StepTooLarge, closed_limit, primed, primed_closed, unprimed,
    unprimed_closed, weighted,
};
pub use truth::{Level, ReferenceLevels, TemporalTruth};
