//! Cases and their leading errors.

/// One case, by its mesh and number of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Case {
    /// Cells per unit length; none in ℝ^m.
    pub n: Option<u32>,
    pub steps: u32,
}

/// The leading error of one case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeadingError {
    pub case: Case,
    /// h = 1/n.
    pub h: Option<f64>,
    pub k: f64,
    pub error: f64,
}

/// Leading errors in one norm, and their limit over the step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LeadingErrors {
    /// One per case, in the order of the cases.
    pub points: Vec<LeadingError>,
    /// lim ‖ε(u - I_h u)‖/h at the time of the largest error on the finest mesh; in space only.
    pub limit: Option<f64>,
    /// Allowed relative difference of a sound scheme's error on the finest case.
    pub tolerance: f64,
}
