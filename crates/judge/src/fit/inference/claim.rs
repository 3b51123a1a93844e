//! A claimed order against what a table says of it.

use super::{FEWEST, Mixture, Posterior};
use crate::fit::Decision;

/// How far an order may lie from the claim unless the claim says otherwise.
pub const TOLERANCE: f64 = 0.15;
/// The tolerance is at most this share of the order.
const SHARE: f64 = 0.4;
/// An order that misses the claim by less is no refutation.
const CLEAR_MISS: f64 = 0.05;
/// Probability of a miss that refutes.
const REFUTED: f64 = 0.975;
/// Probability of a hit that confirms; less with three levels, which have to agree instead.
const CONFIRMED: f64 = 0.80;
const CONFIRMED_BY_THREE: f64 = 0.70;
/// Beyond this a hit counts where the median lies within half the tolerance of the claim.
const CERTAIN: f64 = 0.95;
/// The two slopes of three levels may differ by this share of the order.
const AGREEMENT: f64 = 0.15;
/// Below this probability a floor is not considered; above the other, it is the likelier reading.
const FLOOR: [f64; 2] = [0.05, 0.5];

/// What somebody claims of an order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Claim {
    /// The order p*.
    pub order: f64,
    /// It is a lower bound.
    pub at_least: bool,
    /// A higher order refutes it as well.
    pub exact: bool,
    /// How far the order may lie from it.
    pub tolerance: f64,
    /// Power M of a factor |log h|^M.
    pub log: f64,
}

/// A claim that cannot be judged.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ClaimError {
    /// Not a finite number.
    #[error("the order {0} is no finite number; 1, 1.5 and 2 are")]
    Order(f64),
    /// Not a positive number.
    #[error("the tolerance {0} is no positive number; 0.15 is")]
    Tolerance(f64),
}

impl Claim {
    /// Order `order`, within 0.15, neither a lower bound nor refuted by higher orders.
    ///
    /// # Errors
    /// [`ClaimError::Order`].
    pub fn new(order: f64) -> Result<Self, ClaimError> {
        let claim = Self { order, at_least: false, exact: false, tolerance: TOLERANCE, log: 0.0 };
        claim.checked()
    }

    /// The claim itself, if it can be judged.
    ///
    /// # Errors
    /// [`ClaimError`].
    pub fn checked(self) -> Result<Self, ClaimError> {
        if !self.order.is_finite() {
            return Err(ClaimError::Order(self.order));
        }
        if !self.tolerance.is_finite() || self.tolerance <= 0.0 {
            return Err(ClaimError::Tolerance(self.tolerance));
        }
        Ok(self)
    }

    /// The tolerance, less for small orders: 0.5 is not told from 0.35 by 0.15.
    fn reach(&self) -> f64 {
        match self.order > 0.0 {
            true => self.tolerance.min(SHARE * self.order),
            false => self.tolerance,
        }
    }
}

/// A decision with its reason.
#[derive(Debug, Clone, PartialEq)]
pub struct Ruling {
    /// Pass, fail or unresolved.
    pub decision: Decision,
    /// One sentence.
    pub reason: String,
    /// Probability that the order is within the tolerance of the claim; of a lower bound, that it is not below.
    pub probability: f64,
    /// The order is settled, above the claim.
    pub too_high: bool,
}

/// What a mixture says of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    Confirmed,
    TooLow,
    TooHigh,
    Open,
}

impl Posterior {
    /// Judges a claim; unresolved where the table does not tell.
    pub fn decide(&self, claim: &Claim) -> Ruling {
        let answer = self.answer(claim);
        let decision = match answer {
            Answer::Confirmed => Decision::Pass,
            Answer::TooLow => Decision::Fail,
            Answer::TooHigh if claim.exact => Decision::Fail,
            Answer::TooHigh | Answer::Open => Decision::Unresolved,
        };
        let probability = probability(&self.all, claim);
        let reason = self.reason(claim, answer, probability);
        Ruling { decision, reason, probability, too_high: answer == Answer::TooHigh }
    }

    /// The answer of all readings; open where those with and without a floor disagree.
    fn answer(&self, claim: &Claim) -> Answer {
        let of = |mixture: &Mixture| self.answer_of(mixture, claim);
        if self.floor < FLOOR[0] {
            return of(&self.all);
        }
        let (sound, floored) = (of(&self.sound), of(&self.floored));
        match sound {
            _ if sound == floored => sound,
            Answer::Confirmed if self.floor < FLOOR[1] => sound,
            _ => Answer::Open,
        }
    }

    fn answer_of(&self, mixture: &Mixture, claim: &Claim) -> Answer {
        let agree = self.two_slopes_agree(claim);
        let probability = probability(mixture, claim);
        let too_low = mixture.below(claim.order - CLEAR_MISS);
        let centred = mixture.below(claim.order - 0.5 * claim.reach()) < 0.5;
        let too_high = 1.0 - mixture.below(claim.order + CLEAR_MISS);
        if too_low > REFUTED && !self.rises_to(claim.order) {
            Answer::TooLow
        } else if probability > self.needed()
            && (too_low < 0.5 || (probability > CERTAIN && centred))
            && (agree || claim.at_least)
        {
            Answer::Confirmed
        } else if too_high > REFUTED {
            Answer::TooHigh
        } else {
            Answer::Open
        }
    }

    /// Three levels have two slopes, a grid none.
    fn needed(&self) -> f64 {
        if self.slopes.len() < FEWEST { CONFIRMED_BY_THREE } else { CONFIRMED }
    }

    /// Whether the slopes of three levels are one; more levels have no such rule.
    fn two_slopes_agree(&self, claim: &Claim) -> bool {
        match self.slopes[..] {
            [first, last] => (last - first).abs() <= AGREEMENT * claim.order.abs(),
            _ => true,
        }
    }

    /// Whether the slopes of three levels rise fast enough to reach an order: where what is missing halves with every
    /// level, it is the last change; twice that may be on its way.
    fn rises_to(&self, order: f64) -> bool {
        let [first, last] = self.slopes[..] else { return false };
        last > first && last + 2.0 * (last - first) >= order
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

    /// Why a claim stays open.
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
        if probability <= self.needed() {
            format!("{likely} only")
        } else if let ([first, last], false) = (&self.slopes[..], self.two_slopes_agree(claim)) {
            format!(
                "{likely}, but the two slopes {first:.2} and {last:.2} differ too much to be one"
            )
        } else if self.floor >= FLOOR[0] {
            format!("{likely}, but with a floor below the finest errors it may be another")
        } else {
            format!("{likely}, but likelier below {:.2} than above", order - CLEAR_MISS)
        }
    }
}

/// Probability that the claim holds.
fn probability(mixture: &Mixture, claim: &Claim) -> f64 {
    let reach = claim.reach();
    let not_below = 1.0 - mixture.below(claim.order - reach);
    match claim.at_least {
        true => not_below,
        false => not_below - (1.0 - mixture.below(claim.order + reach)),
    }
}

/// In whole percent, never 0 or 100 where it is not.
fn percent(probability: f64) -> String {
    match 100.0 * probability {
        p if p > 99.0 => "above 99 %".to_owned(),
        p if p < 1.0 => "below 1 %".to_owned(),
        p => format!("{p:.0} %"),
    }
}
