//! Search for the time at which a guard changes sign.
//!
//! One round of equal sections, then regula falsi safeguarded by bisection: about 20 values for smooth guards, a
//! bounded number for any other.

use super::vocabulary::class;

/// Sections of the first round, to find the first of several changes.
const SECTIONS: usize = 16;
/// One in so many rounds bisects, whatever the guard looks like.
const HALVED: usize = 4;
/// Rounds after which any bracket has closed.
const ROUNDS: usize = 60 * HALVED;
/// Sign changes of one guard that are resolved between two watches.
const CHANGES: usize = 6;
/// A bracket is closed at this share of `apart`: near t = 0 floating-point neighbours are closer than matters.
const CLOSED: f64 = 1e-4;

/// An interval whose ends have guards of different sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bracket {
    pub(super) lane: usize,
    pub(super) guard: usize,
    low: End,
    high: End,
    watch: End,
    /// Breaks closer than this are merged.
    apart: f64,
    stage: Stage,
    moved: Option<Side>,
    rounds: usize,
    changes: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// Just beyond a break: a guard may be zero at a single number.
    Beyond,
    /// The ends of equal sections, to find the first of several changes.
    Sections,
    /// A guess of the zero.
    Zero,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    time: f64,
    pub(super) sign: i8,
    /// Value used to guess the zero: that of the guard, or a reduced one.
    value: f64,
}

impl End {
    pub(super) fn new(time: f64, value: f64) -> Self {
        Self { time, sign: class(value), value }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Side {
    Low,
    High,
}

#[derive(Debug, PartialEq)]
pub(super) enum Found {
    Nothing,
    Break(f64),
    /// There is no other break before the watch.
    End,
}

impl Bracket {
    pub(super) fn new(lane: usize, guard: usize, [low, high]: [End; 2], apart: f64) -> Self {
        let (stage, moved, rounds, changes) = (Stage::Sections, None, 0, 0);
        Self { lane, guard, low, high, watch: high, apart, stage, moved, rounds, changes }
    }

    fn at(&self, share: f64) -> f64 {
        self.low.time + (self.high.time - self.low.time) * share
    }

    fn width(&self) -> f64 {
        (self.high.time - self.low.time).abs()
    }

    pub(super) fn count(&self) -> usize {
        match self.stage {
            Stage::Sections => SECTIONS - 1,
            Stage::Beyond | Stage::Zero => 1,
        }
    }

    pub(super) fn time(&self, k: usize) -> f64 {
        match self.stage {
            Stage::Beyond => self.at((self.apart / self.width()).min(1.0)),
            Stage::Sections => self.at((k + 1) as f64 / SECTIONS as f64),
            Stage::Zero => self.guess(),
        }
    }

    /// Guess by regula falsi (with the value of a lagging end halved), kept inside; the midpoint in some rounds, and if
    /// an end has no usable value.
    fn guess(&self) -> f64 {
        let (low, high) = (&self.low, &self.high);
        let rise = high.value - low.value;
        let apart =
            low.value != 0.0 && high.value != 0.0 && (low.value < 0.0) != (high.value < 0.0);
        if self.rounds.is_multiple_of(HALVED) || !apart || !rise.is_finite() {
            return self.at(0.5);
        }
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

    pub(super) fn narrow(&mut self, inside: impl Iterator<Item = End>) -> Found {
        for end in inside {
            if self.stage == Stage::Beyond {
                self.stage = Stage::Sections;
                // A change this close to the last break is the same one.
                let over = end.sign == self.watch.sign;
                return if over { Found::End } else { Found::Nothing };
            }
            let side = if end.sign == self.low.sign { Side::Low } else { Side::High };
            let (same_side, other) = match side {
                Side::Low => (&mut self.low, &mut self.high),
                Side::High => (&mut self.high, &mut self.low),
            };
            // The guess was met: try its neighbours next.
            let met = end.value == 0.0 && same_side.sign != 0;
            let value = if met { f64::MIN_POSITIVE.copysign(same_side.value) } else { end.value };
            *same_side = End { value, ..end };
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

    /// Whether the sign changes again before the watch; the bracket then covers the rest.
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

    /// The breaks of a guard between two watches, and the number of evaluations.
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

    /// Expects one break, to rounding of numbers of order one.
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

    /// A line is zero at a number, so its sign changes twice.
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
                // At least every fourth round halves the bracket.
                assert!(values < HALVED * 50, "{k}: {values}");
            }
        }
    }

    /// Floating-point neighbours near zero are closer than any time in the panel needs.
    #[test]
    fn a_zero_at_the_start_is_closed_in_on_no_further_than_rounding() {
        let (found, values) = breaks(|t| t, [0.0, 0.1]);
        assert!(found[0] < 1e-17, "{found:?}");
        assert!(values < 100, "{values}");
    }

    #[test]
    fn a_stretch_of_zeros_has_two_ends() {
        let guard = |t: f64| (t - 0.6).max(0.0) + (t - 0.4).min(0.0);
        let (found, values) = breaks(guard, [0.0, 1.0]);
        assert!(found.len() == 2, "{found:?}");
        assert!((found[0] - 0.4).abs() < 1e-15 && (found[1] - 0.6).abs() < 1e-15, "{found:?}");
        assert!(values < 150, "{values}");
    }

    /// Of three changes the first is found, if the sections tell them apart.
    #[test]
    fn the_first_of_several_changes_is_found() {
        let (found, _) = breaks(|t| (t - 0.21) * (t - 0.42) * (t - 0.9), [0.0, 1.0]);
        one_at(0.21, &found, 0);
    }
}
