//! Evidence and order of one reading: a linear model with normal noise, in closed form.
//!
//! y = c + p x + a v + b u + N(0, s² τ_i²), a, b ~ N(0, 1), c flat, p normal. c is integrated first: every column less its
//! mean, with weights 1/τ². Then the covariance is s² diag(τ²) + v vᵀ + u uᵀ, and every product aᵀ Σ⁻¹ b is one of the Gram
//! matrix of (x, y, v, u), by Woodbury's formula with a 2 × 2 matrix: the sums over the levels are made once for all s.

/// A level as all readings see it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Observed {
    /// log h, log e, each less its mean over the levels that are read.
    pub(super) x: f64,
    pub(super) y: f64,
    /// 1/τ².
    pub(super) weight: f64,
}

/// What is the same for all next terms over the same levels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Base {
    /// Sum of weights, and Σ w x².
    weight: f64,
    x_x: f64,
    /// n log 2π + Σ log τ² + log Σ w.
    log: f64,
    /// Number of levels.
    count: f64,
}

/// One noise with what its evidence has before any level is looked at.
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

/// What one reading with one noise says of the order.
#[derive(Debug, Clone, Copy)]
pub(super) struct Component {
    /// Logarithm of the evidence, up to a constant that all readings share.
    pub(super) log_evidence: f64,
    /// Mean of the order.
    pub(super) mean: f64,
    /// Its standard deviation.
    pub(super) deviation: f64,
}

impl Base {
    /// Levels with x = log h, y = log e and scales τ of their noise, and what they share.
    pub(super) fn new(x: &[f64], y: &[f64], scales: &[f64]) -> (Vec<Observed>, Self) {
        let weights: Vec<f64> = scales.iter().map(|scale| 1.0 / (scale * scale)).collect();
        let weight: f64 = weights.iter().sum();
        let mean = |values: &[f64]| {
            values.iter().zip(&weights).map(|(value, own)| value * own).sum::<f64>() / weight
        };
        let centre = [mean(x), mean(y)];
        let observed: Vec<Observed> = (0..x.len())
            .map(|i| Observed { x: x[i] - centre[0], y: y[i] - centre[1], weight: weights[i] })
            .collect();
        let count = x.len() as f64;
        let scales: f64 = scales.iter().map(|scale| 2.0 * scale.ln()).sum();
        let log = count * std::f64::consts::TAU.ln() + scales + weight.ln();
        let x_x = observed.iter().map(|own| own.weight * own.x * own.x).sum();
        (observed, Self { weight, x_x, log, count })
    }

    /// The noise `s` with the logarithm of its prior.
    pub(super) fn noise(&self, s: f64, log_prior: f64) -> Noise {
        let variance = s * s;
        // Of s^(2 (n − 1)) of the levels s⁴ is in the determinant of v and u.
        let log = log_prior - 0.5 * (self.log + (self.count - 3.0) * variance.ln());
        Noise { variance, precision: 1.0 / variance, log }
    }

    /// Products of the levels with the rows g, v, u of a next term.
    pub(super) fn gram(&self, levels: impl Iterator<Item = (Observed, [f64; 3])>) -> Gram {
        let (mut sums, mut x, mut y, mut nuisance) = ([0.0; 3], [0.0; 2], [0.0; 2], [0.0; 3]);
        let (mut x_y, mut y_y) = (0.0, 0.0);
        for (level, [g, v, u]) in levels {
            let own = level.y - g;
            let [wx, wy, wv, wu] = [level.x, own, v, u].map(|value| level.weight * value);
            sums = [sums[0] + wy, sums[1] + wv, sums[2] + wu];
            x = [x[0] + wx * v, x[1] + wx * u];
            y = [y[0] + wy * v, y[1] + wy * u];
            nuisance = [nuisance[0] + wv * v, nuisance[1] + wv * u, nuisance[2] + wu * u];
            x_y += wx * own;
            y_y += wy * own;
        }
        // x has no mean.
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

    /// Evidence and order under one noise and the order's prior mean and standard deviation; none where the evidence,
    /// on logarithms, is below `least`.
    pub(super) fn component(
        &self,
        gram: &Gram,
        noise: &Noise,
        [order, spread]: [f64; 2],
        least: f64,
    ) -> Option<Component> {
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
        // p has the precision of the data and that of its prior.
        let prior_precision = 1.0 / (spread * spread);
        let precision = x_x + prior_precision;
        let mean = (x_y + prior_precision * order) / precision;
        let residual = y_y + prior_precision * order * order - precision * mean * mean;
        // Determinants of the covariance and of the two precisions; one logarithm for all.
        let determinants = determinant * precision * spread * spread;
        if noise.log - 0.5 * (below_log(determinants) + residual) < least {
            return None;
        }
        let log_evidence = noise.log - 0.5 * (determinants.ln() + residual);
        (log_evidence > least).then(|| Component {
            log_evidence,
            mean,
            deviation: precision.sqrt().recip(),
        })
    }
}

/// At most log x, by less than log 2: the exponent of x. Most readings need no more to be left out.
fn below_log(x: f64) -> f64 {
    let exponent = (x.to_bits() >> 52) as f64 - 1023.0;
    exponent * std::f64::consts::LN_2
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn the_logarithm_from_below_is_below_by_less_than_that_of_two() {
        for x in [1e-300f64, 3e-9, 0.999, 1.0, 1.5, 2.0, 7e12] {
            let away = x.ln() - below_log(x);
            assert!((-1e-12..=std::f64::consts::LN_2).contains(&away), "{x}: {away}");
        }
    }

    /// The same numbers by dense matrices: Σ inverted, c and p integrated as one normal with a very wide prior of c.
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
            let found = base.component(&gram, &base.noise(s, 0.0), prior, f64::NEG_INFINITY);
            let found = found.expect("an evidence");
            let (log, mean, deviation) = dense(s, prior);
            // The width 1e3 of c leaves 1e-6 of the noise; the covariance has the condition 1e10.
            assert!((found.mean - mean).abs() < 1e-3, "{found:?} {mean}");
            assert!((found.deviation - deviation).abs() < 1e-3, "{found:?} {deviation}");
            differences.push(found.log_evidence - log);
        }
        // Equal up to the constant that all readings share.
        assert!(
            differences.iter().all(|own| (own - differences[0]).abs() < 1e-2),
            "{differences:?}"
        );
    }
}
