//! A case as those see it who run it: its levels, why it has no result, and what it took.

use super::{Floors, LoadError};
use algebra::linalg::LinearWork;
use vhi::FailedStep;

/// The solution at one time level, as an observer sees it.
pub struct StepView<'a> {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// u_n as a nodal vector, clamped nodes included.
    pub u: &'a [f64],
    /// Σ'_{j ≤ n} b(t_n - t_j) u_j as nodal vectors, one per term of the memory.
    pub history: &'a [Vec<f64>],
    /// ζ_n, also for scenes without projection.
    pub zeta: f64,
    /// κ(ζ_n); infinite without projection.
    pub kappa: f64,
    /// ‖ε(u_n)‖.
    pub strain_norm: f64,
    /// ξ_n at the points of the trace (a pressure).
    pub compliance: &'a [f64],
    /// λ_n at the points of the trace (a pressure).
    pub multiplier: &'a [f64],
    /// s_n = -σ_τ along [`super::TracePoint::tangents`] at the points of the trace, d - 1 numbers each; empty without friction.
    pub friction: &'a [f64],
}

/// Called with every time level; an error that it returns ends the march.
pub type Observer<'a> = dyn FnMut(&StepView<'_>) -> Result<(), CaseError> + 'a;

/// Why a case has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CaseError {
    #[error(transparent)]
    Step(#[from] FailedStep),
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The separate evaluation of the KKT system disagrees with the solver.
    #[error(
        "step {n} (t = {t}): KKT residual {residual:.3e} by separate evaluation exceeds {allowed:.1e}"
    )]
    Kkt { n: usize, t: f64, residual: f64, allowed: f64 },
    /// L_κ, and with it the bounds on the step size, hold up to a smaller ζ.
    #[error(
        "step {n} (t = {t}): zeta = {zeta:.4} is beyond {reach:.4}, up to which |kappa'| was bounded: the step bounds say nothing there; give kappa a slope that is bounded for all zeta"
    )]
    BeyondZeta { n: usize, t: f64, zeta: f64, reach: f64 },
    /// A solver outside this program gave no answer.
    #[error("{0}")]
    Outside(String),
    /// Errors are sums of squares, which leave the range of doubles.
    #[error(
        "‖ε(u_n)‖ is {strain:.1e} and stresses are {stress:.1e} at most: outside 1e-152 to 1e152 errors cannot be measured, since their squares leave the range of doubles; state the scene in other units"
    )]
    OutOfRange {
        /// max ‖ε(u_n)‖ over the root of |Ω|.
        strain: f64,
        /// `strain` times the stiffest modulus.
        stress: f64,
    },
}

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

/// What one case took.
#[derive(Debug, Clone, Copy, Default)]
pub struct CaseInfo {
    /// Newton iterations over all steps.
    pub newton_iterations: u32,
    /// Applications of Λ over all steps, 0 for other solvers.
    pub fixed_point_iterations: u32,
    /// Convex problems of the decomposition over all steps, 0 for other solvers.
    pub convex_problems: u32,
    /// Largest quotient of successive changes of the decomposition.
    pub contraction: f64,
    /// Changes of the active set over all steps.
    pub active_set_changes: u32,
    /// Largest relative KKT residual over all steps (separate evaluation).
    pub kkt_residual: f64,
    /// max ‖ε(u_n)‖.
    pub strain_norm: f64,
    /// Factorizations, solves and their times.
    pub work: Work,
    /// Seconds in loads.
    pub seconds_load: f64,
    /// Largest memory held by the history.
    pub peak_history_bytes: usize,
    /// Halved Newton steps over all levels.
    pub damped_iterations: u32,
    /// What solver and rounding contribute to each error.
    pub floors: Floors,
}

/// A relative KKT residual above this is a failure: the accuracy promised for results. Rounding of nodal forces against the
/// largest of them is n·1e-16 for moduli of one size; where it is more, see [`super::kkt_residual`].
pub const KKT_ALLOWED: f64 = 1e-9;
