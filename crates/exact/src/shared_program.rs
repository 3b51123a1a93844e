//! A bound program that threads share.

use std::sync::{Mutex, PoisonError};

use formula::BoundProgram;

pub(super) struct SharedProgram(Mutex<BoundProgram>);

impl From<BoundProgram> for SharedProgram {
    fn from(bound: BoundProgram) -> Self {
        Self(Mutex::new(bound))
    }
}

impl SharedProgram {
    /// All outputs at the bound points, where ζ = 0.
    pub(super) fn values_at(&self, t: f64) -> Vec<Vec<f64>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).values_at(t, 0.0)
    }
}
