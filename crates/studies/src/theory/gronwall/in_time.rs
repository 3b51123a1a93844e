//! What a scene of either kind gives to the study of its error in time.

use super::estimate::{Estimate, Terms};
use super::recurrence::StepTooLarge;
use algebra::linalg::FactorError;
use fem::contact::{CaseError, LoadError};
use scene::setup::SetupError;
use vhi::finite::FiniteError;
use vhi::history::TimeGrid;

/// Vectors at t_0, …, t_N: loads or displacements in the layout of the scene.
pub type Levels = Vec<Vec<f64>>;

/// The truth on a grid.
pub struct Known {
    /// u(t_0), …, u(t_N).
    pub u: Levels,
    /// As in [`Estimate`], and the factors ω_p with which its parts enter.
    pub truncation: [Vec<f64>; 2],
    pub factors: [f64; 2],
    /// What is not known of u, in its norm.
    pub unknown: f64,
}

/// A scene with its truth in time, ready to run on any of the grids it was prepared for.
pub trait InTime {
    /// The constants of (3.24), and what they are made of, by name.
    fn constants(&self) -> Vec<(&'static str, f64)>;

    /// Where the truth comes from.
    fn truth(&self) -> String;

    /// The grid with N steps.
    fn grid(&self, steps: u32) -> TimeGrid;

    /// f_0, …, f_N.
    ///
    /// # Errors
    /// A formula that is not finite.
    fn loads(&self, grid: &TimeGrid) -> Result<Levels, GronwallError>;

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
    ) -> Result<(Levels, f64), GronwallError>;

    /// ‖u - v‖_X.
    fn distance(&self, u: &[f64], v: &[f64]) -> f64;

    /// The constants on this grid.
    fn terms(&self, grid: &TimeGrid) -> Terms;

    /// The truth on this grid.
    ///
    /// # Errors
    /// A formula that is not finite, a grid that the truth does not have.
    fn known(&self, grid: &TimeGrid) -> Result<Known, GronwallError>;

    /// A run against the truth.
    ///
    /// # Errors
    /// As [`Self::known`].
    fn compared(
        &self,
        grid: TimeGrid,
        (run, floor): (Levels, f64),
    ) -> Result<Estimate, GronwallError> {
        let Known { u, truncation, factors, unknown } = self.known(&grid)?;
        let (m0, beta, weights, parts) = self.terms(&grid);
        let both = || truncation[0].iter().zip(&truncation[1]);
        let weighted = both().map(|(zeta, memory)| factors[0] * zeta + factors[1] * memory);
        Ok(Estimate {
            weights,
            error: run.iter().zip(&u).map(|(run, u)| self.distance(run, u)).collect(),
            weighted_source: weighted.collect(),
            source: both().map(|(zeta, memory)| beta * (zeta + memory)).collect(),
            m0,
            beta,
            parts,
            floor: floor + unknown,
            truncation,
            grid,
        })
    }

    /// e_n, g_n and the data of the bounds on the grid with N steps.
    ///
    /// # Errors
    /// The run or the truth fails.
    fn measure(&self, steps: u32) -> Result<Estimate, GronwallError> {
        let grid = self.grid(steps);
        let run = self.solutions(&grid, &self.loads(&grid)?)?;
        self.compared(grid, run)
    }
}

/// m0, β_φ, ‖S‖, C1 = β_φ/m0 and C2 = C1 ‖S‖ by name, and others.
pub(super) fn named<const N: usize>(
    [m0, beta, lipschitz]: [f64; 3],
    others: [(&'static str, f64); N],
) -> Vec<(&'static str, f64)> {
    let c1 = beta / m0;
    let own = [("m0", m0), ("beta_phi", beta), ("lipschitz", lipschitz), ("C1", c1)];
    own.into_iter().chain([("C2", c1 * lipschitz)]).chain(others).collect()
}

/// Loads given at the times of a grid.
pub(super) struct GivenLoads<'a>(pub &'a TimeGrid, pub &'a [Vec<f64>]);

impl GivenLoads<'_> {
    /// The load at t; none between the times of the grid.
    pub(super) fn load(&self, t: f64) -> Option<&[f64]> {
        let n = self.0.times().iter().position(|level| *level == t)?;
        Some(&self.1[n])
    }
}

/// What ends a study before it can judge.
#[derive(Debug, thiserror::Error)]
pub enum GronwallError {
    /// The scene has no estimate: no history, or a constant that is not known, not finite or not positive.
    #[error("scene `{scene}`{why}")]
    Refused { scene: String, why: String },
    /// A body without a mesh, or a mesh without a body.
    #[error("{reason}")]
    Mesh { reason: &'static str },
    /// C2 w_nn ≥ 1 on a grid.
    #[error("{steps} steps: {source}")]
    Step { steps: u32, source: StepTooLarge },
    /// A run with more steps has no level at the times of this grid.
    #[error(
        "the grid with {steps} steps is not part of the reference's with {reference}: random grids need an exact solution in V^h"
    )]
    NotNested { steps: u32, reference: u32 },
    /// A horizon that is no multiple of the step.
    #[error("horizon {horizon} is no multiple of the step k = {k}: choose multiples")]
    Horizon { horizon: f64, k: f64 },
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error("{steps} steps: {source}")]
    Case { steps: u32, source: CaseError },
    #[error("{steps} steps: {source}")]
    FiniteCase { steps: u32, source: FiniteError },
    /// The inner product of an abstract scene has no inverse.
    #[error("the inner product is singular")]
    InnerProduct,
    #[error("the dual norm: {0}")]
    Dual(#[from] FactorError),
    #[error(transparent)]
    Setup(#[from] SetupError),
}

/// A scene without an estimate, by words that follow its name.
pub(super) fn refused(scene: &scene::Scene, why: &str) -> GronwallError {
    GronwallError::Refused { scene: scene.name.clone(), why: why.into() }
}

/// The rule corrects its weights by the kernel.
pub(super) const OWN_WEIGHTS: &str = ": the rule corrects its last weight by the kernel, and (3.24) has one set of weights for all; take \"trapezoid\", \"left\", \"gregory\" or \"product-integration\"";
/// Nothing is remembered, so there is no error in time to bound.
pub(super) const NO_HISTORY: &str = " has no history: neither memory nor a yield limit that depends on zeta; the error in time is zero";

/// (2.9), with a bound of c_j².
pub(super) fn smallness(scene: &scene::Scene, m0: f64) -> Result<(), GronwallError> {
    let why = format!(
        ": m0 = {m0:.6} is not positive with an upper bound of c_j^2; flatten the falling branch of the law"
    );
    if m0 > 0.0 { Ok(()) } else { Err(refused(scene, &why)) }
}
