//! One level of a table: the type through which every error is judged, and its checks.

use files::counted;

use super::{Direction, Exclusion, FLOORS_ABOVE, Interval, Point};

/// Largest relative standard deviation of an error. An error that is known to a factor of e^10 is not known; the sums of
/// the evidence overflow only far beyond.
pub(super) const LARGEST_SIGMA: f64 = 10.0;
/// A level that is left out is not explained if its error, floor included, lies by more than this factor below what the
/// others predict at least. One order more over a halving, beyond the interval of the order, makes a factor of 2.
const FAR_BELOW: f64 = 4.0;

/// Why numbers are no level.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LevelError {
    #[error("the step {0:?} is no step size, which is positive and finite")]
    Size(f64),
    #[error("the error {0:?} is no error")]
    Error(f64),
    #[error("the floor {0:?} is no floor")]
    Floor(f64),
    #[error(
        "the relative standard deviation {0:?} is none: it is positive and at most {LARGEST_SIGMA}; 0.01 is 1 %"
    )]
    Sigma(f64),
}

/// A step, its error, and what is known of it. There is no other way to one than through its checks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    size: f64,
    error: f64,
    floor: f64,
    sigma: Option<f64>,
}

impl Level {
    /// A level whose step is positive and whose error is not negative, both finite.
    pub fn new(size: f64, error: f64) -> Result<Self, LevelError> {
        if !is_step(size) {
            return Err(LevelError::Size(size));
        }
        measured(error, 0.0)?;
        Ok(Self { size, error, floor: 0.0, sigma: None })
    }

    /// With an upper bound of the part of the error that is not discretisation; 0 if unknown.
    pub fn with_floor(self, floor: f64) -> Result<Self, LevelError> {
        measured(self.error, floor)?;
        Ok(Self { floor, ..self })
    }

    /// With the relative standard deviation of the error.
    pub fn with_sigma(self, sigma: f64) -> Result<Self, LevelError> {
        Ok(Self { sigma: Some(deviation(sigma)?), ..self })
    }

    /// A point in one direction; `sigma` is the relative standard deviation of its error, if known.
    pub fn of(point: &Point, direction: Direction, sigma: Option<f64>) -> Result<Self, LevelError> {
        let level = Self::new(direction.step(point), point.error)?.with_floor(point.floor)?;
        sigma.map_or(Ok(level), |sigma| level.with_sigma(sigma))
    }

    pub fn size(&self) -> f64 {
        self.size
    }

    pub fn error(&self) -> f64 {
        self.error
    }

    pub(super) fn sigma(&self) -> Option<f64> {
        self.sigma
    }

    /// Whether the error may carry an order; else why not.
    pub fn screened(&self) -> Result<(), Exclusion> {
        screened(self.error, self.floor)
    }
}

/// Whether a number can be an error or a floor.
pub fn is_magnitude(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// Whether a number can be a step.
pub fn is_step(step: f64) -> bool {
    step.is_finite() && step > 0.0
}

/// Whether an error and its floor are such.
fn measured(error: f64, floor: f64) -> Result<(), LevelError> {
    match (is_magnitude(error), is_magnitude(floor)) {
        (false, _) => Err(LevelError::Error(error)),
        (_, false) => Err(LevelError::Floor(floor)),
        _ => Ok(()),
    }
}

/// A relative standard deviation, if it is one.
///
/// # Errors
/// [`LevelError::Sigma`].
pub fn deviation(sigma: f64) -> Result<f64, LevelError> {
    let sound = sigma > 0.0 && sigma <= LARGEST_SIGMA;
    if sound { Ok(sigma) } else { Err(LevelError::Sigma(sigma)) }
}

/// Whether an error may carry an order.
pub(super) fn screened(error: f64, floor: f64) -> Result<(), Exclusion> {
    measured(error, floor)?;
    match error {
        0.0 if floor == 0.0 => Err(Exclusion::Zero),
        _ if error <= FLOORS_ABOVE * floor => Err(Exclusion::BelowFloor { error, floor }),
        _ => Ok(()),
    }
}

/// Why an error that is left out is not explained where the others predict `least` at least; none if it is. The true error
/// is at most the measured one and its floor.
pub(super) fn foreign(error: f64, floor: f64, least: f64) -> Option<String> {
    if error == 0.0 && floor == 0.0 {
        return Some("is exactly 0, and no floor is stated".into());
    }
    let below = error + floor < least / FAR_BELOW;
    below.then(|| {
        format!("is {error:.1e}, its floor {floor:.1e}, where the others predict {least:.1e}")
    })
}

/// `; 2 errors exactly 0 without a floor`; empty if there is none.
pub fn zeros_in_words(zeros: usize) -> String {
    match zeros {
        0 => String::new(),
        zeros => format!("; {} exactly 0 without a floor", counted(zeros, "error")),
    }
}

/// The first of the levels left out that `used`, coarse to fine, do not explain, in words. `order` is the interval of
/// their order, `log` the power of a factor |log h|.
pub(super) fn unexplained(
    left_out: &[Level],
    used: &[Level],
    order: Interval,
    log: f64,
) -> Option<String> {
    left_out.iter().find_map(|level| {
        let apart = |other: &Level| (level.size / other.size).ln().abs();
        let nearest = used.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
        let p = if level.size < nearest.size { order.hi } else { order.lo };
        let factor = |size: f64| if log == 0.0 { 1.0 } else { size.ln().abs().powf(log) };
        let least = nearest.error * (level.size / nearest.size).powf(p) * factor(level.size)
            / factor(nearest.size);
        let why = foreign(level.error, level.floor, least)?;
        Some(format!("the error at the step {:.3e} {why}", level.size))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_level_cannot_be_built() {
        let level = Level::new(0.5, 0.1).expect("a level");
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
            assert!(matches!(Level::new(bad, 1.0), Err(LevelError::Size(_))), "{bad}");
            assert!(matches!(Level::new(1.0, bad), Err(LevelError::Error(_))), "{bad}");
            assert!(matches!(level.with_floor(bad), Err(LevelError::Floor(_))), "{bad}");
            assert!(matches!(level.with_sigma(bad), Err(LevelError::Sigma(_))), "{bad}");
            let point = Point { h: 0.5, k: bad, error: 1.0, floor: 0.0 };
            assert!(Level::of(&point, Direction::Time, None).is_err(), "{bad}");
            assert!(Level::of(&point, Direction::Space, Some(bad)).is_err(), "{bad}");
        }
        assert_eq!(Level::new(0.0, 1.0), Err(LevelError::Size(0.0)));
        assert_eq!([0.0, 1e308].map(deviation), [0.0, 1e308].map(|s| Err(LevelError::Sigma(s))));
        assert!(level.with_floor(0.0).and_then(|level| level.with_sigma(10.0)).is_ok());
        assert_eq!(Level::new(0.5, 0.0).expect("a level").screened(), Err(Exclusion::Zero));
    }

    /// e = h² on 1/4, 1/8, 1/16; at 1/32 it is 2^-10 = 9.8e-4.
    #[test]
    fn what_the_others_do_not_explain_is_named() {
        let of = |size: f64, error: f64, floor: f64| {
            Level::new(size, error).and_then(|level| level.with_floor(floor)).expect("a level")
        };
        let used: Vec<Level> =
            [0.25, 0.125, 0.0625].map(|h: f64| of(h, h * h, 0.0)).into_iter().collect();
        let order = Interval { lo: 1.9, hi: 2.1 };
        let said = |level: Level| unexplained(&[level], &used, order, 0.0);
        assert!(said(of(0.03125, 0.0, 0.0)).is_some_and(|why| why.contains("exactly 0")));
        // A quarter of the least prediction, 2^-8.1 ... at order 2.1, is 2.3e-4.
        assert!(said(of(0.03125, 0.0, 1e-6)).is_some_and(|why| why.contains("9.1e-4")));
        assert!(said(of(0.03125, 1e-4, 1e-4)).is_some());
        assert_eq!(said(of(0.03125, 1e-4, 1.4e-4)), None);
        // Coarser than all: at least 4^1.9/16 of what is measured at 1/4.
        assert!(said(of(0.5, 1e-3, 1e-3)).is_some() && said(of(0.5, 0.2, 0.1)).is_none());
        // With a factor |log h|^2 less is to be expected: (log 32 / log 16)^2 more, in fact.
        assert!(unexplained(&[of(0.03125, 1e-4, 1.4e-4)], &used, order, 2.0).is_some());
    }
}
