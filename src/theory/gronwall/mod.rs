//! Gronwall's inequality of (3.24) on runs: truncation errors, envelopes, effectivities, horizons and
//! the growth of perturbations.

mod estimate;
mod recurrence;
#[cfg(test)]
mod tests;

pub use estimate::{Envelopes, Estimate, Violation, effectivities, maximum};
pub use recurrence::{
    HistoryPart, KernelNorms, StepTooLarge, closed_limit, primed, primed_closed, unprimed,
    unprimed_closed, weighted,
};
