//! The error of one run from coarser companions: the same scene with 2h, 4h and with 2k, 4k.
//!
//! Space and time each have two differences of nested runs, d₁ of the two finest and d₂ of the two coarser, hence an
//! order p = log₂(d₂/d₁) and estimates d₁ F(p). In time, and wherever errors are aligned, F = 1/(2^p - 1)
//! (Richardson). In space u - u_h is nearly orthogonal to u_h - u_2h in the energy norm (Céa), which gives
//! F = 1/(4^p - 1)^½; in norms without orthogonality both are admissible. No estimate says which order the next
//! refinement would show: the interval is the hull over the observed order, half an order around it as far as it is
//! positive (with three levels there is no drift to measure), and the order of the theorem where the observed one is
//! within that half. Outside of these no number is given, but the reason.

mod advice;
mod answer;
mod companions;
mod quantity;

pub use advice::{Advice, Advised, CostSource, Goal, advise, costs};
pub use answer::{Estimated, estimate};
pub use companions::{
    Companions, NormDifferences, RunTime, Watch, companion_runs, companions, companions_and_bound,
};
use quantity::LEAST_ORDER;
pub use quantity::QuantityEstimate;

use judge::fit::{FLOORS_ABOVE, Interval};
use scene::setup::Setup;
use scene::{Direction, Norm, Prediction};

/// Half of the width of the orders that are admitted around an observed one. On h ≤ 1/8 the shipped scenes with P1 and P2
/// have local orders within 0.3 of their limit; a half leaves room for singular corners.
const HALF: f64 = 0.5;

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

/// One admissible reading of the differences: the error of the run, and how it changes with the step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Error of the run.
    pub value: f64,
    /// p towards coarser steps, where the companions are.
    pub order: f64,
    /// The order towards finer steps, where nothing was run: at most the order of elements and rule.
    pub finer: f64,
}

impl Reading {
    /// e (s/s₀)^p, with `ratio` = s/s₀ of a step to that of the run.
    pub(crate) fn at(self, ratio: f64) -> f64 {
        let order = if ratio < 1.0 { self.finer } else { self.order };
        self.value * ratio.powf(order)
    }
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
        /// All that is admissible, the best first.
        readings: Vec<Reading>,
        /// The most that elements, rule or theorem allow towards finer steps.
        most: f64,
    },
    /// There is no estimate, and why.
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
        // A theorem's order that is near the observed one is the likelier of both.
        let orders = std::iter::once(near.unwrap_or(order)).chain(orders).chain(near);
        let read = |order: f64| {
            let values = factors(order, how).into_iter().map(move |factor| factor * fine);
            values.map(move |value| Reading { value, order, finer: order })
        };
        let readings = orders.filter(|order| *order >= LEAST_ORDER).flat_map(read).collect();
        Self::Known { order, readings, most: f64::INFINITY }
    }

    /// Observed order.
    pub fn order(&self) -> Option<f64> {
        match self {
            Self::Known { order, .. } => Some(*order),
            _ => None,
        }
    }

    /// The order that is counted on towards finer steps, and the most that is possible.
    pub fn counted_on(&self) -> Option<[f64; 2]> {
        match self {
            Self::Known { readings, most, .. } => Some([readings.first()?.finer, *most]),
            _ => None,
        }
    }

    /// Best value and hull of the admissible ones, at `ratio` times the step of the run.
    pub fn at(&self, ratio: f64) -> Option<(f64, Interval)> {
        match self {
            Self::Below(bound) => Some((0.0, Interval { lo: 0.0, hi: *bound })),
            Self::Known { readings, .. } => {
                let values = readings.iter().map(|reading| reading.at(ratio));
                Some((readings.first()?.at(ratio), Interval::of(values)?))
            }
            Self::Unknown(_) => None,
        }
    }

    /// Keeps the orders of the readings towards finer steps within `limits`.
    fn limited(self, limits: Interval) -> Self {
        match self {
            Self::Known { order, readings, .. } => {
                let finer = |reading: Reading| reading.finer.max(limits.lo).min(limits.hi);
                let limit = |reading: Reading| Reading { finer: finer(reading), ..reading };
                let readings = readings.into_iter().map(limit).collect();
                Self::Known { order, readings, most: limits.hi }
            }
            other => other,
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
    /// The error in h.
    pub space: Part,
    /// The error in k.
    pub time: Part,
}

impl Estimate {
    /// Both together: best by the root of the sum of squares, the hull from the larger lower end (errors may cancel no
    /// further than that in either model of `fit`) to the sum of the upper ones. None where a part is unknown.
    pub fn total(&self) -> Option<(f64, Interval)> {
        self.at([1.0; 2])
    }

    /// The error at other steps, `ratios` = \[h/h₀, k/k₀\] to those of the run: E² = (e_h (h/h₀)^p)² + (e_k (k/k₀)^q)².
    pub(crate) fn at(&self, ratios: [f64; 2]) -> Option<(f64, Interval)> {
        let (h, space) = self.space.at(ratios[0])?;
        let (k, time) = self.time.at(ratios[1])?;
        Some((h.hypot(k), Interval { lo: space.lo.max(time.lo), hi: space.hi + time.hi }))
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

/// The order of a theorem for a norm, where the scene has one.
fn theory(setup: &Setup, norm: Norm, variable: Direction) -> Option<&Prediction> {
    setup.scene.predicts.iter().find(|p| p.norm == norm && p.variable == variable)
}

/// Orders towards finer steps. The most is that of elements and rule (strains and stresses have the degree of the
/// element, displacements one more; the trapezoidal rule k²), and no more than a theorem says, unless it says "at least".
/// The least is zero, unless the observed order is within `HALF` of that of a theorem: then it is below the theorem's by
/// twice their distance, the rule of `fit` for a drift, ± 2 |last - limit|.
fn limits(part: &Part, scheme: f64, theory: Option<&Prediction>) -> Interval {
    let hi = theory.filter(|p| !p.at_least).map_or(scheme, |p| p.order.min(scheme));
    let away = theory.zip(part.order()).map(|(p, order)| (p.order, (p.order - order).abs()));
    let lo = away.filter(|(_, away)| *away <= HALF).map_or(0.0, |(order, away)| order - 2.0 * away);
    Interval { lo, hi }
}

/// The orders in h and in k that elements and rule can have in a norm.
fn of_scheme(setup: &Setup, norm: Norm) -> [f64; 2] {
    let degree = setup.body.element.degree() as f64;
    let strains = how(norm) == Alignment::Orthogonal;
    [if strains { degree } else { degree + 1.0 }, setup.scene.time.rule.order()]
}

/// Galerkin's orthogonality is one of strains.
fn how(norm: Norm) -> Alignment {
    match norm {
        Norm::VMax | Norm::StressL2Max => Alignment::Orthogonal,
        _ => Alignment::Either,
    }
}

/// The error of the run in one norm.
pub fn norm_estimate(setup: &Setup, found: &Companions, differences: &NormDifferences) -> Estimate {
    let [in_h, in_k] =
        [Direction::H, Direction::K].map(|step| theory(setup, differences.norm, step));
    // A theorem that says "at least" does not contradict a higher order that is observed.
    let exact = |theory: Option<&Prediction>| theory.filter(|p| !p.at_least).map(|p| p.order);
    let [no_space, no_time] = found.missing.clone().map(|missing| missing.map(Part::Unknown));
    let space = match found.on_mesh {
        true => Part::Below(0.0),
        false => Part::of(differences.space, differences.floor, exact(in_h), how(differences.norm)),
    };
    let time = match found.no_history {
        true => Part::Below(0.0),
        false => Part::of(differences.time, differences.floor, exact(in_k), Alignment::Aligned),
    };
    let (space, time) = (no_space.unwrap_or(space), no_time.unwrap_or(time));
    let [most_h, most_k] = of_scheme(setup, differences.norm);
    let [of_h, of_k] = [limits(&space, most_h, in_h), limits(&time, most_k, in_k)];
    Estimate { space: space.limited(of_h), time: time.limited(of_k) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(part: &Part) -> (f64, f64, Interval) {
        match part {
            Part::Known { order, .. } => {
                let (value, interval) = part.at(1.0).expect("readings");
                (*order, value, interval)
            }
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
        let read = |value| Reading { value, order: 1.0, finer: 1.0 };
        let part = |value: f64| Part::Known {
            order: 1.0,
            readings: [1.0, 0.5, 2.0].map(|factor| read(factor * value)).to_vec(),
            most: 1.0,
        };
        let both = Estimate { space: part(3.0), time: part(4.0) };
        let (value, interval) = both.total().expect("a total");
        assert!((value - 5.0).abs() < 1e-15 && interval == Interval { lo: 2.0, hi: 14.0 });
        let one = Estimate { time: Part::Unknown("N = 3".into()), ..both };
        assert!(one.total().is_none() && one.reasons() == ["k: N = 3"]);
    }

    #[test]
    fn other_steps_have_the_errors_of_the_law() {
        // 3 h + 4 k² in the sense of u_h - u, at h = k = 1: d₁ = 3, d₂ = 6 in h, 12 and 48 in k.
        let space = Part::of([3.0, 6.0], 0.0, None, Alignment::Aligned);
        let time = Part::of([12.0, 48.0], 0.0, None, Alignment::Aligned);
        let estimate = Estimate { space, time };
        for [h, k] in [[1.0, 1.0], [0.25, 0.5], [2.0, 0.1], [0.1, 4.0]] {
            let (value, interval) = estimate.at([h, k]).expect("both parts");
            let truth = (3.0 * h).hypot(4.0 * k * k);
            // Roundings of powers.
            assert!((value / truth - 1.0).abs() < 1e-14, "{h} {k}: {value} {truth}");
            assert!(interval.contains(truth));
        }
        // Half an order less over a factor 16 is a factor 4 of error, beside that of the value itself.
        let (value, interval) = estimate.at([1.0 / 16.0; 2]).expect("both parts");
        assert!(interval.hi > 4.0 * value && interval.lo < value / 4.0);
        // Nothing falls faster than its elements, and nothing is changed towards coarser steps.
        let fast = Part::of([3.0, 12.0], 0.0, None, Alignment::Orthogonal);
        let limited = fast.clone().limited(Interval { lo: 0.0, hi: 1.0 });
        let best = |part: &Part, ratio: f64| part.at(ratio).expect("a value").0;
        assert!((best(&limited, 0.25) / best(&limited, 1.0) - 0.25).abs() < 1e-15);
        assert!((best(&fast, 0.25) / best(&fast, 1.0) - 0.0625).abs() < 1e-15);
        assert_eq!(best(&limited, 4.0), best(&fast, 4.0));
        // A theorem bounds the slowest reading as well: without it half an order less goes on.
        let upper = |part: &Part| part.at(1.0 / 64.0).expect("a hull").1.hi;
        let slow = fast.clone().limited(Interval { lo: 0.9, hi: 1.0 });
        let unlimited = Part::of([3.0, 6.0], 0.0, None, Alignment::Orthogonal);
        let bounded = unlimited.clone().limited(Interval { lo: 0.9, hi: 1.0 });
        assert!((upper(&unlimited) / upper(&bounded) / 64f64.powf(0.4) - 1.0).abs() < 1e-14);
        assert!(upper(&slow) <= upper(&limited));
    }
}
