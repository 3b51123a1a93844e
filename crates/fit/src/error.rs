use super::LevelError;
use files::counted;

/// Largest power of a factor |log h|: theorems have ½, 1 or 2.
pub(super) const LARGEST_LOG: f64 = 100.0;

/// The power M of a factor |log h|^M, if it is one.
///
/// # Errors
/// [`FitError::Log`].
pub(super) fn power_of_log(log: f64) -> Result<f64, FitError> {
    if log.abs() <= LARGEST_LOG { Ok(log) } else { Err(FitError::Log(log)) }
}

/// Why no order could be fitted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FitError {
    #[error("{}, an order needs {needed}", counted(*found, "point"))]
    TooFew { found: usize, needed: usize },
    /// A step that occurs twice has no ratio and no slope.
    #[error("the step {step:e} occurs twice")]
    RepeatedStep { step: f64 },
    #[error("the steps {coarse:e} and {fine:e} are too far apart: their ratio is not finite")]
    NoRatio { coarse: f64, fine: f64 },
    /// A step, an error, a floor or a deviation that is none.
    #[error(transparent)]
    Level(#[from] LevelError),
    #[error(
        "the power {0:?} of |log h| is none: it is at most {LARGEST_LOG} in size; 1 is h |log h|"
    )]
    Log(f64),
    /// |log h| vanishes at a step of one and grows beyond.
    #[error("a factor |log h| needs steps below 1, and one is {step}")]
    NoLogarithm { step: f64 },
    /// A reference that is not finer than all levels.
    #[error(
        "the reference has the step {step:?}, and the finest level {finest:?}: it has to be finer"
    )]
    Reference { step: f64, finest: f64 },
    #[error("the values oscillate: their differences change sign at the step {step:e}")]
    SignChange { step: f64 },
    /// The least-squares problem has no unique solution.
    #[error("the fit of {} is singular", counted(*points, "point"))]
    Singular { points: usize },
}
