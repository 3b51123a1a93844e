//! What a run costs, as a sum of parts that are there for a reason: for predictions beyond the runs, where one power
//! law would go on with the mean exponent of the grid.
//!
//! With d dimensions a mesh has h^-d cells, and a factorization by nested dissection takes h^-3(d-1) operations (George
//! 1973). A part comes once a run (mesh, analysis, a factor kept) or once a level (loads, assembly, solves, new factors).

use nalgebra::{DMatrix, DVector};

use super::CostSample;
use judge::fit::linear_fit;

/// Parts: a constant, cells and factorization, each once and each a level.
const PARTS: usize = 5;

/// t = Σ c_i f_i(h, k) with c_i ≥ 0.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(transparent)]
pub struct Composition {
    /// Seconds a unit of each part: constant, a cell, a cell and level, an operation, an operation and level.
    pub parts: [f64; PARTS],
    #[serde(skip)]
    dimension: usize,
    #[serde(skip)]
    horizon: f64,
}

impl Composition {
    /// Least squares of the relative error over all non-negative c: the best of all choices of parts whose least
    /// squares have no negative coefficient (the minimum has such a support). None without a choice that fits.
    pub(crate) fn fit(samples: &[CostSample], dimension: usize, horizon: f64) -> Option<Self> {
        let mut best: Option<(f64, [f64; PARTS])> = None;
        for chosen in 1u32..1 << PARTS {
            let columns: Vec<usize> = (0..PARTS).filter(|i| chosen & (1 << i) != 0).collect();
            let design = DMatrix::from_fn(samples.len(), columns.len(), |row, column| {
                let sample = &samples[row];
                let parts = features(dimension, horizon, sample.h, sample.k);
                parts[columns[column]] / sample.seconds
            });
            // Columns of size one: a cell of the finest mesh is some 1e-6 of a run.
            let sizes: Vec<f64> = design.column_iter().map(|column| column.norm()).collect();
            let scaled = DMatrix::from_fn(samples.len(), columns.len(), |row, column| {
                design[(row, column)] / sizes[column]
            });
            let ones = DVector::from_element(samples.len(), 1.0);
            let Some(fit) = linear_fit(scaled, &ones) else { continue };
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
        best.map(|(_, parts)| Self { parts, dimension, horizon })
    }

    /// Seconds at (h, k).
    pub fn seconds(&self, h: f64, k: f64) -> f64 {
        let parts = features(self.dimension, self.horizon, h, k);
        parts.iter().zip(&self.parts).map(|(f, c)| f * c).sum()
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
        let found = Composition::fit(&runs(law), 2, 1.0).expect("a composition");
        // Columns of five parts on twelve runs: some digits of 16 are lost.
        for (fitted, part) in found.parts.iter().zip([1e-3, 0.0, 2e-6, 3e-8, 0.0]) {
            assert!((fitted - part).abs() <= 1e-7 * part.max(1e-3), "{:?}", found.parts);
        }
        let (h, k) = (1.0 / 256.0, 1.0 / 40.0);
        assert!((found.seconds(h, k) / law(h, k) - 1.0).abs() < 1e-3);
        // One power law misses a cube that overtakes a square.
        let law = |h: f64, k: f64| (2e-6 * h.powi(-2) + 3e-8 * h.powi(-3)) * (1.0 / k + 1.0);
        let found = Composition::fit(&runs(law), 2, 1.0).expect("a composition");
        assert!((found.seconds(h, k) / law(h, k) - 1.0).abs() < 1e-3);
        let plane = super::super::CostModel::fit(&runs(law)).expect("a cost");
        assert!((plane.seconds(h, k) / law(h, k) - 1.0).abs() > 0.1);
    }

    #[test]
    fn noise_makes_no_negative_part() {
        let mut samples = runs(|h, k| 2e-6 * h.powi(-2) / k);
        for (i, sample) in samples.iter_mut().enumerate() {
            sample.seconds *= if i % 3 == 0 { 1.15 } else { 0.95 };
        }
        let found = Composition::fit(&samples, 2, 1.0).expect("a composition");
        assert!(found.parts.iter().all(|part| *part >= 0.0));
        // An eighth of the step, a fourth of the width: 8 and 16 times the cost, within the noise and its growth.
        let ratio = found.seconds(1.0 / 256.0, 1.0 / 32.0) / (2e-6 * 65536.0 * 32.0);
        assert!((0.7..1.5).contains(&ratio), "{ratio}");
        assert!(Composition::fit(&[], 2, 1.0).is_none());
    }
}
