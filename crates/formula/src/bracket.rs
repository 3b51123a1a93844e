//! The search for the place between two times where a guard changes its sign.
//!
//! One round of equal parts, then regula falsi with halvings among the guesses:
//! smooth guards take some 20 values, any other a bounded number.

use super::scalar::class;

/// Parts a bracket is cut into at first, to find the first of several changes.
const SECTIONS: usize = 16;
/// Of so many rounds after the first one halves the bracket, whatever the guard looks like.
const HALVED: usize = 4;
/// Rounds of halving and guessing after which a bracket has closed.
const ROUNDS: usize = 60 * HALVED;
/// Changes of sign of one guard between two watches that are told apart.
const CHANGES: usize = 6;
/// A bracket no wider than this share of that is closed: near t = 0 neighbours are closer than anything sees.
const CLOSED: f64 = 1e-4;

/// An interval at whose ends a guard has different signs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    pub(super) lane: usize,
    pub(super) guard: usize,
    low: End,
    high: End,
    /// The watch at which the search ends.
    watch: End,
    /// Breaks closer than this are one.
    apart: f64,
    stage: Stage,
    /// Which end the last guess moved.
    moved: Option<Side>,
    rounds: usize,
    changes: usize,
}

/// What the next round of a bracket looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// Whether anything is left to be found just beyond a break: a guard may be zero at one number alone.
    Beyond,
    /// The ends of equal parts, to find the first of several changes; inside one part any may be found.
    Sections,
    /// Where the zero may be.
    Zero,
}

/// A guard at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    time: f64,
    pub(super) sign: i8,
    /// By which the place of the zero is guessed: the guard's own value, or less.
    value: f64,
}

impl End {
    pub(super) fn new(time: f64, value: f64) -> Self {
        Self { time, sign: class(value), value }
    }
}

/// The end of a bracket.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Low,
    High,
}

/// What a round has found.
#[derive(Debug, PartialEq)]
pub(super) enum Found {
    /// Nothing yet.
    Nothing,
    /// A break.
    Break(f64),
    /// That there is no other break before the watch.
    End,
}

impl Bracket {
    pub(super) fn new(lane: usize, guard: usize, [low, high]: [End; 2], apart: f64) -> Self {
        let (stage, moved, rounds, changes) = (Stage::Sections, None, 0, 0);
        Self { lane, guard, low, high, watch: high, apart, stage, moved, rounds, changes }
    }

    /// The time at a share of the bracket.
    fn at(&self, share: f64) -> f64 {
        self.low.time + (self.high.time - self.low.time) * share
    }

    fn width(&self) -> f64 {
        (self.high.time - self.low.time).abs()
    }

    /// At how many times the next round looks.
    pub(super) fn count(&self) -> usize {
        match self.stage {
            Stage::Sections => SECTIONS - 1,
            Stage::Beyond | Stage::Zero => 1,
        }
    }

    /// The k-th of them.
    pub(super) fn time(&self, k: usize) -> f64 {
        match self.stage {
            Stage::Beyond => self.at((self.apart / self.width()).min(1.0)),
            Stage::Sections => self.at((k + 1) as f64 / SECTIONS as f64),
            Stage::Zero => self.guess(),
        }
    }

    /// Where the guard has its zero if it is a line (regula falsi, a lagging end at half its value), but inside; the
    /// middle in some rounds, and wherever an end has no such value.
    fn guess(&self) -> f64 {
        let (low, high) = (&self.low, &self.high);
        let rise = high.value - low.value;
        let apart =
            low.value != 0.0 && high.value != 0.0 && (low.value < 0.0) != (high.value < 0.0);
        if self.rounds.is_multiple_of(HALVED) || !apart || !rise.is_finite() {
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

    /// Takes what a round has seen; moves to the first of the parts at whose end the sign is another.
    pub(super) fn narrow(&mut self, inside: impl Iterator<Item = End>) -> Found {
        for end in inside {
            if self.stage == Stage::Beyond {
                self.stage = Stage::Sections;
                // A change closer to the last break is that one.
                let over = end.sign == self.watch.sign;
                return if over { Found::End } else { Found::Nothing };
            }
            let side = if end.sign == self.low.sign { Side::Low } else { Side::High };
            let (own, other) = match side {
                Side::Low => (&mut self.low, &mut self.high),
                Side::High => (&mut self.high, &mut self.low),
            };
            // The guess was met: its neighbours are tried next.
            let met = end.value == 0.0 && own.sign != 0;
            let value = if met { f64::MIN_POSITIVE.copysign(own.value) } else { end.value };
            *own = End { value, ..end };
            if self.moved == Some(side) {
                other.value *= 0.5;
            }
            self.moved = (self.stage == Stage::Zero).then_some(side);
            if side == Side::High {
                break;
            }
        }
        self.stage = Stage::Zero;
        self.rounds += 1;
        if self.is_closed() { Found::Break(self.high.time) } else { Found::Nothing }
    }

    fn is_closed(&self) -> bool {
        let middle = self.at(0.5);
        let neighbours = middle == self.low.time || middle == self.high.time;
        neighbours || self.width() <= CLOSED * self.apart || self.rounds >= ROUNDS
    }

    /// Whether the sign changes again before the watch; the bracket then
    /// covers the rest.
    pub(super) fn reopen(&mut self) -> bool {
        self.changes += 1;
        (self.stage, self.moved, self.rounds) = (Stage::Beyond, None, 0);
        (self.low, self.high) = (self.high, self.watch);
        self.low.sign != self.watch.sign && self.changes < CHANGES
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The breaks of a guard between two watches, and how many values they took.
    fn breaks(guard: impl Fn(f64) -> f64, [low, high]: [f64; 2]) -> (Vec<f64>, usize) {
        let end = |time: f64| End::new(time, guard(time));
        let mut bracket =
            Bracket::new(0, 0, [end(low), end(high)], 1e-14 * low.abs().max(high.abs()));
        let (mut found, mut values) = (Vec::new(), 0);
        loop {
            let seen: Vec<End> = (0..bracket.count()).map(|k| end(bracket.time(k))).collect();
            values += seen.len();
            assert!(bracket.rounds < ROUNDS);
            match bracket.narrow(seen.into_iter()) {
                Found::Nothing => {}
                Found::End => return (found, values),
                Found::Break(time) => {
                    found.push(time);
                    if !bracket.reopen() {
                        return (found, values);
                    }
                }
            }
        }
    }

    /// A break and no other, to rounding of numbers of order one.
    fn one_at(root: f64, found: &[f64], what: usize) {
        assert!(found.len() == 1 && (found[0] - root).abs() < 1e-15, "{what}: {found:?}");
    }

    /// Sections alone take 13 rounds of 15.
    const FEW: usize = 40;

    #[test]
    fn smooth_guards_take_few_values() {
        let root = 0.3f64.sqrt();
        let smooth: [&dyn Fn(f64) -> f64; 4] =
            [&|t| t * t - 0.3, &|t| (0.3 - t * t) * t.exp(), &|t| (t * t - 0.3).tanh(), &|t| {
                1e-180 * (t * t - 0.3)
            }];
        for (k, guard) in smooth.iter().enumerate() {
            for ends in [[0.5, 0.6], [0.6, 0.5]] {
                let (found, values) = breaks(guard, ends);
                one_at(root, &found, k);
                assert!(values < FEW, "{k}: {values}");
            }
        }
    }

    /// A line is zero at a number, so that its sign changes twice.
    #[test]
    fn a_zero_at_one_number_is_one_break() {
        for k in 0..200 {
            let place = 0.5 + 0.001 * f64::from(k).sqrt();
            let slope = 0.3 + 0.017 * f64::from(k);
            for (ends, sign) in [([0.45, 0.55], 1.0), ([0.55, 0.45], -1.0)] {
                let (found, values) = breaks(|t| sign * slope * (t - place), ends);
                one_at(place, &found, k as usize);
                assert!(values < FEW, "{k}: {values}");
            }
        }
    }

    #[test]
    fn other_guards_take_a_bounded_number() {
        let root = 0.3f64.sqrt();
        let other: [&dyn Fn(f64) -> f64; 6] = [
            &|t| if t < root { -1.0 } else { 1e9 },
            &|t| (t - root).max(0.0),
            &|t| (root - t).max(0.0),
            &|t| (t - root).powi(9),
            &|t| if t < root { f64::NEG_INFINITY } else { 1.0 },
            &|t| if t < root { f64::NAN } else { 1.0 },
        ];
        for (k, guard) in other.iter().enumerate() {
            for ends in [[0.5, 0.6], [0.6, 0.5]] {
                let (found, values) = breaks(guard, ends);
                assert!((found[0] - root).abs() < 1e-15, "{k}: {found:?}");
                // Half of the bracket in each fourth round, at the least.
                assert!(values < HALVED * 50, "{k}: {values}");
            }
        }
    }

    /// Numbers near zero are closer to each other than any time of the panel is good for.
    #[test]
    fn a_zero_at_the_start_is_closed_in_on_no_further_than_rounding() {
        let (found, values) = breaks(|t| t, [0.0, 0.1]);
        assert!(found[0] < 1e-17, "{found:?}");
        assert!(values < 100, "{values}");
    }

    /// Minus, nothing, plus: two breaks.
    #[test]
    fn a_stretch_of_zeros_has_two_ends() {
        let guard = |t: f64| (t - 0.6).max(0.0) + (t - 0.4).min(0.0);
        let (found, values) = breaks(guard, [0.0, 1.0]);
        assert!(found.len() == 2, "{found:?}");
        assert!((found[0] - 0.4).abs() < 1e-15 && (found[1] - 0.6).abs() < 1e-15, "{found:?}");
        assert!(values < 150, "{values}");
    }

    /// Of three changes the first, where the sections tell them apart.
    #[test]
    fn the_first_of_several_changes_is_found() {
        let (found, _) = breaks(|t| (t - 0.21) * (t - 0.42) * (t - 0.9), [0.0, 1.0]);
        one_at(0.21, &found, 0);
    }
}
