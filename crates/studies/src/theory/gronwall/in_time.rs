//! What a scene of either kind gives to the study of its error in time.

use super::GronwallError;
use super::constants::InequalityConstants;
use super::estimate::Estimate;
use vhi::history::TimeGrid;

/// A scene with its truth in time, ready to run on any of the grids it was prepared for. Vectors are
/// loads and displacements in the layout of the scene.
pub trait InTime {
    /// The constants of (3.24).
    fn constants(&self) -> InequalityConstants;

    /// Where the truth comes from.
    fn truth(&self) -> String;

    /// The grid with N steps.
    fn grid(&self, steps: u32) -> TimeGrid;

    /// e_n, g_n and the data of the bounds on this grid.
    ///
    /// # Errors
    /// The run or the truth fails.
    fn measure(&self, steps: u32) -> Result<Estimate, GronwallError>;

    /// f_0, …, f_N.
    ///
    /// # Errors
    /// A formula that is not finite.
    fn loads(&self, grid: &TimeGrid) -> Result<Vec<Vec<f64>>, GronwallError>;

    /// ‖·‖_* of each vector.
    ///
    /// # Errors
    /// A factorization's.
    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>, GronwallError>;

    /// u_0^k, …, u_N^k under these loads, and the floor of the run.
    ///
    /// # Errors
    /// The run fails.
    fn solutions(
        &self,
        grid: &TimeGrid,
        loads: &[Vec<f64>],
    ) -> Result<(Vec<Vec<f64>>, f64), GronwallError>;

    /// ‖u - v‖_X.
    fn distance(&self, u: &[f64], v: &[f64]) -> f64;

    /// The bounds of a difference without truncation whose source is ‖δf_n‖_*: constants and parts
    /// of the history on this grid, everything else zero.
    fn blank(&self, grid: &TimeGrid) -> Estimate;
}

/// Loads given at the times of a grid.
pub(super) struct Levels<'a> {
    pub grid: &'a TimeGrid,
    pub loads: &'a [Vec<f64>],
}

impl Levels<'_> {
    /// The load at t; none between the times of the grid.
    pub(super) fn load(&self, t: f64) -> Option<&[f64]> {
        let n = self.grid.times().iter().position(|level| *level == t)?;
        Some(&self.loads[n])
    }
}
