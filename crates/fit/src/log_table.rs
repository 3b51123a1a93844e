//! Residuals of an error model and their Jacobian, in logarithms.

use nalgebra::{DMatrix, DVector};

use super::{ErrorCombination, Point};

/// log C_h, log C_k at the centre of the table, p, q, log F, D_h, D_k.
pub(super) type Parameters = [f64; 7];

/// Which parameters are fitted, beside the constants; the others are given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    pub(super) orders: bool,
    pub(super) floor: bool,
    /// D_h and D_k in A = C_h h^p exp(D_h h), B = C_k k^q exp(D_k k²), the next terms in space and of the trapezoidal
    /// rule.
    pub(super) bends: bool,
}

impl Shape {
    /// Places of the fitted parameters.
    pub(super) fn free(self) -> Vec<usize> {
        let fitted = |place: &usize| match place {
            0 | 1 => true,
            2 | 3 => self.orders,
            4 => self.floor,
            _ => self.bends,
        };
        (0..7).filter(fitted).collect()
    }

    pub(super) fn parameters(self) -> usize {
        self.free().len()
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

    /// Residuals log E − log e and their Jacobian by the parameters at these places.
    pub(super) fn residuals(
        &self,
        model: ErrorCombination,
        [c_h, c_k, p, q, floor, d_h, d_k]: Parameters,
        free: &[usize],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let mut residuals = DVector::zeros(self.rows.len());
        let mut jacobian = DMatrix::zeros(self.rows.len(), free.len());
        for (i, row) in self.rows.iter().enumerate() {
            let Row { steps: [h, k], bends: [bend_h, bend_k], error } = *row;
            let terms = [c_h + p * h + d_h * bend_h, c_k + q * k + d_k * bend_k, floor];
            let (log_error, [a, b, f]) = model.combine(terms);
            residuals[i] = log_error - error;
            let gradient: Parameters = [a, b, a * h, b * k, f, a * bend_h, b * bend_k];
            for (j, place) in free.iter().enumerate() {
                jacobian[(i, j)] = gradient[*place];
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
        let yes = [false, true];
        let shapes = yes.into_iter().flat_map(|orders| {
            [(true, true), (true, false), (false, true), (false, false)]
                .map(|(floor, bends)| Shape { orders, floor, bends })
        });
        for shape in shapes {
            let free = shape.free();
            let fitted = [2, usize::from(shape.orders), usize::from(shape.floor)];
            let expected = fitted[0] + 2 * fitted[1] + fitted[2] + 2 * usize::from(shape.bends);
            assert_eq!(shape.parameters(), expected, "{shape:?}");
            for model in [ErrorCombination::Sum, ErrorCombination::RootSumSquare] {
                let (_, jacobian) = table.residuals(model, all, &free);
                for (j, place) in free.iter().enumerate() {
                    let moved = |by: f64| {
                        let mut moved = all;
                        moved[*place] += by;
                        table.residuals(model, moved, &free).0
                    };
                    // Central differences: rounding 1e-16 / 1e-6, truncation 1e-12.
                    let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                    assert!((difference - jacobian.column(j)).norm() < 1e-9);
                }
            }
        }
    }

    /// One point h = k = 1 is its centre: E = C_h exp(D_h) + C_k exp(D_k) + F.
    #[test]
    fn every_parameter_enters_the_model_where_it_should() {
        let table = LogTable::new(&[Point { h: 2.0, k: 3.0, error: 5.0, floor: 0.0 }]);
        let all = [0.3, -0.2, 9.0, 8.0, 0.1, 0.5, -0.4];
        let (residuals, _) = table.residuals(ErrorCombination::Sum, all, &[]);
        let error = 0.8f64.exp() + (-0.6f64).exp() + 0.1f64.exp();
        assert!((residuals[0] - (error / 5.0).ln()).abs() < 1e-15);
        assert_eq!(table.centre, [2f64.ln(), 3f64.ln()]);
    }
}
