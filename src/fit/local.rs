//! Orders and constants of neighbouring grids.

use nalgebra::{DMatrix, DVector};

use super::{Interval, Sample, linear_fit, student_quantile};

/// Local slopes p_i = ln(e_i / e_{i+1}) / ln(s_i / s_{i+1}), with the true ratio of the steps
/// and with sign: divergence is negative.
pub fn local_slopes(samples: &[Sample]) -> Vec<f64> {
    samples
        .windows(2)
        .map(|pair| (pair[0].error.ln() - pair[1].error.ln()) / (pair[0].step / pair[1].step).ln())
        .collect()
}

/// Points from which the next term of the expansion is fitted beside a constant: two degrees
/// of freedom, Student's factor 4.3; one would have 12.7.
const CURVED: usize = 4;

/// The constant C = e / s^p under a given order p: its value on the finest grid, and the hull
/// of the Student interval of the mean of log C (noise), the last value times or over the
/// square of its last change (drift), and, from four points on, the Student interval of c in
/// log C = c + D s (the limit s → 0, with the next term of the expansion fitted). Needs two
/// samples.
pub fn constant_under(order: f64, samples: &[Sample]) -> Option<(f64, Interval)> {
    let logs: Vec<f64> =
        samples.iter().map(|sample| sample.error.ln() - order * sample.step.ln()).collect();
    let [.., previous, last] = logs[..] else {
        return None;
    };
    let count = logs.len() as f64;
    let mean = logs.iter().sum::<f64>() / count;
    let variance = logs.iter().map(|log| (log - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let radius = student_quantile(logs.len() - 1)? * (variance / count).sqrt();
    let drift = Interval::around(last, 2.0 * (last - previous).abs());
    let hull = drift.hull(Interval::around(mean, radius));
    let hull = limit(&logs, samples).map_or(hull, |part| hull.hull(part));
    Some((last.exp(), hull.exp()))
}

/// Student interval of c in log C = c + D s.
fn limit(logs: &[f64], samples: &[Sample]) -> Option<Interval> {
    if samples.len() < CURVED {
        return None;
    }
    let coarsest = samples.iter().map(|sample| sample.step).fold(0.0, f64::max);
    let design = DMatrix::from_fn(samples.len(), 2, |row, column| match column {
        0 => 1.0,
        _ => samples[row].step / coarsest,
    });
    linear_fit(design, &DVector::from_column_slice(logs))?.interval(0)
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

    #[test]
    fn constants_drift_towards_their_limit() {
        let samples = law(&[0.125, 0.0625, 0.03125], |h| 3.0 * h * (1.0 + h));
        let (value, interval) = constant_under(1.0, &samples).unwrap();
        // exp(log C) returns C up to a few roundings.
        assert!((value - samples[2].error / 0.03125).abs() < 1e-14);
        assert!(interval.contains(3.0));
        assert!(constant_under(1.0, &samples[..1]).is_none());
    }
}
