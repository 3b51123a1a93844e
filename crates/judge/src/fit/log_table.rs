//! Residuals of an error model and their Jacobian, in logarithms.

use nalgebra::{DMatrix, DVector};

use super::{ErrorCombination, Point};

/// Fitted parameters, in this order: log C_h, log C_k[, p, q][, log F][, D_h, D_k].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    pub(super) orders: Option<(f64, f64)>,
    pub(super) floor: bool,
    /// Fits D_h and D_k in A = C_h h^p exp(D_h h), B = C_k k^q exp(D_k k²), the next terms in space and of the
    /// trapezoidal rule.
    pub(super) bends: bool,
}

const MOST: usize = 7;

impl Shape {
    pub(super) fn parameters(self) -> usize {
        self.bends_at() + 2 * usize::from(self.bends)
    }

    pub(super) fn floor_at(self) -> usize {
        if self.orders.is_some() { 2 } else { 4 }
    }

    fn bends_at(self) -> usize {
        self.floor_at() + usize::from(self.floor)
    }

    pub(super) fn orders_of(self, x: &DVector<f64>) -> (f64, f64) {
        self.orders.unwrap_or_else(|| (x[2], x[3]))
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// log h and log k less their means, for the condition.
    steps: [f64; 2],
    /// h and k², scaled to maximum 1.
    bends: [f64; 2],
    pub(super) error: f64,
}

pub(super) struct LogTable {
    pub(super) rows: Vec<Row>,
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

    /// Residuals log E − log e and their Jacobian; constants refer to the centre of the table.
    pub(super) fn residuals(
        &self,
        model: ErrorCombination,
        shape: Shape,
        x: &DVector<f64>,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let mut residuals = DVector::zeros(self.rows.len());
        let mut jacobian = DMatrix::zeros(self.rows.len(), x.len());
        let (p, q) = shape.orders_of(x);
        let floor = if shape.floor { x[shape.floor_at()] } else { f64::NEG_INFINITY };
        let bent = shape.bends_at();
        let [d_h, d_k] = if shape.bends { [x[bent], x[bent + 1]] } else { [0.0; 2] };
        for (i, row) in self.rows.iter().enumerate() {
            let Row { steps: [h, k], bends: [bend_h, bend_k], error } = *row;
            let space = x[0] + p * h + d_h * bend_h;
            let time = x[1] + q * k + d_k * bend_k;
            let (log_error, [a, b, f]) = model.combine([space, time, floor]);
            residuals[i] = log_error - error;
            let mut gradient = [0.0; MOST];
            gradient[..2].copy_from_slice(&[a, b]);
            if shape.orders.is_none() {
                gradient[2..4].copy_from_slice(&[a * h, b * k]);
            }
            if shape.floor {
                gradient[shape.floor_at()] = f;
            }
            if shape.bends {
                gradient[bent..bent + 2].copy_from_slice(&[a * bend_h, b * bend_k]);
            }
            for (j, value) in gradient.into_iter().take(x.len()).enumerate() {
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
    fn the_jacobian_agrees_with_central_differences() {
        let points = [(0.5, 0.3, 1.0), (0.2, 0.1, 0.3), (0.1, 0.25, 0.2)]
            .map(|(h, k, error)| Point { h, k, error, floor: 0.0 });
        let table = LogTable::new(&points);
        let all = [-1.0, -1.5, 1.2, 1.8, -3.0, 0.4, -0.7];
        let shapes = [None, Some((1.2, 1.8))].into_iter().flat_map(|orders| {
            [(true, true), (true, false), (false, true), (false, false)]
                .map(|(floor, bends)| Shape { orders, floor, bends })
        });
        for shape in shapes {
            let serves = |i: &usize| match i {
                2 | 3 => shape.orders.is_none(),
                4 => shape.floor,
                5 | 6 => shape.bends,
                _ => true,
            };
            let x: Vec<f64> = (0..MOST).filter(serves).map(|i| all[i]).collect();
            let x = DVector::from_vec(x);
            assert_eq!(x.len(), shape.parameters(), "{shape:?}");
            for model in [ErrorCombination::Sum, ErrorCombination::RootSumSquare] {
                let (_, jacobian) = table.residuals(model, shape, &x);
                for j in 0..x.len() {
                    let step = DVector::from_fn(x.len(), |i, _| if i == j { 1e-6 } else { 0.0 });
                    let (up, _) = table.residuals(model, shape, &(&x + &step));
                    let (down, _) = table.residuals(model, shape, &(&x - &step));
                    // Central differences: rounding 1e-16 / 1e-6, truncation 1e-12.
                    assert!(((up - down) / 2e-6 - jacobian.column(j)).norm() < 1e-9);
                }
            }
        }
    }

    /// One point h = k = 1 is its centre: E = C_h exp(D_h) + C_k exp(D_k) + F.
    #[test]
    fn every_parameter_enters_the_model_where_it_should() {
        let table = LogTable::new(&[Point { h: 2.0, k: 3.0, error: 5.0, floor: 0.0 }]);
        let x = DVector::from_vec(vec![0.3, -0.2, 9.0, 8.0, 0.1, 0.5, -0.4]);
        let shape = Shape { orders: None, floor: true, bends: true };
        let (residuals, _) = table.residuals(ErrorCombination::Sum, shape, &x);
        let error = 0.8f64.exp() + (-0.6f64).exp() + 0.1f64.exp();
        assert!((residuals[0] - (error / 5.0).ln()).abs() < 1e-15);
        assert_eq!(table.centre, [2f64.ln(), 3f64.ln()]);
    }
}
