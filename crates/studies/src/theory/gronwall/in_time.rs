//! What a scene of either kind gives to the study of its error in time.

use super::contact::ContactInTime;
use super::estimate::Estimate;
use super::finite::FiniteInTime;
use super::recurrence::StepTooLarge;
use algebra::linalg::FactorError;
use fem::contact::{CaseError, LoadError};
use scene::setup::{SetupError, Subject};
use vhi::finite::FiniteError;
use vhi::history::TimeGrid;

/// A scene with its truth in time, ready to run on any of the grids it was prepared for. Vectors are
/// loads and displacements in the layout of the scene.
pub trait InTime {
    /// The constants of (3.24), and what they are made of, by name.
    fn constants(&self) -> Vec<(&'static str, f64)>;

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

/// Prepares a scene for grids with these numbers of steps. A body needs `n`, cells per unit length; an
/// abstract scene has none.
///
/// # Errors
/// Constants, loads or a reference run that cannot be had.
pub fn prepare<'a>(
    subject: &'a Subject,
    n: Option<u32>,
    steps: &[u32],
) -> Result<Box<dyn InTime + 'a>, GronwallError> {
    let reason = match (subject, n) {
        (Subject::Contact(setup), Some(n)) => {
            return Ok(Box::new(ContactInTime::new(setup, n, steps)?));
        }
        (Subject::Abstract(setup), None) => return Ok(Box::new(FiniteInTime::new(setup)?)),
        (Subject::Contact(_), None) => "a body needs a mesh: give --n",
        (Subject::Abstract(_), Some(_)) => "an abstract problem has no mesh: remove --n",
    };
    Err(GronwallError::Mesh { reason })
}

/// What ends a study before it can judge.
#[derive(Debug, thiserror::Error)]
pub enum GronwallError {
    /// Nothing is remembered, so there is no error in time to bound.
    #[error(
        "scene `{scene}` has no history (neither memory nor a yield limit that depends on zeta), so its error in time is zero"
    )]
    NoHistory { scene: String },
    /// m0 would have to rely on a computed c_j², which is no upper bound.
    #[error(
        "scene `{scene}` has a falling contact law, and no bound of c_j^2 is proved for its sides: place the contact side opposite a clamped one"
    )]
    NoTraceBound { scene: String },
    /// (2.9) fails with the proved bound.
    #[error(
        "scene `{scene}`: m0 = {m0:.6} is not positive with an upper bound of c_j^2; flatten the falling branch of the law"
    )]
    Smallness { scene: String, m0: f64 },
    /// Friction takes from the monotonicity by a constant of which no bound is proved.
    #[error(
        "scene `{scene}`: m0 needs an upper bound of c_tau^2 where friction falls with the slip or follows the pressure, and none is proved; take a bound that is given"
    )]
    NoTangentialBound { scene: String },
    /// A rule whose weights depend on the kernel.
    #[error(
        "scene `{scene}`: the rule corrects its last weight by the kernel, and (3.24) has one set of weights for all; take \"trapezoid\", \"left\", \"gregory\" or \"product-integration\""
    )]
    OwnWeights { scene: String },
    /// A body without a mesh, or a mesh without a body.
    #[error("{reason}")]
    Mesh { reason: &'static str },
    /// L_κ is infinite.
    #[error("scene `{scene}`: kappa is not Lipschitz, so (3.24) has no constant C2")]
    NotLipschitz { scene: String },
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
    /// Horizons are beginnings of one run, which holds on a uniform grid.
    #[error("scene `{scene}`: horizons at a fixed step need a uniform grid; leave --horizons out")]
    NotUniform { scene: String },
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
    #[error("the table of levels: {0}")]
    Table(csv::Error),
}
