//! Where the panels of hereditary integrals are broken.
//!
//! An integrand has a kink or a jump where a guard changes sign.  Guards are
//! watched at a few times of every panel; a change of sign is closed in on
//! until the two sides are neighbouring numbers, and the panel is broken there.

use super::history::HistoryPlan;
use super::past::Past;
use super::sampler::{Sampler, Surroundings};
use super::scalar::class;

/// Parts a bracket is cut into at first, to find the first of several changes.
const SECTIONS: usize = 16;
/// Of so many rounds after the first one halves the bracket, whatever the guard looks like.
const HALVED: usize = 4;
/// Rounds after which a bracket of any width has closed: 60 halvings.
const ROUNDS: usize = 60 * HALVED;
/// Changes of sign of one guard between two watches that are told apart.
const CHANGES: usize = 6;
/// Breaks closer than this, relative to the times, are one.
const APART: f64 = 1e-14;

/// The interval of one lane's integral: a panel or the first part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lane {
    pub(super) tuple: u32,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// A part of a lane's interval on which the integrand is smooth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) lane: u32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Piece {
    /// Its two halves, in order of integration.
    pub(super) fn halves(&self) -> [Self; 2] {
        let middle = 0.5 * (self.from + self.to);
        [Self { to: middle, ..*self }, Self { from: middle, ..*self }]
    }
}

/// An interval at whose ends a guard has different signs.
#[derive(Clone, Copy, Debug)]
struct Bracket {
    lane: usize,
    guard: usize,
    low: End,
    high: End,
    /// The watch at which the search ends.
    watch: End,
    /// Which end the last round moved.
    moved: Option<Side>,
    rounds: usize,
    changes: usize,
}

/// A guard at a time.
#[derive(Clone, Copy, Debug)]
struct End {
    time: f64,
    sign: i8,
    /// By which the place of the zero is guessed: the guard's own value, or less.
    value: f64,
}

impl End {
    fn new(time: f64, value: f64) -> Self {
        Self { time, sign: class(value), value }
    }
}

/// The end of a bracket.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Low,
    High,
}

/// The search for breaks, with its scratch memory.
#[derive(Clone, Debug)]
pub(super) struct Breaks {
    sampler: Sampler,
    /// Over how many intervals the guards of each lane are watched.
    watches: Vec<usize>,
    brackets: Vec<Bracket>,
    cuts: Vec<(usize, f64)>,
    pub(super) pieces: Vec<Piece>,
}

impl Breaks {
    pub(super) fn new(nested: &[usize]) -> Self {
        Self {
            sampler: Sampler::new(nested),
            watches: Vec::new(),
            brackets: Vec::new(),
            cuts: Vec::new(),
            pieces: Vec::new(),
        }
    }

    /// The pieces of all lanes, in order of lanes and of integration.
    pub(super) fn find(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
    ) {
        self.cuts.clear();
        if !plan.watch.results.is_empty() {
            self.watch(plan, below, all, lanes);
            while !self.brackets.is_empty() {
                self.narrow(plan, below, all, lanes);
            }
        }
        let order = |s: f64, lane: usize| (s - lanes[lane].from).abs();
        self.cuts.sort_by(|a, b| (a.0.cmp(&b.0)).then(order(a.1, a.0).total_cmp(&order(b.1, b.0))));
        self.pieces.clear();
        let mut cuts = self.cuts.iter().peekable();
        for (k, lane) in lanes.iter().enumerate() {
            let apart = APART * lane.from.abs().max(lane.to.abs());
            let mut from = lane.from;
            while let Some(&(_, cut)) = cuts.next_if(|(owner, _)| *owner == k) {
                if (cut - from).abs() > apart && (lane.to - cut).abs() > apart {
                    self.pieces.push(Piece { lane: k as u32, from, to: cut });
                    from = cut;
                }
            }
            if from != lane.to {
                self.pieces.push(Piece { lane: k as u32, from, to: lane.to });
            }
        }
    }

    /// Opens a bracket wherever a guard changes sign between watches.
    fn watch(&mut self, plan: &HistoryPlan, below: &mut [Past], all: Surroundings, lanes: &[Lane]) {
        self.sampler.clear();
        self.watches.clear();
        for lane in lanes {
            let watches = plan.watches(lane.to - lane.from);
            let at = |k: usize| match k == watches {
                true => lane.to,
                false => lane.from + (lane.to - lane.from) * (k as f64 / watches as f64),
            };
            self.sampler.extend(lane.tuple, (0..watches + 1).map(at));
            self.watches.push(watches);
        }
        self.sampler.run(&plan.watch, plan.mask, below, all);
        self.brackets.clear();
        for (guard, values) in self.sampler.values.iter().enumerate() {
            let mut first = 0;
            for (lane, &watches) in self.watches.iter().enumerate() {
                let (values, times) = (&values[first..], &self.sampler.times[first..]);
                first += watches + 1;
                if is_of_one_sign(&values[..=watches]) {
                    continue;
                }
                for k in 0..watches {
                    let [low, high] = [k, k + 1].map(|k| End::new(times[k], values[k]));
                    if low.sign != high.sign {
                        let (moved, rounds, changes) = (None, 0, 0);
                        let watch = high;
                        let bracket =
                            Bracket { lane, guard, low, high, watch, moved, rounds, changes };
                        self.brackets.push(bracket);
                    }
                }
            }
        }
    }

    /// One round of all brackets; closed ones become breaks.
    fn narrow(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
    ) {
        self.sampler.clear();
        for bracket in &self.brackets {
            let tuple = lanes[bracket.lane].tuple;
            if bracket.rounds > 0 {
                self.sampler.extend(tuple, std::iter::once(bracket.guess()));
                continue;
            }
            let at = |k: usize| bracket.at(k as f64 / SECTIONS as f64);
            self.sampler.extend(tuple, (1..SECTIONS).map(at));
        }
        self.sampler.run(&plan.watch, plan.mask, below, all);
        let (values, times) = (&self.sampler.values, &self.sampler.times);
        let (cuts, mut place) = (&mut self.cuts, 0);
        self.brackets.retain_mut(|bracket| {
            let mine = place..place + if bracket.rounds > 0 { 1 } else { SECTIONS - 1 };
            place = mine.end;
            let values = &values[bracket.guard][mine.clone()];
            bracket.narrow(times[mine].iter().zip(values).map(|(t, v)| End::new(*t, *v)));
            if !bracket.is_closed() {
                return true;
            }
            cuts.push((bracket.lane, bracket.high.time));
            bracket.reopen()
        });
    }
}

/// Whether all values are above zero, or all below.
fn is_of_one_sign(values: &[f64]) -> bool {
    // Without a jump for each of them.
    values.iter().fold(true, |all, value| all & (*value > 0.0))
        || values.iter().fold(true, |all, value| all & (*value < 0.0))
}

impl Bracket {
    /// The time at a share of the bracket.
    fn at(&self, share: f64) -> f64 {
        self.low.time + (self.high.time - self.low.time) * share
    }

    /// Where the guard has its zero if it is a line (regula falsi, a lagging end at half its value), but inside; the
    /// middle in some rounds, and wherever an end has no such value.
    fn guess(&self) -> f64 {
        let (low, high) = (&self.low, &self.high);
        let rise = high.value - low.value;
        if self.rounds.is_multiple_of(HALVED) || !(low.value * high.value < 0.0 && rise.is_finite())
        {
            return self.at(0.5);
        }
        // From the end that is closer.
        let zero = if low.value.abs() < high.value.abs() {
            low.time + (high.time - low.time) * (-low.value / rise)
        } else {
            high.time - (high.time - low.time) * (high.value / rise)
        };
        if low.time < high.time {
            zero.clamp(low.time.next_up(), high.time.next_down())
        } else {
            zero.clamp(high.time.next_up(), low.time.next_down())
        }
    }

    /// Moves to the first of the parts between some times at whose end the sign is another.
    fn narrow(&mut self, inside: impl Iterator<Item = End>) {
        for end in inside {
            let side = if end.sign == self.low.sign { Side::Low } else { Side::High };
            let (own, other) = match side {
                Side::Low => (&mut self.low, &mut self.high),
                Side::High => (&mut self.high, &mut self.low),
            };
            // The guess was met: its neighbours are tried next.
            let met = end.value == 0.0 && own.value != 0.0;
            let value = if met { f64::MIN_POSITIVE.copysign(own.value) } else { end.value };
            *own = End { value, ..end };
            if self.moved == Some(side) {
                other.value *= 0.5;
            }
            self.moved = (self.rounds > 0).then_some(side);
            if side == Side::High {
                break;
            }
        }
        self.rounds += 1;
    }

    fn is_closed(&self) -> bool {
        let middle = self.at(0.5);
        middle == self.low.time || middle == self.high.time || self.rounds >= ROUNDS
    }

    /// Whether the sign changes again before the watch; the bracket then
    /// covers the rest.
    fn reopen(&mut self) -> bool {
        self.changes += 1;
        self.rounds = 0;
        self.moved = None;
        (self.low, self.high) = (self.high, self.watch);
        self.low.sign != self.watch.sign && self.changes < CHANGES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The break of a guard between two watches, and how many values it took.
    fn closed(guard: impl Fn(f64) -> f64, [low, high]: [f64; 2]) -> (f64, usize) {
        let end = |time: f64| End::new(time, guard(time));
        let (low, high) = (end(low), end(high));
        let (lane, moved, rounds, changes) = (0, None, 0, 0);
        let mut bracket =
            Bracket { lane, guard: 0, low, high, watch: high, moved, rounds, changes };
        let parts = (1..SECTIONS).map(|k| end(bracket.at(k as f64 / SECTIONS as f64)));
        bracket.narrow(parts.collect::<Vec<_>>().into_iter());
        let mut values = SECTIONS - 1;
        while !bracket.is_closed() {
            bracket.narrow(std::iter::once(end(bracket.guess())));
            values += 1;
        }
        assert!(bracket.rounds < ROUNDS);
        assert!(class(guard(bracket.low.time)) == low.sign);
        (bracket.high.time, values)
    }

    #[test]
    fn smooth_guards_take_few_values_and_others_a_bounded_number() {
        let root = 0.3f64.sqrt();
        let smooth: [&dyn Fn(f64) -> f64; 3] =
            [&|t| t * t - 0.3, &|t| (0.3 - t * t) * t.exp(), &|t| (t * t - 0.3).tanh()];
        for (k, guard) in smooth.iter().enumerate() {
            for ends in [[0.5, 0.6], [0.6, 0.5]] {
                let (found, values) = closed(guard, ends);
                // A value of the guard is good to a few roundings of numbers of order one.
                assert!((found - root).abs() < 1e-15, "{k}: {found}");
                // Sections take 13 rounds of 15.
                assert!(values < 40, "{k}: {values}");
            }
        }
        let other: [&dyn Fn(f64) -> f64; 5] = [
            &|t| if t < root { -1.0 } else { 1e9 },
            &|t| (t - root).max(0.0),
            &|t| (root - t).max(0.0),
            &|t| (t - root).powi(9),
            &|t| if t < root { f64::NEG_INFINITY } else { 1.0 },
        ];
        for (k, guard) in other.iter().enumerate() {
            for ends in [[0.5, 0.6], [0.6, 0.5]] {
                let (found, values) = closed(guard, ends);
                assert!((found - root).abs() < 1e-15, "{k}: {found}");
                assert!(values < HALVED * 60, "{k}: {values}");
            }
        }
    }

    /// Of three changes the first, where the sections tell them apart.
    #[test]
    fn the_first_of_several_changes_is_found() {
        let guard = |t: f64| (t - 0.21) * (t - 0.42) * (t - 0.9);
        let (found, _) = closed(guard, [0.0, 1.0]);
        assert!((found - 0.21).abs() < 1e-15, "{found}");
    }
}
