//! Breaks of the panels of hereditary integrals.
//!
//! An integrand has a kink or a jump where a guard changes sign. Guards are evaluated at a few times of each panel; a
//! sign change is enclosed down to neighbouring numbers, or the rounding of the panel's times, and the panel is broken
//! there.

use super::bracket::{Bracket, End, Found};
use super::history::HistoryPlan;
use super::past::Past;
use super::sampler::{Sampler, Surroundings};

/// Lanes whose guards are watched at once and stay in cache.
const WATCHED: usize = 128;
/// Breaks closer than this, relative to the times, are merged.
const APART: f64 = 1e-14;

#[derive(Clone, Copy, Debug)]
pub(super) struct Lane {
    pub(super) tuple: u32,
    pub(super) from: f64,
    pub(super) to: f64,
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
            while !self.brackets.is_empty() {
                self.narrow(plan, below, all, lanes);
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
                let apart = lanes[lane].apart();
                let (values, times) = (&values[first..], &self.sampler.times[first..]);
                first += watches + 1;
                if is_of_one_sign(&values[..=watches]) {
                    continue;
                }
                for k in 0..watches {
                    let [low, high] = [k, k + 1].map(|k| End::new(times[k], values[k]));
                    if low.sign != high.sign {
                        self.brackets.push(Bracket::new(before + lane, guard, [low, high], apart));
                    }
                }
            }
        }
    }

    fn narrow(
        &mut self,
        plan: &HistoryPlan,
        below: &mut [Past],
        all: Surroundings,
        lanes: &[Lane],
    ) {
        self.sampler.clear();
        for bracket in &self.brackets {
            let times = (0..bracket.count()).map(|k| bracket.time(k));
            self.sampler.extend(lanes[bracket.lane].tuple, times);
        }
        self.sampler.run(&plan.watch, plan.mask, below, all);
        let (values, times) = (&self.sampler.values, &self.sampler.times);
        let (cuts, mut place) = (&mut self.cuts, 0);
        self.brackets.retain_mut(|bracket| {
            let mine = place..place + bracket.count();
            place = mine.end;
            let values = &values[bracket.guard][mine.clone()];
            let found = times[mine].iter().zip(values).map(|(t, v)| End::new(*t, *v));
            match bracket.narrow(found) {
                Found::Nothing => true,
                Found::End => false,
                Found::Break(time) => {
                    cuts.push((bracket.lane, time));
                    bracket.reopen()
                }
            }
        });
    }
}

fn is_of_one_sign(values: &[f64]) -> bool {
    // Branch-free.
    values.iter().fold(true, |all, value| all & (*value > 0.0))
        || values.iter().fold(true, |all, value| all & (*value < 0.0))
}
