//! "The error tends to zero", without an order that anybody predicts.
//!
//! A sequence shows that only by its trend: its order is above zero with its interval, and no constant is left below it.
//! The constant is that of C h^p + F through the last three errors. An error that falls from 1 to F = 0.1 leaves more than
//! `LEFT` of its last value in F after three halvings, whatever its order from 0.3 on, so that four levels are needed.

use super::claim::{NOTHING, REFUTED};
use super::{Posterior, Ruling};
use crate::Decision;

/// Fewest levels.
const LEVELS: usize = 4;
/// Largest share of the last error that may be left as a constant.
const LEFT: f64 = 0.15;
/// Probability of a floor, unstated, up to which a trend is one to zero.
const FLOORED: f64 = 0.5;

impl Posterior {
    /// Whether the errors tend to zero; unresolved where their trend does not tell.
    pub fn tends_to_zero(&self) -> Ruling {
        self.agreed(Self::trend_to_zero)
    }

    fn trend_to_zero(&self) -> Ruling {
        let falls = 1.0 - self.below(NOTHING);
        let left = self.trend.left;
        let (decision, why) = match left {
            _ if let Some(doubt) = &self.doubts.always => (Decision::Unresolved, doubt.clone()),
            _ if let Some(why) = &self.unexplained => (Decision::Unresolved, why.clone()),
            _ if 1.0 - falls > REFUTED => (
                Decision::Fail,
                format!("the errors do not fall, their order is in {}", self.interval),
            ),
            _ if self.interval.lo <= NOTHING => (
                Decision::Unresolved,
                format!("the order is in {}, which is not away from 0", self.interval),
            ),
            _ if self.slopes.len() + 1 < LEVELS => (
                Decision::Unresolved,
                format!(
                    "{} levels are too few for a trend, {LEVELS} are needed",
                    self.slopes.len() + 1
                ),
            ),
            None => (Decision::Unresolved, "the last errors do not fall".to_owned()),
            Some(share) if share > LEFT => (
                Decision::Unresolved,
                format!("{:.0} % of the last error may be left as a constant", 100.0 * share),
            ),
            Some(_) if self.floor > FLOORED => {
                (Decision::Unresolved, "an unstated floor is likelier than none".to_owned())
            }
            Some(share) => (
                Decision::Pass,
                format!(
                    "the order is in {}, above 0, and no more than {:.0} % of the last error is a constant",
                    self.interval,
                    100.0 * share.max(0.0)
                ),
            ),
        };
        let unexplained = self.unexplained.is_some() || self.doubts.nothing_but_rounding;
        Ruling { decision, reason: why, probability: falls, too_high: false, unexplained }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Decision, order};

    /// e = F + (1 - F) h^p on these steps.
    fn on(steps: &[f64], floor: f64, p: f64) -> Decision {
        let error = |h: f64| floor + (1.0 - floor) * h.powf(p);
        let table: Vec<(f64, f64)> = steps.iter().map(|&h| (h, error(h))).collect();
        order(&table).expect("levels").tends_to_zero().decision
    }

    /// On so many halvings.
    fn decided(floor: f64, p: f64, levels: i32) -> Decision {
        let steps: Vec<f64> = (0..levels).map(|i| 0.5f64.powi(i)).collect();
        on(&steps, floor, p)
    }

    /// The ratios of steps need not be equal: what is left is that of the steps at hand.
    #[test]
    fn steps_of_other_ratios_hide_no_constant() {
        let ratios = [
            vec![1.0, 0.5, 0.25, 0.125, 1.0 / 64.0],
            vec![1.0, 0.5, 0.4, 0.1, 0.05],
            vec![1.0, 0.25, 0.2, 0.15, 0.02],
        ];
        for steps in &ratios {
            for p in [0.5, 0.75, 1.0] {
                assert_eq!(on(steps, 0.0, p), Decision::Pass, "{steps:?} {p}");
                assert_ne!(on(steps, 0.1, p), Decision::Pass, "{steps:?} {p}");
            }
        }
    }

    /// Of any order from 0.3 to 2 the trend is seen on four to seven levels.
    #[test]
    fn an_error_that_tends_to_zero_passes() {
        for p in [0.3, 0.5445, 0.75, 1.0, 1.5, 2.0] {
            for levels in 4..=7 {
                assert_eq!(decided(0.0, p, levels), Decision::Pass, "{p} on {levels} levels");
            }
        }
        // Orders that drift as at a corner, and errors that are not of one power.
        let drifting =
            [(1.0, 0.2), (0.5, 0.113), (0.25, 0.0645), (0.125, 0.0372), (0.0625, 0.0216)];
        assert_eq!(order(&drifting).expect("levels").tends_to_zero().decision, Decision::Pass);
    }

    /// One that levels off at 10 % of its first value never passes, on no number of levels, whatever its order; nor does one
    /// that rises or stays, and then it fails.
    #[test]
    fn an_error_that_levels_off_never_passes() {
        for floor in [0.1, 0.2, 0.5] {
            for p in [0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0] {
                for levels in 3..=10 {
                    assert_ne!(decided(floor, p, levels), Decision::Pass, "{floor} {p} {levels}");
                }
            }
        }
        for p in [0.0, -0.5] {
            assert_eq!(decided(0.0, p, 5), Decision::Fail, "{p}");
        }
        assert_eq!(decided(0.0, 1.0, 3), Decision::Unresolved);
    }
}
