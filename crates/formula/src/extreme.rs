//! Proved extremes of formulas over boxes, by branch and bound, and jumps.

use std::collections::BinaryHeap;

use super::enclosure::{Enclosing, Interval, Place};
use super::graph::{Graph, Node, Variable};

/// A proved bound of a function on a box, beside a value that it takes there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme<const N: usize> {
    /// No value is larger. Infinite if none was found.
    pub bound: f64,
    /// Some value is at least this; NaN if the function has no value at any point that was tried.
    pub attained: f64,
    /// Where `attained` is.
    pub at: [f64; N],
    /// The part of the box with this bound: where the function is large, or could not be bounded.
    pub part: [Interval; N],
}

/// When the search for an extreme ends, beside a box that cannot be halved.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Largest distance of bound and attained value, relative to the latter.
    pub tolerance: f64,
    /// Number of boxes; the bound is proved even if this comes first.
    pub boxes: usize,
}

impl Effort {
    /// For functions that cost some hundred operations: tens of milliseconds at most.
    pub const FORMULA: Self = Self { tolerance: 1e-7, boxes: 40_000 };
}

/// Distances of bound and attained value below this share of the largest |value| met are rounding.
const ROUNDING: f64 = 1e-13;
/// Boxes narrower than this, relative to their numbers, and to the whole, are not halved.
const NARROW: f64 = 1e-15;

#[derive(Clone, Copy)]
struct Part<const N: usize> {
    bound: f64,
    sides: [Interval; N],
}

impl<const N: usize> PartialEq for Part<N> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl<const N: usize> Eq for Part<N> {}

impl<const N: usize> PartialOrd for Part<N> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<const N: usize> Ord for Part<N> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound.total_cmp(&other.bound)
    }
}

/// The largest value on a box, by its proved ranges on parts of it. `range` must give an interval that contains all values;
/// what it gives for a point counts as attained.
pub fn largest<const N: usize>(
    whole: [Interval; N],
    effort: Effort,
    mut range: impl FnMut(&[Interval; N]) -> Interval,
) -> Extreme<N> {
    let mut found =
        Extreme { bound: f64::NEG_INFINITY, attained: f64::NAN, at: [f64::NAN; N], part: whole };
    let mut parts = BinaryHeap::new();
    let mut largest_met = 0.0f64;
    let mut meet = |at: [f64; N], value: Interval, found: &mut Extreme<N>| {
        if value.is_finite() {
            largest_met = largest_met.max(value.size());
        }
        let more = found.attained.is_nan() || value.low > found.attained;
        if value.low > f64::NEG_INFINITY && more {
            (found.attained, found.at) = (value.low, at);
        }
        largest_met
    };
    let mut size = 0.0;
    for at in [whole.map(|side| side.low), whole.map(|side| side.high), whole.map(Interval::middle)]
    {
        if at.iter().all(|value| value.is_finite()) {
            size = meet(at, range(&at.map(Interval::point)), &mut found);
        }
    }
    parts.push(Part { bound: range(&whole).high, sides: whole });
    let mut count = 1;
    while let Some(part) = parts.pop() {
        let enough = part.bound
            <= found.attained + effort.tolerance * found.attained.abs() + ROUNDING * size;
        let halves = halves(&part.sides, &whole);
        if enough || count >= effort.boxes || found.bound >= part.bound {
            if part.bound > found.bound {
                (found.bound, found.part) = (part.bound, part.sides);
            }
            return found;
        }
        let Some(halves) = halves else {
            // Not to be refined: what is left of it counts.
            (found.bound, found.part) = (part.bound, part.sides);
            continue;
        };
        for sides in halves {
            let at = sides.map(Interval::middle);
            size = meet(at, range(&at.map(Interval::point)), &mut found);
            parts.push(Part { bound: range(&sides).high, sides });
        }
        count += 2;
    }
    found
}

/// Halves along the side that is longest relative to the whole; None if it is too narrow.
fn halves<const N: usize>(
    sides: &[Interval; N],
    whole: &[Interval; N],
) -> Option<[[Interval; N]; 2]> {
    let share = |i: usize| {
        let (side, all) = (sides[i], whole[i]);
        match (side.is_finite(), all.is_finite()) {
            (false, _) => f64::INFINITY,
            (true, true) if all.low == all.high => 0.0,
            (true, true) => (side.high - side.low) / (all.high - all.low),
            (true, false) => (side.high - side.low) / side.size().max(1.0),
        }
    };
    let longest = (0..N).max_by(|&i, &j| share(i).total_cmp(&share(j)))?;
    let side = sides[longest];
    let middle = side.middle();
    let narrow = side.is_finite()
        && (share(longest) <= NARROW || side.high - side.low <= 2.0 * NARROW * side.size());
    if narrow || middle <= side.low || middle >= side.high {
        return None;
    }
    let mut halves = [*sides; 2];
    halves[0][longest].high = middle;
    halves[1][longest].low = middle;
    Some(halves)
}

/// A place where a function of one variable changes by more than rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// An interval of a few units in the last place.
    pub at: Interval,
    /// Contains the values on both sides.
    pub values: Interval,
}

/// Changes below this share of the values around are rounding, not jumps.
const SMALLEST_JUMP: f64 = 1e-9;

impl Graph {
    /// The largest |f| for a variable in an interval, all others zero.
    pub fn largest_modulus(&self, f: Node, v: Variable, over: Interval) -> Extreme<1> {
        let mut f = self.enclosing(f);
        largest([over], Effort::FORMULA, |[range]| bounded(&mut f, v, *range).abs())
    }

    /// The largest -f likewise: f is nowhere below minus the bound.
    pub fn largest_negative(&self, f: Node, v: Variable, over: Interval) -> Extreme<1> {
        let mut f = self.enclosing(f);
        largest([over], Effort::FORMULA, |[range]| -bounded(&mut f, v, *range))
    }

    /// A jump of `f`, continuous but for the branches of `if` and `sign`, for a variable in a finite interval.
    ///
    /// # Errors
    /// More branches than could be examined; the interval that was left over.
    pub fn jump(&self, f: Node, v: Variable, over: Interval) -> Result<Option<Jump>, Interval> {
        let mut f = self.enclosing(f);
        let mut left = vec![over];
        for _ in 0..Effort::FORMULA.boxes {
            let Some(part) = left.pop() else { return Ok(None) };
            // The size of the function around the part: at a kink from zero it is rounding in the part itself.
            let around = [over.low, 0.5 * part.low, part.low, part.high, 2.0 * part.high];
            let sizes = around.map(|end| {
                let end = Interval::point(end.clamp(over.low, over.high));
                f.over(&Place::origin().with(v, end)).range.size()
            });
            let finite = sizes.into_iter().filter(|size| size.is_finite());
            let size = finite.fold(0.0, f64::max);
            let found = f.over(&Place::origin().with(v, part));
            if !found.branches || found.range.high - found.range.low <= SMALLEST_JUMP * size {
                continue;
            }
            match halves(&[part], &[over]) {
                None => return Ok(Some(Jump { at: part, values: found.range })),
                Some([[first], [second]]) => left.extend([second, first]),
            }
        }
        Err(left.pop().unwrap_or(over))
    }
}

/// The values on a part; unbounded if the formula may have no value there, unless the part is so narrow that the formula
/// was seen to have one at both ends and between.
fn bounded(f: &mut Enclosing<'_>, v: Variable, range: Interval) -> Interval {
    let mut over = |range: Interval| f.over(&Place::origin().with(v, range));
    let found = over(range);
    if !found.undefined {
        return found.range;
    }
    let narrow = range.high - range.low <= 4.0 * NARROW * range.size();
    let known = narrow
        && [range.low, range.middle(), range.high]
            .iter()
            .all(|&end| over(Interval::point(end)).range.is_finite());
    if known { found.range } else { Interval::ALL }
}
