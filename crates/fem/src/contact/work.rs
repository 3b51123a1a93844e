//! What a run counts.

use algebra::linalg::LinearWork;

/// Counters and times of the solver's parts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Work {
    /// Evaluations of F.
    pub residuals: u32,
    /// Tangents of the projection: walks over the cells.
    pub tangents: u32,
    /// Seconds in residuals and tangents.
    pub seconds_assemble: f64,
    /// Factorizations and solves.
    pub linear: LinearWork,
}
