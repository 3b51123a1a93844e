//! An interval against a prediction.

use super::Decision;
use crate::fit::Interval;

/// Half of the distance between orders that theories tell apart, 1 and 1.5 say, less a margin:
/// a wider interval would pass two of them.
pub(super) const WIDEST_HALF_WIDTH: f64 = 0.15;

/// An interval that misses the prediction by less is no refutation: the interval's own ends
/// are uncertain by so much (its simulated coverage is 98 %, not 100 %).
pub(super) const CLEAR_MISS: f64 = 0.05;

/// An interval that misses the prediction by less has met it. On a clean sequence the interval is a few thousandths
/// wide, while the next term of the error, of one sign, holds the orders of all pairs on one side of the prediction by
/// as much; no two theories are told apart by a hundredth.
const NEGLIGIBLE_MISS: f64 = 0.01;

/// What a prediction says about one order.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    pub order: f64,
    pub at_least: bool,
    pub exact: bool,
}

/// The decision on one order, and the sentence that states it. Where the decision is
/// `Unresolved`, the next cases to run are still to be named.
pub fn compare(interval: Interval, aim: Aim) -> (Decision, String) {
    let Aim { order, at_least, exact } = aim;
    let below = order - interval.hi;
    let above = interval.lo - order;
    let half_width = interval.half_width();
    if at_least && interval.lo >= order - WIDEST_HALF_WIDTH {
        (Decision::Pass, format!("{interval} is not below {order}"))
    } else if below > CLEAR_MISS {
        (Decision::Fail, format!("{interval} lies {below:.2} below {order}"))
    } else if at_least {
        let sentence = format!("{interval} reaches below {order} - {WIDEST_HALF_WIDTH}");
        (Decision::Unresolved, sentence)
    } else if exact && above > CLEAR_MISS {
        (Decision::Fail, format!("{interval} lies {above:.2} above {order}, which is exact"))
    } else if above > CLEAR_MISS {
        let cause = "superconvergence, or a solution that does not excite the term";
        let sentence =
            format!("{interval} lies {above:.2} above {order}: order too high ({cause})");
        (Decision::Unresolved, sentence)
    } else if below.max(above) > NEGLIGIBLE_MISS {
        let miss = below.max(above);
        (Decision::Unresolved, format!("{interval} misses {order} by {miss:.3}"))
    } else if half_width > WIDEST_HALF_WIDTH {
        let sentence = format!("half-width {half_width:.2} > {WIDEST_HALF_WIDTH}");
        (Decision::Unresolved, sentence)
    } else if !interval.contains(order) {
        (Decision::Pass, format!("{interval} misses {order} by less than {NEGLIGIBLE_MISS}"))
    } else {
        (Decision::Pass, format!("{order} lies in {interval}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decide(lo: f64, hi: f64, at_least: bool, exact: bool) -> (Decision, String) {
        compare(Interval { lo, hi }, Aim { order: 1.0, at_least, exact })
    }

    #[test]
    fn every_rule_has_its_decision() {
        let cases = [
            (0.9, 1.1, false, false, Decision::Pass, "lies in"),
            (0.8, 1.2, false, false, Decision::Unresolved, "half-width 0.20 > 0.15"),
            (0.8, 0.94, false, false, Decision::Fail, "below"),
            (0.8, 0.96, false, false, Decision::Unresolved, "misses 1 by 0.040"),
            (1.04, 1.1, false, true, Decision::Unresolved, "misses"),
            (1.002, 1.004, false, true, Decision::Pass, "misses 1 by less than 0.01"),
            (0.97, 0.995, false, false, Decision::Pass, "by less than 0.01"),
            (0.97, 0.985, false, false, Decision::Unresolved, "misses 1 by 0.015"),
            (1.015, 1.02, false, true, Decision::Unresolved, "misses 1 by 0.015"),
            (1.005, 1.4, false, false, Decision::Unresolved, "half-width 0.20"),
            (1.06, 1.1, false, false, Decision::Unresolved, "order too high"),
            (1.06, 1.1, false, true, Decision::Fail, "exact"),
            (0.86, 3.0, true, false, Decision::Pass, "not below"),
            (0.80, 3.0, true, false, Decision::Unresolved, "reaches below"),
            (0.80, 0.90, true, false, Decision::Fail, "below"),
        ];
        for (lo, hi, at_least, exact, decision, words) in cases {
            let (found, sentence) = decide(lo, hi, at_least, exact);
            assert!(found == decision && sentence.contains(words), "{lo} {hi}: {sentence}");
        }
    }

    /// A limit is the last value that still counts for the scheme. Around 0 the limits are doubles.
    #[test]
    fn the_limits_themselves_do_not_refute() {
        let around_zero = |lo: f64, hi: f64, exact: bool| {
            compare(Interval { lo, hi }, Aim { order: 0.0, at_least: false, exact })
        };
        let cases = [
            (-0.08, -0.05, false, Decision::Unresolved, "misses 0 by 0.050"),
            (0.05, 0.08, true, Decision::Unresolved, "misses 0 by 0.050"),
            (0.05, 0.08, false, Decision::Unresolved, "misses 0 by 0.050"),
            (0.01, 0.02, false, Decision::Pass, "misses 0 by less than"),
            (-0.15, 0.15, false, Decision::Pass, "0 lies in"),
        ];
        for (lo, hi, exact, decision, words) in cases {
            let (found, sentence) = around_zero(lo, hi, exact);
            assert!(found == decision && sentence.contains(words), "{lo} {hi}: {sentence}");
        }
    }
}
