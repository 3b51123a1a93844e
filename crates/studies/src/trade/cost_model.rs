//! What a run costs as a function of both steps: t = t₀ + c h^-a k^-b, fitted to measured CPU times.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use judge::fit::{Interval, LinearFit, linear_fit, same_level};

/// A measured run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CostSample {
    /// Mesh size.
    pub h: f64,
    /// Time step.
    pub k: f64,
    /// CPU seconds.
    pub seconds: f64,
}

/// An exponent with its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Exponent {
    pub exponent: f64,
    pub interval: Interval,
}

/// t = t₀ + c h^-a k^-b.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct CostModel {
    /// t₀, seconds; 0 unless the runs refute that.
    pub base: f64,
    /// c, seconds at h = k = 1.
    pub constant: f64,
    /// a with its interval: the hull of the Student interval and of a' ± 2 |a' - a| with a' from the runs
    /// without the coarsest h, and without the coarsest k. What a power law leaves over is bias, as in `fit`.
    pub space: Exponent,
    /// b, likewise.
    pub time: Exponent,
    /// Largest |log t - log t(h, k)| of the runs.
    pub residual: f64,
}

/// Why a cost was not fitted.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub(crate) enum NoCost {
    /// Three numbers and a spare run are needed.
    #[error("{found} runs, a cost in h and k needs {NEEDED}")]
    TooFew {
        /// Runs that came to their end.
        found: usize,
    },
    /// One value of h or k, or a path: the exponents trade places.
    #[error(
        "the runs are one mesh, one number of steps or one path: the exponents of h and k cannot be told apart"
    )]
    OneDirection,
}

const NEEDED: usize = 4;
/// t₀ is kept where the residual without it is more than so many times that with it, as models are compared in `fit`.
const COMPARABLE: f64 = 2.0;
/// Values of t₀ that are tried, up to all but a hundredth of the fastest run.
const BASES: u32 = 99;

impl CostModel {
    /// Fits the model on logarithms, so that a run of a millisecond counts as much as one of a minute.
    ///
    /// # Errors
    /// [`NoCost`].
    pub(crate) fn fit(samples: &[CostSample]) -> Result<Self, NoCost> {
        let found = samples.len();
        if found < NEEDED {
            return Err(NoCost::TooFew { found });
        }
        let fastest = samples.iter().map(|s| s.seconds).fold(f64::INFINITY, f64::min);
        let plain = plane(samples, 0.0).ok_or(NoCost::OneDirection)?;
        let with_base = |i: u32| {
            let base = fastest * f64::from(i) / f64::from(BASES + 1);
            Some((plane(samples, base)?, base))
        };
        let norm = |fit: &LinearFit| fit.residuals.norm();
        let best = (1..=BASES)
            .filter_map(with_base)
            .filter(|_| found > NEEDED)
            .min_by(|a, b| norm(&a.0).total_cmp(&norm(&b.0)));
        let refuted = |best: &(LinearFit, f64)| norm(&plain) > COMPARABLE * norm(&best.0);
        let (fit, base) = best.filter(refuted).unwrap_or((plain, 0.0));
        let clips: Vec<LinearFit> = [clip(samples, |s| s.h), clip(samples, |s| s.k)]
            .iter()
            .filter(|clip| clip.len() >= NEEDED)
            .filter_map(|clip| plane(clip, base))
            .collect();
        let estimate = |i: usize| {
            let value = fit.coefficients[i];
            let student = fit.interval(i).unwrap_or(Interval::around(value, f64::INFINITY));
            let drift = |clip: &LinearFit| {
                let clipped = clip.coefficients[i];
                Interval::around(clipped, 2.0 * (clipped - value).abs())
            };
            let interval = clips.iter().map(drift).fold(student, Interval::hull);
            Exponent { exponent: value, interval }
        };
        Ok(Self {
            base,
            constant: fit.coefficients[0].exp(),
            space: estimate(1),
            time: estimate(2),
            residual: fit.residuals.amax(),
        })
    }

    /// Seconds at (h, k).
    pub(crate) fn seconds(&self, h: f64, k: f64) -> f64 {
        self.base + self.constant * h.powf(-self.space.exponent) * k.powf(-self.time.exponent)
    }
}

/// Least squares of log(t - t₀) in 1, -log h, -log k; none where the runs do not determine them.
fn plane(samples: &[CostSample], base: f64) -> Option<LinearFit> {
    let design = DMatrix::from_fn(samples.len(), 3, |row, column| match column {
        0 => 1.0,
        1 => -samples[row].h.ln(),
        _ => -samples[row].k.ln(),
    });
    let values = DVector::from_fn(samples.len(), |row, _| (samples[row].seconds - base).ln());
    // On a path one column is a combination of the others but for rounding.
    let fit = linear_fit(design, &values)?;
    let sound = fit.coefficients.iter().chain(&fit.standard_errors).all(|x| x.abs() < LARGEST);
    sound.then_some(fit)
}

/// No cost grows with such a power: it is what rounding makes of columns that depend on each other.
const LARGEST: f64 = 1e3;

/// The runs without those of the coarsest step.
fn clip(samples: &[CostSample], step: fn(&CostSample) -> f64) -> Vec<CostSample> {
    let coarsest = samples.iter().map(step).fold(0.0, f64::max);
    samples.iter().filter(|s| !same_level(step(s), coarsest)).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs on a grid with a given cost; `noise` multiplies run i by exp(± noise), in an order without a pattern.
    fn runs(cost: impl Fn(f64, f64) -> f64, noise: f64) -> Vec<CostSample> {
        let mut found = Vec::new();
        for n in [8, 16, 32, 64] {
            for steps in [4, 8, 16, 32] {
                let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
                let i = found.len() as u32;
                let sign = if (i * i + i / 3).is_multiple_of(2) { noise } else { -noise };
                found.push(CostSample { h, k, seconds: cost(h, k) * sign.exp() });
            }
        }
        found
    }

    #[test]
    fn a_power_law_is_recovered() {
        let law = |h: f64, k: f64| 3e-6 * h.powf(-2.3) * k.powf(-0.9);
        let found = CostModel::fit(&runs(law, 0.0)).expect("a cost");
        // Roundings of logarithms of size 10.
        assert!(
            (found.space.exponent - 2.3).abs() < 1e-12 && (found.time.exponent - 0.9).abs() < 1e-12
        );
        assert!((found.constant / 3e-6 - 1.0).abs() < 1e-11 && found.base == 0.0);
        let noisy = CostModel::fit(&runs(law, 0.1)).expect("a cost");
        // 10 % of noise on 16 runs over a factor 8: 0.1/√16/ln 8 · Student's 2.2, twice.
        assert!(
            (noisy.space.exponent - 2.3).abs() < 0.06 && (noisy.time.exponent - 0.9).abs() < 0.06
        );
        assert!(noisy.space.interval.contains(2.3) && noisy.time.interval.contains(0.9));
        assert!(!noisy.space.interval.contains(2.0) && !noisy.time.interval.contains(1.3));
    }

    #[test]
    fn a_constant_is_found_where_it_is_needed() {
        let law = |h: f64, k: f64| 0.004 + 3e-6 * h.powf(-2.0) / k;
        let found = CostModel::fit(&runs(law, 0.0)).expect("a cost");
        // t₀ is tried in hundredths of the fastest run.
        assert!((found.base / 0.004 - 1.0).abs() < 0.03, "{}", found.base);
        assert!(
            (found.space.exponent - 2.0).abs() < 0.05 && (found.time.exponent - 1.0).abs() < 0.05
        );
        assert!(
            (found.seconds(1.0 / 64.0, 1.0 / 32.0) / law(1.0 / 64.0, 1.0 / 32.0) - 1.0).abs()
                < 0.02
        );
    }

    /// n² + n³ is no power law: the interval reaches the exponent of the finest meshes.
    #[test]
    fn bias_is_in_the_interval() {
        let law = |h: f64, k: f64| 1e-6 * (h.powi(-2) + 0.02 * h.powi(-3)) / k;
        let found = CostModel::fit(&runs(law, 0.0)).expect("a cost");
        let local = (law(1.0 / 64.0, 1.0) / law(1.0 / 32.0, 1.0)).log2();
        assert!(found.space.interval.contains(local), "{local} {:?}", found.space);
        assert!(found.space.exponent < local);
    }

    #[test]
    fn what_does_not_determine_a_cost_has_none() {
        let all = runs(|h, k| 1.0 / (h * k), 0.0);
        assert_eq!(CostModel::fit(&all[..3]), Err(NoCost::TooFew { found: 3 }));
        let one_mesh: Vec<CostSample> = all[..4].to_vec();
        assert_eq!(CostModel::fit(&one_mesh), Err(NoCost::OneDirection));
        let path: Vec<CostSample> = all.iter().copied().filter(|s| s.h * 2.0 == s.k).collect();
        assert_eq!(path.len(), 4);
        assert_eq!(CostModel::fit(&path), Err(NoCost::OneDirection));
    }
}
