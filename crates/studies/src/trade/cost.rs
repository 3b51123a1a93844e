//! What a run costs as a function of both steps, as a sum of parts that are there for a reason.
//!
//! With d dimensions a mesh has h^-d cells, and a factorization by nested dissection takes h^-3(d-1) operations (George
//! 1973). A part comes once a run (mesh, analysis, a factor kept) or once a level (loads, assembly, solves, new factors).

use nalgebra::{DMatrix, DVector};

use judge::fit::linear_fit;

/// A measured run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CostSample {
    pub h: f64,
    pub k: f64,
    /// CPU seconds.
    pub seconds: f64,
}

/// Parts: a constant, cells and factorization, each once and each a level.
const PARTS: usize = 5;

/// t = Σ c_i f_i(h, k) with c_i ≥ 0.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Cost {
    /// Seconds a unit of each part: constant, a cell, a cell and level, an operation, an operation and level.
    pub parts: [f64; PARTS],
    /// Largest |log t - log t(h, k)| of the runs.
    pub residual: f64,
    #[serde(skip)]
    dimension: usize,
    #[serde(skip)]
    horizon: f64,
}

impl Cost {
    /// Least squares of the relative error over all non-negative c: the best of all choices of parts whose least
    /// squares have no negative coefficient (the minimum has such a support). None without a choice that fits.
    pub(super) fn fit(samples: &[CostSample], dimension: usize, horizon: f64) -> Option<Self> {
        let ones = DVector::from_element(samples.len(), 1.0);
        let mut best: Option<(f64, [f64; PARTS])> = None;
        for chosen in 1u32..1 << PARTS {
            let columns: Vec<usize> = (0..PARTS).filter(|i| chosen & (1 << i) != 0).collect();
            let mut design = DMatrix::from_fn(samples.len(), columns.len(), |row, column| {
                let CostSample { h, k, seconds } = samples[row];
                features(dimension, horizon, h, k)[columns[column]] / seconds
            });
            // Columns of size one: a cell of the finest mesh is some 1e-6 of a run.
            let sizes: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
            design.column_iter_mut().zip(&sizes).for_each(|(mut column, size)| column /= *size);
            let Some(fit) = linear_fit(design, &ones) else { continue };
            let norm = fit.residuals.norm();
            let sound = fit.coefficients.iter().all(|c| c.is_finite() && *c >= 0.0);
            if !sound || best.is_some_and(|(least, _)| least <= norm) {
                continue;
            }
            let mut parts = [0.0; PARTS];
            for (i, &column) in columns.iter().enumerate() {
                parts[column] = fit.coefficients[i] / sizes[i];
            }
            best = Some((norm, parts));
        }
        let (_, parts) = best?;
        Some(Self { parts, residual: 0.0, dimension, horizon }.judged(samples))
    }

    /// The seconds of all runs, shared out by cells times levels: for runs that are too short for a clock.
    pub(super) fn counted(samples: &[CostSample], dimension: usize, horizon: f64) -> Self {
        let work = |s: &CostSample| features(dimension, horizon, s.h, s.k)[2];
        let taken: f64 = samples.iter().map(|s| s.seconds).sum();
        // A clock that stands still gives no rate, and any will do.
        let rate = taken.max(f64::MIN_POSITIVE) / samples.iter().map(work).sum::<f64>();
        let parts = [0.0, 0.0, rate, 0.0, 0.0];
        Self { parts, residual: 0.0, dimension, horizon }.judged(samples)
    }

    fn judged(mut self, samples: &[CostSample]) -> Self {
        let off = |s: &CostSample| (self.seconds(s.h, s.k) / s.seconds).ln().abs();
        self.residual = samples.iter().map(off).fold(0.0, f64::max);
        self
    }

    /// Seconds at (h, k).
    pub fn seconds(&self, h: f64, k: f64) -> f64 {
        let parts = features(self.dimension, self.horizon, h, k);
        parts.iter().zip(&self.parts).map(|(f, c)| f * c).sum()
    }

    /// The exponents a and b of t ~ h^-a k^-b around (h, k).
    pub(super) fn exponents(&self, h: f64, k: f64) -> [f64; 2] {
        let shares = features(self.dimension, self.horizon, h, k);
        let all = self.seconds(h, k);
        let share = |i: usize| shares[i] * self.parts[i] / all;
        let d = self.dimension as f64;
        // Of T/k + 1 levels T/k come and go with k.
        let falls = self.horizon / (self.horizon + k);
        let in_space = d * (share(1) + share(2)) + 3.0 * (d - 1.0) * (share(3) + share(4));
        [in_space, falls * (share(2) + share(4))]
    }
}

/// The f_i at (h, k).
fn features(dimension: usize, horizon: f64, h: f64, k: f64) -> [f64; PARTS] {
    let (cells, levels) = (h.powi(-(dimension as i32)), horizon / k + 1.0);
    let operations = h.powi(-3 * (dimension as i32 - 1));
    [1.0, cells, cells * levels, operations, operations * levels]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(cost: impl Fn(f64, f64) -> f64) -> Vec<CostSample> {
        let mut found = Vec::new();
        for n in [8, 16, 32, 64] {
            for steps in [4, 8, 16] {
                let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
                found.push(CostSample { h, k, seconds: cost(h, k) });
            }
        }
        found
    }

    #[test]
    fn parts_are_found_and_carry_beyond_the_runs() {
        let law = |h: f64, k: f64| 1e-3 + 2e-6 * h.powi(-2) * (1.0 / k + 1.0) + 3e-8 * h.powi(-3);
        let found = Cost::fit(&runs(law), 2, 1.0).expect("a cost");
        // Columns of five parts on twelve runs: some digits of 16 are lost.
        for (fitted, part) in found.parts.iter().zip([1e-3, 0.0, 2e-6, 3e-8, 0.0]) {
            assert!((fitted - part).abs() <= 1e-7 * part.max(1e-3), "{:?}", found.parts);
        }
        let (h, k) = (1.0 / 256.0, 1.0 / 40.0);
        assert!((found.seconds(h, k) / law(h, k) - 1.0).abs() < 1e-3 && found.residual < 1e-3);
        // Differences of the law itself: their error is of the square of the step, 1e-4.
        let [a, b] = found.exponents(h, k);
        let slope = |[up, down]: [f64; 2]| (down / up).ln() / (1.001f64 / 0.999).ln();
        assert!((a - slope([1.001, 0.999].map(|s| law(s * h, k)))).abs() < 1e-3, "{a}");
        assert!((b - slope([1.001, 0.999].map(|s| law(h, s * k)))).abs() < 1e-3, "{b}");
    }

    #[test]
    fn noise_makes_no_negative_part() {
        let mut samples = runs(|h, k| 2e-6 * h.powi(-2) / k);
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.seconds *= if i % 3 == 0 { 1.15 } else { 0.95 };
        }
        let found = Cost::fit(&samples, 2, 1.0).expect("a cost");
        assert!(found.parts.iter().all(|part| *part >= 0.0));
        // An eighth of the step, a fourth of the width: 8 and 16 times the cost, within the noise and its growth.
        let ratio = found.seconds(1.0 / 256.0, 1.0 / 32.0) / (2e-6 * 65536.0 * 32.0);
        assert!((0.7..1.5).contains(&ratio), "{ratio}");
        assert!(Cost::fit(&[], 2, 1.0).is_none());
    }

    #[test]
    fn counts_share_out_what_no_clock_resolves() {
        let samples = runs(|_, _| 1e-4);
        let found = Cost::counted(&samples, 2, 1.0);
        let all: f64 = samples.iter().map(|s| found.seconds(s.h, s.k)).sum();
        // Roundings of a sum of twelve numbers.
        assert!((all / 12e-4 - 1.0).abs() < 1e-12);
        assert!((found.seconds(0.01, 0.1) / found.seconds(0.02, 0.1) - 4.0).abs() < 1e-12);
        assert!(Cost::counted(&runs(|_, _| 0.0), 2, 1.0).seconds(0.01, 0.1) > 0.0);
    }
}
