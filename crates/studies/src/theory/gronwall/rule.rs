//! Gronwall's inequality with the weights of a rule: the recurrence on any grid, and a closed form of it.

use super::mittag_leffler::mittag_leffler;
use super::recurrence::{StepTooLarge, closed_limit, primed, primed_closed, solvable};
use algebra::linalg::larger;
use statrs::function::gamma::gamma;
use vhi::history::{
    Gregory, GregoryOrder, Left, ProductIntegration, TimeGrid, TimeRule, Trapezoid,
};
use vhi::law::HistoryKernel;

/// Weights in Gronwall's inequality that are not negative, the same for every kernel: those of a rule, or bounds of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weights {
    /// Σ' of the paper.
    Trapezoid,
    /// The left end of each step.
    Left,
    /// Gregory's, on equal steps.
    Gregory(GregoryOrder),
    /// Product integration, its weights of (t - s)^{-power} alone, which bound those of kernels by what these have beside it;
    /// of kernels that are finite, power = 0, those of the trapezoidal rule.
    Product {
        /// 0 ≤ power < 1.
        power: f64,
    },
}

/// (t - s)^{-a}.
struct Power(f64);

impl HistoryKernel for Power {
    fn at(&self, t: f64, s: f64) -> f64 {
        (t - s).powf(-self.0)
    }

    fn power(&self) -> f64 {
        self.0
    }

    fn factor(&self, _: f64, _: f64) -> f64 {
        1.0
    }
}

impl Weights {
    /// The weights of a rule on kernels with this largest power; none where they depend on the kernel in another way.
    pub(crate) fn of(rule: scene::TimeRule, power: f64) -> Option<Self> {
        Some(match rule {
            scene::TimeRule::Trapezoid => Self::Trapezoid,
            scene::TimeRule::Left => Self::Left,
            scene::TimeRule::Gregory { order: 3 } => Self::Gregory(GregoryOrder::Three),
            scene::TimeRule::Gregory { .. } => Self::Gregory(GregoryOrder::Four),
            scene::TimeRule::ProductIntegration => Self::Product { power },
            scene::TimeRule::CorrectedEnd { .. } => return None,
        })
    }

    /// The rule.
    pub fn rule(self) -> &'static dyn TimeRule {
        match self {
            Self::Trapezoid => &Trapezoid,
            Self::Left => &Left,
            Self::Gregory(GregoryOrder::Three) => &Gregory { order: GregoryOrder::Three },
            Self::Gregory(GregoryOrder::Four) => &Gregory { order: GregoryOrder::Four },
            Self::Product { .. } => &ProductIntegration,
        }
    }

    /// w_n0, …, w_nn.
    pub fn row(self, grid: &TimeGrid, n: usize) -> Vec<f64> {
        match self {
            Self::Product { power } => ProductIntegration.kernel_row(&Power(power), grid, n),
            _ => (0..=n).map(|j| self.rule().weight(grid, n, j)).collect(),
        }
    }

    /// What C2 stands beside on a step k: k, or k^{1-a}.
    pub(crate) fn of_step(self, k: f64) -> f64 {
        if let Self::Product { power } = self { k.powf(1.0 - power) } else { k }
    }

    /// By how much a bound of κ(n, j) beside the weights of the trapezoidal rule is to be multiplied beside these, up to the
    /// horizon: (t - s)^{-a} ≥ T^{-a}.
    pub(crate) fn beside_plain(self, horizon: f64) -> f64 {
        if let Self::Product { power } = self { horizon.powf(power) } else { 1.0 }
    }

    /// E_n = s_n + C2 Σ_{j ≤ n} w_nj E_j. O(N) by the trapezoidal rule, else O(N²).
    ///
    /// # Errors
    /// C2 w_nn ≥ 1.
    pub fn envelope(
        self,
        grid: &TimeGrid,
        source: &[f64],
        c2: f64,
    ) -> Result<Vec<f64>, StepTooLarge> {
        if self == Self::Trapezoid {
            return primed(grid, source, c2);
        }
        let mut envelope: Vec<f64> = Vec::with_capacity(source.len());
        for (n, s) in source.iter().enumerate() {
            let row = self.row(grid, n);
            let sum: f64 = envelope.iter().zip(&row).map(|(e, weight)| weight * e).sum();
            let remaining = solvable(n, c2, row[n])?;
            envelope.push((s + c2 * sum) / remaining);
        }
        Ok(envelope)
    }

    /// Above E_n of [`Self::envelope`]: max_{j ≤ n} s_j times 1/(1 - θ) · (1 + δc/(1 - θ)) · (1 + c/(1 - θ))^{n-1}, c = C2 k on
    /// equal steps. δ and θ hold what the weights beyond one step and its tail sums beyond whole steps have: θ = c/2 and
    /// δ = 1/12 by Gregory's rule of order 3, 13c/24 and 1/3 by that of order 4, both for c ≤ 1; 0 and 0 by the left rule, on any
    /// grid with a product of 1 + c_m in place of the power. Where s_0 > 0 the power is n. The limit for k → 0 is e^{C2 t}.
    /// By the trapezoidal rule it is `primed_closed`.
    ///
    /// By product integration, on any grid with largest step k, it is max s/(1 - θ) · E_α(C2 Γ(α) t^α/(1 - θ)), α = 1 - a,
    /// θ = C2 k^α/α, with the function of Mittag-Leffler. Let y be that, which solves
    /// y(t) = y(0) + C2/(1 - θ) ∫_0^t (t - s)^{-a} y(s) ds and increases. Its interpolant is below y(s + k), and below y(t_n) in
    /// the last k, so the sum of w_nj y(t_j) is below ∫_0^{t_n} (t_n - s)^{-a} y ds + y(t_n) k^α/α; with max s added and C2 before
    /// it that is y(t_n) at most, and induction over n puts E_n below y(t_n).
    ///
    /// # Errors
    /// θ ≥ 1, or c > 1 by Gregory's rules.
    pub fn closed(
        self,
        grid: &TimeGrid,
        source: &[f64],
        c2: f64,
    ) -> Result<Vec<f64>, StepTooLarge> {
        let (share, beyond, most) = match self {
            Self::Trapezoid => return primed_closed(grid, source, c2),
            Self::Left => (0.0, 0.0, f64::INFINITY),
            Self::Gregory(GregoryOrder::Three) => (1.0 / 2.0, 1.0 / 12.0, 1.0),
            Self::Gregory(GregoryOrder::Four) => (13.0 / 24.0, 1.0 / 3.0, 1.0),
            Self::Product { power } => {
                let exponent = 1.0 - power;
                let whole = grid.largest_step().powf(exponent) / exponent;
                let remaining = solvable(1, c2, whole)?;
                return Ok(fractional(grid, source, exponent, c2, remaining));
            }
        };
        let k = grid.largest_step();
        // Beyond c = 1 the form is not shown to be a bound.
        let weight = if c2 * k <= most { share * k } else { f64::INFINITY };
        let remaining = solvable(1, c2, weight)?;
        let from_rest = source.first().is_none_or(|s| *s == 0.0);
        let (mut largest, mut amplification) = (0.0f64, 1.0);
        let bound = |(n, s): (usize, &f64)| {
            let grown = || 1.0 + c2 * grid.step(n) / remaining;
            amplification *= match n {
                0 => 1.0,
                1 if from_rest => (1.0 + beyond * c2 * k / remaining) / remaining,
                1 => grown() * (1.0 + beyond * c2 * k / remaining) / remaining,
                _ => grown(),
            };
            largest = larger(largest, *s);
            largest * amplification
        };
        Ok(source.iter().enumerate().map(bound).collect())
    }

    /// The limit of [`Self::closed`] for k → 0: max_{j ≤ n} s_j · e^{C2 t_n}, or E_α(C2 Γ(α) t_n^α) in place of e.
    pub fn limit(self, grid: &TimeGrid, source: &[f64], c2: f64) -> Vec<f64> {
        match self {
            Self::Product { power } if power > 0.0 => {
                fractional(grid, source, 1.0 - power, c2, 1.0)
            }
            _ => closed_limit(grid, source, c2),
        }
    }
}

/// max_{j ≤ n} s_j/r · E_α(C2 Γ(α) t_n^α/r).
fn fractional(grid: &TimeGrid, source: &[f64], exponent: f64, c2: f64, r: f64) -> Vec<f64> {
    let mut largest = 0.0f64;
    let growth = c2 * gamma(exponent) / r;
    let bound = |(s, t): (&f64, &f64)| {
        largest = larger(largest, *s);
        largest / r * mittag_leffler(exponent, growth * t.powf(exponent))
    };
    source.iter().zip(grid.times()).map(bound).collect()
}
