//! Boundedness of derivatives, by difference quotients under refinement: the quotient converges if and only if the
//! derivative is bounded.

use super::{Finding, Status};

/// Fine intervals along a line; quotients are taken over 8, 4, 2 and 1 of them.
pub(super) const FINE: usize = 768;
pub(super) const STRIDES: [usize; 4] = [8, 4, 2, 1];
/// A quotient that grows by more than this at the last halving is unbounded: a jump gives √2 in L² and 2 in L∞, a
/// corner singularity ρ^0.54 over its smooth surroundings 1.2 in L², a bounded derivative a factor near 1.
const GROWS: f64 = 1.1;
/// Rounding of a difference, in units of ε·max|f|: 4 for the weights 1, 2, 1 of a second difference, 2 for the
/// Frobenius norm over ε_xx, ε_xy twice, ε_yy, and 8 for the formula behind each sample, whose operations cost half a
/// unit each. Measured on fields linear in t: 0.1 to 2.
const ROUNDING_UNITS: f64 = 64.0;

/// Rounding of samples of size at most `largest` in a quotient with the divisor δ or δ², whose norm gives the constant
/// 1 the value `one`.
pub(super) fn rounding(largest: f64, one: f64, divisor: f64) -> f64 {
    ROUNDING_UNITS * f64::EPSILON * largest * one / divisor
}

/// Judges quotients over ever finer strides. The last one may contain `rounding`, which grows as the stride falls.
pub(super) fn judge(subject: &str, what: &str, quotients: &[f64], rounding: f64) -> Finding {
    let last = quotients[quotients.len() - 1];
    let before = quotients[quotients.len() - 2];
    // NaN is not bounded.
    let bounded = last.is_finite() && last <= GROWS * before + rounding;
    let text = if bounded && last <= rounding {
        format!("{what} is zero to rounding: {last:.1e}, rounding is below {rounding:.1e}")
    } else if bounded {
        format!("{what} settles at {last:.3e}")
    } else if !last.is_finite() {
        format!("{what} is infinite: not bounded")
    } else {
        format!("{what} grows by {:.2} a halving: not bounded", last / before)
    };
    let status = if bounded { Status::Verified } else { Status::Weak };
    Finding::new(subject, status, last, text)
}

/// The larger modulus; NaN is largest.
pub(super) fn worst(known: f64, value: f64) -> f64 {
    if value.is_nan() { f64::INFINITY } else { known.max(value.abs()) }
}

pub(super) fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |known, value| worst(known, *value))
}

/// (f(x - δ) - 2f(x) + f(x + δ))/δ² of values at the ends of [`FINE`] intervals, δ being `stride` of them.
pub(super) fn second_quotients(
    values: &[f64],
    stride: usize,
    delta: f64,
) -> impl Iterator<Item = f64> {
    (stride..=FINE - stride)
        .map(move |i| (values[i - stride] - 2.0 * values[i] + values[i + stride]) / delta.powi(2))
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
        second_quotients(&values, stride, delta).fold(0.0, worst)
    });
    let floor = rounding(largest(&values), 1.0, step.powi(2));
    judge(subject, &format!("the second difference quotient of {name}"), &quotients, floor)
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
