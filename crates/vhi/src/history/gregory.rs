//! Gregory's rules: the trapezoidal rule with difference corrections at both ends, on equal steps.

use super::{ClosedForm, TimeGrid, TimeRule, Trapezoid};

/// Order of a rule of Gregory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GregoryOrder {
    /// First differences; error (k³/24)(F''(t) + F''(0)), F(s) = q(t, s) u(s).
    Three,
    /// Second differences too; error (19/720) k⁴ [F''']_0^t, and that of the trapezoidal rule at t_1.
    Four,
}

/// The trapezoidal weights with k/12 moved from each end to its neighbour; for order four also k/24 of (−1, 2, −1) on
/// the three points at each end. Overlapping corrections are added: Simpson's rule at t_2, the 3/8 rule at t_3.
///
/// At t_1 only the trapezoidal rule is possible, with error k³ F''(0)/12: order four in the maximum over t_n needs
/// F''(0) = 0. Weights are positive. The corrections assume equal steps; scenes refuse others.
///
/// H. Brunner and P. J. van der Houwen, The Numerical Solution of Volterra Equations, North-Holland (1986).
#[derive(Debug, Clone, Copy)]
pub struct Gregory {
    pub order: GregoryOrder,
}

impl Gregory {
    /// Correction `i` steps from an end of a sum over n steps, in units of the step.
    fn correction(self, n: usize, i: usize) -> f64 {
        let first = [-1.0 / 12.0, 1.0 / 12.0].get(i).filter(|_| n >= 1);
        let second = [-1.0 / 24.0, 2.0 / 24.0, -1.0 / 24.0].get(i);
        let second = second.filter(|_| n >= 2 && self.order == GregoryOrder::Four);
        first.unwrap_or(&0.0) + second.unwrap_or(&0.0)
    }
}

impl TimeRule for Gregory {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        if n == 0 {
            return 0.0;
        }
        let corrections = self.correction(n, j) + self.correction(n, n - j);
        Trapezoid.weight(grid, n, j) + corrections * grid.step(1)
    }

    fn closed_form(&self) -> Option<ClosedForm> {
        let (share, beyond) = match self.order {
            GregoryOrder::Three => (1.0 / 2.0, 1.0 / 12.0),
            GregoryOrder::Four => (13.0 / 24.0, 1.0 / 3.0),
        };
        Some(ClosedForm::Corrected { share, beyond, most: 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THREE: Gregory = Gregory { order: GregoryOrder::Three };
    const FOUR: Gregory = Gregory { order: GregoryOrder::Four };

    fn weights(rule: Gregory, n: usize) -> Vec<f64> {
        let grid = TimeGrid::uniform(n as f64, n as u32);
        (0..=n).map(|j| rule.weight(&grid, n, j)).collect()
    }

    /// Newton–Cotes rules at the start, Gregory's patterns from n = 3 and n = 5 on.
    #[test]
    fn weights_are_those_of_the_tables() {
        let tables: [(Gregory, &[f64]); 8] = [
            (THREE, &[0.0]),
            (THREE, &[0.5, 0.5]),
            (THREE, &[5.0 / 12.0, 13.0 / 12.0, 13.0 / 12.0, 5.0 / 12.0]),
            (THREE, &[5.0 / 12.0, 13.0 / 12.0, 1.0, 13.0 / 12.0, 5.0 / 12.0]),
            (FOUR, &[0.5, 0.5]),
            (FOUR, &[1.0 / 3.0, 4.0 / 3.0, 1.0 / 3.0]),
            (FOUR, &[3.0 / 8.0, 9.0 / 8.0, 9.0 / 8.0, 3.0 / 8.0]),
            (FOUR, &[0.375, 7.0 / 6.0, 23.0 / 24.0, 23.0 / 24.0, 7.0 / 6.0, 0.375]),
        ];
        for (rule, table) in tables {
            let found = weights(rule, table.len() - 1);
            assert!(
                found.iter().zip(table).all(|(a, b)| (a - b).abs() < 1e-15),
                "{found:?} {table:?}"
            );
        }
    }

    /// Errors for ∫_0^t s^m ds: (k³/24)(F''(t) + F''(0)) for m = 3 by order three, (19/720) k⁴ [F''']_0^t for m = 4 by
    /// order four, to leading order; straight lines are exact by both, parabolas and cubics by order four from n = 2
    /// on.
    #[test]
    fn powers_are_missed_by_the_leading_terms() {
        let missed = |rule: Gregory, n: usize, power: i32| -> f64 {
            let found = weights(rule, n);
            let sum: f64 = found.iter().enumerate().map(|(j, w)| w * (j as f64).powi(power)).sum();
            (n as f64).powi(power + 1) / f64::from(power + 1) - sum
        };
        for n in 1..12 {
            assert!(missed(THREE, n, 1).abs() < 1e-12 && missed(FOUR, n, 1).abs() < 1e-12);
            assert!(n == 1 || missed(FOUR, n, 2).abs() + missed(FOUR, n, 3).abs() < 1e-11, "{n}");
        }
        // F''' = 0 and F''(t) + F''(0) = 4: there is no other term.
        assert!((missed(THREE, 64, 2) + 4.0 / 24.0).abs() < 1e-9);
        assert!((missed(THREE, 64, 3) + 6.0 * 64.0 / 24.0).abs() < 1e-6);
        // [F''']_0^64 = 24 · 64, beside F'''' terms that do not grow with t: 1/40 of it.
        let leading = -19.0 / 720.0 * 24.0 * 64.0;
        assert!((missed(FOUR, 64, 4) / leading - 1.0).abs() < 0.03);
    }

    #[test]
    fn the_last_weight_is_at_most_its_share() {
        for rule in [THREE, FOUR] {
            let last = (1..9).map(|n| weights(rule, n)[n]).fold(0.0, f64::max);
            assert!(last == rule.last_share() && weights(rule, 9).iter().all(|w| *w > 0.0));
        }
    }
}
