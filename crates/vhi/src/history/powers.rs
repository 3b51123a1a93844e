//! Moments of (t_n - s)^{-a} over one step, the weights of kernels that are infinite at s = t_n.

use crate::law::GAUSS;

/// ∫ λ^{-a} φ(λ) over the lags near < λ < near + step, for the hat functions φ of the far and the near end of the step,
/// 0 ≤ a < 1.
///
/// Differences of powers lose (near/step)² roundings: 4e-8 of a weight on t_j = T (j/N)^4 with N = 1024. If the step is
/// no longer than its distance from lag zero, Gauss's rule with 10 points is used; its error (3 + √8)^{-20} is
/// rounding.
pub(super) fn moments(a: f64, near: f64, step: f64) -> (f64, f64) {
    let (one, two) = (1.0 - a, 2.0 - a);
    if near <= 0.0 {
        let power = step.powf(one);
        return (power / two, power / (one * two));
    }
    if step <= near {
        let parts = GAUSS.iter().map(|(x, weight)| {
            let value = weight * step * (near + step * x).powf(-a);
            (value * x, value * (1.0 - x))
        });
        return parts.fold((0.0, 0.0), |sums, (far, near_end)| (sums.0 + far, sums.1 + near_end));
    }
    let far = near + step;
    let zeroth = (far.powf(one) - near.powf(one)) / one;
    let first = (far.powf(two) - near.powf(two)) / two;
    ((first - near * zeroth) / step, (far * zeroth - first) / step)
}

#[cfg(test)]
mod tests {
    use super::moments;
    use crate::history::{ProductIntegration, TimeGrid, TimeRule};
    use crate::law::{Convolution, ExponentialSum, Singular};

    const POWERS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
    /// Rounding of a power and of ten terms; of a closed form with a factor 10 from a - 1 and cancellation.
    const EXACT: f64 = 2e-14;

    fn row(a: f64, grid: &TimeGrid, n: usize) -> Vec<f64> {
        let factor = Box::new(ExponentialSum { terms: vec![(1.0, 0.0)] });
        ProductIntegration.kernel_row(&Convolution(&Singular { power: a, factor }), grid, n)
    }

    /// Hat functions sum to 1, and weighted by the times to s: t^{1-a}/(1-a), t^{2-a}/((1-a)(2-a)).
    #[test]
    fn straight_lines_are_integrated_exactly_on_any_grid() {
        let grids = [
            TimeGrid::uniform(3.0, 1024),
            TimeGrid::graded(2.0, 1024, 4.0),
            TimeGrid::graded(1.0, 1024, 10.0 / 3.0),
            TimeGrid::random(1.0, 300, 5),
        ];
        for grid in &grids {
            for a in POWERS {
                for n in [1, 2, 3, 17, grid.steps() / 2, grid.steps()] {
                    let (row, t) = (row(a, grid, n), grid.time(n));
                    let sum = |v: &dyn Fn(f64) -> f64| -> f64 {
                        row.iter().zip(grid.times()).map(|(w, s)| w * v(*s)).sum()
                    };
                    let ones = sum(&|_| 1.0) * (1.0 - a) / t.powf(1.0 - a);
                    let lines = sum(&|s| s) * (1.0 - a) * (2.0 - a) / t.powf(2.0 - a);
                    // A thousand positive terms, each to EXACT, and the rounding of lags of uniform steps.
                    assert!((ones - 1.0).abs() < 1e-13, "{a} {n}: {}", ones - 1.0);
                    assert!((lines - 1.0).abs() < 1e-13, "{a} {n}: {}", lines - 1.0);
                }
            }
        }
    }

    /// ∫ φ_j(s) (t_n - s)^{-a} ds by the series of the power about t_j, if both adjacent steps are short.
    fn by_series(a: f64, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        let (before, after) = (grid.step(j), grid.step(j + 1));
        let lag = grid.lag(n, j);
        let (mut sum, mut factor) = (0.0, lag.powf(-a));
        for i in 0..40 {
            let degree = f64::from(i);
            // ∫ φ_j(s) (s - t_j)^i ds.
            let share = 1.0 / ((degree + 1.0) * (degree + 2.0));
            sum += factor * share * (after.powi(i + 1) - (-before).powi(i + 1));
            factor *= (a + degree) / ((degree + 1.0) * lag);
        }
        sum
    }

    /// Each weight to rounding, where the second difference of powers loses nine digits.
    #[test]
    fn weights_of_short_steps_far_away_keep_their_digits() {
        let grid = TimeGrid::graded(1.0, 1024, 4.0);
        let n = grid.steps();
        for a in POWERS {
            let (row, mut lost) = (row(a, &grid, n), 0.0f64);
            let short = |j: &usize| grid.step(j + 1) < 0.4 * grid.lag(n, j + 1);
            let mut count = 0;
            for j in (1..n - 1).filter(short) {
                let expected = by_series(a, &grid, n, j);
                assert!((row[j] / expected - 1.0).abs() < EXACT, "{a} {j}: {}", row[j] / expected);
                let bend = |j: usize| grid.lag(n, j).powf(2.0 - a) / ((1.0 - a) * (2.0 - a));
                let plain = (bend(j + 1) - bend(j)) / grid.step(j + 1)
                    - (bend(j) - bend(j - 1)) / grid.step(j);
                lost = lost.max((plain / expected - 1.0).abs());
                count += 1;
            }
            assert!(count > 1000 && lost > 1e-9, "{a}: {count}, the plain formula loses {lost:e}");
        }
    }

    /// The three formulas agree at their limits: beside lag zero, and at the length where they switch.
    #[test]
    fn the_three_ways_agree_where_they_meet() {
        for a in POWERS {
            let [closed, gauss] = [1.0 - 1e-15, 1.0].map(|near| moments(a, near, 1.0));
            let [zero, beside] = [0.0, 1e-300].map(|near| moments(a, near, 1.0));
            for (x, y) in [(closed, gauss), (zero, beside)] {
                assert!((x.0 / y.0 - 1.0).abs() < EXACT, "{a}: {x:?} {y:?}");
                assert!((x.1 / y.1 - 1.0).abs() < EXACT, "{a}: {x:?} {y:?}");
            }
        }
    }

    /// w_nn = k^{1-a}/((1-a)(2-a)) times the factor at lag zero, as in (3.4); half a step for a = 0.
    #[test]
    fn the_last_weight_is_the_one_of_the_step_bound() {
        let grid = TimeGrid::graded(1.0, 16, 2.0);
        for a in POWERS {
            for n in 1..=16 {
                let last_weight = ProductIntegration.last_weight(a, grid.step(n));
                assert!((row(a, &grid, n)[n] / last_weight - 1.0).abs() < 1e-15);
            }
        }
        assert_eq!(ProductIntegration.last_weight(0.0, 0.25), 0.125);
    }
}
