//! Which points of a table may carry an order.

use super::{Direction, FitError, LevelError, Point, ValueSample, level, same_level};

/// Floors that an error has to exceed: the floor then changes log e by less than 1/20, and a slope over a halving by
/// less than 0.07.
pub const FLOORS_ABOVE: f64 = 20.0;

/// Why a point carries no order.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Exclusion {
    /// The floor is too large a part of the error.
    #[error("below floor: error {error:.1e}, floor {floor:.1e}, {FLOORS_ABOVE} floors needed")]
    BelowFloor { error: f64, floor: f64 },
    /// An error of exactly zero has no logarithm; without a floor nothing says that it was measured.
    #[error("the error is exactly 0, and no floor is stated")]
    Zero,
    /// The error (NaN where it is missing) or its floor is none.
    #[error(transparent)]
    Broken(#[from] LevelError),
}

impl Exclusion {
    /// Whether the point is invalid, not only too small.
    pub fn is_broken(self) -> bool {
        matches!(self, Self::Broken(_))
    }
}

/// Whether a point may carry an order.
///
/// # Errors
/// The reason to leave it out.
pub fn screen(point: &Point) -> Result<(), Exclusion> {
    level::screened(point.error, point.floor)
}

/// A step and its error, both positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub step: f64,
    pub error: f64,
}

/// The screened points, coarse to fine.
pub fn samples(points: &[Point], direction: Direction) -> Result<Vec<Sample>, FitError> {
    let sample = |point: &Point, step| Sample { step, error: point.error };
    line(points, direction, |point| screen(point).is_ok(), sample)
}

/// The values of a functional, coarse to fine, from a table that has them in place of errors; non-finite ones are
/// dropped.
pub fn value_samples(points: &[Point], direction: Direction) -> Result<Vec<ValueSample>, FitError> {
    let sample = |point: &Point, step| ValueSample { step, value: point.error };
    line(points, direction, |point| point.error.is_finite(), sample)
}

/// What `sample` makes of the points that serve and their steps, coarse to fine; steps are distinct.
fn line<T>(
    points: &[Point],
    direction: Direction,
    serves: impl Fn(&Point) -> bool,
    sample: impl Fn(&Point, f64) -> T,
) -> Result<Vec<T>, FitError> {
    let steps = points.iter().filter(|point| serves(point));
    let steps = steps.map(|point| (direction.step(point), point));
    let mut line: Vec<(f64, &Point)> = steps.filter(|(step, _)| level::is_step(*step)).collect();
    line.sort_by(|a, b| b.0.total_cmp(&a.0));
    match line.windows(2).find(|pair| same_level(pair[0].0, pair[1].0)) {
        Some(pair) => Err(FitError::RepeatedStep { step: pair[1].0 }),
        None => Ok(line.into_iter().map(|(step, point)| sample(point, step)).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(error: f64, floor: f64) -> Point {
        Point { h: 0.5, k: 0.5, error, floor }
    }

    #[test]
    fn every_kind_of_bad_point_has_its_reason() {
        assert_eq!(screen(&point(1.0, 0.01)), Ok(()));
        assert_eq!(screen(&point(0.0, 0.0)), Err(Exclusion::Zero));
        assert!(matches!(screen(&point(0.2, 0.01)), Err(Exclusion::BelowFloor { .. })));
        for error in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
            let reason = screen(&point(error, 0.0)).unwrap_err();
            assert!(
                reason.is_broken() && matches!(reason, Exclusion::Broken(LevelError::Error(_)))
            );
        }
        assert!(screen(&point(1.0, f64::NAN)).unwrap_err().is_broken());
        assert!(!Exclusion::Zero.is_broken());
        // A zero that has a floor is below it.
        assert!(matches!(screen(&point(0.0, 0.01)), Err(Exclusion::BelowFloor { .. })));
    }

    #[test]
    fn a_step_is_a_positive_number() {
        let at = |h: f64| Point { h, ..point(1.0, 0.0) };
        let points = [at(0.1), at(f64::INFINITY), at(0.0), at(-0.5), at(f64::NAN), at(0.2)];
        let steps: Vec<f64> =
            samples(&points, Direction::Space).unwrap().iter().map(|sample| sample.step).collect();
        assert_eq!(steps, [0.2, 0.1]);
    }

    #[test]
    fn values_may_have_any_sign() {
        let at = |h: f64, error: f64| Point { h, ..point(error, f64::NAN) };
        let points =
            [at(0.1, -1.0), at(0.4, 0.0), at(0.2, f64::NAN), at(f64::NAN, 1.0), at(0.0, 1.0)];
        let values = value_samples(&points, Direction::Space).unwrap();
        let plain: Vec<(f64, f64)> = values.iter().map(|v| (v.step, v.value)).collect();
        assert_eq!(plain, [(0.4, 0.0), (0.1, -1.0)]);
        let twice = [at(0.1, 1.0), at(0.1 * (1.0 + 1e-12), 2.0)];
        assert!(matches!(
            value_samples(&twice, Direction::Space),
            Err(FitError::RepeatedStep { .. })
        ));
        let close = [at(0.1, 1.0), at(0.1 * (1.0 + 1e-6), 2.0)];
        assert_eq!(value_samples(&close, Direction::Space).unwrap().len(), 2);
    }

    #[test]
    fn samples_are_sorted_and_steps_distinct() {
        let a = Point { h: 0.25, ..point(1.0, 0.0) };
        let sorted = samples(&[a, point(2.0, 0.0)], Direction::Space).unwrap();
        assert_eq!(sorted[0], Sample { step: 0.5, error: 2.0 });
        assert!(samples(&[a, a], Direction::Space).is_err());
        let nowhere = Point { h: f64::NAN, ..a };
        assert!(samples(&[nowhere, nowhere], Direction::Space).unwrap().is_empty());
    }
}
