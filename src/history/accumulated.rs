//! ζ_n = Σ' ‖ε(u_j)‖, the accumulated strain of (5.11), with the sum of the past kept apart from
//! the implicit last term.

use super::{TimeGrid, TimeRule};

/// Committed norms of the past and the sums over them.
#[derive(Debug, Clone, Default)]
pub struct Accumulated {
    values: Vec<f64>,
    /// Trapezoidal integral up to the last committed time.
    integral: f64,
}

impl Accumulated {
    /// Σ_{j < n} w_{nj} z_j for the next step n.
    pub fn past(&self, rule: &dyn TimeRule, grid: &TimeGrid) -> f64 {
        let n = self.values.len();
        if n == 0 {
            0.0
        } else if rule.is_trapezoidal() {
            self.integral + 0.5 * grid.step(n) * self.values[n - 1]
        } else {
            self.values.iter().enumerate().map(|(j, z)| rule.weight(grid, n, j) * z).sum()
        }
    }

    /// The trapezoidal integral up to the last committed time.
    pub fn value(&self) -> f64 {
        self.integral
    }

    /// Appends z_n.
    pub fn commit(&mut self, grid: &TimeGrid, value: f64) {
        let n = self.values.len();
        if n > 0 {
            self.integral += 0.5 * grid.step(n) * (self.values[n - 1] + value);
        }
        self.values.push(value);
    }
}
