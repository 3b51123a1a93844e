//! Orders of convergence from errors: pure functions of numbers, usable for any table.
//!
//! The residuals of a straight line through the logarithms are bias, not noise: the next term of the expansion bends
//! it, and its Student interval misses the truth. The order is therefore inferred together with the next term, see
//! [`infer`].

mod against_reference;
mod decision;
mod error;
mod further;
mod grid_fit;
mod identifiable;
mod inference;
mod interval;
mod joint;
mod joint_fit;
mod least_squares;
mod level;
mod levenberg_marquardt;
mod local;
mod log_table;
mod model;
mod path;
mod point;
mod power_law;
mod richardson;
mod screen;
mod stopping;
mod values;

pub use against_reference::{AgainstReference, against_reference};
pub use decision::Decision;
pub use error::FitError;
use error::power_of_log;
pub use further::{Further, plain};
pub use identifiable::NotIdentifiable;
pub use inference::{
    Claim, ClaimError, FEWEST, GridPosterior, Known, Posterior, Ruling, TOLERANCE, infer_grid,
    line::{LineReading, infer, order},
};
pub use interval::Interval;
pub use joint::{JointFits, LARGEST_OTHER_SHARE, fit_constants, joint_fits};
pub use joint_fit::{FittedValue, JointFit};
pub use least_squares::{LinearFit, linear_fit, student_quantile};
use level::LARGEST_SIGMA;
pub use level::{Level, LevelError, deviation, is_magnitude, is_step, zeros_in_words};
pub use local::{Correction, constant_under, local_slopes};
pub use model::ErrorCombination;
pub use path::{RefinementPath, path};
pub use point::{Direction, Point, same_level};
pub use power_law::{PowerLaw, power_law};
pub use richardson::{Triple, ValueSample};
pub use screen::{Exclusion, FLOORS_ABOVE, Sample, samples, screen, value_samples};
pub use stopping::settles;
pub use values::infer_values;
