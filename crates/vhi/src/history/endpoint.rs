//! The endpoint rules: rectangles whose height is the value at one end of each step. Order 1, on any grid.

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

/// w_n0 = 0, w_nj = k_j for j ≥ 1, on any grid; error -(k/2)[q(t, s) u(s)]_0^t: order 1. For q = 1 it is the displacement
/// of backward Euler, u_n = u_{n-1} + k_n w_n, as the sum of the velocities w.
#[derive(Debug, Clone, Copy, Default)]
pub struct Right;

impl TimeRule for Right {
    fn weight(&self, grid: &TimeGrid, _n: usize, j: usize) -> f64 {
        if j > 0 { grid.step(j) } else { 0.0 }
    }

    fn last_share(&self) -> f64 {
        1.0
    }

    /// E_n is s times the product of 1/(1 - c_m) = 1 + c_m/(1 - c_m), m ≤ n, if s is constant, on any grid; the first has
    /// no sum before it and is 1/(1 - c).
    fn closed_form(&self) -> Option<ClosedForm> {
        Some(ClosedForm::Corrected { share: 1.0, beyond: 0.0, most: f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rectangles: exact for constants; below t²/2 at the left ends and above at the right ones by Σ k_j²/2 for v(s) = s.
    #[test]
    fn constants_are_integrated_and_straight_lines_by_what_the_rectangles_miss() {
        let rules: [(&dyn TimeRule, f64); 2] = [(&Left, 1.0), (&Right, -1.0)];
        for (rule, sign) in rules {
            for grid in [TimeGrid::uniform(2.0, 7), TimeGrid::graded(2.0, 9, 1.7)] {
                for n in 0..=grid.steps() {
                    let t = grid.time(n);
                    let sum = |v: fn(f64) -> f64| -> f64 {
                        (0..=n).map(|j| rule.weight(&grid, n, j) * v(grid.time(j))).sum()
                    };
                    assert!((sum(|_| 1.0) - t).abs() < 1e-14);
                    let missed: f64 = (1..=n).map(|j| 0.5 * grid.step(j).powi(2)).sum();
                    assert!((sum(|s| s) + sign * missed - 0.5 * t * t).abs() < 1e-14);
                    let last = if n == 0 { 0.0 } else { grid.step(n) };
                    assert!((rule.weight(&grid, n, n) - rule.last_share() * last).abs() < 1e-15);
                }
            }
        }
    }
}
