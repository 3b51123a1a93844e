//! A run in time under the chain of its bounds.

use super::GronwallError;
use super::estimate::{Envelopes, LinkViolation};
use super::measure::TemporalRun;

/// A run with its envelopes and the links of the chain that do not hold; the table of all levels holds its curves.
pub struct Judged {
    pub run: TemporalRun,
    pub envelopes: Envelopes,
    pub violations: Vec<LinkViolation>,
}

impl Judged {
    /// # Errors
    /// [`GronwallError::Step`].
    pub(super) fn new(run: TemporalRun) -> Result<Self, GronwallError> {
        let steps = run.estimate.grid.steps() as u32;
        let envelopes =
            run.estimate.envelopes().map_err(|source| GronwallError::Step { steps, source })?;
        let violations = envelopes.violations(&run.estimate);
        Ok(Self { run, envelopes, violations })
    }
}
