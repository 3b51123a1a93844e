//! The order of a functional whose limit is not known, with its interval.

use nalgebra::{DMatrix, DVector};

use super::levenberg_marquardt::{Minimum, minimise};
use super::{FitError, Interval, Triple, ValueSample, student_quantile};

/// φ₀, α and p.
const PARAMETERS: usize = 3;

/// Values that an interval needs: one more than the bent model of four parameters has. With four
/// values the hull without that model covers 82 % of simulated tables with 1 % of noise.
const VALUES: usize = 5;

/// The order of φ = φ₀ + α h^p and the parts of its interval.
#[derive(Debug, Clone, PartialEq)]
pub struct ValueOrder {
    /// p, in least squares over all values.
    pub order: f64,
    /// Hull of the parts below.
    pub interval: Interval,
    /// Student interval of p.
    pub student: Interval,
    /// Orders of all triples of neighbouring grids.
    pub triples: Interval,
    /// Last of these ± 2 |last change|, further where the steps lie close together.
    pub drift: Interval,
    /// Student interval of p in φ = φ₀ + α h^p (1 + D h); none if D has no minimum.
    pub curvature: Option<Interval>,
}

/// The order of at least five values in direction of refinement, and its interval: the hull of
/// an order from errors, with a triple in place of a pair. None if some triple has no order,
/// because the values oscillate or stand still, or if no order fits them all best.
///
/// # Errors
/// [`FitError::TooFew`] for fewer than five.
pub fn value_order(samples: &[ValueSample]) -> Result<Option<ValueOrder>, FitError> {
    let found = samples.len();
    let too_few = FitError::TooFew { found, needed: VALUES };
    if found < VALUES {
        return Err(too_few);
    }
    let triples = samples.windows(3).map(|triple| Triple::of([triple[0], triple[1], triple[2]]));
    let Some(orders) = triples.map(Triple::order).collect::<Option<Vec<f64>>>() else {
        return Ok(None);
    };
    let [.., previous, last] = orders[..] else {
        return Err(too_few);
    };
    let table = Table::new(samples);
    let start = table.start(last);
    let Some(plain) = table.minimum(start.clone()) else {
        return Ok(None);
    };
    let Some(student) = student(&plain, found) else {
        return Ok(None);
    };
    // The bent model may have its minimum at infinity: then the other parts have to do.
    let bent = table.minimum(start.push(0.0));
    let curvature = bent.and_then(|minimum| self::student(&minimum, found));
    let triples = Interval::of(orders).ok_or(too_few)?;
    let drift = Interval::around(last, 2.0 * reach(samples).max(1.0) * (last - previous).abs());
    let hull = student.hull(triples).hull(drift);
    let interval = curvature.map_or(hull, |part| hull.hull(part));
    Ok(Some(ValueOrder { order: plain.x[2], interval, student, triples, drift, curvature }))
}

/// Values relative to the finest, in units of their range; steps in units of the coarsest.
struct Table {
    steps: Vec<f64>,
    values: Vec<f64>,
}

impl Table {
    fn new(samples: &[ValueSample]) -> Self {
        let finest = samples.last().map_or(0.0, |sample| sample.value);
        let coarsest = samples.first().map_or(1.0, |sample| sample.step);
        let away = |sample: &ValueSample| sample.value - finest;
        let range = samples.iter().map(|sample| away(sample).abs()).fold(0.0, f64::max);
        Self {
            steps: samples.iter().map(|sample| sample.step / coarsest).collect(),
            values: samples.iter().map(|sample| away(sample) / range).collect(),
        }
    }

    /// φ₀, α, p through the first and the last value.
    fn start(&self, order: f64) -> DVector<f64> {
        let [first, last] =
            [0, self.steps.len() - 1].map(|at| (self.steps[at].powf(order), self.values[at]));
        let factor = (first.1 - last.1) / (first.0 - last.0);
        DVector::from_vec(vec![last.1 - factor * last.0, factor, order])
    }

    /// The minimum in φ₀, α, p and, if the start has it, D.
    fn minimum(&self, start: DVector<f64>) -> Option<Minimum> {
        let parameters = start.len();
        minimise(start, |x| {
            let bend = if parameters > PARAMETERS { x[PARAMETERS] } else { 0.0 };
            let power = |i: usize| self.steps[i].powf(x[2]);
            let factor = |i: usize| 1.0 + bend * self.steps[i];
            let residuals = DVector::from_fn(self.steps.len(), |i, _| {
                x[0] + x[1] * power(i) * factor(i) - self.values[i]
            });
            let jacobian = DMatrix::from_fn(self.steps.len(), parameters, |i, j| match j {
                0 => 1.0,
                1 => power(i) * factor(i),
                2 => x[1] * power(i) * factor(i) * self.steps[i].ln(),
                _ => x[1] * power(i) * self.steps[i],
            });
            (residuals, jacobian)
        })
    }
}

fn student(minimum: &Minimum, found: usize) -> Option<Interval> {
    let freedom = found.checked_sub(minimum.x.len())?;
    let radius = student_quantile(freedom)? * minimum.deviations(freedom)?[2];
    Some(Interval::around(minimum.x[2], radius))
}

/// As for local slopes: how far the limit lies beyond the last triple, in last changes, if the
/// order of a triple drifts like the logarithmic mean of its outer steps. Halvings have 1.
fn reach(samples: &[ValueSample]) -> f64 {
    let mean = |coarse: &ValueSample, fine: &ValueSample| {
        (coarse.step - fine.step) / (coarse.step / fine.step).ln()
    };
    match samples {
        [.., first, second, third, fourth] => {
            let (previous, last) = (mean(first, third), mean(second, fourth));
            last / (previous - last)
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(steps: &[f64], value: impl Fn(f64) -> f64) -> Vec<ValueSample> {
        steps.iter().map(|&step| ValueSample { step, value: value(step) }).collect()
    }

    const STEPS: [f64; 6] = [0.5, 0.3, 0.2, 0.1, 0.05, 0.04];

    #[test]
    fn exact_laws_have_their_order() {
        // Of order −1 the term D h is a constant, which φ₀ is already.
        for order in [0.5, 1.0, 2.0, -0.5] {
            for levels in [5, 6] {
                let samples = values(&STEPS[..levels], |h| 3.0 - 7.0 * h.powf(order));
                let found = value_order(&samples).unwrap().unwrap();
                assert!((found.order - order).abs() < 1e-7, "{order} {found:?}");
                assert!(found.interval.half_width() < 1e-5, "{order} {found:?}");
                assert!(found.curvature.is_some(), "{found:?}");
            }
        }
    }

    /// φ = 1 + h (1 + 2h): every triple overestimates the order 1, the hull holds it.
    #[test]
    fn bias_is_covered() {
        let samples =
            values(&[0.25, 0.125, 0.0625, 0.03125, 0.015625], |h| 1.0 + h * (1.0 + 2.0 * h));
        let found = value_order(&samples).unwrap().unwrap();
        assert!(found.triples.lo > 1.0 && found.interval.contains(1.0), "{found:?}");
    }

    /// Orders of triples 2, 1 and 3 by construction of the differences: 64, 16, 8, 1.
    #[test]
    fn triples_and_drift_by_hand() {
        let phi = [89.0, 25.0, 9.0, 1.0, 0.0];
        let samples: Vec<ValueSample> =
            (0..5).map(|i| ValueSample { step: 0.5f64.powi(i), value: phi[i as usize] }).collect();
        let found = value_order(&samples).unwrap().unwrap();
        // Roundings of logarithms.
        assert!((found.triples.lo - 1.0).abs() < 1e-12 && (found.triples.hi - 3.0).abs() < 1e-12);
        assert!((found.drift.lo + 1.0).abs() < 1e-12 && (found.drift.hi - 7.0).abs() < 1e-12);
        assert!(found.interval.lo <= -1.0 && found.interval.hi >= 7.0);
        assert!(found.student.contains(found.order));
    }

    /// Steps 0.4, 0.3, 0.25, 0.2: outer steps 0.4, 0.25 and 0.3, 0.2.
    #[test]
    fn the_reach_follows_the_steps() {
        let mean = |a: f64, b: f64| (a - b) / (a / b).ln();
        let samples = values(&[0.4, 0.3, 0.25, 0.2], |h| h);
        let expected = mean(0.3, 0.2) / (mean(0.4, 0.25) - mean(0.3, 0.2));
        assert!((reach(&samples) - expected).abs() < 1e-12 && expected > 2.0);
        let halved = values(&[0.8, 0.4, 0.2, 0.1], |h| h);
        assert!((reach(&halved) - 1.0).abs() < 1e-14);
        assert_eq!(reach(&halved[..3]), 0.0);
    }

    /// Steps of one ratio r reach 1/(r - 1) last changes beyond the last triple, and the drift is twice that.
    #[test]
    fn the_drift_reaches_as_far_as_the_steps() {
        let samples = values(&[1.728, 1.44, 1.2, 1.0, 1.0 / 1.2], |h| h * (1.0 + 0.2 * h));
        let order = |at: usize| {
            let triple = [samples[at], samples[at + 1], samples[at + 2]];
            Triple::of(triple).order().expect("an order")
        };
        let found = value_order(&samples).unwrap().unwrap();
        let expected = 2.0 * (order(2) - order(1)).abs() / (1.2 - 1.0);
        assert!((found.drift.half_width() / expected - 1.0).abs() < 1e-9, "{found:?}");
    }

    /// φ = 2 + 3 h^1.5 (1 + 0.4 h): the minimum has these numbers, and its derivatives are those of differences.
    #[test]
    fn the_bent_model_finds_its_numbers() {
        let samples = values(&STEPS, |h| 2.0 + 3.0 * h.powf(1.5) * (1.0 + 0.4 * h));
        let table = Table::new(&samples);
        let minimum = table.minimum(table.start(1.3).push(0.0)).unwrap();
        // Steps in units of the coarsest; the minimisation stops at steps of 1e-10 of six values.
        let bend = 0.4 * STEPS[0];
        assert!((minimum.x[2] - 1.5).abs() < 1e-6, "{}", minimum.x);
        assert!((minimum.x[3] - bend).abs() < 1e-5, "{}", minimum.x);
        let model = |x: &DVector<f64>, s: f64| x[0] + x[1] * s.powf(x[2]) * (1.0 + x[3] * s);
        for (i, &s) in table.steps.iter().enumerate() {
            for j in 0..4 {
                let moved = |by: f64| {
                    let mut x = minimum.x.clone();
                    x[j] += by;
                    model(&x, s)
                };
                let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                // Differences of step 1e-5: their square, and rounding over it.
                assert!((minimum.jacobian[(i, j)] - slope).abs() < 1e-8, "{i} {j}");
            }
        }
    }

    #[test]
    fn what_has_no_order_has_none() {
        let signs = values(&[0.4, 0.2, 0.1, 0.05, 0.02], |h| if h == 0.2 { 1.0 } else { h });
        assert_eq!(value_order(&signs), Ok(None));
        assert_eq!(value_order(&values(&STEPS, |_| 1.0)), Ok(None));
        let refused = value_order(&values(&STEPS[..4], |h| h));
        assert_eq!(refused, Err(FitError::TooFew { found: 4, needed: 5 }));
    }
}
