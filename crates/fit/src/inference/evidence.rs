//! Evidence and order of one reading: a linear model with normal noise, in closed form.
//!
//! y = c + p x + Σ a_i v_i + N(0, s² τ²), a_i ~ N(0, 1), c flat, p normal. c is integrated first: every column less its
//! mean, with weights 1/τ². Then the covariance is s² diag(τ²) + Σ v_i v_iᵀ, and every product aᵀ Σ⁻¹ b is one of the Gram
//! matrix of (x, y, v), by Woodbury's formula with a 3 × 3 matrix: the sums over the levels are made once for all s.

/// Columns of unknown size: between the sizes of the list, after the next term, between the powers of the list.
pub(super) const NUISANCES: usize = 3;
/// A product of variances is taken to its logarithm before it is smaller.
const SMALL: f64 = 1e-100;

/// One level under one reading.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// What p multiplies: log h, and where g depends on p its derivative.
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) nuisances: [f64; NUISANCES],
    pub(super) weight: f64,
}

/// What all readings of the same levels share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Base {
    /// n log 2π + Σ log τ² + log Σ 1/τ².
    log: f64,
    count: f64,
}

/// One noise with the part of its evidence that needs no data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    pub(super) size: f64,
    variance: f64,
    precision: f64,
    log: f64,
    /// No reading is likelier: with residuals of zero, and determinants of what is unknown that are those of the priors.
    pub(super) most: f64,
}

/// Products of x, y and the nuisances, less their means.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gram {
    x_x: f64,
    x_y: f64,
    y_y: f64,
    x: [f64; NUISANCES],
    y: [f64; NUISANCES],
    nuisance: [[f64; NUISANCES]; NUISANCES],
}

/// Posterior of the order for one reading and one noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Component {
    /// Up to a constant that all readings share.
    pub(super) log_evidence: f64,
    pub(super) mean: f64,
    precision: f64,
}

impl Component {
    /// Standard deviation of the order, beside one of what no reading has.
    pub(super) fn deviation(&self, beside: f64) -> f64 {
        (1.0 / self.precision + beside * beside).sqrt()
    }
}

impl Base {
    /// Of the variances τ².
    pub(super) fn new(variances: impl Iterator<Item = f64>) -> Self {
        // A logarithm of mantissas, and exponents that are counted: no product leaves the numbers.
        let (mut count, mut product, mut log, mut weight) = (0.0, 1.0, 0.0, 0.0);
        for variance in variances {
            count += 1.0;
            weight += 1.0 / variance;
            product *= variance;
            if !(SMALL..1.0 / SMALL).contains(&product) {
                log += f64::ln(product);
                product = 1.0;
            }
        }
        let log = log + f64::ln(product * weight);
        Self { log: count * std::f64::consts::TAU.ln() + log, count }
    }

    pub(super) fn noise(&self, s: f64, log_prior: f64) -> Noise {
        let variance = s * s;
        // Of s^(2 (n − 1)), s⁶ is contained in the determinant of the nuisances.
        let left = self.count - 1.0 - NUISANCES as f64;
        let of = |power: f64| log_prior - 0.5 * (self.log + power * variance.ln());
        Noise {
            size: s,
            variance,
            precision: 1.0 / variance,
            log: of(left),
            most: of(self.count - 1.0),
        }
    }
}

impl Gram {
    pub(super) fn of(rows: impl Iterator<Item = Row>) -> Self {
        // Columns x, y, nuisances; sums first, products after.
        const ALL: usize = 2 + NUISANCES;
        let (mut total, mut sums, mut products) = (0.0, [0.0; ALL], [[0.0; ALL]; ALL]);
        for Row { x, y, nuisances: [v, u, w], weight } in rows {
            let columns = [x, y, v, u, w];
            total += weight;
            for i in 0..ALL {
                let weighted = weight * columns[i];
                sums[i] += weighted;
                for j in i..ALL {
                    products[i][j] += weighted * columns[j];
                }
            }
        }
        let at = |i: usize, j: usize| products[i.min(j)][i.max(j)] - sums[i] * sums[j] / total;
        Self {
            x_x: at(0, 0),
            x_y: at(0, 1),
            y_y: at(1, 1),
            x: [at(0, 2), at(0, 3), at(0, 4)],
            y: [at(1, 2), at(1, 3), at(1, 4)],
            nuisance: [2, 3, 4].map(|i| [2, 3, 4].map(|j| at(i, j))),
        }
    }

    /// Evidence and order for one noise and a normal prior of the order. Where the evidence is less than `least`, a bound of it
    /// that is so, too.
    pub(super) fn component(
        &self,
        noise: &Noise,
        [order, spread]: [f64; 2],
        least: f64,
    ) -> Component {
        // Cholesky factor of the nuisances with their priors.
        let [[n00, n01, n02], [_, n11, n12], [.., n22]] = self.nuisance;
        let d0 = n00 + noise.variance;
        let i0 = 1.0 / d0;
        let (l10, l20) = (n01 * i0, n02 * i0);
        let d1 = n11 + noise.variance - l10 * n01;
        let i1 = 1.0 / d1;
        let l21 = (n12 - l20 * n01) * i1;
        let d2 = n22 + noise.variance - l20 * n02 - l21 * l21 * d1;
        let inverse = [i0, i1, 1.0 / d2];
        let forward = |[a, b, c]: [f64; NUISANCES]| {
            let second = b - l10 * a;
            [a, second, c - l20 * a - l21 * second]
        };
        let (x, y) = (forward(self.x), forward(self.y));
        let reduced = |a: [f64; 3], b: [f64; 3]| -> f64 {
            a[0] * b[0] * inverse[0] + a[1] * b[1] * inverse[1] + a[2] * b[2] * inverse[2]
        };
        let precision = noise.precision;
        let x_x = (self.x_x - reduced(x, x)) * precision;
        let x_y = (self.x_y - reduced(x, y)) * precision;
        let y_y = (self.y_y - reduced(y, y)) * precision;
        // The precision of p is that of the data plus that of its prior.
        let prior_precision = 1.0 / (spread * spread);
        let precision = x_x + prior_precision;
        let mean = (x_y + prior_precision * order) / precision;
        let residual = y_y + prior_precision * order * order - precision * mean * mean;
        let most = noise.most - 0.5 * residual;
        if most < least {
            return Component { log_evidence: most, mean, precision };
        }
        // One logarithm for the covariance and both precisions.
        let determinants = (d0 * d1 * d2 * precision * spread * spread).ln();
        Component { log_evidence: noise.log - 0.5 * (determinants + residual), mean, precision }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Reference: dense matrices with Σ inverted, c and p integrated as one normal with a very wide prior of c.
    #[test]
    fn closed_forms_agree_with_dense_matrices() {
        let rows = [
            [0.0, 0.3, 0.11, 0.05, 0.0],
            [-0.7, -0.5, 0.07, 0.02, 0.03],
            [-1.4, -1.1, 0.04, -0.01, 0.02],
            [-2.0, -1.9, 0.02, 0.003, 0.01],
        ];
        let scales = [1.0, 0.7, 1.3, 1.0];
        let base = Base::new(scales.iter().map(|scale| scale * scale));
        let row = |([x, y, v, u, w], scale): ([f64; 5], f64)| Row {
            x,
            y,
            nuisances: [v, u, w],
            weight: 1.0 / (scale * scale),
        };
        let gram = Gram::of(rows.into_iter().zip(scales).map(row));
        let dense = |s: f64, [order, spread]: [f64; 2]| {
            let wide = 1e3;
            let column = |j: usize| DVector::from_fn(4, |i, _| rows[i][j]);
            let noise =
                DMatrix::from_fn(4, 4, |i, j| if i == j { (s * scales[i]).powi(2) } else { 0.0 });
            let (x, y) = (column(0), column(1));
            let nuisances = [2, 3, 4].map(column);
            let ones = DVector::from_element(4, 1.0);
            let noise = nuisances.iter().fold(noise, |noise, v| noise + v * v.transpose());
            let all: DMatrix<f64> = &noise
                + &ones * ones.transpose() * (wide * wide)
                + &x * x.transpose() * (spread * spread);
            let away: DVector<f64> = &y - &x * order;
            let factor = all.cholesky().expect("a covariance");
            let log_determinant = 2.0 * factor.l().diagonal().map(f64::ln).sum();
            let log = -0.5 * (log_determinant + away.dot(&factor.solve(&away)));
            let gain: DVector<f64> = factor.solve(&x) * (spread * spread);
            let (mean, shrunk) = (order + gain.dot(&away), spread * spread * gain.dot(&x));
            (log, mean, (spread * spread - shrunk).sqrt())
        };
        let prior = [1.5, 2.5];
        let mut differences = Vec::new();
        for s in [0.01, 0.03, 0.1] {
            let found = gram.component(&base.noise(s, 0.0), prior, f64::NEG_INFINITY);
            let (log, mean, deviation) = dense(s, prior);
            // A prior of width 1e3 leaves 1e-6 of the noise; the covariance has condition 1e10.
            assert!((found.mean - mean).abs() < 1e-3, "{found:?} {mean}");
            assert!((found.deviation(0.0) - deviation).abs() < 1e-3, "{found:?} {deviation}");
            differences.push(found.log_evidence - log);
        }
        assert!(
            differences.iter().all(|difference| (difference - differences[0]).abs() < 1e-2),
            "{differences:?}"
        );
    }
}
