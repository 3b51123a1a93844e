//! Gronwall's inequality with the weights of a rule: the recurrence on any grid, and a closed form of it.

use super::mittag_leffler::mittag_leffler;
use super::recurrence::{Solved, amplified, closed_limit, primed_closed, solvable, solved};
use statrs::function::gamma::gamma;
use vhi::history::{ClosedForm, TimeGrid, TimeRule};
use vhi::law::HistoryKernel;

/// Weights in Gronwall's inequality that are not negative, the same for every kernel: those of a rule, or bounds of them.
/// By product integration they are those of (t - s)^{-power} alone, which bound those of kernels by what these have
/// beside it; of kernels that are finite, power = 0, those of the trapezoidal rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    rule: scene::TimeRule,
    form: ClosedForm,
    /// 0 ≤ power < 1, 0 by other rules than product integration.
    power: f64,
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
    pub fn of(rule: scene::TimeRule, power: f64) -> Option<Self> {
        let form = rule.weights().closed_form()?;
        let power = if form == ClosedForm::MittagLeffler { power } else { 0.0 };
        Some(Self { rule, form, power })
    }

    /// The rule, if it integrates kernels, so that its weights are theirs.
    pub(super) fn integrating(self) -> Option<Box<dyn TimeRule>> {
        (self.form == ClosedForm::MittagLeffler).then(|| self.rule())
    }

    /// Whether they are those of Σ'.
    pub(crate) fn are_the_papers(self) -> bool {
        self.form == ClosedForm::Paper
    }

    /// The rule.
    pub fn rule(self) -> Box<dyn TimeRule> {
        self.rule.weights()
    }

    /// w_n0, …, w_nn.
    pub fn row(self, grid: &TimeGrid, n: usize) -> Vec<f64> {
        self.rule().kernel_row(&Power(self.power), grid, n)
    }

    /// What C2 stands beside on a step k: k, or k^{1-a}.
    pub(crate) fn of_step(self, k: f64) -> f64 {
        if self.power > 0.0 { k.powf(1.0 - self.power) } else { k }
    }

    /// By how much a bound of κ(n, j) beside the weights of the trapezoidal rule is to be multiplied beside these, up to the
    /// horizon: (t - s)^{-a} ≥ T^{-a}.
    pub(crate) fn beside_plain(self, horizon: f64) -> f64 {
        horizon.powf(self.power)
    }

    /// E_n = s_n + C2 Σ_{j ≤ n} w_nj E_j.
    ///
    /// # Errors
    /// C2 w_nn ≥ 1.
    pub fn envelope(self, grid: &TimeGrid, source: &[f64], c2: f64) -> Solved {
        solved(source, c2, |n| self.row(grid, n))
    }

    /// Above E_n of [`Self::envelope`]: max_{j ≤ n} s_j times what [`ClosedForm`] says. Where s_0 > 0 the power of
    /// 1 + c/(1 - θ) is n. The limit for k → 0 is e^{C2 t}. By the trapezoidal rule it is `primed_closed`.
    ///
    /// By product integration, on any grid with largest step k, it is max s/(1 - θ) · E_α(C2 Γ(α) t^α/(1 - θ)), α = 1 - a,
    /// θ = C2 k^α/α, with the function of Mittag-Leffler. Let y be that, which solves
    /// y(t) = y(0) + C2/(1 - θ) ∫_0^t (t - s)^{-a} y(s) ds and increases. Its interpolant is below y(s + k), and below y(t_n) in
    /// the last k, so the sum of w_nj y(t_j) is below ∫_0^{t_n} (t_n - s)^{-a} y ds + y(t_n) k^α/α; with max s added and C2 before
    /// it that is y(t_n) at most, and induction over n puts E_n below y(t_n).
    ///
    /// # Errors
    /// θ ≥ 1, or c > 1 by Gregory's rules.
    pub fn closed(self, grid: &TimeGrid, source: &[f64], c2: f64) -> Solved {
        let (share, beyond, most) = match self.form {
            ClosedForm::Paper => return primed_closed(grid, source, c2),
            ClosedForm::Corrected { share, beyond, most } => (share, beyond, most),
            ClosedForm::MittagLeffler => {
                let exponent = 1.0 - self.power;
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
        let mut amplification = 1.0;
        let factor = |n: usize| {
            let grown = || 1.0 + c2 * grid.step(n) / remaining;
            amplification *= match n {
                0 => 1.0,
                1 if from_rest => (1.0 + beyond * c2 * k / remaining) / remaining,
                1 => grown() * (1.0 + beyond * c2 * k / remaining) / remaining,
                _ => grown(),
            };
            amplification
        };
        Ok(amplified(source, (0..source.len()).map(factor)))
    }

    /// The limit of [`Self::closed`] for k → 0: max_{j ≤ n} s_j · e^{C2 t_n}, or E_α(C2 Γ(α) t_n^α) in place of e.
    pub fn limit(self, grid: &TimeGrid, source: &[f64], c2: f64) -> Vec<f64> {
        match self.power {
            0.0 => closed_limit(grid, source, c2),
            power => fractional(grid, source, 1.0 - power, c2, 1.0),
        }
    }
}

/// max_{j ≤ n} s_j/r · E_α(C2 Γ(α) t_n^α/r).
fn fractional(grid: &TimeGrid, source: &[f64], exponent: f64, c2: f64, r: f64) -> Vec<f64> {
    let growth = c2 * gamma(exponent) / r;
    let factor = |t: &f64| mittag_leffler(exponent, growth * t.powf(exponent)) / r;
    amplified(source, grid.times().iter().map(factor))
}
