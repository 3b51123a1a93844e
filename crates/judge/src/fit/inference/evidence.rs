//! Evidence and order of one reading: a linear model with normal noise, in closed form.
//!
//! y = c + p x + a v + b u + N(0, s² τ_i²), a, b ~ N(0, 1), c flat, p normal. With the covariance
//! Σ = s² diag(τ²) + v vᵀ + u uᵀ every product aᵀ Σ⁻¹ b is one of the Gram matrix of (1, x, y, v, u) with weights 1/τ²,
//! by Woodbury's formula with a 2 × 2 matrix: the sums over the levels are made once for all s.

/// Sums over levels of products of 1, x, y, v and u, with weights.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gram {
    /// Rows 1, x, y against 1, x, y.
    data: [[f64; 3]; 3],
    /// Rows 1, x, y against v, u.
    mixed: [[f64; 2]; 3],
    /// v, u against v, u.
    nuisance: [[f64; 2]; 2],
    /// Number of levels, and Σ log τ².
    count: f64,
    log_scales: f64,
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

impl Gram {
    /// Adds a level with scale τ of its noise.
    pub(super) fn add(&mut self, [x, y, v, u]: [f64; 4], scale: f64) {
        let weight = 1.0 / (scale * scale);
        let (data, nuisance) = ([1.0, x, y], [v, u]);
        for i in 0..3 {
            for j in 0..3 {
                self.data[i][j] += weight * data[i] * data[j];
            }
            for j in 0..2 {
                self.mixed[i][j] += weight * data[i] * nuisance[j];
            }
        }
        for i in 0..2 {
            for j in 0..2 {
                self.nuisance[i][j] += weight * nuisance[i] * nuisance[j];
            }
        }
        self.count += 1.0;
        self.log_scales += 2.0 * scale.ln();
    }

    /// Evidence and order for the noise `s` and the order's prior mean and standard deviation.
    pub(super) fn component(&self, s: f64, [order, spread]: [f64; 2]) -> Component {
        let variance = s * s;
        let [[a, b], [_, d]] = self.nuisance;
        let (a, d) = (a + variance, d + variance);
        let determinant = a * d - b * b;
        let product = |i: usize, j: usize| {
            let ([vi, ui], [vj, uj]) = (self.mixed[i], self.mixed[j]);
            let reduced = (vi * (d * vj - b * uj) + ui * (a * uj - b * vj)) / determinant;
            (self.data[i][j] - reduced) / variance
        };
        let (one, x_one, x_x) = (product(0, 0), product(0, 1), product(1, 1));
        let (y_one, y_x, y_y) = (product(0, 2), product(1, 2), product(2, 2));
        // c is projected out; then p has the precision of the data and that of its prior.
        let data_precision = x_x - x_one * x_one / one;
        let prior_precision = 1.0 / (spread * spread);
        let precision = data_precision + prior_precision;
        let at_data = y_x - x_one * y_one / one;
        let mean = (at_data + prior_precision * order) / precision;
        let residual =
            y_y - y_one * y_one / one + prior_precision * order * order - precision * mean * mean;
        // Determinants of the covariance and of the two precisions; one logarithm for all.
        let determinants = determinant * one * precision * spread * spread;
        let log_evidence = -0.5
            * (self.count * std::f64::consts::TAU.ln()
                + (self.count - 2.0) * variance.ln()
                + self.log_scales
                + determinants.ln()
                + residual);
        Component { log_evidence, mean, deviation: precision.sqrt().recip() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

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
        let mut gram = Gram::default();
        rows.iter().zip(scales).for_each(|(row, scale)| gram.add(*row, scale));
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
            let (found, (log, mean, deviation)) = (gram.component(s, prior), dense(s, prior));
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
