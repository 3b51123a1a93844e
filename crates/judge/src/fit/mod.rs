//! Orders of convergence from errors: pure functions of numbers, usable for any table.
//!
//! The residuals of a straight line through the logarithms are bias, not noise: the next term of the expansion bends
//! it, and its Student interval misses the truth. The order is therefore inferred together with the next term, see
//! [`infer`].

mod against_reference;
mod decision;
mod eca_hoekstra;
mod grid_fit;
mod identifiable;
mod inference;
mod interval;
mod joint;
mod least_squares;
mod levenberg_marquardt;
mod local;
mod log_table;
mod model;
mod path;
mod power_law;
mod richardson;
mod screen;
mod stopping;
mod values;

pub use against_reference::{AgainstReference, against_reference};
pub use decision::Decision;
pub use eca_hoekstra::{EcaHoekstra, Expansion, eca_hoekstra};
use files::counted;
pub use identifiable::NotIdentifiable;
pub(crate) use identifiable::distinct;
pub use inference::{
    Claim, ClaimError, FEWEST, GridPosterior, Level, Posterior, Ruling, TOLERANCE, infer,
    infer_grid, order,
};
pub use interval::Interval;
pub use joint::{FittedValue, JointFit, JointFits, LARGEST_OTHER_SHARE, fit_constants, joint_fits};
pub use least_squares::{LinearFit, linear_fit, student_quantile};
pub use local::{Correction, constant_under, local_slopes};
pub use model::ErrorCombination;
pub use path::{RefinementPath, path};
pub use power_law::{PowerLaw, power_law};
pub use richardson::{Triple, ValueSample};
pub use screen::{Exclusion, FLOORS_ABOVE, Sample, samples, screen, value_samples};
pub use stopping::settles;
pub use values::infer_values;

/// Relative difference of steps that count as one level: tables carry 1/3 as 0.333333333.
const SAME_LEVEL: f64 = 1e-9;

/// Whether two positive steps are one up to rounding.
pub fn same_level(a: f64, b: f64) -> bool {
    a.min(b) >= a.max(b) * (1.0 - SAME_LEVEL)
}

/// One entry of an error table. A missing error or step is NaN, an unmeasured floor is 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub h: f64,
    pub k: f64,
    pub error: f64,
    /// Error that exact discretisation would leave: solver tolerance and rounding.
    pub floor: f64,
}

/// The step that is refined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Space,
    Time,
}

impl Direction {
    /// The step of a point in this direction.
    pub fn step(self, point: &Point) -> f64 {
        match self {
            Self::Space => point.h,
            Self::Time => point.k,
        }
    }
}

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
