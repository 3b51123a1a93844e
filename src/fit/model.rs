//! Error models of two steps: sum and root-sum-square.

use nalgebra::{DMatrix, DVector};

use super::Point;

/// E = (A^m + B^m + F^m)^(1/m) with A = C_h h^p, B = C_k k^q and an optional floor F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// m = 1: the triangle inequality attained.
    Sum,
    /// m = 2: space and time error nearly orthogonal.
    RootSumSquare,
}

impl Model {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sum => "sum",
            Self::RootSumSquare => "root-sum-square",
        }
    }

    fn exponent(self) -> f64 {
        match self {
            Self::Sum => 1.0,
            Self::RootSumSquare => 2.0,
        }
    }

    /// log E and the weights ∂ log E / ∂ log A, … of terms given by their logarithms: a local
    /// slope is the mean of the orders with these weights.
    pub(super) fn combine<const T: usize>(self, log_terms: [f64; T]) -> (f64, [f64; T]) {
        let m = self.exponent();
        let largest = log_terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let parts = log_terms.map(|term| (m * (term - largest)).exp());
        let total: f64 = parts.iter().sum();
        (largest + total.ln() / m, parts.map(|part| part / total))
    }
}

/// The parameters of a fit beside log C_h, log C_k, p and q.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Extra {
    /// log F.
    pub(super) floor: bool,
    /// D_h and D_k in A = C_h h^p exp(D_h h), B = C_k k^q exp(D_k k²): the next terms of the
    /// expansions of the space error and of the trapezoidal rule's.
    pub(super) bends: bool,
}

impl Extra {
    /// Number of all parameters.
    pub(super) fn parameters(self) -> usize {
        4 + usize::from(self.floor) + 2 * usize::from(self.bends)
    }
}

/// One point on logarithms.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// log h and log k, less their means over the table: better for the condition.
    steps: [f64; 2],
    /// h and k², largest 1.
    bends: [f64; 2],
    /// log e.
    pub(super) error: f64,
}

/// The points of a fit.
pub(super) struct LogTable {
    pub(super) rows: Vec<Row>,
    /// Means of log h and log k.
    pub(super) centre: [f64; 2],
}

impl LogTable {
    pub(super) fn new(points: &[Point]) -> Self {
        let count = points.len().max(1) as f64;
        let mean = |f: fn(&Point) -> f64| points.iter().map(f).sum::<f64>() / count;
        let centre = [mean(|point| point.h.ln()), mean(|point| point.k.ln())];
        let largest = |f: fn(&Point) -> f64| points.iter().map(f).fold(0.0, f64::max);
        let (h, k) = (largest(|point| point.h), largest(|point| point.k));
        let row = |point: &Point| Row {
            steps: [point.h.ln() - centre[0], point.k.ln() - centre[1]],
            bends: [point.h / h, (point.k / k).powi(2)],
            error: point.error.ln(),
        };
        Self { rows: points.iter().map(row).collect(), centre }
    }

    /// Residuals log E − log e and their Jacobian in (log C_h, log C_k, p, q[, log F][, D_h,
    /// D_k]), the constants at the centre of the table.
    pub(super) fn residuals(
        &self,
        model: Model,
        extra: Extra,
        x: &DVector<f64>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let mut residuals = DVector::zeros(self.rows.len());
        let mut jacobian = DMatrix::zeros(self.rows.len(), x.len());
        let bent = 4 + usize::from(extra.floor);
        for (i, Row { steps: [h, k], bends: [bend_h, bend_k], error }) in
            self.rows.iter().copied().enumerate()
        {
            let floor = if extra.floor { x[4] } else { f64::NEG_INFINITY };
            let [d_h, d_k] = if extra.bends { [x[bent], x[bent + 1]] } else { [0.0; 2] };
            let space = x[0] + x[2] * h + d_h * bend_h;
            let time = x[1] + x[3] * k + d_k * bend_k;
            let (log_error, [a, b, f]) = model.combine([space, time, floor]);
            residuals[i] = log_error - error;
            let floor = extra.floor.then_some(f);
            let bends = if extra.bends { vec![a * bend_h, b * bend_k] } else { Vec::new() };
            let columns = [a, b, a * h, b * k].into_iter().chain(floor).chain(bends);
            for (j, value) in columns.enumerate() {
                jacobian[(i, j)] = value;
            }
        }
        (residuals, jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_combine_with_their_weights() {
        let (log_error, weights) = Model::Sum.combine([3f64.ln(), 0.0]);
        // Single roundings.
        assert!((log_error - 4f64.ln()).abs() < 1e-15 && (weights[0] - 0.75).abs() < 1e-15);
        let (log_error, weights) = Model::RootSumSquare.combine([3f64.ln(), 4f64.ln()]);
        assert!((log_error - 5f64.ln()).abs() < 1e-15 && (weights[1] - 0.64).abs() < 1e-15);
        assert!(Model::Sum.combine([900.0, -900.0]).0.is_finite());
    }

    #[test]
    fn the_jacobian_agrees_with_central_differences() {
        let points = [(0.5, 0.3, 1.0), (0.2, 0.1, 0.3), (0.1, 0.25, 0.2)]
            .map(|(h, k, error)| Point { h, k, error, floor: 0.0 });
        let table = LogTable::new(&points);
        let x = DVector::from_vec(vec![-1.0, -1.5, 1.2, 1.8, -3.0, 0.4, -0.7]);
        let extra = Extra { floor: true, bends: true };
        for model in [Model::Sum, Model::RootSumSquare] {
            let (_, jacobian) = table.residuals(model, extra, &x);
            for j in 0..extra.parameters() {
                let step = DVector::from_fn(x.len(), |i, _| if i == j { 1e-6 } else { 0.0 });
                let (up, _) = table.residuals(model, extra, &(&x + &step));
                let (down, _) = table.residuals(model, extra, &(&x - &step));
                // Central differences: rounding 1e-16 / 1e-6, truncation 1e-12.
                assert!(((up - down) / 2e-6 - jacobian.column(j)).norm() < 1e-9);
            }
        }
    }
}
