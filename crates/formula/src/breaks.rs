//! Breaks of the panels of hereditary integrals.
//!
//! An integrand has a kink or a jump where a guard changes sign. Guards are evaluated at a few times of each panel; a
//! sign change is enclosed down to neighbouring numbers, or the rounding of the panel's times, and the panel is broken
//! there.

use super::history::HistoryPlan;
use super::past::Past;
use super::sampler::{Sampler, Surroundings};
use super::vocabulary::class;

/// Lanes whose guards are watched at once and stay in cache.
const WATCHED: usize = 128;
/// Breaks closer than this, relative to the times, are merged.
const APART: f64 = 1e-14;
/// A bracket is closed at this share of that distance, a unit in the last place.
const CLOSED: f64 = 1e-2;
/// Sections of an interval between two watches at which a guard has different signs, and most changes sought there.
const SECTIONS: usize = 16;
const CHANGES: usize = 6;

#[derive(Clone, Copy, Debug)]
pub(super) struct Lane {
    pub(super) tuple: u32,
    pub(super) from: f64,
    pub(super) to: f64,
    /// The time up to which kernels count lags.
    pub(super) end: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) lane: u32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Lane {
    /// Distance within which breaks are merged.
    fn apart(&self) -> f64 {
        APART * self.from.abs().max(self.to.abs())
    }
}

impl Piece {
    pub(super) fn width(&self) -> f64 {
        (self.to - self.from).abs()
    }

    pub(super) fn can_be_halved(&self) -> bool {
        let middle = 0.5 * (self.from + self.to);
        middle != self.from && middle != self.to
    }

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
    ends: [(f64, i8); 2],
}

#[derive(Clone, Debug)]
pub(super) struct Breaks {
    sampler: Sampler,
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
            self.brackets.clear();
            for (index, some) in lanes.chunks(WATCHED).enumerate() {
                self.watch(plan, below, all, some, WATCHED * index);
            }
            self.divide(plan, below, all, lanes, (SECTIONS, CHANGES));
            while !self.brackets.is_empty() {
                self.divide(plan, below, all, lanes, (2, 1));
            }
        }
        let order = |s: f64, lane: usize| (s - lanes[lane].from).abs();
        self.cuts.sort_by(|a, b| (a.0.cmp(&b.0)).then(order(a.1, a.0).total_cmp(&order(b.1, b.0))));
        self.pieces.clear();
        let mut cuts = self.cuts.iter().peekable();
        for (k, lane) in lanes.iter().enumerate() {
            let (apart, mut from) = (lane.apart(), lane.from);
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

    /// Opens a bracket at each sign change of a guard between watches; lane numbers start after `before` others.
    fn watch(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
        before: usize,
    ) {
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
        for (guard, values) in self.sampler.values.iter().enumerate() {
            let mut first = 0;
            for (lane, &watches) in self.watches.iter().enumerate() {
                let (values, times) = (&values[first..], &self.sampler.times[first..]);
                first += watches + 1;
                if is_of_one_sign(&values[..=watches]) {
                    continue;
                }
                for k in 0..watches {
                    let ends = [k, k + 1].map(|k| (times[k], class(values[k])));
                    if ends[0].1 != ends[1].1 {
                        self.brackets.push(Bracket { lane: before + lane, guard, ends });
                    }
                }
            }
        }
    }

    /// Divides brackets into sections and keeps the first of those that are brackets, at most `kept`. What is closed
    /// becomes a cut.
    fn divide(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
        (sections, kept): (usize, usize),
    ) {
        let cuts = &mut self.cuts;
        self.brackets.retain(|Bracket { lane, ends: [(low, _), (high, _)], .. }| {
            let middle = 0.5 * (low + high);
            let closed = (high - low).abs() <= CLOSED * lanes[*lane].apart();
            let open = !closed && middle != *low && middle != *high;
            if !open {
                cuts.push((*lane, *high));
            }
            open
        });
        self.sampler.clear();
        for Bracket { lane, ends: [(low, _), (high, _)], .. } in &self.brackets {
            let inside = (1..sections).map(|k| low + (high - low) * (k as f64 / sections as f64));
            self.sampler.extend(lanes[*lane].tuple, inside);
        }
        self.sampler.run(&plan.watch, plan.mask, below, all);
        let (values, times) = (&self.sampler.values, &self.sampler.times);
        let mut found = Vec::new();
        for (index, bracket) in self.brackets.iter().enumerate() {
            let range = (sections - 1) * index..(sections - 1) * (index + 1);
            let inside = range.map(|k| (times[k], class(values[bracket.guard][k])));
            let [mut low, high] = bracket.ends;
            let pairs = inside.chain([high]).map(|next| [std::mem::replace(&mut low, next), next]);
            let changes = pairs.filter(|[low, high]| low.1 != high.1).take(kept);
            found.extend(changes.map(|ends| Bracket { ends, ..*bracket }));
        }
        self.brackets = found;
    }
}

fn is_of_one_sign(values: &[f64]) -> bool {
    // Branch-free.
    values.iter().fold(true, |all, value| all & (*value > 0.0))
        || values.iter().fold(true, |all, value| all & (*value < 0.0))
}
