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

    /// Above E_n of [`Self::envelope`] for s_0 = 0: max_{j ≤ n} s_j · (1 - θ)⁻¹ Π_{m=2..n} (1 + W c_m/(1 - θ)), c_m = C2 k_m,
    /// with θ = C2 max w_nn and W = max_{j<n} w_nj/k_{j+1}, by induction; where s_0 > 0 the product starts at m = 1. It is E_n for
    /// constant s by the left rule. By the trapezoidal rule it is [`primed_closed`].
    ///
    /// # Errors
    /// θ ≥ 1.
    pub fn closed(
        self,
        grid: &TimeGrid,
        source: &[f64],
        c2: f64,
    ) -> Result<Vec<f64>, StepTooLarge> {
        let largest_inside = match self {
            Self::Trapezoid => return primed_closed(grid, source, c2),
            Self::Left => 1.0,
            Self::Gregory(GregoryOrder::Three) => 7.0 / 6.0,
            Self::Gregory(GregoryOrder::Four) => 4.0 / 3.0,
        };
        let share = self.rule().last_share();
        let remaining = solvable(1, c2, share * grid.largest_step())?;
        let from_rest = source.first().is_none_or(|s| *s == 0.0);
        let (mut largest, mut amplification) = (0.0f64, 1.0);
        let bound = |(n, s): (usize, &f64)| {
            if n > 0 {
                let carried = largest_inside * c2 * grid.step(n) / remaining;
                amplification *= match n {
                    1 if from_rest => 1.0 / remaining,
                    1 => (1.0 + carried) / remaining,
                    _ => 1.0 + carried,
                };
            }
            largest = larger(largest, *s);
            largest * amplification
        };
        Ok(source.iter().enumerate().map(bound).collect())
    }
}
