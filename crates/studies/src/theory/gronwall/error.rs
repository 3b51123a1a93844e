//! Why Gronwall's inequality could not be put over a run.

use super::recurrence::StepTooLarge;
use algebra::linalg::FactorError;
use fem::contact::{CaseError, LoadError};
use scene::setup::SetupError;
use vhi::finite::FiniteError;

/// What ends a study before it can judge.
#[derive(Debug, thiserror::Error)]
pub enum GronwallError {
    /// Nothing is remembered, so there is no error in time to bound.
    #[error(
        "scene `{scene}` has no history: neither memory nor a yield limit that depends on zeta; the error in time is zero"
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
}
