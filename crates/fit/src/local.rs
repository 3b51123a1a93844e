//! Orders and constants of neighbouring grids.

use nalgebra::{DMatrix, DVector};

use super::{Interval, Sample, linear_fit};

/// Rounding of logarithms: |log e| up to 700 carries 1e-13, divided by 0.26 for a ratio of 1.3.
const ROUNDING: f64 = 1e-12;

/// Power of the next term of the error expansion, relative to the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correction {
    /// e = C s^p (1 + D s + …): space, and time schemes with odd terms.
    Linear,
    /// e = C s^p (1 + D s² + …): the trapezoidal rule on smooth data.
    Quadratic,
}

impl Correction {
    fn power(self) -> i32 {
        match self {
            Self::Linear => 1,
            Self::Quadratic => 2,
        }
    }
}

/// Local slopes p_i = ln(e_i / e_{i+1}) / ln(s_i / s_{i+1}), with the true ratio of the steps; negative for divergence.
pub fn local_slopes(samples: &[Sample]) -> Vec<f64> {
    samples
        .windows(2)
        .map(|pair| (pair[0].error.ln() - pair[1].error.ln()) / (pair[0].step / pair[1].step).ln())
        .collect()
}

/// C = e / s^p for a given order p, extrapolated to s → 0, and its interval.
///
/// From three samples on, C is the limit of log C = c + D s^r in least squares, r the next power of the expansion: for
/// |D| ≤ 4 three to ten times closer to the truth than the last e / s^p, whose bias is D s^r. The interval is the hull
/// of the Student interval of c (noise), of c ± 2 |c − c'| with the limit c' of the last two samples (further terms),
/// and of the last value. With two samples C is the last value, times or over the square of its change; with fewer,
/// none.
pub fn constant_under(
    order: f64,
    samples: &[Sample],
    correction: Correction,
) -> Option<(f64, Interval)> {
    let logs: Vec<f64> =
        samples.iter().map(|sample| sample.error.ln() - order * sample.step.ln()).collect();
    let [.., previous, last] = logs[..] else {
        return None;
    };
    if samples.len() == 2 {
        return Some((last.exp(), Interval::around(last, 2.0 * (last - previous).abs()).exp()));
    }
    let coarsest = samples.first()?.step;
    let next: Vec<f64> =
        samples.iter().map(|sample| (sample.step / coarsest).powi(correction.power())).collect();
    let design = DMatrix::from_fn(samples.len(), 2, |row, column| [1.0, next[row]][column]);
    let fit = linear_fit(design, &DVector::from_column_slice(&logs))?;
    let limit = fit.coefficients[0];
    let [.., coarse, fine] = next[..] else {
        return None;
    };
    let last_limit = last + (last - previous) * fine / (coarse - fine);
    let later_terms = Interval::around(limit, 2.0 * (limit - last_limit).abs());
    let hull = fit.interval(0)?.hull(later_terms).hull(Interval { lo: last, hi: last });
    let hull = Interval { lo: hull.lo - ROUNDING, hi: hull.hi + ROUNDING };
    Some((limit.exp(), hull.exp()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(steps: &[f64], error: impl Fn(f64) -> f64) -> Vec<Sample> {
        steps.iter().map(|&step| Sample { step, error: error(step) }).collect()
    }

    #[test]
    fn true_ratios_give_true_orders() {
        for ratio in [1.3f64, 1.5, 2.0, 3.7] {
            let steps: Vec<f64> = (0..5).map(|i| ratio.powi(-i)).collect();
            for order in [1.0, 2.0, -2.0] {
                for slope in local_slopes(&law(&steps, |s| 3.0 * s.powf(order))) {
                    // Rounding of logarithms of size 10 over ln 1.3.
                    assert!((slope - order).abs() < 1e-13);
                }
            }
        }
    }

    /// log C of 3 h (1 + h) at h = 1/8, 1/16, 1/32 is bent by h²/2 only: the limit is 0.2 % from 3, the last value 3 %.
    #[test]
    fn constants_are_extrapolated() {
        let samples = law(&[0.125, 0.0625, 0.03125], |h| 3.0 * h * (1.0 + h));
        let (value, interval) = constant_under(1.0, &samples, Correction::Linear).unwrap();
        assert!((value / 3.0 - 1.0).abs() < 0.004, "{value}");
        let last = samples[2].error / samples[2].step;
        assert!(interval.contains(3.0) && interval.contains(value) && interval.contains(last));
        assert!(interval.half_width() < 0.1, "{interval}");
    }

    /// log C = log 3 + D s^r exactly: the limit is 3 to rounding for the fitted r, and the interval ends at the last
    /// value.
    #[test]
    fn the_fitted_power_is_removed_exactly() {
        for (correction, power) in [(Correction::Linear, 1), (Correction::Quadratic, 2)] {
            let bend = |s: f64| (0.7 * s.powi(power)).exp();
            let samples = law(&[0.3, 0.2, 0.1, 0.05], |s| 3.0 * s * s * bend(s));
            let (value, interval) = constant_under(2.0, &samples, correction).unwrap();
            // About ten roundings of logarithms of size 5, times Student's 4.3; the interval is widened by 1e-12 of its
            // ends.
            assert!((value - 3.0).abs() < 1e-13 && (interval.lo - 3.0).abs() < 1e-11);
            assert!((interval.hi - 3.0 * bend(0.05)).abs() < 1e-11, "{interval}");
        }
    }

    #[test]
    fn two_samples_have_their_drift() {
        let samples = law(&[0.5, 0.25], |s| s);
        let (value, interval) = constant_under(0.0, &samples, Correction::Linear).unwrap();
        assert!((value - 0.25).abs() < 1e-15 && (interval.lo - 0.0625).abs() < 1e-15);
        assert!((interval.hi - 1.0).abs() < 1e-15);
        assert!(constant_under(1.0, &samples[..1], Correction::Linear).is_none());
        assert!(constant_under(1.0, &[], Correction::Linear).is_none());
    }

    /// log e = log 3 + log h + h/2: both limits are 3, and the interval ends at the last constant.
    #[test]
    fn the_interval_of_a_constant_reaches_from_its_limit_to_the_last_case() {
        let samples = law(&[0.4, 0.2, 0.1, 0.05], |h| 3.0 * h * (0.5 * h).exp());
        let (constant, interval) = constant_under(1.0, &samples, Correction::Linear).unwrap();
        // ROUNDING is 1e-12.
        assert!((constant - 3.0).abs() < 1e-11 && (interval.lo - 3.0).abs() < 1e-11);
        assert!(interval.lo < 3.0 && interval.contains(3.0));
        assert!((interval.hi - 3.0 * 0.025f64.exp()).abs() < 1e-11, "{interval}");
    }
}
