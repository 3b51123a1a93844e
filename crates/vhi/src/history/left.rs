//! The left-endpoint rule: the history at t_n uses earlier levels only.

use super::{ClosedForm, TimeGrid, TimeRule};

/// w_nj = k_{j+1} for j < n, w_nn = 0, on any grid; error (k/2)[q(t, s) u(s)]_0^t: order 1. The last slot has no
/// weight, so every step size has one solution per step.
#[derive(Debug, Clone, Copy, Default)]
pub struct Left;

impl TimeRule for Left {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        if j < n { grid.step(j + 1) } else { 0.0 }
    }

    fn last_share(&self) -> f64 {
        0.0
    }

    /// On any grid, with a product of 1 + c_m in place of the power.
    fn closed_form(&self) -> Option<ClosedForm> {
        Some(ClosedForm::Corrected { share: 0.0, beyond: 0.0, most: f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lower rectangles: exact for constants, short of t²/2 by Σ k_j²/2 for v(s) = s.
    #[test]
    fn constants_are_integrated_and_straight_lines_by_what_the_rectangles_miss() {
        for grid in [TimeGrid::uniform(2.0, 7), TimeGrid::graded(2.0, 9, 1.7)] {
            for n in 0..=grid.steps() {
                let t = grid.time(n);
                let sum = |v: fn(f64) -> f64| -> f64 {
                    (0..=n).map(|j| Left.weight(&grid, n, j) * v(grid.time(j))).sum()
                };
                assert!((sum(|_| 1.0) - t).abs() < 1e-14);
                let missed: f64 = (1..=n).map(|j| 0.5 * grid.step(j).powi(2)).sum();
                assert!((sum(|s| s) + missed - 0.5 * t * t).abs() < 1e-14);
                assert_eq!(Left.weight(&grid, n, n), Left.last_share());
            }
        }
    }
}
