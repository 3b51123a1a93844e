//! A run in time under the chain of its bounds.

use super::GronwallError;
use super::estimate::{Envelopes, Estimate, LinkViolation};

/// A run with its envelopes and the links of the chain that do not hold; the table of all levels holds its curves.
pub struct Judged {
    pub estimate: Estimate,
    pub envelopes: Envelopes,
    pub violations: Vec<LinkViolation>,
}

impl Judged {
    /// # Errors
    /// [`GronwallError::Step`].
    pub(super) fn new(estimate: Estimate) -> Result<Self, GronwallError> {
        let steps = estimate.grid.steps() as u32;
        let envelopes =
            estimate.envelopes().map_err(|source| GronwallError::Step { steps, source })?;
        let violations = envelopes.violations(&estimate);
        Ok(Self { estimate, envelopes, violations })
    }
}
