//! A claimed order against what a table says of it.

use std::cmp::Ordering;

use super::{FEWEST, Mixture, Posterior, SAME};
use crate::{Decision, FitError, power_of_log};

/// Default distance of an order from the claim.
pub const TOLERANCE: f64 = 0.15;
/// Bounds of the tolerance as shares of the order: no larger, and for high orders no smaller unless a smaller one is asked.
const SHARE: f64 = 0.4;
const SHARE_OF_HIGH: f64 = 0.05;
/// A miss is refuted from where the tolerance leaves a tenth: at 0.05 from the claim of ordinary ones; from a third on of
/// smaller ones.
const LEFT_TO_MISS: f64 = 0.10;
pub(super) const REFUTED: f64 = 0.975;
/// Probability of a hit that confirms; lower with three levels, whose slopes have to agree instead.
const CONFIRMED: f64 = 0.80;
const CONFIRMED_BY_THREE: f64 = 0.70;
/// The same where a straight line is near the claim, and the slopes scatter about it.
const CONFIRMED_BY_LINE: f64 = 0.50;
/// Over the tolerance: 18 % for 0.15. A noise of 10 % leaves less about a line, with a probability of 95 % where two degrees of
/// freedom are left (chi-square).
const MOST_SCATTER: f64 = 1.2;
/// Near the claim, as shares of the tolerance: all slopes; the line through slopes that scatter, and the median beside it.
const NEAR_SLOPES: f64 = 2.0 / 3.0;
const NEAR_LINE: f64 = 0.8;
/// Slopes that fall by this factor more at each level do not come from a next term: its changes shrink, or grow by less where
/// it outweighs the first.
const EVER_FASTER: f64 = 1.1;
/// Above this, a hit counts if the median is within half the tolerance of the claim.
const CERTAIN: f64 = 0.95;
/// Allowed difference of the two slopes of three levels, as a share of the order.
const AGREEMENT: f64 = 0.15;
/// Slopes below this are those of errors that do not fall: by a tenth in three halvings. Those closer are alike.
pub(super) const NOTHING: f64 = 0.05;
/// How far, in tolerances, the order of the differences of three errors may lie below the claim: less than a quarter of an
/// order by the default.
const DIFFERENCES: f64 = 1.6;
/// Two slopes refute an order from so far below on, where the last is taken to change as much again: half an order, by which
/// theorems differ, less a tenth for what the change leaves out. A floor that scatters feigns less.
const FAR_BELOW: f64 = 0.4;
/// A factor |log h| lowers slopes by 1/|log h|: a third from h = 1/20 on. Its changes fall by 1/i² over halvings, to more than
/// this share from the sixth on; those of a next term h to a half.
const SLOWLY: f64 = 1.0 / 3.0;
const ALIKE: f64 = 0.6;
/// Slopes that rise by this factor are not those of a power.
const STEEP: f64 = 1.5;
/// Below the first probability a floor is ignored; above the second it is the likelier reading.
const FLOOR: [f64; 2] = [0.05, 0.5];

/// What somebody claims of an order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    pub order: f64,
    pub at_least: bool,
    /// A higher order refutes it as well.
    pub exact: bool,
    /// How far the order may lie from p*.
    pub tolerance: f64,
    /// Power M of a factor |log h|^M.
    pub log: f64,
}

/// A claim that cannot be judged.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ClaimError {
    #[error("the order {0} is no finite number; 1, 1.5 and 2 are")]
    Order(f64),
    #[error("the tolerance {0} is no positive number; 0.15 is")]
    Tolerance(f64),
    #[error("an order is a lower bound (at_least) or exact, not both")]
    Both,
    #[error(transparent)]
    Log(#[from] FitError),
}

impl Claim {
    /// Order `order` within the default tolerance, two-sided; higher orders do not refute it.
    pub fn new(order: f64) -> Result<Self, ClaimError> {
        let claim = Self { order, at_least: false, exact: false, tolerance: TOLERANCE, log: 0.0 };
        claim.checked()
    }

    /// The claim, if it can be judged.
    pub fn checked(self) -> Result<Self, ClaimError> {
        if !self.order.is_finite() {
            return Err(ClaimError::Order(self.order));
        }
        if !self.tolerance.is_finite() || self.tolerance <= 0.0 {
            return Err(ClaimError::Tolerance(self.tolerance));
        }
        if self.at_least && self.exact {
            return Err(ClaimError::Both);
        }
        power_of_log(self.log)?;
        Ok(self)
    }

    /// The tolerance, reduced for small orders: 0.15 cannot tell 0.5 from 0.35; raised for high ones.
    fn reach(&self) -> f64 {
        let high = if self.tolerance < TOLERANCE { 0.0 } else { SHARE_OF_HIGH * self.order };
        match self.order > 0.0 {
            true => self.tolerance.max(high).min(SHARE * self.order),
            false => self.tolerance,
        }
    }

    /// A miss by less than this is no refutation.
    fn clear_miss(&self) -> f64 {
        let reach = self.reach();
        (reach / 3.0).max(reach - LEFT_TO_MISS)
    }
}

/// A decision with its reason.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruling {
    pub decision: Decision,
    pub reason: String,
    /// Probability that the order is within the tolerance; for a lower bound, that it is not below.
    pub probability: f64,
    /// The order is settled above the claim.
    pub too_high: bool,
    /// A level left out is not explained by the others, or all are rounding, as the reason says: finer levels would not help.
    pub unexplained: bool,
}

impl Ruling {
    /// Whether a further level would help.
    pub fn is_helped(&self) -> bool {
        self.decision == Decision::Unresolved && !self.too_high && !self.unexplained
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    Confirmed,
    TooLow,
    TooHigh,
    Open,
}

impl Posterior {
    /// The ruling that holds for every noise up to the one that is told: of the least sure one, and open where they differ.
    pub(super) fn agreed(&self, of: impl Fn(&Self) -> Ruling) -> Ruling {
        let mut all: Vec<Ruling> = self.less.iter().chain([self]).map(of).collect();
        let differ = all.iter().any(|ruling| ruling.decision != all[0].decision);
        let sure = |r: &Ruling| (r.decision != Decision::Unresolved, r.too_high, r.probability);
        all.sort_by(|a, b| sure(a).partial_cmp(&sure(b)).unwrap_or(Ordering::Equal));
        let least = all.swap_remove(0);
        if !differ {
            return least;
        }
        let reason = format!("{}, for a noise up to the one told", least.reason);
        Ruling { decision: Decision::Unresolved, reason, ..least }
    }

    /// Judges a claim; unresolved where the data do not decide.
    pub fn decide(&self, claim: &Claim) -> Ruling {
        self.agreed(|posterior| posterior.ruling(claim))
    }

    fn ruling(&self, claim: &Claim) -> Ruling {
        let (answer, mixture) = self.answer(claim);
        let doubts = &self.doubts;
        let doubt = match answer {
            Answer::Confirmed if claim.order > 0.0 => {
                doubts.always.as_ref().or(doubts.passing.as_ref())
            }
            Answer::Confirmed | Answer::Open => doubts.always.as_ref(),
            Answer::TooLow | Answer::TooHigh => doubts.always.as_ref().or(doubts.failing.as_ref()),
        };
        let decision = match answer {
            _ if doubt.is_some() => Decision::Unresolved,
            Answer::Confirmed if self.unexplained.is_some() => Decision::Unresolved,
            Answer::Confirmed => Decision::Pass,
            Answer::TooLow => Decision::Fail,
            Answer::TooHigh if claim.exact => Decision::Fail,
            Answer::TooHigh | Answer::Open => Decision::Unresolved,
        };
        let probability = probability(mixture, claim);
        let mut reason = self.reason(claim, answer, probability);
        if let Some(why) = doubt {
            reason = format!("{reason}; but {why}");
        }
        if let Some(why) = &self.unexplained {
            reason = format!("{reason}; but {why}: run it again, or state its floor");
        }
        let too_high = answer == Answer::TooHigh;
        let unexplained = self.unexplained.is_some() || doubts.nothing_but_rounding;
        Ruling { decision, reason, probability, too_high, unexplained }
    }

    /// The answer over all readings, with those that gave it; open if those with and without a floor disagree.
    fn answer(&self, claim: &Claim) -> (Answer, &Mixture) {
        let of = |mixture: &Mixture| self.answer_of(mixture, claim);
        if self.floor < FLOOR[0] {
            return (of(&self.all), &self.all);
        }
        let (sound, floored) = (of(&self.sound), of(&self.floored));
        match sound {
            _ if sound == floored => (sound, &self.all),
            // Together they confirm, and the floor is the less likely one.
            _ if self.floor < FLOOR[1]
                && (floored == Answer::Confirmed
                    || floored == Answer::Open && sound != Answer::TooLow)
                && of(&self.all) == Answer::Confirmed =>
            {
                (Answer::Confirmed, &self.all)
            }
            Answer::Confirmed if self.floor < FLOOR[1] => (sound, &self.sound),
            // The floor is rounding.
            _ if self.floor > FLOOR[1]
                && self.doubts.failing.is_some()
                && floored == Answer::Confirmed =>
            {
                (floored, &self.floored)
            }
            _ => (Answer::Open, &self.all),
        }
    }

    fn answer_of(&self, mixture: &Mixture, claim: &Claim) -> Answer {
        let too_low = mixture.below(claim.order - claim.clear_miss());
        let hidden = || {
            self.trend.before_floor.is_some_and(|slope| slope >= claim.order - claim.reach())
                || self.may_end_in_a_floor(claim)
        };
        if too_low > REFUTED
            && !self.rises_to(claim.order)
            && !hidden()
            && self.refuted_beside_floors(claim)
        {
            return Answer::TooLow;
        }
        let probability = probability(mixture, claim);
        let line = self.scatters_about(claim);
        let centred = || {
            let settled =
                self.turns_about(claim) || self.falls_about(claim) || self.arrives_at(claim.order);
            let near = if settled { NEAR_LINE } else { 0.5 };
            mixture.below(claim.order - near * claim.reach()) < 0.5
        };
        let agree = self.two_slopes_agree(claim) && self.holds_against_a_reference(claim);
        if probability > self.needed(claim)
            && (agree || claim.at_least)
            && (too_low < 0.5 || (probability > CERTAIN || line) && centred())
        {
            return Answer::Confirmed;
        }
        let wide = self.wide.as_ref().unwrap_or(mixture);
        if 1.0 - wide.below(claim.order + claim.clear_miss()) > REFUTED {
            Answer::TooHigh
        } else {
            Answer::Open
        }
    }

    /// Whether the order is too low also if floors that scatter are likelier, and of two slopes far too low.
    fn refuted_beside_floors(&self, claim: &Claim) -> bool {
        if let [first, last] = self.slopes[..]
            && claim.order - (2.0 * last - first) < FAR_BELOW
        {
            return false;
        }
        let below = |wary: &Mixture| wary.below(claim.order - claim.clear_miss());
        self.wary.as_ref().is_none_or(|wary| below(wary) > REFUTED)
    }

    /// Three levels give two slopes, a grid none. Where slopes scatter about the claim as by noise, the straight line is asked.
    fn needed(&self, claim: &Claim) -> f64 {
        match self.slopes.len() {
            _ if self.scatters_about(claim) => CONFIRMED_BY_LINE,
            slopes if slopes < FEWEST => CONFIRMED_BY_THREE,
            _ => CONFIRMED,
        }
    }

    /// Three and more slopes are all near the claim, or come nearer and end there, or scatter about a line that is near.
    fn scatters_about(&self, claim: &Claim) -> bool {
        let near = |slope: &f64| (slope - claim.order).abs() <= NEAR_SLOPES * claim.reach();
        let few = self.slopes.len() < FEWEST || self.trend.told_noise;
        self.turns_about(claim)
            || self.falls_about(claim)
            || !few && (self.slopes.iter().all(near) || self.arrives_at(claim.order))
    }

    /// Three and more slopes fall ever faster, as noise may have it, all within the tolerance and about the claim.
    fn falls_about(&self, claim: &Claim) -> bool {
        let changes: Vec<f64> = self.slopes.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let faster = |pair: &[f64]| pair[0] <= 0.0 && pair[1] <= EVER_FASTER * pair[0];
        let mean = self.slopes.iter().sum::<f64>() / self.slopes.len() as f64;
        let off = |slope: f64| (slope - claim.order).abs() / claim.reach();
        changes.len() > 1
            && !self.trend.told_noise
            && changes.windows(2).all(faster)
            && off(mean) <= NEAR_LINE
            && self.slopes.iter().all(|slope| off(*slope) <= 1.0)
    }

    /// The slopes go up and down, and the line through the errors is near the claim.
    fn turns_about(&self, claim: &Claim) -> bool {
        self.trend.scattered.is_some_and(|[slope, scatter]| {
            (slope - claim.order).abs() <= NEAR_LINE * claim.reach()
                && scatter <= MOST_SCATTER * claim.reach()
        })
    }

    /// Four and more slopes come nearer to the order at each level, and the last is it.
    fn arrives_at(&self, order: f64) -> bool {
        let away: Vec<f64> = self.slopes.iter().map(|slope| (slope - order).abs()).collect();
        away.len() > FEWEST
            && away.windows(2).all(|pair| pair[1] < pair[0])
            && away.last().is_some_and(|away| *away <= SAME)
    }

    /// Whether the slopes of three levels agree; more levels need no such check.
    fn two_slopes_agree(&self, claim: &Claim) -> bool {
        match self.slopes[..] {
            [first, last] => (last - first).abs() <= AGREEMENT * claim.order.abs(),
            _ => true,
        }
    }

    /// Few slopes that fall from the order on may be those of a floor that scatters.
    fn may_end_in_a_floor(&self, claim: &Claim) -> bool {
        let (Some(first), Some(last)) = (self.slopes.first(), self.slopes.last()) else {
            return false;
        };
        let falls = self.slopes.iter().all(|slope| *slope >= last - NOTHING);
        self.slopes.len() <= FEWEST + 1
            && falls
            && *first >= claim.order - claim.reach()
            && first - last > TOLERANCE
    }

    /// Two slopes that rise may be those of errors against a finer run, whose order is that of their differences.
    fn holds_against_a_reference(&self, claim: &Claim) -> bool {
        match (&self.slopes[..], self.trend.of_differences) {
            ([first, last], Some(order)) if last > first && self.trend.may_have_a_reference => {
                order >= claim.order - DIFFERENCES * claim.reach().min(TOLERANCE)
            }
            _ => true,
        }
    }

    /// Whether the slopes may still reach `order`. If the gap halves at each level, the remainder equals the last change;
    /// twice that is allowed, and anything where the slope rises by more than half. Of three levels whose slopes fall, a
    /// floor leaves the order of their differences.
    fn rises_to(&self, order: f64) -> bool {
        let [.., first, last] = self.slopes[..] else { return false };
        // Levels on which nothing falls are no start.
        if self.slopes.iter().all(|slope| *slope < NOTHING) {
            return false;
        }
        if last > first {
            last + 2.0 * (last - first) >= order || last > STEEP * first
        } else {
            self.slopes.len() < FEWEST
                && self.trend.of_differences.is_some_and(|found| found >= order)
        }
    }

    fn reason(&self, claim: &Claim, answer: Answer, probability: f64) -> String {
        let (interval, order, percent) = (self.interval, claim.order, percent(probability));
        let reach = claim.reach();
        match answer {
            Answer::Confirmed if claim.at_least => {
                format!("not below {order} - {reach:.2} with probability {percent}")
            }
            Answer::Confirmed => {
                format!("within {reach:.2} of {order} with probability {percent}")
            }
            Answer::TooLow if self.rises_slowly_to(order) => format!(
                "{interval} lies below {order}; slopes that rise so slowly are those of a factor |log h|, where theory has one"
            ),
            Answer::TooLow => format!("{interval} lies below {order}"),
            Answer::TooHigh if claim.exact => {
                format!("{interval} lies above {order}, which is exact")
            }
            Answer::TooHigh => format!(
                "{interval} lies above {order}: order too high (superconvergence, or a solution that does not excite the term)"
            ),
            Answer::Open => self.open_reason(claim, probability),
        }
    }

    /// Four and more slopes rise towards the order, and at last by nearly as much as before.
    fn rises_slowly_to(&self, order: f64) -> bool {
        let rise = self.slopes.windows(2).all(|pair| pair[1] > pair[0]);
        let [.., a, b, c] = self.slopes[..] else { return false };
        rise && self.slopes.len() > FEWEST && order - c < SLOWLY && c - b > ALIKE * (b - a)
    }

    /// Whether nobody has said what the errors are measured against.
    pub(crate) fn may_have_a_reference(&self) -> bool {
        self.trend.may_have_a_reference
    }

    /// Whether a floor is not to be ignored.
    pub(crate) fn may_have_a_floor(&self) -> bool {
        self.floor >= FLOOR[0]
    }

    fn open_reason(&self, claim: &Claim, probability: f64) -> String {
        if let Some(step) = self.floor_from {
            return format!(
                "the errors flatten from step {step:.3e} on: with a floor there the table does not tell"
            );
        }
        let order = claim.order;
        let likely = match claim.at_least {
            true => format!("not below {order} - {:.2}", claim.reach()),
            false => format!("within {:.2} of {order}", claim.reach()),
        };
        let likely = format!("{likely} with probability {}", percent(probability));
        if !self.refuted_beside_floors(claim) && self.below(order - claim.clear_miss()) > REFUTED {
            format!(
                "{} lies below {order}, unless a floor scatters below the errors",
                self.interval
            )
        } else if probability <= self.needed(claim) {
            format!("{likely} only")
        } else if let ([first, last], false) = (&self.slopes[..], self.two_slopes_agree(claim)) {
            format!(
                "{likely}, but the two slopes {first:.2} and {last:.2} differ too much to be one"
            )
        } else if self.floor >= FLOOR[0] {
            format!("{likely}, but with a floor below the finest errors it may be another")
        } else {
            format!("{likely}, but likelier below {:.2} than above", order - claim.clear_miss())
        }
    }
}

fn probability(mixture: &Mixture, claim: &Claim) -> f64 {
    let reach = claim.reach();
    let not_below = 1.0 - mixture.below(claim.order - reach);
    match claim.at_least {
        true => not_below,
        false => not_below - (1.0 - mixture.below(claim.order + reach)),
    }
}

/// In whole percent, but 0 and 100 only if exact.
fn percent(probability: f64) -> String {
    match 100.0 * probability {
        p if p > 99.0 => "above 99 %".to_owned(),
        p if p < 1.0 => "below 1 %".to_owned(),
        p => format!("{p:.0} %"),
    }
}
