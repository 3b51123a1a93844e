//! The order of a line: errors over one step.

use super::told::up_to;
use super::{Known, NOISES, Posterior, infer_at};
use crate::{Direction, FitError, Level, Point, Sample, deviation, samples, screen};

/// The levels of a line that serve, and what they say of the order.
#[derive(Debug, Clone)]
pub struct LineReading {
    pub samples: Vec<Sample>,
    pub posterior: Posterior,
}

impl LineReading {
    /// Reads points with the relative standard deviations of their errors, if known; see [`infer`]. Points without a step
    /// in this direction do not count.
    pub fn of(
        measured: &[(Point, Option<f64>)],
        direction: Direction,
        known: &Known,
    ) -> Result<Self, FitError> {
        let there = measured.iter().filter(|(point, _)| !direction.step(point).is_nan());
        let levels = there.map(|(point, sigma)| {
            // Of a level that is left out, the deviation may be none: a share of nothing.
            let sigma = sigma.filter(|_| screen(point).is_ok());
            Level::of(point, direction, sigma)
        });
        let levels = levels.collect::<Result<Vec<_>, _>>()?;
        let posterior = infer(&levels, known)?;
        let points: Vec<Point> = measured.iter().map(|(point, _)| *point).collect();
        Ok(Self { samples: samples(&points, direction)?, posterior })
    }
}

/// Order of a table of steps h and errors e.
pub fn order(table: &[(f64, f64)]) -> Result<Posterior, FitError> {
    let levels = table.iter().map(|&(h, error)| Level::new(h, error));
    infer(&levels.collect::<Result<Vec<_>, _>>()?, &Known::default())
}

/// Posterior of the order. Levels in any order, each once; levels near their floors, and errors of exactly 0, are left
/// out, and confirm nothing if the others do not explain them.
///
/// # Errors
/// [`FitError::TooFew`] below three levels, [`FitError::RepeatedStep`], [`FitError::Level`] for a noise that is none,
/// [`FitError::Log`], [`FitError::NoLogarithm`] with a factor |log h|^M, [`FitError::Reference`].
pub fn infer(levels: &[Level], known: &Known) -> Result<Posterior, FitError> {
    match known.noise {
        Some(noise) if levels.iter().any(|level| level.sigma().is_none()) => {
            let of = |noise| infer_at(levels, &Known { noise: Some(noise), ..*known });
            up_to(deviation(noise)?, NOISES, |noise| Ok([of(noise)?])).map(|[found]| found)
        }
        _ => infer_at(levels, known),
    }
}
