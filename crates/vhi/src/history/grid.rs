//! Time grids 0 = t_0 < … < t_N = T and the quadrature weights of the history integrals.

use crate::law::HistoryKernel;
use algebra::linalg::signed_unit;

/// A time grid.
#[derive(Debug, Clone, PartialEq)]
pub struct TimeGrid {
    times: Vec<f64>,
    /// T/N if all steps are equal up to rounding of their ends: equal weights are then bitwise equal, and a matrix that
    /// depends on them is factorized once.
    equal: Option<f64>,
}

/// The time points t_0 = 0 < … < t_N = T for each N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GridFamily {
    /// t_j = T j/N.
    Uniform,
    /// t_j = T (j/N)^exponent, exponent ≥ 1: fine near t = 0.
    Graded { exponent: f64 },
    /// Steps drawn from [½, 3/2] mean steps by a seeded generator.
    Random { seed: u64 },
}

impl GridFamily {
    /// The grid of N steps up to T.
    ///
    /// # Errors
    /// [`GridError`], as [`TimeGrid::new`].
    pub fn grid(self, horizon: f64, steps: u32) -> Result<TimeGrid, GridError> {
        let share = |n: u32| f64::from(n) / f64::from(steps.max(1));
        TimeGrid::new(match self {
            Self::Uniform => {
                (0..=steps).map(|n| horizon * f64::from(n) / f64::from(steps.max(1))).collect()
            }
            Self::Graded { exponent } => {
                (0..=steps).map(|n| horizon * share(n).powf(exponent)).collect()
            }
            Self::Random { seed } => {
                let (mut state, mut times) = (seed, vec![0.0]);
                for n in 0..steps as usize {
                    times.push(times[n] + 1.0 + 0.5 * signed_unit(&mut state));
                }
                let total = times[steps as usize];
                times[1..].iter_mut().for_each(|time| *time *= horizon / total);
                times
            }
        })
    }

    fn expect(self, horizon: f64, steps: u32) -> TimeGrid {
        self.grid(horizon, steps).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// Why times are no grid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GridError {
    #[error("the times of a grid begin with {first:e}, not with 0")]
    Start { first: f64 },
    #[error("a horizon of {horizon:e} is too short: steps would be rounding of the least doubles")]
    Short { horizon: f64 },
    #[error(
        "step {n} of {steps} goes from t = {from:e} to {to:e}, which is not above rounding of the horizon {horizon:e}"
    )]
    Step { n: usize, steps: usize, from: f64, to: f64, horizon: f64 },
}

/// Shortest step over the horizon: t_n - t_j is known to an ε of T, and weights are differences of such lags.
const SHORTEST: f64 = 4.0 * f64::EPSILON;

impl TimeGrid {
    /// Times from 0 on, each step above rounding of the last.
    ///
    /// # Errors
    /// [`GridError`].
    pub fn new(times: Vec<f64>) -> Result<Self, GridError> {
        let (first, horizon) = (times.first().copied(), times.last().copied().unwrap_or(0.0));
        if first != Some(0.0) {
            return Err(GridError::Start { first: first.unwrap_or(f64::NAN) });
        }
        let (shortest, steps) = (SHORTEST * horizon, times.len() - 1);
        if steps > 0 && (shortest.is_nan() || shortest < f64::MIN_POSITIVE) {
            return Err(GridError::Short { horizon });
        }
        for (n, pair) in (1..).zip(times.windows(2)) {
            let (from, to) = (pair[0], pair[1]);
            let step = to - from;
            if step.is_nan() || step <= shortest {
                return Err(GridError::Step { n, steps, from, to, horizon });
            }
        }
        Ok(Self::of(times))
    }

    /// t_n = n T / N.
    ///
    /// # Panics
    /// Where [`GridFamily::grid`] refuses.
    pub fn uniform(horizon: f64, steps: u32) -> Self {
        GridFamily::Uniform.expect(horizon, steps)
    }

    /// t_n = T (n/N)^r.
    ///
    /// # Panics
    /// Where [`GridFamily::grid`] refuses.
    pub fn graded(horizon: f64, steps: u32, exponent: f64) -> Self {
        GridFamily::Graded { exponent }.expect(horizon, steps)
    }

    /// Steps drawn from [½, 3/2] mean steps by a seeded generator, scaled to end at T.
    ///
    /// # Panics
    /// Where [`GridFamily::grid`] refuses.
    pub fn random(horizon: f64, steps: u32, seed: u64) -> Self {
        GridFamily::Random { seed }.expect(horizon, steps)
    }

    fn of(times: Vec<f64>) -> Self {
        let (end, count) = (times[times.len() - 1], times.len() - 1);
        let k = end / count as f64;
        let near = |pair: &[f64]| (pair[1] - pair[0] - k).abs() <= 4.0 * f64::EPSILON * end;
        let equal = (count > 0 && times.windows(2).all(near)).then_some(k);
        Self { times, equal }
    }

    /// Number of steps N.
    pub fn steps(&self) -> usize {
        self.times.len() - 1
    }

    /// t_n.
    pub fn time(&self, n: usize) -> f64 {
        self.times[n]
    }

    /// All times t_0, …, t_N.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// k_n = t_n - t_{n-1}, n ≥ 1.
    pub fn step(&self, n: usize) -> f64 {
        self.equal.unwrap_or(self.times[n] - self.times[n - 1])
    }

    /// t_n - t_j, n ≥ j; on equal steps a multiple of them.
    pub fn lag(&self, n: usize, j: usize) -> f64 {
        self.equal.map_or(self.times[n] - self.times[j], |k| (n - j) as f64 * k)
    }

    /// Whether all steps are equal up to rounding of their ends.
    pub fn is_uniform(&self) -> bool {
        self.equal.is_some()
    }

    /// k, the largest step.
    pub fn largest_step(&self) -> f64 {
        (1..self.times.len()).map(|n| self.step(n)).fold(0.0, f64::max)
    }
}

/// Weights of ∫_0^{t_n} Z(s) ds ≈ Σ_{j ≤ n} w_{nj} Z(t_j).
pub trait TimeRule: Send + Sync {
    /// w_{nj}, 0 ≤ j ≤ n; all zero for n = 0.
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64;

    /// The weight of v(t_j) in ∫_0^{t_n} q(t_n, s) v(s) ds: w_{nj} q(t_n, t_j), unless the rule integrates the kernel
    /// otherwise.
    fn kernel_weight(
        &self,
        kernel: &dyn HistoryKernel,
        grid: &TimeGrid,
        n: usize,
        j: usize,
    ) -> f64 {
        match self.weight(grid, n, j) {
            // A kernel may be infinite where it has no weight.
            0.0 => 0.0,
            weight => weight * kernel.at(grid.time(n), grid.time(j)),
        }
    }

    /// The weights of v(t_0), …, v(t_n) in this integral.
    fn kernel_row(&self, kernel: &dyn HistoryKernel, grid: &TimeGrid, n: usize) -> Vec<f64> {
        (0..=n).map(|j| self.kernel_weight(kernel, grid, n, j)).collect()
    }

    /// The largest w_nn over the step before t_n, which enters (3.4) and the bounds on the last slot.
    fn last_share(&self) -> f64 {
        0.5
    }

    /// The weight w_nn of a last step k for a kernel (t - s)^{-a} b(t, s), over b(t, t).
    fn last_weight(&self, _power: f64, k: f64) -> f64 {
        self.last_share() * k
    }

    /// Whether the weights are those of [`Trapezoid`], so that recursions may replace sums.
    fn is_trapezoidal(&self) -> bool {
        false
    }

    /// What bounds Gronwall's inequality with these weights. None without such a bound, and where weights depend on the
    /// kernel in another way than by its power.
    fn closed_form(&self) -> Option<ClosedForm> {
        None
    }
}

/// Bounds of E_n in E_n = s_n + C2 Σ_{j ≤ n} w_nj E_j by max s, with c = C2 k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClosedForm {
    /// That of the paper, by the trapezoidal rule on any grid: 1/(1 - c/2) ((1 + c/2)/(1 - c/2))^{n-1} on equal steps.
    Paper,
    /// 1/(1 - θ) · (1 + δc/(1 - θ)) · (1 + c/(1 - θ))^{n-1} for c ≤ `most`, θ = `share` c and δ = `beyond`: what the weights
    /// beyond one step and its tail sums beyond whole steps have.
    Corrected { share: f64, beyond: f64, most: f64 },
    /// E_α(C2 Γ(α) t^α/(1 - θ))/(1 - θ), α = 1 - a, θ = C2 k^α/α, by product integration of kernels with (t - s)^{-a}.
    MittagLeffler,
}

/// The trapezoidal rule Σ' of (3.1): half a step at either end, (k_j + k_{j+1})/2 inside.
#[derive(Debug, Clone, Copy, Default)]
pub struct Trapezoid;

impl TimeRule for Trapezoid {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        let before = if j > 0 { grid.step(j) } else { 0.0 };
        let after = if j < n { grid.step(j + 1) } else { 0.0 };
        0.5 * (before + after)
    }

    fn kernel_row(&self, kernel: &dyn HistoryKernel, grid: &TimeGrid, n: usize) -> Vec<f64> {
        let mut row = kernel.row(grid.time(n), &grid.times()[..=n]);
        for (j, value) in row.iter_mut().enumerate() {
            let weight = self.weight(grid, n, j);
            *value = if weight == 0.0 { 0.0 } else { weight * *value };
        }
        row
    }

    fn is_trapezoidal(&self) -> bool {
        true
    }

    fn closed_form(&self) -> Option<ClosedForm> {
        Some(ClosedForm::Paper)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_exact_for_affine_functions_on_any_grid() {
        for grid in [TimeGrid::uniform(2.0, 7), TimeGrid::graded(2.0, 9, 1.7)] {
            for n in 0..=grid.steps() {
                let t = grid.time(n);
                let sum: f64 =
                    (0..=n).map(|j| Trapezoid.weight(&grid, n, j) * (3.0 - grid.time(j))).sum();
                assert!((sum - (3.0 * t - 0.5 * t * t)).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn grids_must_increase_from_zero_by_more_than_rounding() {
        let refused = |times: &[f64]| TimeGrid::new(times.to_vec()).unwrap_err();
        let of_step = |horizon: f64| {
            move |n, steps, from, to| GridError::Step { n, steps, from, to, horizon }
        };
        let step = of_step(0.5);
        assert_eq!(refused(&[0.0, 0.5, 0.5]), step(2, 2, 0.5, 0.5));
        assert_eq!(refused(&[0.0, 1e-16, 0.5]), step(1, 2, 0.0, 1e-16));
        assert_eq!(refused(&[0.1, 0.5]), GridError::Start { first: 0.1 });
        assert_eq!(refused(&[0.0, 5e-324]), GridError::Short { horizon: 5e-324 });
        assert!(TimeGrid::new(vec![0.0, f64::NAN]).is_err() && TimeGrid::new(Vec::new()).is_err());
        // (1/4)^200 T is no step: times would coincide.
        let graded = GridFamily::Graded { exponent: 200.0 };
        assert!(matches!(graded.grid(1.0, 4), Err(GridError::Step { n: 1, .. })));
        for family in [GridFamily::Uniform, graded, GridFamily::Random { seed: 3 }] {
            assert!(family.grid(5e-324, 4).is_err() && family.grid(f64::NAN, 4).is_err());
            assert_eq!(family.grid(2.0, 1).unwrap().times(), [0.0, 2.0]);
        }
        assert_eq!(TimeGrid::new(vec![0.0, 0.2, 1.0]).unwrap().largest_step(), 0.8);
    }

    #[test]
    fn grids_have_the_times_of_their_formulas() {
        assert_eq!(TimeGrid::uniform(2.0, 4).times(), [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(TimeGrid::graded(4.0, 4, 2.0).times(), [0.0, 0.25, 1.0, 2.25, 4.0]);
        let grid = TimeGrid::graded(4.0, 4, 2.0);
        assert_eq!((grid.steps(), grid.step(2), grid.time(3)), (4, 0.75, 2.25));
        assert_eq!(grid.largest_step(), 1.75);
    }

    /// The differences of n/6 take three floating-point values.
    #[test]
    fn equal_steps_are_equal_to_the_last_digit() {
        let grid = TimeGrid::uniform(1.0, 6);
        let differences = grid.times().windows(2).map(|pair| pair[1] - pair[0]);
        assert!(differences.clone().any(|k| k != 1.0 / 6.0));
        for part in [&grid, &TimeGrid::new(grid.times().to_vec()).unwrap()] {
            assert!((1..=part.steps()).all(|n| part.step(n) == 1.0 / 6.0) && part.is_uniform());
        }
        assert!(!TimeGrid::graded(1.0, 6, 1.1).is_uniform());
    }

    /// Steps in the ratios of 1 + draw/2, scaled to the horizon.
    #[test]
    fn random_steps_are_those_of_the_generator() {
        let grid = TimeGrid::random(3.0, 200, 7);
        let mut state = 7;
        let steps: Vec<f64> = (0..200).map(|_| 1.0 + 0.5 * signed_unit(&mut state)).collect();
        let total: f64 = steps.iter().sum();
        for (n, step) in steps.iter().enumerate() {
            assert!((grid.step(n + 1) - 3.0 * step / total).abs() < 1e-14);
        }
        assert!((grid.time(200) - 3.0).abs() < 1e-14);
    }

    /// q(t, s) = s - 2 with a pole at t = 0, where no rule may evaluate it.
    struct Pole;
    impl HistoryKernel for Pole {
        fn at(&self, t: f64, s: f64) -> f64 {
            if t == 0.0 { f64::INFINITY } else { s - 2.0 }
        }
    }

    #[test]
    fn kernels_are_weighted_and_not_asked_where_the_weight_is_zero() {
        struct Plain;
        impl TimeRule for Plain {
            fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
                Trapezoid.weight(grid, n, j)
            }
        }
        let grid = TimeGrid::uniform(1.0, 2);
        for rule in [&Plain as &dyn TimeRule, &Trapezoid] {
            assert_eq!(rule.kernel_row(&Pole, &grid, 0), [0.0]);
            assert_eq!(rule.kernel_row(&Pole, &grid, 2), [-0.5, -0.75, -0.25]);
            assert_eq!(rule.kernel_weight(&Pole, &grid, 0, 0), 0.0);
            assert_eq!(rule.kernel_weight(&Pole, &grid, 2, 1), -0.75);
        }
        assert!(Trapezoid.is_trapezoidal() && !Plain.is_trapezoidal());
    }
}
