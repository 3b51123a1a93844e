//! Evidence and order of one reading: a linear model with normal noise, in closed form.
//!
//! y = c + p x + a v + b u + N(0, s² τ_i²), a, b ~ N(0, 1), c flat, p normal. c is integrated first: every column less its
//! mean, with weights 1/τ². Then the covariance is s² diag(τ²) + v vᵀ + u uᵀ, and every product aᵀ Σ⁻¹ b is one of the Gram
//! matrix of (x, y, v, u), by Woodbury's formula with a 2 × 2 matrix: the sums over the levels are made once for all s.

#[derive(Debug, Clone, Copy)]
pub(super) struct Observed {
    /// log h, log e, each less its weighted mean.
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) weight: f64,
}

/// What all next terms over the same levels share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Base {
    /// Σ weights and Σ w x².
    weight: f64,
    x_x: f64,
    /// n log 2π + Σ log τ² + log Σ w.
    log: f64,
    count: f64,
}

/// One noise with the part of its evidence that needs no data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
    variance: f64,
    precision: f64,
    log: f64,
}

/// Products of x, y, v and u, less their means.
#[derive(Debug, Clone, Copy)]
pub(super) struct Gram {
    x: [f64; 2],
    y: [f64; 2],
    x_y: f64,
    y_y: f64,
    /// v, u against v, u.
    nuisance: [f64; 3],
}

/// Posterior of the order for one reading and one noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Component {
    /// Up to a constant that all readings share.
    pub(super) log_evidence: f64,
    pub(super) mean: f64,
    /// Standard deviation of the order.
    pub(super) deviation: f64,
}

impl Base {
    pub(super) fn new(x: &[f64], y: &[f64], scales: &[f64]) -> (Vec<Observed>, Self) {
        let weights: Vec<f64> = scales.iter().map(|scale| 1.0 / (scale * scale)).collect();
        let weight: f64 = weights.iter().sum();
        let mean = |values: &[f64]| {
            values.iter().zip(&weights).map(|(value, w)| value * w).sum::<f64>() / weight
        };
        let centre = [mean(x), mean(y)];
        let observed: Vec<Observed> = (0..x.len())
            .map(|i| Observed { x: x[i] - centre[0], y: y[i] - centre[1], weight: weights[i] })
            .collect();
        let count = x.len() as f64;
        let scales: f64 = scales.iter().map(|scale| 2.0 * scale.ln()).sum();
        let log = count * std::f64::consts::TAU.ln() + scales + weight.ln();
        let x_x = observed.iter().map(|level| level.weight * level.x * level.x).sum();
        (observed, Self { weight, x_x, log, count })
    }

    pub(super) fn noise(&self, s: f64, log_prior: f64) -> Noise {
        let variance = s * s;
        // Of s^(2 (n − 1)), s⁴ is contained in the determinant of v and u.
        let log = log_prior - 0.5 * (self.log + (self.count - 3.0) * variance.ln());
        Noise { variance, precision: 1.0 / variance, log }
    }

    pub(super) fn gram(&self, levels: impl Iterator<Item = (Observed, [f64; 3])>) -> Gram {
        let (mut sums, mut x, mut y, mut nuisance) = ([0.0; 3], [0.0; 2], [0.0; 2], [0.0; 3]);
        let (mut x_y, mut y_y) = (0.0, 0.0);
        for (level, [g, v, u]) in levels {
            let residual = level.y - g;
            let [wx, wy, wv, wu] = [level.x, residual, v, u].map(|value| level.weight * value);
            sums = [sums[0] + wy, sums[1] + wv, sums[2] + wu];
            x = [x[0] + wx * v, x[1] + wx * u];
            y = [y[0] + wy * v, y[1] + wy * u];
            nuisance = [nuisance[0] + wv * v, nuisance[1] + wv * u, nuisance[2] + wu * u];
            x_y += wx * residual;
            y_y += wy * residual;
        }
        // x has mean zero.
        let [of_y, v, u] = sums.map(|sum| sum / self.weight);
        Gram {
            x,
            y: [y[0] - of_y * sums[1], y[1] - of_y * sums[2]],
            x_y,
            y_y: y_y - of_y * sums[0],
            nuisance: [
                nuisance[0] - v * sums[1],
                nuisance[1] - v * sums[2],
                nuisance[2] - u * sums[2],
            ],
        }
    }

    /// Evidence and order for one noise and a normal prior of the order.
    pub(super) fn component(
        &self,
        gram: &Gram,
        noise: &Noise,
        [order, spread]: [f64; 2],
    ) -> Component {
        let [a, b, d] = gram.nuisance;
        let (a, d) = (a + noise.variance, d + noise.variance);
        let determinant = a * d - b * b;
        let scale = 1.0 / determinant;
        let reduced = |[v, u]: [f64; 2], [w, z]: [f64; 2]| {
            (v * (d * w - b * z) + u * (a * z - b * w)) * scale
        };
        let x_x = (self.x_x - reduced(gram.x, gram.x)) * noise.precision;
        let x_y = (gram.x_y - reduced(gram.x, gram.y)) * noise.precision;
        let y_y = (gram.y_y - reduced(gram.y, gram.y)) * noise.precision;
        // The precision of p is that of the data plus that of its prior.
        let prior_precision = 1.0 / (spread * spread);
        let precision = x_x + prior_precision;
        let mean = (x_y + prior_precision * order) / precision;
        let residual = y_y + prior_precision * order * order - precision * mean * mean;
        // One logarithm for the covariance and both precisions.
        let determinants = determinant * precision * spread * spread;
        let log_evidence = noise.log - 0.5 * (determinants.ln() + residual);
        Component { log_evidence, mean, deviation: precision.sqrt().recip() }
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
            [0.0, 0.3, 0.11, 0.05],
            [-0.7, -0.5, 0.07, 0.02],
            [-1.4, -1.1, 0.04, -0.01],
            [-2.0, -1.9, 0.02, 0.003],
        ];
        let scales = [1.0, 0.7, 1.3, 1.0];
        let column = |j: usize| rows.map(|row| row[j]);
        let (observed, base) = Base::new(&column(0), &column(1), &scales);
        let nexts = rows.map(|[.., v, u]| [0.0, v, u]);
        let gram = base.gram(observed.into_iter().zip(nexts));
        let dense = |s: f64, [order, spread]: [f64; 2]| {
            let wide = 1e3;
            let column = |j: usize| DVector::from_fn(4, |i, _| rows[i][j]);
            let noise =
                DMatrix::from_fn(4, 4, |i, j| if i == j { (s * scales[i]).powi(2) } else { 0.0 });
            let (x, y, v, u) = (column(0), column(1), column(2), column(3));
            let ones = DVector::from_element(4, 1.0);
            let noise = noise + &v * v.transpose() + &u * u.transpose();
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
            let found = base.component(&gram, &base.noise(s, 0.0), prior);
            let (log, mean, deviation) = dense(s, prior);
            // A prior of width 1e3 leaves 1e-6 of the noise; the covariance has condition 1e10.
            assert!((found.mean - mean).abs() < 1e-3, "{found:?} {mean}");
            assert!((found.deviation - deviation).abs() < 1e-3, "{found:?} {deviation}");
            differences.push(found.log_evidence - log);
        }
        assert!(
            differences.iter().all(|difference| (difference - differences[0]).abs() < 1e-2),
            "{differences:?}"
        );
    }
}
