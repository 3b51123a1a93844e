//! The evidence of every pair of orders of a grid, in closed form.
//!
//! Columns h^p, k^q and their next terms, divided by the observed errors, are fitted to one. The leading terms are
//! eliminated once per pair; a 2 × 2 matrix of the next terms remains for each noise.

use nalgebra::{DMatrix, Matrix2, Vector2};

use crate::Point;

pub(super) const STEP: f64 = 0.05;
pub(super) const ORDERS: usize = 160;
/// Every so many orders are looked at first.
const COARSE: usize = 4;
/// Squares of residuals a point, and of all, by which an order between those looked at may fit better, or may be likely at
/// the largest noise.
const MARGIN: [f64; 2] = [0.02, 0.4];
/// Neighbours whose logarithms of evidence differ by less are interpolated; those below exp(-30) of the best are not looked
/// at.
const CLOSE: f64 = 0.5;
const OUT_OF_REACH: f64 = 30.0;
/// Prior of terms of opposite sign.
const OPPOSITE: f64 = 0.03;
/// Powers of next terms in multiples of `STEP`, with weights.
const NEXT: [(usize, f64); 3] = [(10, 0.15), (20, 0.55), (40, 0.30)];
/// Standard deviation of D.
const BEND: f64 = 0.3;
/// Noise at which the orders are looked at.
const LOOK: f64 = 0.1;

pub(super) fn order(index: usize) -> f64 {
    STEP * (index + 1) as f64
}

pub(super) struct PairSums {
    /// 1 if errors add, 2 if squares do.
    exponent: usize,
    points: f64,
    /// Products of the columns of h, those of k, and one.
    gram: DMatrix<f64>,
}

const COLUMNS: usize = ORDERS + NEXT[2].0;

impl PairSums {
    pub(super) fn new(points: &[Point], exponent: i32) -> Self {
        let largest = |f: fn(&Point) -> f64| points.iter().map(f).fold(0.0, f64::max);
        let scale = [largest(|p| p.h), largest(|p| p.k)];
        let mut columns = DMatrix::from_element(points.len(), 2 * COLUMNS + 1, 1.0);
        for (row, point) in points.iter().enumerate() {
            for (which, step) in [point.h / scale[0], point.k / scale[1]].into_iter().enumerate() {
                let factor = step.powi(exponent).powf(STEP);
                let mut value = 1.0 / point.error.powi(exponent);
                // By repeated products: 200 of them are off by 1e-13.
                for column in 0..COLUMNS {
                    value *= factor;
                    columns[(row, which * COLUMNS + column)] = value;
                }
            }
        }
        let gram = columns.tr_mul(&columns);
        Self { exponent: exponent as usize, points: points.len() as f64, gram }
    }

    /// Adds exp(log prior) times the evidence of every pair, in logarithms: of every fourth order, then of those between,
    /// interpolated where it is smooth.
    pub(super) fn add(&self, log_prior: f64, noises: &[(f64, f64)], evidence: &mut [f64]) {
        let noises: Vec<Noise> = noises.iter().map(|noise| self.noise(*noise, log_prior)).collect();
        let likely = self.likely();
        let mut logs = vec![None; ORDERS * ORDERS];
        let mut best = f64::NEG_INFINITY;
        let mut set =
            |logs: &mut [Option<f64>], i: usize, j: usize, along: usize, stride: usize| {
                let place = if along == 1 { j } else { i };
                let near = [-3, -1, 1, 3].map(|steps| {
                    let there = place.checked_add_signed(steps * stride as isize)?;
                    let at = (i * ORDERS + j + there * along).checked_sub(place * along)?;
                    (there < ORDERS).then(|| logs[at]).flatten()
                });
                let log = between(near, best).unwrap_or_else(|| {
                    let pair = likely[i / COARSE * (ORDERS / COARSE) + j / COARSE]
                        .then(|| self.pair(i, j))
                        .flatten();
                    pair.map_or(f64::NEG_INFINITY, |pair| self.evidence(&pair, &noises))
                });
                best = best.max(log);
                logs[i * ORDERS + j] = Some(log);
            };
        let every = |stride: usize| (stride - 1..ORDERS).step_by(stride);
        let new = |stride: usize| (stride - 1..ORDERS).step_by(2 * stride);
        for (i, j) in every(COARSE).flat_map(|i| every(COARSE).map(move |j| (i, j))) {
            set(&mut logs, i, j, 1, ORDERS);
        }
        let mut stride = COARSE;
        while stride > 1 {
            stride /= 2;
            for (i, j) in new(stride).flat_map(|i| every(2 * stride).map(move |j| (i, j))) {
                set(&mut logs, i, j, ORDERS, stride);
            }
            for (i, j) in every(stride).flat_map(|i| new(stride).map(move |j| (i, j))) {
                set(&mut logs, i, j, 1, stride);
            }
        }
        for (sum, log) in evidence.iter_mut().zip(logs) {
            *sum = log_sum(*sum, log.unwrap_or(f64::NEG_INFINITY));
        }
    }

    /// Cells of `COARSE` orders in h and in k that leave residuals not far above the least.
    fn likely(&self) -> Vec<bool> {
        let noise = LOOK * self.exponent as f64;
        let looked_at = || (COARSE / 2..ORDERS).step_by(COARSE);
        let least = |(i, j): (usize, usize)| {
            let Some(pair) = self.pair(i, j) else { return f64::INFINITY };
            let powers = NEXT.iter().flat_map(|(r, _)| NEXT.iter().map(move |(s, _)| [*r, *s]));
            let left = powers.map(|at| self.left(&pair, &self.next(&pair, at), noise * noise).0);
            left.fold(f64::INFINITY, f64::min)
        };
        let pairs = looked_at().flat_map(|i| looked_at().map(move |j| (i, j)));
        let least: Vec<f64> = pairs.map(least).collect();
        let square = (self.exponent * self.exponent) as f64;
        let margin = (MARGIN[0] * self.points + MARGIN[1]) * square;
        let most = least.iter().copied().fold(f64::INFINITY, f64::min) + margin;
        least.into_iter().map(|least| least <= most).collect()
    }

    fn noise(&self, (noise, share): (f64, f64), log_prior: f64) -> Noise {
        let noise = noise * self.exponent as f64;
        let variance = noise * noise;
        let log = log_prior + share.ln() - (self.points - 4.0) * noise.ln();
        Noise { variance, precision: 1.0 / variance, log }
    }

    fn products(&self, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> Matrix2<f64> {
        let at = |row, column| self.gram[(row, column)];
        Matrix2::new(at(a, c), at(a, d), at(b, c), at(b, d))
    }

    fn with_one(&self, columns: [usize; 2]) -> Vector2<f64> {
        Vector2::from(columns.map(|column| self.gram[(column, 2 * COLUMNS)]))
    }

    /// Eliminates a pair of orders without next terms; none unless a term is positive.
    fn pair(&self, i: usize, j: usize) -> Option<Pair> {
        let at = [i, COLUMNS + j];
        let matrix = self.products(at, at);
        let (inverse, ones) = (matrix.try_inverse()?, self.with_one(at));
        let sizes = inverse * ones;
        let positive = sizes.iter().filter(|size| **size > 0.0).count();
        if positive == 0 || !sizes.iter().all(|size| size.is_finite() && *size != 0.0) {
            return None;
        }
        let opposite = if positive == 1 { OPPOSITE.ln() } else { 0.0 };
        let bends = sizes.abs() * (BEND * self.exponent as f64);
        Some(Pair {
            at,
            inverse,
            determinant: matrix.determinant(),
            sizes,
            explained: ones.dot(&sizes),
            ridges: bends.map(|bend| 1.0 / (bend * bend)),
            // C has a flat prior in log C, C D is normal with standard deviation 0.3 C.
            log: opposite - bends.iter().chain(&sizes).map(|size| size.abs().ln()).sum::<f64>(),
        })
    }

    /// Log evidence of all readings of a pair: one logarithm for all of them.
    fn evidence(&self, pair: &Pair, noises: &[Noise]) -> f64 {
        let mut readings = Vec::with_capacity(NEXT.len() * NEXT.len() * noises.len());
        for (r, r_weight) in NEXT {
            for (s, s_weight) in NEXT {
                let (next, weight) = (self.next(pair, [r, s]), r_weight * s_weight);
                readings
                    .extend(noises.iter().map(|noise| self.reading(pair, &next, noise, weight)));
            }
        }
        let most = readings.iter().map(|reading| reading.log).fold(f64::NEG_INFINITY, f64::max);
        let near = readings.iter().filter(|reading| reading.log > most - OUT_OF_REACH);
        let sum: f64 = near.map(|reading| (reading.log - most).exp() * reading.factor).sum();
        pair.log + most + sum.ln()
    }

    /// The columns of two next terms, orthogonal to the two leading terms.
    fn next(&self, pair: &Pair, powers: [usize; 2]) -> Next {
        let next = [0, 1].map(|which| pair.at[which] + powers[which] / self.exponent);
        let along = self.products(next, pair.at);
        Next {
            products: self.products(next, next) - along * pair.inverse * along.transpose(),
            ones: self.with_one(next) - along * pair.sizes,
        }
    }

    /// The squares of residuals of a reading, and its determinants.
    fn left(&self, pair: &Pair, next: &Next, variance: f64) -> (f64, f64) {
        let [a, d] = [0, 1].map(|i| next.products[(i, i)] + pair.ridges[i] * variance);
        let (b, f, g) = (next.products[(0, 1)], next.ones[0], next.ones[1]);
        let determinant = a * d - b * b;
        let explained = (d * f * f - 2.0 * b * f * g + a * g * g) / determinant;
        (self.points - pair.explained - explained, pair.determinant * determinant)
    }

    /// Four parameters are integrated: |M| of M = gram / s² + prior is s⁻⁸ times the determinants.
    fn reading(&self, pair: &Pair, next: &Next, noise: &Noise, weight: f64) -> Reading {
        let (left, determinants) = self.left(pair, next, noise.variance);
        let there = determinants > 0.0;
        let log = if there { noise.log - 0.5 * left * noise.precision } else { f64::NEG_INFINITY };
        Reading { log, factor: weight / determinants.sqrt() }
    }
}

/// One reading of a pair: its evidence is the factor times exp(log).
struct Reading {
    log: f64,
    factor: f64,
}

struct Noise {
    variance: f64,
    precision: f64,
    /// Evidence before any error is seen.
    log: f64,
}

struct Pair {
    /// Its columns.
    at: [usize; 2],
    inverse: Matrix2<f64>,
    determinant: f64,
    /// C_h and C_k by least squares, and the share of the observations (all one) that they explain.
    sizes: Vector2<f64>,
    explained: f64,
    ridges: Vector2<f64>,
    log: f64,
}

/// Products of the columns of two next terms with each other, and with one.
struct Next {
    products: Matrix2<f64>,
    ones: Vector2<f64>,
}

/// The middle of four neighbours at distances 3, 1, 1, 3, by a cubic: where they are close to each other, or all out of
/// reach.
fn between(near: [Option<f64>; 4], best: f64) -> Option<f64> {
    let [Some(a), Some(b), Some(c), Some(d)] = near else { return None };
    if [a, b, c, d].iter().all(|log| *log < best - OUT_OF_REACH) {
        return Some(b.max(c));
    }
    let close = (a - b).abs().max((b - c).abs()).max((c - d).abs()) < CLOSE;
    close.then_some((9.0 * (b + c) - a - d) / 16.0)
}

fn log_sum(a: f64, b: f64) -> f64 {
    let (large, small) = (a.max(b), a.min(b));
    if small == f64::NEG_INFINITY { large } else { large + (small - large).exp().ln_1p() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inference::grid::NOISE;

    fn grid(error: impl Fn(f64, f64) -> f64) -> Vec<Point> {
        let step = |i: i32| 0.125 * 0.5f64.powi(i);
        let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (step(i), 4.0 * step(j))));
        pairs.map(|(h, k)| Point { h, k, error: error(h, k), floor: 0.0 }).collect()
    }

    /// Reference: four explicit columns and a dense factor.
    #[test]
    fn closed_forms_agree_with_dense_matrices() {
        let points = grid(|h, k| h + k * k);
        for exponent in [1, 2] {
            let model = PairSums::new(&points, exponent);
            let (i, j, r, s) = (19, 38, 0, 2);
            let power = |base: f64, at: usize, shift: usize| {
                base.powi(exponent).powf(order(at) + STEP * (shift / exponent as usize) as f64)
            };
            let gram = nalgebra::DMatrix::from_fn(points.len(), 4, |row, column| {
                let point = points[row];
                let (h, k) = (point.h / 0.125, point.k / 0.5);
                let top = match column {
                    0 => power(h, i, 0),
                    1 => power(k, j, 0),
                    2 => power(h, i, NEXT[r].0),
                    _ => power(k, j, NEXT[s].0),
                };
                top / point.error.powi(exponent)
            });
            let pair = model.pair(i, j).expect("both terms are positive");
            let ones = nalgebra::DVector::from_element(points.len(), 1.0);
            let sizes = gram.columns(0, 2).into_owned().svd(true, true);
            let sizes = sizes.solve(&ones, 0.0).expect("two sizes");
            let bends = [0, 1].map(|at| BEND * f64::from(exponent) * sizes[at]);
            let next = model.next(&pair, [NEXT[r].0, NEXT[s].0]);
            for (s, share) in NOISE {
                let noise = s * f64::from(exponent);
                let mut precision = gram.transpose() * &gram / (noise * noise);
                precision[(2, 2)] += 1.0 / (bends[0] * bends[0]);
                precision[(3, 3)] += 1.0 / (bends[1] * bends[1]);
                let along = gram.transpose() * &ones / (noise * noise);
                let factor = precision.cholesky().expect("a precision");
                let log_determinant = 2.0 * factor.l().diagonal().map(f64::ln).sum();
                let left = points.len() as f64 / (noise * noise) - along.dot(&factor.solve(&along));
                let expected = share.ln()
                    - points.len() as f64 * noise.ln()
                    - 0.5 * (left + log_determinant)
                    - (bends[0] * bends[1] * sizes[0] * sizes[1]).ln();
                let Reading { log, factor } =
                    model.reading(&pair, &next, &model.noise((s, share), 0.0), 1.0);
                let found = pair.log + log + factor.ln();
                // Rounding of nine over the square of the noise.
                assert!((found - expected).abs() < 1e-6, "{exponent} {s}: {found} {expected}");
            }
        }
    }
    /// Reference: every pair by itself.
    #[test]
    fn interpolated_evidence_is_that_of_the_pairs() {
        for (bend, k_share) in [(0.0, 1.0), (-0.8, 0.2), (0.5, 4.0)] {
            let points = grid(|h, k| h * (1.0 + bend * h) + k_share * k * k);
            let model = PairSums::new(&points, 1);
            let mut found = vec![f64::NEG_INFINITY; ORDERS * ORDERS];
            model.add(0.0, &NOISE, &mut found);
            let noises: Vec<_> = NOISE.iter().map(|noise| model.noise(*noise, 0.0)).collect();
            let log = |at: usize| {
                let pair = model.pair(at / ORDERS, at % ORDERS);
                pair.map_or(f64::NEG_INFINITY, |pair| model.evidence(&pair, &noises))
            };
            let expected: Vec<f64> = (0..ORDERS * ORDERS).map(log).collect();
            let most = expected.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let weights = |logs: &[f64]| -> Vec<f64> {
                let weights: Vec<f64> = logs.iter().map(|log| (log - most).exp()).collect();
                let total: f64 = weights.iter().sum();
                weights.into_iter().map(|weight| weight / total).collect()
            };
            let pairs = weights(&found).into_iter().zip(weights(&expected));
            let moved: f64 = pairs.map(|(a, b)| (a - b).abs()).sum();
            // Less than a tenth of the percent that is printed, twice: what leaves and what comes.
            assert!(moved < 2e-3, "{bend} {k_share}: {moved}");
        }
    }
}
