//! The order of a functional whose limit is not known, from the differences of its values.
//!
//! Under φ = φ₀ + α h^p the values of neighbouring grids differ by α h^p (1 − r^{−p}), r the ratio of their steps.
//! Divided by (1 − r^{−p})/p that is an error of order p at h. For differing ratios the factor depends on the order,
//! which is iterated.

use std::f64::consts::SQRT_2;

use super::inference::line::infer;
use super::inference::told::up_to;
use super::inference::{FEWEST, Known, Posterior};
use super::{FitError, LARGEST_SIGMA, Level, LevelError, ValueSample, deviation};

/// Differences below so many units in the last place are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// The least noise of values that is thought of, and the largest that is sought where a smaller one is told: differences of
/// a millionth of the values show an order, and their own noise is not below 0.0005.
const NOISES: [f64; 2] = [1e-10, 0.1];
/// Each pass leaves less than a tenth of the previous change.
const PASSES: usize = 6;
/// Orders this close count as equal: a tenth of what is printed.
const SETTLED: f64 = 1e-4;

/// Order of at least four values, coarse to fine. `noise`: what their relative standard deviation
/// is at most, if known.
///
/// # Errors
/// [`FitError::TooFew`] below four values, [`FitError::SignChange`] where they oscillate, and those of [`infer`].
pub fn infer_values(samples: &[ValueSample], noise: Option<f64>) -> Result<Posterior, FitError> {
    if samples.len() <= FEWEST {
        return Err(FitError::TooFew { found: samples.len(), needed: FEWEST + 1 });
    }
    let noise = noise.map(deviation).transpose()?;
    let differences: Vec<f64> =
        samples.windows(2).map(|pair| pair[0].value - pair[1].value).collect();
    if let Some(at) = differences.windows(2).position(|pair| pair[0] * pair[1] < 0.0) {
        return Err(FitError::SignChange { step: samples[at + 1].step });
    }
    let Some(noise) = noise else { return infer_at(samples, &differences, None) };
    up_to(noise, NOISES, |noise| Ok([infer_at(samples, &differences, Some(noise))?]))
        .map(|[found]| found)
}

/// The same where the noise is just what is told.
fn infer_at(
    samples: &[ValueSample],
    differences: &[f64],
    noise: Option<f64>,
) -> Result<Posterior, FitError> {
    let level = |(pair, difference): (&[ValueSample], &f64), order: f64| {
        let refinement = (pair[0].step / pair[1].step).ln();
        let factor = match order * refinement {
            small if small.abs() < 1e-8 => refinement,
            product => -(-product).exp_m1() / order,
        };
        let size = pair[0].value.abs().max(pair[1].value.abs());
        // A difference has the noise of two values.
        let sigma = noise.map(|noise| SQRT_2 * noise * size / difference.abs());
        let level = Level::new(pair[0].step, difference.abs() / factor)?
            .with_floor(ROUNDING * size / factor)?;
        // A difference that the noise exceeds by far says as little as one that it exceeds ten times.
        sigma.map_or(Ok(level), |sigma| level.with_sigma(sigma.min(LARGEST_SIGMA)))
    };
    let mut order = 1.0;
    let mut passes = 0;
    loop {
        let pairs = samples.windows(2).zip(differences);
        let levels = pairs.map(|pair| level(pair, order));
        let levels = levels.collect::<Result<Vec<Level>, LevelError>>()?;
        let posterior = infer(&levels, &Known { differences: true, ..Known::EXACT })?;
        passes += 1;
        if passes == PASSES || (posterior.order - order).abs() < SETTLED || regular(samples) {
            return Ok(posterior);
        }
        order = posterior.order;
    }
}

/// Whether all ratios are equal, and so all factors.
fn regular(samples: &[ValueSample]) -> bool {
    let ratios = samples.windows(2).map(|pair| pair[0].step / pair[1].step);
    let [lo, hi] = ratios
        .fold([f64::INFINITY, 0.0], |[lo, hi]: [f64; 2], ratio| [lo.min(ratio), hi.max(ratio)]);
    super::same_level(lo, hi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Claim, Decision};

    fn values(steps: &[f64], value: impl Fn(f64) -> f64) -> Vec<ValueSample> {
        steps.iter().map(|&step| ValueSample { step, value: value(step) }).collect()
    }

    fn decide(samples: &[ValueSample], order: f64) -> Decision {
        let found = infer_values(samples, None).expect("an order");
        found.decide(&Claim::new(order).expect("a claim")).decision
    }

    #[test]
    fn exact_laws_have_their_order_with_any_ratios() {
        for steps in [[0.2, 0.1, 0.05, 0.025, 0.0125], [0.2, 0.13, 0.05, 0.04, 0.02]] {
            for order in [0.5, 1.0, 1.5, 2.0] {
                for sign in [1.0, -1.0] {
                    let table = values(&steps, |h| 2.0 + sign * 3.0 * h.powf(order));
                    let found = infer_values(&table, None).expect("an order");
                    // A third of the least noise over a factor of ten in h.
                    assert!((found.order - order).abs() < 3e-3, "{order}: {}", found.order);
                    assert_eq!(decide(&table, order), Decision::Pass, "{order}");
                    assert_eq!(decide(&table, order + 0.5), Decision::Fail, "{order}");
                }
            }
        }
    }

    /// φ = 1 + h (1 + 2h): differences of halvings are h/2 (1 + 3h); no triple has order 1.
    #[test]
    fn bent_values_have_the_order_of_their_first_term() {
        let table =
            values(&[0.125, 0.0625, 0.03125, 0.015625, 0.0078125], |h| 1.0 + h * (1.0 + 2.0 * h));
        assert_eq!(decide(&table, 1.0), Decision::Pass);
        assert_eq!(decide(&table, 1.5), Decision::Fail);
        assert_ne!(decide(&table, 1.25), Decision::Pass);
    }

    #[test]
    fn what_has_no_order_is_refused() {
        let steps = [0.5, 0.25, 0.125, 0.0625];
        let three = infer_values(&values(&steps[..3], |h| h), None).unwrap_err();
        assert_eq!(three, FitError::TooFew { found: 3, needed: 4 });
        let swings = infer_values(&values(&steps, |h| (h - 0.2).powi(2)), None).unwrap_err();
        assert!(matches!(swings, FitError::SignChange { step } if step == 0.25), "{swings}");
        let still = infer_values(&values(&steps, |_| 0.7), None).unwrap_err();
        assert_eq!(still, FitError::TooFew { found: 0, needed: 3 });
    }

    #[test]
    fn noise_that_is_told_counts() {
        let table = values(&[0.2, 0.1, 0.05, 0.025], |h| 1.0 + h);
        let width = |noise| infer_values(&table, noise).expect("an order").interval.half_width();
        assert!(width(Some(1e-3)) > 3.0 * width(Some(1e-5)));
        assert!(infer_values(&table, Some(-1.0)).is_err());
    }
}
