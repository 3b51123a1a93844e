//! The error of one run from coarser companions: the same scene with 2h, 4h and with 2k, 4k.
//!
//! Space and time each have two differences of nested runs, d₁ of the two finest and d₂ of the two coarser, hence an
//! order p = log₂(d₂/d₁) and estimates d₁ F(p). In time, and wherever errors are aligned, F = 1/(2^p - 1)
//! (Richardson). In space u - u_h is nearly orthogonal to u_h - u_2h in the energy norm (Céa), which gives
//! F = 1/(4^p - 1)^½; in norms without orthogonality both are admissible. No estimate says which order the next
//! refinement would show: the interval is the hull over the observed order, half an order around it as far as it is
//! positive (with three levels there is no drift to measure), and the order of the theorem where the observed one is
//! within that half. Outside of these no number is given, but the reason.

mod companions;
mod quantity;

pub use companions::{Companions, NormDifferences, Scalar, companion_runs, companions};
pub use quantity::{QuantityEstimate, quantity};

use crate::fit::{FLOORS_ABOVE, Interval};
use crate::scene::{Direction, Norm};
use crate::setup::Setup;

/// Half of the width of the orders that are admitted around an observed one. A P1 run on h ≤ 1/8 of the shipped scenes
/// has local orders within 0.3 of their limit; a half leaves room for singular corners.
const HALF: f64 = 0.5;
/// Below this order differences fall too slowly to say anything about what is left.
const LEAST_ORDER: f64 = 0.3;

/// How the errors of two refinements lie to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// One direction: e_2h = e_h + d.
    Aligned,
    /// At right angles, e_2h² = e_h² + d².
    Orthogonal,
    /// Not known: both.
    Either,
}

/// The error of a run in one step.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// The run does not depend on the step but for rounding, which bounds the error.
    Below(f64),
    /// An estimate.
    Known {
        /// Observed order.
        order: f64,
        /// Best value.
        value: f64,
        /// Hull of the admissible ones.
        interval: Interval,
    },
    /// None, and why.
    Unknown(String),
}

impl Part {
    /// Reads d₁ and d₂; `theory` is the order of a theorem, where there is one.
    pub fn of([fine, coarse]: [f64; 2], floor: f64, theory: Option<f64>, how: Alignment) -> Self {
        if !(fine.is_finite() && coarse.is_finite()) {
            return Self::Unknown("a difference of runs is no number".into());
        }
        if fine.max(coarse) <= FLOORS_ABOVE * floor {
            return Self::Below(FLOORS_ABOVE * floor);
        }
        if fine <= FLOORS_ABOVE * floor {
            let text = format!(
                "the last difference {fine:.1e} is not above {FLOORS_ABOVE} floors of {floor:.1e}"
            );
            return Self::Unknown(text);
        }
        let order = (coarse / fine).log2();
        if order < LEAST_ORDER {
            return Self::Unknown(format!(
                "pre-asymptotic: differences of {coarse:.2e} and {fine:.2e} have order {order:.2}"
            ));
        }
        if let Some(theory) = theory.filter(|theory| order > theory + 2.0 * HALF) {
            return Self::Unknown(format!(
                "pre-asymptotic: order {order:.2} observed, {theory} predicted; a coarse companion does not resolve the solution"
            ));
        }
        let near = theory.filter(|theory| (theory - order).abs() <= HALF);
        let orders = [order, order - HALF, order + HALF].into_iter();
        let orders = orders.chain(near).filter(|order| *order >= LEAST_ORDER);
        let hull = Interval::of(orders.flat_map(|order| factors(order, how)).map(|f| f * fine));
        // The last two agree with a theorem better than with each other's noise.
        let best = factors(near.unwrap_or(order), how)[0] * fine;
        match hull {
            Some(interval) => Self::Known { order, value: best, interval },
            None => Self::Unknown("no admissible order".into()),
        }
    }

    fn value(&self) -> Option<f64> {
        match self {
            Self::Below(_) => Some(0.0),
            Self::Known { value, .. } => Some(*value),
            Self::Unknown(_) => None,
        }
    }

    fn interval(&self) -> Option<Interval> {
        match self {
            Self::Below(bound) => Some(Interval { lo: 0.0, hi: *bound }),
            Self::Known { interval, .. } => Some(*interval),
            Self::Unknown(_) => None,
        }
    }
}

/// e_h over d₁ for an order, the likelier first.
fn factors(order: f64, how: Alignment) -> Vec<f64> {
    let aligned = 1.0 / (2f64.powf(order) - 1.0);
    let orthogonal = 1.0 / (4f64.powf(order) - 1.0).sqrt();
    match how {
        Alignment::Aligned => vec![aligned],
        Alignment::Orthogonal => vec![orthogonal],
        Alignment::Either => vec![orthogonal, aligned],
    }
}

/// The error of a run in both steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Of h.
    pub space: Part,
    /// Of k.
    pub time: Part,
}

impl Estimate {
    /// Both together: best by the root of the sum of squares, the hull from the larger lower end (errors may cancel no
    /// further than that in either model of `fit`) to the sum of the upper ones. None where a part is unknown.
    pub fn total(&self) -> Option<(f64, Interval)> {
        let value = self.space.value()?.hypot(self.time.value()?);
        let (space, time) = (self.space.interval()?, self.time.interval()?);
        Some((value, Interval { lo: space.lo.max(time.lo), hi: space.hi + time.hi }))
    }

    /// Why there is no total.
    pub fn reasons(&self) -> Vec<String> {
        let reason = |name: &str, part: &Part| match part {
            Part::Unknown(reason) => Some(format!("{name}: {reason}")),
            _ => None,
        };
        [reason("h", &self.space), reason("k", &self.time)].into_iter().flatten().collect()
    }
}

/// The error of the run in one norm.
pub fn norm_estimate(setup: &Setup, found: &Companions, own: &NormDifferences) -> Estimate {
    let theory = |variable: Direction| {
        let predicts = setup.scene.predicts.iter();
        let serves = |p: &&crate::scene::Prediction| p.norm == own.norm && p.variable == variable;
        predicts.filter(serves).map(|p| p.order).next()
    };
    let how = match own.norm {
        Norm::VMax | Norm::StressL2Max => Alignment::Orthogonal,
        _ => Alignment::Either,
    };
    let [no_space, no_time] = found.missing.clone().map(|missing| missing.map(Part::Unknown));
    let space = match found.own_on_each_mesh {
        true => Part::Below(0.0),
        false => Part::of(own.space, own.floor, theory(Direction::H), how),
    };
    let time = Part::of(own.time, own.floor, theory(Direction::K), Alignment::Aligned);
    Estimate { space: no_space.unwrap_or(space), time: no_time.unwrap_or(time) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(part: &Part) -> (f64, f64, Interval) {
        match part {
            Part::Known { order, value, interval } => (*order, *value, *interval),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn aligned_errors_are_found_with_their_order() {
        // u_h = u + C h²: e = 1, d₁ = 3, d₂ = 12.
        let (order, value, interval) =
            known(&Part::of([3.0, 12.0], 0.0, Some(2.0), Alignment::Aligned));
        assert!((order - 2.0).abs() < 1e-15 && (value - 1.0).abs() < 1e-15);
        assert!(interval.contains(1.0) && interval.lo > 0.5 && interval.hi < 1.7);
        // The estimate of orthogonal errors does not hold them.
        let (_, _, wrong) = known(&Part::of([3.0, 12.0], 0.0, Some(2.0), Alignment::Orthogonal));
        assert!(wrong.contains(3.0 / 15f64.sqrt()));
    }

    #[test]
    fn orthogonal_errors_are_found_with_their_order() {
        // e² = h²: e = 1, 2, 4 at h, 2h, 4h; d₁² = 3, d₂² = 12.
        let (fine, coarse) = (3f64.sqrt(), 12f64.sqrt());
        let (order, value, interval) =
            known(&Part::of([fine, coarse], 0.0, Some(1.0), Alignment::Orthogonal));
        assert!((order - 1.0).abs() < 1e-15 && (value - 1.0).abs() < 1e-15);
        assert!(interval.contains(1.0) && interval.hi < 2.0);
        let (_, _, both) = known(&Part::of([fine, coarse], 0.0, None, Alignment::Either));
        assert!(both.contains(1.0) && both.contains(fine));
    }

    #[test]
    fn what_is_not_asymptotic_has_no_estimate() {
        let unknown = |part: Part| matches!(part, Part::Unknown(_));
        // Differences that grow, that stand still, that fall far faster than the theorem says, NaN.
        for (d, theory) in [
            ([2.0, 1.0], None),
            ([1.0, 1.0], Some(1.0)),
            ([1.0, 10.0], Some(1.0)),
            ([f64::NAN, 1.0], None),
        ] {
            assert!(unknown(Part::of(d, 0.0, theory, Alignment::Aligned)), "{d:?}");
        }
        assert!(unknown(Part::of([1e-12, 1.0], 1e-12, None, Alignment::Aligned)));
        let below = Part::of([1e-13, 1e-13], 1e-13, None, Alignment::Aligned);
        assert_eq!(below, Part::Below(FLOORS_ABOVE * 1e-13));
    }

    #[test]
    fn a_total_needs_both_parts() {
        let part = |value: f64| Part::Known {
            order: 1.0,
            value,
            interval: Interval { lo: 0.5 * value, hi: 2.0 * value },
        };
        let both = Estimate { space: part(3.0), time: part(4.0) };
        let (value, interval) = both.total().expect("a total");
        assert!((value - 5.0).abs() < 1e-15 && interval == Interval { lo: 2.0, hi: 14.0 });
        let one = Estimate { time: Part::Unknown("N = 3".into()), ..both };
        assert!(one.total().is_none() && one.reasons() == ["k: N = 3"]);
    }
}
