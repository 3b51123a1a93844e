use files::counted;

/// Why no order could be fitted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FitError {
    #[error("{}, an order needs {needed}", counted(*found, "point"))]
    TooFew { found: usize, needed: usize },
    /// A step that occurs twice has no ratio and no slope.
    #[error("the step {step:e} occurs twice")]
    RepeatedStep { step: f64 },
    /// A step or an error that is not a positive number.
    #[error("the error {error:e} at the step {step:e}: both have to be positive numbers")]
    NoError { step: f64, error: f64 },
    /// A relative standard deviation that is not positive.
    #[error("the relative standard deviation {sigma} is no positive number")]
    NoDeviation { sigma: f64 },
    /// |log h| vanishes at a step of one and grows beyond.
    #[error("a factor |log h| needs steps below 1, and one is {step}")]
    NoLogarithm { step: f64 },
    #[error("the values oscillate: their differences change sign at the step {step:e}")]
    SignChange { step: f64 },
    /// The least-squares problem has no unique solution.
    #[error("the fit of {} is singular", counted(*points, "point"))]
    Singular { points: usize },
}
