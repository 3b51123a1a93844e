//! Noise that is told: errors scatter by at most so much.
//!
//! How much less they scatter nobody knows, and the answer has to hold for every noise of a list up to the one that is told.
//! A larger one adds answers to those of a smaller one: no interval becomes narrower, no verdict surer or another. The list
//! is one for all tables; a noise between two of it is rounded up.

use super::{Known, NOISES, Posterior, infer_at};
use crate::fit::{Direction, FitError, Level, Point, Sample, deviation, samples, screen};

/// The noises of a decade: one that is rounded up is at most doubled.
const DIGITS: [f64; 4] = [1.0, 2.0, 3.0, 5.0];
/// Where the list begins: at 1e-15, below the rounding of numbers.
const FIRST: i32 = -60;
/// A noise leaves where a larger one explains the table a thousand times better, by this logarithm.
const CONTRADICTED: f64 = 6.9;

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

fn listed(at: i32) -> f64 {
    DIGITS[at.rem_euclid(4) as usize] * 10f64.powi(at.div_euclid(4))
}

/// The place of a noise in the list; what differs by rounding is equal.
fn place(noise: f64) -> i32 {
    (FIRST..).find(|at| listed(*at) * (1.0 + 1e-9) >= noise).unwrap_or(FIRST)
}

/// Posteriors for all noises of the list from the least that the table does not contradict to `noise`. The list begins at
/// `least`, and is compared up to `seen`. Several posteriors are of one table, with one evidence.
pub(in crate::fit) fn up_to<const N: usize, E>(
    noise: f64,
    [least, seen]: [f64; 2],
    of: impl Fn(f64) -> Result<[Posterior; N], E>,
) -> Result<[Posterior; N], E> {
    let [least, seen, told] = [least, seen, noise.max(least)].map(place);
    let all = (least..=seen.max(told)).map(|at| of(listed(at))).collect::<Result<Vec<_>, E>>()?;
    let compared: Vec<f64> =
        all[..=(seen - least) as usize].iter().map(|of| of[0].evidence).collect();
    let stands = |at: &usize| compared[*at..].iter().all(|e| *e <= compared[*at] + CONTRADICTED);
    let first = (0..compared.len()).find(stands).unwrap_or_default();
    let last = first.max((told - least) as usize);
    Ok(std::array::from_fn(|i| {
        let kept = || all[first..=last].iter().map(|of| &of[i]);
        let interval = kept().fold(all[last][i].interval, |hull, of| hull.hull(of.interval));
        let mut less: Vec<_> = kept().map(|of| Posterior { interval, ..of.clone() }).collect();
        Posterior { less: less.drain(..last - first).collect(), ..less.remove(0) }
    }))
}
