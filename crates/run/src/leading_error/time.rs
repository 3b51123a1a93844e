//! Times of a scene's grid, and the weights of its rule, written apart from those of the solver.

use super::NoConstant;
use scene::{Time, TimeGrid, TimeRule};
use vhi::history::TimeGrid as Steps;

/// t_0, …, t_N. A random grid is defined by its generator, which is shared.
pub(super) fn times(time: &Time, steps: u32) -> Vec<f64> {
    let share = |j: u32| f64::from(j) / f64::from(steps);
    match time.grid {
        TimeGrid::Uniform => (0..=steps).map(|j| time.horizon * share(j)).collect(),
        TimeGrid::Graded { exponent } => {
            (0..=steps).map(|j| time.horizon * share(j).powf(exponent)).collect()
        }
        TimeGrid::Random { seed } => Steps::random(time.horizon, steps, seed).times().to_vec(),
    }
}

/// max_j (t_j - t_{j-1}).
pub(super) fn largest_step(times: &[f64]) -> f64 {
    times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
}

/// The weights of a rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Weights {
    /// Half of each adjacent step.
    Trapezoid,
    /// The step after t_j.
    Left,
}

impl Weights {
    /// Those of a rule whose weights do not depend on the kernel.
    ///
    /// # Errors
    /// [`NoConstant::Rule`].
    pub(super) fn of(rule: TimeRule) -> Result<Self, NoConstant> {
        match rule {
            TimeRule::Trapezoid => Ok(Self::Trapezoid),
            TimeRule::Left => Ok(Self::Left),
            TimeRule::CorrectedEnd { .. } | TimeRule::ProductIntegration => Err(NoConstant::Rule),
        }
    }

    /// The weight of t_j in the sum up to t_n.
    pub(super) fn at(self, times: &[f64], n: usize, j: usize) -> f64 {
        let before = if j > 0 { times[j] - times[j - 1] } else { 0.0 };
        let after = if j < n { times[j + 1] - times[j] } else { 0.0 };
        match self {
            Self::Trapezoid => 0.5 * (before + after),
            Self::Left => after,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_integrate_what_the_rules_are_made_for_on_any_grid() {
        let times = [0.0, 0.1, 0.35, 0.5, 0.9];
        for n in 0..times.len() {
            let sum = |rule: Weights, slope: f64| -> f64 {
                (0..=n).map(|j| rule.at(&times, n, j) * (1.0 + slope * times[j])).sum()
            };
            let line = times[n] + 0.5 * times[n] * times[n];
            assert!((sum(Weights::Trapezoid, 1.0) - line).abs() < 1e-15);
            assert!((sum(Weights::Left, 0.0) - times[n]).abs() < 1e-15);
            let missed: f64 = times[..=n].windows(2).map(|k| 0.5 * (k[1] - k[0]).powi(2)).sum();
            assert!((sum(Weights::Left, 1.0) + missed - line).abs() < 1e-15);
        }
        assert!((largest_step(&times) - 0.4).abs() < 1e-15);
    }
}
