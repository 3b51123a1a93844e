//! The interval of an order: a hull of noise, choice of window, drift and curvature.

use super::power_law::corrected_interval;
use super::{FitError, Interval, PowerLaw, Sample, local_slopes, power_law};

/// An interval and a window need at least so many points.
const WINDOW: usize = 3;

/// Rounding of logarithms: log e up to 700 in magnitude carries 1e-13, and a slope over a
/// ratio of 1.3 divides that by 0.26.
pub(super) const ROUNDING: f64 = 1e-12;

/// Power of the next term of the error expansion, relative to the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correction {
    /// e = C s^p (1 + D s + …): space, and time schemes with odd terms.
    Linear,
    /// e = C s^p (1 + D s² + …): the trapezoidal rule on smooth data.
    Quadratic,
}

impl Correction {
    /// The power of the next term, relative to the first.
    pub(super) fn power(self) -> i32 {
        match self {
            Self::Linear => 1,
            Self::Quadratic => 2,
        }
    }
}

/// An order with its interval, and the parts that the interval is the hull of.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderInterval {
    /// The power law through all points.
    pub law: PowerLaw,
    /// Hull of the parts, widened by the rounding of logarithms.
    pub interval: Interval,
    /// (a) Student interval of the logarithmic fit.
    pub student: Interval,
    /// (b) Slopes over all contiguous windows of at least three points.
    pub windows: Interval,
    /// (c) Last local slope ± 2 |last − previous|, for halved steps; further where the last two
    /// slopes lie close together.
    pub drift: Interval,
    /// (d) Student interval of p with the next term of the expansion fitted as well; from four
    /// points on.
    pub curvature: Option<Interval>,
}

impl OrderInterval {
    /// Name of the part that reaches furthest from the order.
    pub fn widest_part(&self) -> &'static str {
        let curvature = self.curvature.map(|part| ("curvature", part));
        let parts = [("scatter", self.student), ("windows", self.windows), ("drift", self.drift)];
        let reach = |part: Interval| (part.hi - self.law.order).max(self.law.order - part.lo);
        let widest =
            parts.into_iter().chain(curvature).max_by(|a, b| reach(a.1).total_cmp(&reach(b.1)));
        widest.map_or("scatter", |(name, _)| name)
    }
}

/// The order of at least three samples in direction of refinement, and its interval.
///
/// # Errors
/// [`FitError::TooFew`] for fewer than three, [`FitError::Singular`].
pub fn order_interval(
    samples: &[Sample],
    correction: Correction,
) -> Result<OrderInterval, FitError> {
    let too_few = FitError::TooFew { found: samples.len(), needed: WINDOW };
    let slopes = local_slopes(samples);
    let [.., previous, last] = slopes[..] else {
        return Err(too_few);
    };
    let law = power_law(samples)?;
    let student = law.interval.ok_or(too_few)?;
    let windows = windows(samples)?;
    let reach = 2.0 * reach(samples, correction).max(1.0);
    let drift = Interval::around(last, reach * (last - previous).abs());
    let curvature = match samples.len() {
        0..=WINDOW => None,
        _ => Some(corrected_interval(samples, correction.power())?),
    };
    let hull = student.hull(windows).hull(drift);
    let hull = curvature.map_or(hull, |part| hull.hull(part));
    let rounding = ROUNDING * law.order.abs().max(1.0);
    let interval = Interval { lo: hull.lo - rounding, hi: hull.hi + rounding };
    Ok(OrderInterval { law, interval, student, windows, drift, curvature })
}

/// What is left of the drift of local slopes, in units of its last change. Under
/// log e = c + p log s + D s^r the local slope is p + r D m with m the logarithmic mean of s^r at
/// its two ends, so that p lies m / (m' − m) last changes beyond the last slope, m' belonging to
/// the slope before. Halvings have 1 for r = 1; the steps 3, 2, 1.5 have 2.4.
fn reach(samples: &[Sample], correction: Correction) -> f64 {
    let mean = |coarse: &Sample, fine: &Sample| {
        let power = |sample: &Sample| sample.step.powi(correction.power());
        (power(coarse) - power(fine)) / (coarse.step / fine.step).ln()
    };
    match samples {
        [.., first, second, third] => {
            let (previous, last) = (mean(first, second), mean(second, third));
            last / (previous - last)
        }
        _ => 0.0,
    }
}

/// Hull of the slopes over every contiguous window of at least three points. The sums of a
/// window go on from those of the shorter one with the same first point, so that all n²/2 of
/// them cost O(n²), and are relative to that point, so that nothing cancels.
fn windows(samples: &[Sample]) -> Result<Interval, FitError> {
    let logs: Vec<(f64, f64)> =
        samples.iter().map(|sample| (sample.step.ln(), sample.error.ln())).collect();
    let mut hull: Option<Interval> = None;
    for (start, origin) in logs.iter().enumerate() {
        let [mut x_sum, mut y_sum, mut xx_sum, mut xy_sum] = [0.0; 4];
        for (length, (x, y)) in (1..).zip(&logs[start..]) {
            let (x, y) = (x - origin.0, y - origin.1);
            x_sum += x;
            y_sum += y;
            xx_sum += x * x;
            xy_sum += x * y;
            if length >= WINDOW {
                let count = length as f64;
                let slope = (count * xy_sum - x_sum * y_sum) / (count * xx_sum - x_sum * x_sum);
                if !slope.is_finite() {
                    return Err(FitError::Singular { points: length });
                }
                let slope = Interval { lo: slope, hi: slope };
                hull = Some(hull.map_or(slope, |hull| hull.hull(slope)));
            }
        }
    }
    hull.ok_or(FitError::TooFew { found: samples.len(), needed: WINDOW })
}

#[cfg(test)]
mod tests;
