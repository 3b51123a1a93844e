use crate::FailedStep;

/// Why a case has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FiniteError {
    #[error(transparent)]
    Step(#[from] FailedStep),
    /// The functionals of j and K do not determine coordinates.
    #[error("the functionals of [[trace]] are linearly dependent: state each direction once")]
    Dependent,
    #[error("component {component} of the load is {value} at t = {t}")]
    Load { component: usize, value: f64, t: f64 },
    /// The independent evaluation of the inequality disagrees with the solver.
    #[error(
        "step {n} (t = {t}): residual {residual:.3e} by separate evaluation exceeds {allowed:.1e}"
    )]
    Kkt { n: usize, t: f64, residual: f64, allowed: f64 },
}
