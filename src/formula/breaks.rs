//! Where the panels of hereditary integrals are broken.
//!
//! An integrand has a kink or a jump where a guard changes sign.  Guards are
//! watched at a few times of every panel; a change of sign is closed in on
//! until the two sides are neighbouring numbers, and the panel is broken there.

use super::history::HistoryPlan;
use super::past::Past;
use super::sampler::{Sampler, Surroundings};
use super::scalar::class;

/// Parts a bracket is cut into at each round.
const SECTIONS: usize = 16;
/// Rounds after which a bracket of any width has closed.
const ROUNDS: usize = 18;
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
    low: f64,
    high: f64,
    low_sign: i8,
    high_sign: i8,
    /// The watch at which the search ends, and the sign there.
    end: f64,
    end_sign: i8,
    rounds: usize,
    changes: usize,
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
            for k in 0..watches {
                let part = k as f64 / watches as f64;
                self.sampler.push(lane.tuple, lane.from + (lane.to - lane.from) * part);
            }
            self.sampler.push(lane.tuple, lane.to);
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
                    let (low_sign, end_sign) = (class(values[k]), class(values[k + 1]));
                    if low_sign != end_sign {
                        self.brackets.push(Bracket {
                            lane,
                            guard,
                            low: times[k],
                            high: times[k + 1],
                            low_sign,
                            high_sign: end_sign,
                            end: times[k + 1],
                            end_sign,
                            rounds: 0,
                            changes: 0,
                        });
                    }
                }
            }
        }
    }

    /// One round of section of all brackets; closed ones become breaks.
    fn narrow(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
    ) {
        self.sampler.clear();
        for bracket in &self.brackets {
            for k in 1..SECTIONS {
                let part = k as f64 / SECTIONS as f64;
                let time = bracket.low + (bracket.high - bracket.low) * part;
                self.sampler.push(lanes[bracket.lane].tuple, time);
            }
        }
        self.sampler.run(&plan.watch, plan.mask, below, all);
        let (values, times) = (&self.sampler.values, &self.sampler.times);
        let (cuts, mut place) = (&mut self.cuts, 0);
        self.brackets.retain_mut(|bracket| {
            let mine = place..place + SECTIONS - 1;
            place = mine.end;
            let signs = values[bracket.guard][mine.clone()].iter().map(|v| class(*v));
            bracket.section(&times[mine], signs);
            if !bracket.is_closed() {
                return true;
            }
            cuts.push((bracket.lane, bracket.high));
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
    /// Moves to the first part at whose end the sign is another.
    fn section(&mut self, times: &[f64], signs: impl Iterator<Item = i8>) {
        for (&time, sign) in times.iter().zip(signs) {
            if sign != self.low_sign {
                self.high = time;
                self.high_sign = sign;
                break;
            }
            self.low = time;
        }
        self.rounds += 1;
    }

    fn is_closed(&self) -> bool {
        let middle = 0.5 * (self.low + self.high);
        middle == self.low || middle == self.high || self.rounds >= ROUNDS
    }

    /// Whether the sign changes again before the watch; the bracket then
    /// covers the rest.
    fn reopen(&mut self) -> bool {
        self.changes += 1;
        self.rounds = 0;
        self.low = self.high;
        self.low_sign = self.high_sign;
        self.high = self.end;
        self.high_sign = self.end_sign;
        self.low_sign != self.end_sign && self.changes < CHANGES
    }
}
