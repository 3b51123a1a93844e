//! Time rules for kernels that are not C², or infinite at s = t: a corrected end weight, and product integration.

use super::{ClosedForm, TimeGrid, TimeRule, Trapezoid, powers};
use crate::law::GAUSS;
use crate::law::HistoryKernel;

/// The trapezoidal rule with a corrected weight at s = t_n for kernels q(t, s) ≈ q(t, t) + c(t) (t - s)^a near s = t, 0
/// < a < 1.
///
/// With v(s) = v(t_n) + O(t_n - s) only c (t_n - s)^a v(t_n) has an unbounded derivative. Its error is ζ_R(-a) c
/// k^{1+a} v(t_n) for large n (Riemann's zeta function; I. Navot, J. Math. Phys. 40 (1961) 271-276) and another
/// multiple of k^{1+a} for small n. The weight at t_n absorbs it exactly, c (t_n^{1+a}/(1+a) - Σ' (t_n - t_j)^a): order
/// 2 at every n, on any grid.
#[derive(Debug, Clone, Copy)]
pub struct CorrectedEnd {
    /// a.
    pub exponent: f64,
}

/// Share of a step before t at which c(t) is read off q: a part of q that is differentiable at s = t changes c by this
/// share of a step to the power 1 - a, of higher order in k.
const NEAR: f64 = 1e-6;

impl CorrectedEnd {
    /// t_n^{1+a}/(1+a) - Σ' (t_n - t_j)^a.
    fn missed(&self, grid: &TimeGrid, n: usize) -> f64 {
        let (a, t) = (self.exponent, grid.time(n));
        let power = |j: usize| Trapezoid.weight(grid, n, j) * (t - grid.time(j)).powf(a);
        t.powf(1.0 + a) / (1.0 + a) - (0..n).map(power).sum::<f64>()
    }
}

impl TimeRule for CorrectedEnd {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    /// O(n) for j = n, O(1) else.
    fn kernel_weight(
        &self,
        kernel: &dyn HistoryKernel,
        grid: &TimeGrid,
        n: usize,
        j: usize,
    ) -> f64 {
        let plain = Trapezoid.kernel_weight(kernel, grid, n, j);
        if n == 0 || j != n {
            return plain;
        }
        let t = grid.time(n);
        let lag = NEAR * grid.step(n);
        let factor = (kernel.at(t, t - lag) - kernel.at(t, t)) / lag.powf(self.exponent);
        plain + factor * self.missed(grid, n)
    }
}

/// Product integration with the hat functions φ_j of the times. For finite kernels v is interpolated and the kernel
/// integrated, W_nj = ∫ q(t_n, s) φ_j(s) ds. For (t - s)^{-a} b(t, s) the product b v is interpolated and the power
/// integrated, W_nj = b(t_n, t_j) ∫ (t_n - s)^{-a} φ_j(s) ds: as accurate, with three powers per weight.
#[derive(Debug, Clone, Copy, Default)]
pub struct ProductIntegration;

impl ProductIntegration {
    /// The weights (of v, or of b v) at both ends of the step that ends at t_i.
    fn step(kernel: &dyn HistoryKernel, grid: &TimeGrid, n: usize, i: usize) -> (f64, f64) {
        match kernel.power() {
            0.0 => Self::whole(kernel, grid, n, i),
            a => powers::moments(a, grid.lag(n, i), grid.step(i)),
        }
    }

    /// b(t_n, t_j), or 1.
    fn factor(kernel: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        if kernel.power() == 0.0 { 1.0 } else { kernel.factor(grid.time(n), grid.time(j)) }
    }

    /// ∫ q(t_n, s) over the step that ends at t_i, against the hat functions of its two ends.
    ///
    /// Nodes are graded towards t_n as x⁴, which makes (t_n - s)^a a polynomial for a = ¼, ½, ¾ and smooth enough for
    /// 14 digits for other a > 0; steps away from t_n are smooth anyway.
    fn whole(kernel: &dyn HistoryKernel, grid: &TimeGrid, n: usize, i: usize) -> (f64, f64) {
        let (t, from, k) = (grid.time(n), grid.time(i - 1), grid.step(i));
        let mut sums = (0.0, 0.0);
        for (x, weight) in GAUSS {
            // Distance from the end of the step, as a share of it.
            let (share, density) = if i == n { (x.powi(4), 4.0 * x.powi(3)) } else { (x, 1.0) };
            let s = if i == n { t - k * share } else { from + k * (1.0 - share) };
            let value = weight * density * k * kernel.at(t, s);
            sums.0 += value * share;
            sums.1 += value * (1.0 - share);
        }
        sums
    }
}

impl TimeRule for ProductIntegration {
    /// For a smooth integrand without kernel (ζ): the trapezoidal weights.
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(
        &self,
        kernel: &dyn HistoryKernel,
        grid: &TimeGrid,
        n: usize,
        j: usize,
    ) -> f64 {
        let before = if j > 0 { Self::step(kernel, grid, n, j).1 } else { 0.0 };
        let after = if j < n { Self::step(kernel, grid, n, j + 1).0 } else { 0.0 };
        (before + after) * Self::factor(kernel, grid, n, j)
    }

    fn kernel_row(&self, kernel: &dyn HistoryKernel, grid: &TimeGrid, n: usize) -> Vec<f64> {
        let mut row = vec![0.0; n + 1];
        for i in 1..=n {
            let (left, right) = Self::step(kernel, grid, n, i);
            row[i - 1] += left;
            row[i] += right;
        }
        for (j, weight) in row.iter_mut().enumerate() {
            *weight *= Self::factor(kernel, grid, n, j);
        }
        row
    }

    fn last_weight(&self, power: f64, k: f64) -> f64 {
        powers::moments(power, 0.0, k).1
    }

    fn closed_form(&self) -> Option<ClosedForm> {
        Some(ClosedForm::MittagLeffler)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Power(f64);
    impl HistoryKernel for Power {
        fn at(&self, t: f64, s: f64) -> f64 {
            3.0 * (t - s).max(0.0).powf(self.0)
        }
    }

    /// ∫_0^1 3 (1-s)^a (s + s²) ds = 3/((a+1)(a+2)) + 6/((a+1)(a+2)(a+3)).
    fn error(rule: &dyn TimeRule, a: f64, steps: u32) -> f64 {
        let grid = TimeGrid::uniform(1.0, steps);
        let row = rule.kernel_row(&Power(a), &grid, steps as usize);
        let sum: f64 = row.iter().zip(grid.times()).map(|(w, s)| w * (s + s * s)).sum();
        let two = (a + 1.0) * (a + 2.0);
        (sum - 3.0 / two - 6.0 / (two * (a + 3.0))).abs()
    }

    /// -ζ_R(-½) k^{3/2} for large n, with ζ_R(-½) = -0.2078862….
    #[test]
    fn the_end_weight_tends_to_the_value_of_zeta() {
        let grid = TimeGrid::uniform(1.0, 4096);
        let missed = CorrectedEnd { exponent: 0.5 }.missed(&grid, 4096) * 4096f64.powf(1.5);
        // The far end contributes -k^{1/2}/24.
        assert!((missed - 0.207_886_2 + 1.0 / (24.0 * 64.0)).abs() < 1e-5, "{missed}");
    }

    /// Single weights equal those of their row, also if the grid goes on.
    #[test]
    fn weights_are_those_of_their_row() {
        let grid = TimeGrid::graded(1.0, 8, 2.0);
        for rule in [&CorrectedEnd { exponent: 0.5 } as &dyn TimeRule, &ProductIntegration] {
            for n in [0, 1, 5, 8] {
                let row = rule.kernel_row(&Power(0.5), &grid, n);
                let weight = |j: usize| rule.kernel_weight(&Power(0.5), &grid, n, j);
                let alone: Vec<f64> = (0..=n).map(weight).collect();
                // The two integrals of a weight, added in another order.
                let pairs = row.iter().zip(&alone).map(|(a, b)| (a - b).abs());
                let apart = pairs.fold(0.0, f64::max);
                assert!(row.len() == n + 1 && apart < 1e-15, "{row:?} {alone:?}");
            }
        }
    }

    /// The largest error over all n, for v(0) ≠ 0: near t = 0 the asymptotic correction does not hold.
    #[test]
    fn order_two_holds_from_the_first_step_on() {
        let exact = |t: f64| 2.0 * t.powf(1.5) + 0.8 * t.powf(2.5);
        let worst = |rule: &dyn TimeRule, grid: &TimeGrid| {
            let at = |n: usize| {
                let row = rule.kernel_row(&Power(0.5), grid, n);
                let sum: f64 = row.iter().zip(grid.times()).map(|(w, s)| w * (1.0 + s)).sum();
                (sum - exact(grid.time(n))).abs()
            };
            (1..=grid.steps()).map(at).fold(0.0, f64::max)
        };
        let order = |rule: &dyn TimeRule, grid: fn(u32) -> TimeGrid| {
            (worst(rule, &grid(64)) / worst(rule, &grid(128))).log2()
        };
        let end = CorrectedEnd { exponent: 0.5 };
        for grid in [|n| TimeGrid::uniform(1.0, n), |n| TimeGrid::graded(1.0, n, 2.0)] {
            // The term k^{5/2} is 3 % of the error here.
            assert!((order(&end, grid) - 2.0).abs() < 0.05, "{}", order(&end, grid));
            assert!(order(&Trapezoid, grid) < 1.55);
        }
        /// The asymptotic correction alone.
        struct LongRun;
        impl TimeRule for LongRun {
            fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
                Trapezoid.weight(grid, n, j)
            }
            fn kernel_weight(
                &self,
                kernel: &dyn HistoryKernel,
                grid: &TimeGrid,
                n: usize,
                j: usize,
            ) -> f64 {
                let end = if j == n { 3.0 * 0.207_886_2 * grid.step(n).powf(1.5) } else { 0.0 };
                Trapezoid.kernel_weight(kernel, grid, n, j) + end
            }
        }
        assert!(order(&LongRun, |n| TimeGrid::uniform(1.0, n)) < 1.55);
    }

    /// A smooth part of the kernel does not spoil the factor.
    #[test]
    fn a_kernel_that_does_not_vanish_at_zero_lag_is_corrected_too() {
        struct Shifted;
        impl HistoryKernel for Shifted {
            fn at(&self, t: f64, s: f64) -> f64 {
                2.0 * (s - t).exp() + Power(0.5).at(t, s)
            }
        }
        let off = |rule: &dyn TimeRule, steps: u32| {
            let grid = TimeGrid::uniform(1.0, steps);
            let sum: f64 = rule.kernel_row(&Shifted, &grid, steps as usize).iter().sum();
            (sum - 2.0 * (1.0 - (-1f64).exp()) - 2.0).abs()
        };
        let end = CorrectedEnd { exponent: 0.5 };
        let order = (off(&end, 64) / off(&end, 128)).log2();
        assert!((order - 2.0).abs() < 0.05, "{order}");
        assert!((off(&Trapezoid, 64) / off(&Trapezoid, 128)).log2() < 1.7);
        // c = 3 is read off close to s = t: at a whole step before it the smooth part would add 8 %.
        let grid = TimeGrid::uniform(1.0, 64);
        let added = end.kernel_weight(&Shifted, &grid, 64, 64)
            - Trapezoid.kernel_weight(&Shifted, &grid, 64, 64);
        assert!((added / end.missed(&grid, 64) - 3.0).abs() < 1e-3);
    }

    #[test]
    fn both_rules_restore_order_two_and_the_plain_one_has_order_one_and_a_half() {
        let order =
            |rule: &dyn TimeRule, a: f64| (error(rule, a, 256) / error(rule, a, 512)).log2();
        assert!((order(&Trapezoid, 0.5) - 1.5).abs() < 0.05, "{}", order(&Trapezoid, 0.5));
        for a in [0.3, 0.5, 0.8] {
            let corrected = order(&CorrectedEnd { exponent: a }, a);
            let product = order(&ProductIntegration, a);
            // The next term, k^{2+a}, is still there: 0.15 for the smallest a.
            assert!((corrected - 2.0).abs() < 0.15, "{a}: {corrected}");
            assert!((product - 2.0).abs() < 0.15, "{a}: {product}");
        }
        // The wrong exponent corrects nothing.
        assert!(order(&CorrectedEnd { exponent: 0.9 }, 0.5) < 1.7);
    }

    #[test]
    fn product_integration_is_exact_for_affine_functions() {
        let grid = TimeGrid::graded(1.0, 6, 2.0);
        let row = ProductIntegration.kernel_row(&Power(0.5), &grid, 6);
        let sum: f64 = row.iter().zip(grid.times()).map(|(w, s)| w * (1.0 + s)).sum();
        // 3 ∫ (1-s)^½ (1+s) = 3 (2/3 + 4/15).
        assert!((sum - 2.8).abs() < 1e-10, "{sum}");
    }

    /// Without a kernel both rules are trapezoidal; all weights are zero at n = 0.
    #[test]
    fn without_a_kernel_and_at_the_start_the_rules_are_plain() {
        let grid = TimeGrid::graded(2.0, 5, 1.5);
        for rule in [&CorrectedEnd { exponent: 0.5 } as &dyn TimeRule, &ProductIntegration] {
            for j in 0..=4 {
                assert_eq!(rule.weight(&grid, 4, j), Trapezoid.weight(&grid, 4, j));
            }
            assert_eq!(rule.kernel_row(&Power(0.5), &grid, 0), [0.0]);
            assert!(!rule.is_trapezoidal());
        }
    }
}
