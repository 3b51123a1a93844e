//! ζ_n = Σ' ‖ε(u_j)‖, the accumulated strain of (5.11); the sum of the past is kept apart from the implicit last term.

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

    /// ζ at the last committed time; 0 before the first.
    pub fn value(&self, rule: &dyn TimeRule, grid: &TimeGrid) -> f64 {
        if rule.is_trapezoidal() {
            return self.integral;
        }
        let n = self.values.len().saturating_sub(1);
        self.values.iter().enumerate().map(|(j, z)| rule.weight(grid, n, j) * z).sum()
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

#[cfg(test)]
mod tests {
    use super::super::Trapezoid;
    use super::*;

    /// The trapezoidal weights without [`TimeRule::is_trapezoidal`]: the full sum is taken.
    struct Written;
    impl TimeRule for Written {
        fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
            Trapezoid.weight(grid, n, j)
        }
    }

    #[test]
    fn the_running_sum_is_the_sum_in_full_on_any_grid() {
        let grid = TimeGrid::graded(3.0, 6, 2.0);
        let z = |n: usize| 1.0 + grid.time(n).powi(2);
        let mut zeta = Accumulated::default();
        assert_eq!((zeta.past(&Trapezoid, &grid), zeta.past(&Written, &grid)), (0.0, 0.0));
        for n in 0..=grid.steps() {
            let past: f64 = (0..n).map(|j| Trapezoid.weight(&grid, n, j) * z(j)).sum();
            assert!((zeta.past(&Trapezoid, &grid) - past).abs() < 1e-13, "{n}");
            assert!((zeta.past(&Written, &grid) - past).abs() < 1e-13, "{n}");
            zeta.commit(&grid, z(n));
            let whole: f64 = (0..=n).map(|j| Trapezoid.weight(&grid, n, j) * z(j)).sum();
            for rule in [&Trapezoid as &dyn TimeRule, &Written] {
                assert!((zeta.value(rule, &grid) - whole).abs() < 1e-13, "{n}");
            }
        }
    }
}
