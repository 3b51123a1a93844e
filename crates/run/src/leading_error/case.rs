//! A case of a scene whose errors are predicted.

use judge::verdict::LeadingPoint;

/// One case, by its mesh and number of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Case {
    /// Cells per unit length; none in ℝ^m.
    pub n: Option<u32>,
    pub steps: u32,
}

impl Case {
    pub(super) fn point(self, h: Option<f64>, k: f64, error: f64) -> LeadingPoint {
        LeadingPoint { n: self.n, steps: self.steps, h, k, error }
    }
}
