//! Times and trapezoidal weights of a scene's grid.

use scene::{Time, TimeGrid};
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

/// The weight of t_j in Σ' up to t_n: half of each adjacent step.
pub(super) fn weight(times: &[f64], n: usize, j: usize) -> f64 {
    let before = if j > 0 { times[j] - times[j - 1] } else { 0.0 };
    let after = if j < n { times[j + 1] - times[j] } else { 0.0 };
    0.5 * (before + after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_integrate_linear_functions_on_any_grid() {
        let times = [0.0, 0.1, 0.35, 0.5, 0.9];
        for n in 0..times.len() {
            let sum: f64 = (0..=n).map(|j| weight(&times, n, j) * (1.0 + times[j])).sum();
            assert!((sum - times[n] - 0.5 * times[n] * times[n]).abs() < 1e-15);
        }
        assert!((largest_step(&times) - 0.4).abs() < 1e-15);
    }
}
