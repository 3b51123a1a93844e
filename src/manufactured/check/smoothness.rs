//! Whether a derivative is bounded, by difference quotients under refinement: a quotient that
//! settles belongs to a bounded derivative, one that grows does not.

use super::{Finding, Status};

/// Fine intervals along a line; quotients are taken over 8, 4, 2 and 1 of them.
pub(super) const FINE: usize = 768;
pub(super) const STRIDES: [usize; 4] = [8, 4, 2, 1];
/// A quotient that grows by more than this at the last halving is unbounded: a jump gives √2 in
/// L² and 2 in L∞, a corner singularity ρ^0.54 over its smooth surroundings 1.2 in L², a bounded
/// derivative a factor near 1.
const GROWS: f64 = 1.1;
/// Differences of values are known to a few units of their rounding.
const UNITS: f64 = 64.0;

/// Reads a list of quotients over ever finer strides; `noise` is what one unit of rounding of the
/// values makes of the last one.
pub(super) fn judge(subject: &str, what: &str, quotients: &[f64], noise: f64) -> Finding {
    let last = quotients[quotients.len() - 1];
    let before = quotients[quotients.len() - 2];
    let growth = if before > 0.0 { last / before } else { 1.0 };
    let bounded = last.is_finite() && (growth <= GROWS || last <= UNITS * noise);
    let text = if bounded {
        format!("{what} settles at {last:.3e}")
    } else {
        format!("{what} grows by {growth:.2} a halving: not bounded")
    };
    let status = if bounded { Status::Verified } else { Status::Weak };
    Finding::new(subject, status, last, text)
}

/// max |f''| on [0, length] by second differences.
pub fn second_difference(
    subject: &str,
    name: &str,
    length: f64,
    f: impl Fn(f64) -> f64,
) -> Finding {
    let step = length / FINE as f64;
    let values: Vec<f64> = (0..=FINE).map(|n| f(step * n as f64)).collect();
    let quotients = STRIDES.map(|stride| {
        let delta = step * stride as f64;
        let second =
            |i: usize| (values[i - stride] - 2.0 * values[i] + values[i + stride]) / delta.powi(2);
        // A NaN stays.
        let largest =
            |worst: f64, value: f64| if value > worst || value.is_nan() { value } else { worst };
        (stride..=FINE - stride).map(|i| second(i).abs()).fold(0.0, largest)
    });
    let size = values.iter().fold(0f64, |size, value| size.max(value.abs()));
    let noise = f64::EPSILON * size / step.powi(2);
    judge(subject, &format!("the second difference quotient of {name}"), &quotients, noise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounded_second_derivatives_are_told_from_unbounded_ones() {
        let status = |f: fn(f64) -> f64| second_difference("f", "f", 1.0, f).status;
        let smooth: [fn(f64) -> f64; 4] =
            [|_| 0.3, |x| 0.02 * (1.0 + x), |x| (9.0 * x).sin(), |x| x.powf(2.5)];
        let rough: [fn(f64) -> f64; 5] = [
            f64::sqrt,
            |x| (1.0 - x).max(0.0).powf(1.5),
            |x| (x - 1.0 / 3.0).abs(),
            |x| if x < 0.4 { 0.0 } else { 1.0 },
            |x| 1.0 / (x - 0.5).abs(),
        ];
        assert!(smooth.iter().all(|f| status(*f) == Status::Verified));
        assert!(rough.iter().all(|f| status(*f) == Status::Weak));
    }
}
