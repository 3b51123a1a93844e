//! Gronwall's inequality with the weights of a rule: the recurrence on any grid, and a closed form of it.

use super::recurrence::{StepTooLarge, larger, primed, primed_closed, solvable};
use vhi::history::{Gregory, GregoryOrder, Left, TimeGrid, TimeRule, Trapezoid};

/// A rule whose weights are the same for every kernel, and not negative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// Σ' of the paper.
    Trapezoid,
    /// The left end of each step.
    Left,
    /// Gregory's, on equal steps.
    Gregory(GregoryOrder),
}

impl Weights {
    /// Those of a scene; none where they depend on the kernel.
    pub(crate) fn of(rule: scene::TimeRule) -> Option<Self> {
        Some(match rule {
            scene::TimeRule::Trapezoid => Self::Trapezoid,
            scene::TimeRule::Left => Self::Left,
            scene::TimeRule::Gregory { order: 3 } => Self::Gregory(GregoryOrder::Three),
            scene::TimeRule::Gregory { .. } => Self::Gregory(GregoryOrder::Four),
            scene::TimeRule::CorrectedEnd { .. } | scene::TimeRule::ProductIntegration => {
                return None;
            }
        })
    }

    /// The rule.
    pub fn rule(self) -> &'static dyn TimeRule {
        match self {
            Self::Trapezoid => &Trapezoid,
            Self::Left => &Left,
            Self::Gregory(GregoryOrder::Three) => &Gregory { order: GregoryOrder::Three },
            Self::Gregory(GregoryOrder::Four) => &Gregory { order: GregoryOrder::Four },
        }
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
        let rule = self.rule();
        let mut envelope: Vec<f64> = Vec::with_capacity(source.len());
        for (n, s) in source.iter().enumerate() {
            let known = envelope.iter().enumerate();
            let sum: f64 = known.map(|(j, e)| rule.weight(grid, n, j) * e).sum();
            let remaining = solvable(n, c2, rule.weight(grid, n, n))?;
            envelope.push((s + c2 * sum) / remaining);
        }
        Ok(envelope)
    }

    /// Above E_n of [`Self::envelope`]: max_{j ≤ n} s_j times 1/(1 - θ) · (1 + δc/(1 - θ)) · (1 + c/(1 - θ))^{n-1}, c = C2 k on
    /// equal steps. δ and θ hold what the weights beyond one step and its tail sums beyond whole steps have: θ = c/2 and
    /// δ = 1/12 by Gregory's rule of order 3, 13c/24 and 1/3 by that of order 4, both for c ≤ 1; 0 and 0 by the left rule, on any
    /// grid with a product of 1 + c_m in place of the power. Where s_0 > 0 the power is n. The limit for k → 0 is e^{C2 t}.
    /// By the trapezoidal rule it is [`primed_closed`].
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
}
