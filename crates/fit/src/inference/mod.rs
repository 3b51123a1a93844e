//! Bayesian inference of the order of a table: all readings of its levels, weighed by their evidence.
//!
//! Model: log e = c + p log h + g(h) + noise, g a next term of unknown size and power ([`next_term`]). Coarse levels
//! may be dropped one by one; a dropped level costs as much as one explained with density 1/3 per unit of log e. Fine
//! levels are dropped only where the slopes break downwards, as into a floor. Each reading gives a normal distribution
//! of p in closed form ([`evidence`]); the posterior is their mixture. Deterministic: equal tables have equal answers.

use std::cell::Cell;

mod claim;
mod evidence;
mod grid;
pub(super) mod line;
mod mixture;
mod next_term;
mod to_zero;
pub(super) mod told;

use super::level::{deviation, unexplained};
use super::richardson::{Triple, ValueSample};
use super::{FitError, Interval, Level, power_of_log};
use evidence::{Base, Component, Gram, Noise, Row};
use mixture::{Mixture, Part};
use next_term::{Family, Node, Terms, runs};

#[cfg(test)]
mod tests;

pub use claim::{Claim, ClaimError, Ruling, TOLERANCE};
pub use grid::{GridPosterior, infer_grid};

/// An order needs so many levels.
pub const FEWEST: usize = 3;
/// Noise of log e if unknown, with weights.
const NOISE: [(f64, f64); 7] = [
    (0.0005, 0.25),
    (0.001, 0.25),
    (0.003, 0.25),
    (0.01, 0.18),
    (0.03, 0.05),
    (0.1, 0.06),
    (LARGEST_NOISE, 0.004),
];
const LEAST_NOISE: f64 = 0.0005;
const LARGEST_NOISE: f64 = 0.3;
const NOISES: [f64; 2] = [LEAST_NOISE, LARGEST_NOISE];
/// Prior of dropping so many coarse levels; halved for each further one.
const COARSE: [f64; 6] = [0.6, 0.2, 0.1, 0.05, 0.03, 0.02];
/// Prior of dropping so many fine levels; the last for any more.
const FINE: [f64; 4] = [1.0, 0.03, 0.015, 0.008];
/// Slopes below this share of those before are a floor that scatters, not a slower term.
const FLAT: f64 = 0.35;
/// Readings of the fine end drop at most so many coarse levels.
const COARSE_OF_FINE: usize = 2;
/// Density per unit of log e of a dropped level.
const LEFT: f64 = 1.0 / 3.0;
/// A reading with a floor needs more levels than an order has parameters.
const FLOOR_LEVELS: usize = 4;
/// What scatters in a floor, as a standard deviation of its logarithm, beside so much noise of the rest, with weights.
const SCATTER: f64 = 0.5;
const BESIDE_SCATTER: [(f64, f64); 2] = [(0.001, 0.75), (0.01, 0.2)];
/// Errors that fall by more than this factor e^x are in no floor: three deviations of the ratio of two.
const FALLEN: f64 = 2.1;
/// Before four and more levels refute a claim, a floor that scatters is so many times likelier than by its prior. It leaves
/// open every twelfth claim on four levels that is half an order too high, and next to none on five.
const WARY: f64 = 100.0;
/// Two slopes do not show that a next term changes the sign: their interval has it so many times likelier.
const CROSSING_OF_THREE: f64 = 4.0;
/// A floor that scatters, by three deviations where it begins, hides or feigns so much of the fall before it. It may be ten
/// times the rest there.
const HIDDEN: [f64; 2] = [1.5, 3.9];
/// It is looked for with at most one coarse level dropped.
const COARSE_OF_SCATTER: usize = 1;
/// Readings below exp(-12) of the likeliest are dropped.
const LEAST: f64 = 12.0;
/// No node has a larger logarithm of its prior: a straight line in noise has ln 3.
const LIKELIEST: f64 = 1.1;
/// Of a long list of sizes every fourth is looked at first; those between two that are below exp(-16) of the likeliest at
/// this noise are not: a step between the sizes changes log e by about as much.
const STRIDE: usize = 4;
const LONG_RUN: usize = 16;
const LOOK: f64 = 0.03;
const OUT_OF_REACH: f64 = 16.0;
/// A floor or a reference is read about orders that are beyond the slopes, or so near: three deviations of what it is read
/// about, and noise.
const NEAR_SLOPE: f64 = 0.6;
/// Rounding, as a share of the largest error, and of numbers of size one.
const ROUNDING: f64 = 1e-15;
const ROUNDING_OF_ONE: std::ops::RangeInclusive<f64> = 1e-18..=1e-14;
/// An order found against a reference is put into the error of the reference, so often at most, until it changes by less
/// than a tenth of what is printed.
const PASSES: usize = 6;
const SETTLED: f64 = 1e-3;
/// No order is known better: what the readings leave out, on tables without noise.
const CLOSEST: f64 = 0.003;
/// Orders this close are one.
const SAME: f64 = 0.02;
/// Of a lower order the reference takes nearly all; beyond the higher one nothing.
const LEAST_ORDER: f64 = 0.1;
const LARGEST_ORDER: f64 = 20.0;
/// Levels of a long table beyond which the coarsest are dropped at once.
const LONGEST: usize = 12;

/// What a table says of its order.
#[derive(Debug, Clone)]
pub struct Posterior {
    pub order: f64,
    /// 95 % interval with equal tails.
    pub interval: Interval,
    /// Coarse levels, from the coarsest, that are beyond the longest table or carry less than half of the evidence.
    pub coarse_left_out: usize,
    /// Largest step affected by an unstated floor, if a floor is likelier than not.
    pub floor_from: Option<f64>,
    /// Slopes of log e between neighbouring levels, coarse to fine; empty for a grid.
    pub slopes: Vec<f64>,
    /// All readings, those without a floor, those with one.
    all: Mixture,
    /// All with floors that scatter likelier, or with signs that change likelier: for refutations, and for the lower end of
    /// the interval of three levels.
    wary: Option<Mixture>,
    wide: Option<Mixture>,
    sound: Mixture,
    floored: Mixture,
    floor: f64,
    /// Logarithm of the evidence of all readings.
    evidence: f64,
    /// The same for smaller noises, where the noise is told.
    less: Vec<Self>,
    /// A level left out that the others do not explain, in words: nothing is confirmed then.
    unexplained: Option<String>,
    doubts: Doubts,
    trend: Trend,
}

/// What the slopes of a line look like, whatever is read into them; nothing for a grid.
#[derive(Debug, Clone, Default)]
struct Trend {
    /// Order of the differences of the last three errors, which no constant changes.
    of_differences: Option<f64>,
    /// Share of the last error that is F of C h^p + F through the last three; none where they do not fall.
    left: Option<f64>,
    /// Slope of the straight line, where the slopes go up and down about it as by noise, and what errors scatter about it.
    scattered: Option<[f64; 2]>,
    /// The noise is told.
    told_noise: bool,
    /// The largest slope before the finest levels that a floor may hold.
    before_floor: Option<f64>,
    /// Nobody has said that the errors are those against an exact solution, or against which run.
    may_have_a_reference: bool,
}

/// What is known of the errors of a table besides their sizes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Known {
    /// What the relative standard deviation of the errors is at most.
    pub noise: Option<f64>,
    /// Power M of a factor |log h|^M.
    pub log: f64,
    /// Step h_r of the run that the errors are measured against: e = C (h^p − h_r^p), or the same of squares where errors
    /// are orthogonal. 0 stands for an exact solution, none for a table that does not say.
    pub reference: Option<f64>,
    /// The errors are differences of neighbouring values: their noise is that of two values and correlated, so that it tells
    /// nothing of next terms.
    pub differences: bool,
}

impl Known {
    /// Errors against an exact solution.
    pub const EXACT: Self =
        Self { noise: None, log: 0.0, reference: Some(0.0), differences: false };

    /// # Errors
    /// [`FitError::Reference`] if the reference is no exact solution and no run of a step below the finest one.
    pub fn check_reference(&self, finest: f64) -> Result<(), FitError> {
        match self.reference {
            Some(step) if step != 0.0 && !(super::level::is_step(step) && step < finest) => {
                Err(FitError::Reference { step, finest })
            }
            _ => Ok(()),
        }
    }
}

/// Posterior of the order where the noise is just what is told.
fn infer_at(levels: &[Level], known: &Known) -> Result<Posterior, FitError> {
    let Known { noise, log, reference, differences } = *known;
    let (mut serving, left_out): (Vec<Level>, Vec<Level>) =
        levels.iter().partition(|level| level.screened().is_ok());
    serving.sort_by(|a, b| b.size().total_cmp(&a.size()));
    let table = Table { differences, ..Table::new(&serving, noise, log)? };
    // The exponent of the likelier form of errors against a reference.
    let mut of_squares = 1.0;
    let parts = match reference {
        None => table.parts(),
        Some(0.0) => Table { against_reference: true, ..table.clone() }.parts(),
        Some(step) => {
            known.check_reference(table.sizes[table.sizes.len() - 1])?;
            let forms = [1.0, 2.0].map(|exponent| table.against(step, exponent));
            let [linear, squares] = forms.each_ref().map(|parts| largest(parts));
            of_squares = if squares > linear { 2.0 } else { 1.0 };
            forms.concat()
        }
    };
    let likeliest = largest(&parts);
    let parts = weighed(parts);
    let [sound, floored] =
        [false, true].map(|with_floor| Mixture::of(&parts, |part| part.floored == with_floor));
    let all = sound.union(&floored);
    let floor = floored.weight / all.weight;
    let mut leaving = vec![0.0; levels.len()];
    parts.iter().for_each(|part| leaving[part.coarse] += part.weight);
    let beyond = |coarse: &usize| leaving[*coarse..].iter().sum::<f64>() > 0.5 * all.weight;
    let unread = serving.len().saturating_sub(LONGEST);
    let coarse_left_out = unread + (1..levels.len()).take_while(beyond).count();
    let likelier =
        |which: fn(&Part) -> bool, by: f64| all.union(&Mixture::of(&parts, which).times(by - 1.0));
    let short = serving.len() == FEWEST;
    let wary = (!short && parts.iter().any(|part| part.scattered))
        .then(|| likelier(|part| part.scattered, WARY));
    let wide = short.then(|| likelier(|part| part.crossing, CROSSING_OF_THREE));
    let interval =
        Interval { lo: wide.as_ref().unwrap_or(&all).quantile(0.025), hi: all.quantile(0.975) };
    let order = all.quantile(0.5);
    let table = match reference {
        Some(step) if step > 0.0 => table.without_reference(step, of_squares, order),
        _ => table,
    };
    let outside: f64 = parts.iter().filter(|part| part.outside).map(|part| part.weight).sum();
    Ok(Posterior {
        order,
        unexplained: unexplained(&left_out, &serving, interval, log),
        interval,
        coarse_left_out,
        floor_from: (floor > 0.5 && (table.flat > 0 || table.flattens()))
            .then(|| table.sizes[table.break_down()]),
        slopes: table.slopes(),
        doubts: Doubts::of(&serving, outside > 0.5 * all.weight),
        trend: Trend {
            of_differences: of_differences(&serving),
            left: left_of_the_last(&serving),
            before_floor: table.before_floor(),
            scattered: table.scattered(),
            told_noise: table.told_noise(),
            may_have_a_reference: reference.is_none(),
        },
        evidence: likeliest + all.weight.ln(),
        less: Vec::new(),
        all,
        wary,
        wide,
        sound,
        floored,
        floor,
    })
}

/// log of the ratio of the last two differences over that of the steps: exact for C h^p + F and equal ratios.
fn of_differences(serving: &[Level]) -> Option<f64> {
    let [.., a, b, c] = serving else { return None };
    let ratio = (a.error() - b.error()) / (b.error() - c.error());
    Some(ratio.ln() / (a.size() / b.size()).ln()).filter(|order| order.is_finite())
}

/// The share of the last of three errors that is F of C h^p + F; none where they do not fall towards it.
fn left_of_the_last(serving: &[Level]) -> Option<f64> {
    let [.., a, b, c] = serving else { return None };
    let of = |level: &Level| ValueSample { step: level.size(), value: level.error() };
    match Triple::of([of(a), of(b), of(c)]) {
        Triple::Converging { limit, .. } if c.error() < b.error() => Some(limit / c.error()),
        _ => None,
    }
}

fn largest(parts: &[Part]) -> f64 {
    parts.iter().map(|part| part.weight).fold(f64::NEG_INFINITY, f64::max)
}

/// Parts with the weight of the likeliest 1, from logarithms.
fn weighed(mut parts: Vec<Part>) -> Vec<Part> {
    let largest = largest(&parts);
    // Those dropped sum to less than a thousandth of the likeliest.
    parts.retain(|part| part.weight > largest - LEAST);
    parts.iter_mut().for_each(|part| part.weight = (part.weight - largest).exp());
    parts
}

/// Why a table confirms or refutes nothing, whatever its readings say.
#[derive(Debug, Clone, Default)]
struct Doubts {
    /// Against any answer.
    always: Option<String>,
    /// Against a pass of an order above zero.
    passing: Option<String>,
    /// Against a failure: the finest errors are rounding, which is a floor with a cause.
    failing: Option<String>,
    /// No error is more than rounding: no further level helps.
    nothing_but_rounding: bool,
}

impl Doubts {
    /// Of levels that serve, coarse to fine.
    fn of(serving: &[Level], outside: bool) -> Self {
        let [coarsest, finest] = [serving[0], serving[serving.len() - 1]].map(|l| l.error());
        let largest = serving.iter().map(Level::error).fold(0.0, f64::max);
        let rounding_of_one = |error: f64| ROUNDING_OF_ONE.contains(&error);
        let nothing_but_rounding = serving.iter().all(|level| rounding_of_one(level.error()));
        let always = if nothing_but_rounding {
            Some("no error is above the rounding of numbers of size 1: state the floor".to_owned())
        } else if outside {
            Some("no reading that the judge knows fits these levels".to_owned())
        } else {
            None
        };
        let passing = (finest >= coarsest).then(|| {
            format!("the finest error {finest:.1e} is not below the coarsest, {coarsest:.1e}")
        });
        let rounded = finest <= ROUNDING * largest || rounding_of_one(finest);
        let failing = rounded.then(|| {
            format!(
                "the finest error {finest:.1e} is at the rounding of the numbers: state the floor"
            )
        });
        Self { always, passing, failing, nothing_but_rounding }
    }
}

impl Posterior {
    /// `, without the 2 coarsest levels`, to follow a sentence; empty if none is dropped.
    pub fn left_out_in_words(&self) -> String {
        match self.coarse_left_out {
            0 => String::new(),
            1 => ", without the coarsest level".to_owned(),
            more => format!(", without the {more} coarsest levels"),
        }
    }

    /// Probability that the order is at most p.
    pub fn below(&self, p: f64) -> f64 {
        self.all.below(p)
    }

    /// Probability that the order is within `tolerance` of p.
    pub fn within(&self, p: f64, tolerance: f64) -> f64 {
        self.all.below(p + tolerance) - self.all.below(p - tolerance)
    }
}

#[derive(Clone)]
struct Table {
    sizes: Vec<f64>,
    /// log h and log e, each less its mean.
    x: Vec<f64>,
    y: Vec<f64>,
    scales: Vec<f64>,
    /// The step of the reference is known, and taken out.
    against_reference: bool,
    differences: bool,
    /// Log weight of the likeliest reading so far.
    best: Cell<f64>,
    /// The same at the noise of the first look.
    seen: Cell<f64>,
    /// Fine levels that look like a floor: those after the break of the slopes.
    flat: usize,
    /// Noises relative to these scales, with weights.
    noise: Vec<(f64, f64)>,
}

impl Table {
    /// Of levels that serve, coarse to fine.
    fn new(levels: &[Level], noise: Option<f64>, log: f64) -> Result<Self, FitError> {
        let (noise, log) = (noise.map(deviation).transpose()?, power_of_log(log)?);
        if levels.len() < FEWEST {
            return Err(FitError::TooFew { found: levels.len(), needed: FEWEST });
        }
        if let Some(level) = levels.iter().find(|level| log != 0.0 && level.size() >= 1.0) {
            return Err(FitError::NoLogarithm { step: level.size() });
        }
        let same = |pair: &&[Level]| super::same_level(pair[0].size(), pair[1].size());
        if let Some(pair) = levels.windows(2).find(same) {
            return Err(FitError::RepeatedStep { step: pair[1].size() });
        }
        let [coarse, fine] = [levels[0].size(), levels[levels.len() - 1].size()];
        if !(coarse / fine).is_finite() {
            return Err(FitError::NoRatio { coarse, fine });
        }
        let levels = &levels[levels.len().saturating_sub(LONGEST)..];
        let factor = |size: f64| if log == 0.0 { 0.0 } else { log * size.ln().abs().ln() };
        // One noise for all levels (unknown or given), or one per level.
        let given = |level: &Level| level.sigma().or(noise).map(|sigma| sigma.max(LEAST_NOISE));
        let known: Option<Vec<f64>> = levels.iter().map(given).collect();
        let centred = |values: Vec<f64>| -> Vec<f64> {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            values.into_iter().map(|value| value - mean).collect()
        };
        let table = Self {
            sizes: levels.iter().map(Level::size).collect(),
            x: centred(levels.iter().map(|level| level.size().ln()).collect()),
            y: centred(
                levels.iter().map(|level| level.error().ln() - factor(level.size())).collect(),
            ),
            noise: if known.is_some() { vec![(1.0, 1.0)] } else { NOISE.to_vec() },
            scales: known.unwrap_or_else(|| vec![1.0; levels.len()]),
            against_reference: false,
            differences: false,
            best: Cell::new(f64::NEG_INFINITY),
            seen: Cell::new(f64::NEG_INFINITY),
            flat: 0,
        };
        let flat = levels.len() - 1 - table.break_down();
        let flat = if flat > 0 && table.breaks(flat) { flat } else { 0 };
        Ok(Self { flat, ..table })
    }

    /// Readings where e = C (h^(m p) − h_r^(m p))^(1/m). They are linear in p about an order: first about those of the finest
    /// two levels and of all, then about the one that is found.
    fn against(&self, reference: f64, exponent: f64) -> Vec<Part> {
        let mut found: Vec<(f64, Vec<Part>)> = Vec::new();
        let finest = self.sizes.len() - 1;
        for coarser in [finest - 1, 0] {
            let mut order = self.order_between([coarser, finest], reference, exponent);
            let known = |found: &[(f64, Vec<Part>)], order: f64| {
                found.iter().any(|(known, _)| (order - known).abs() < SAME)
            };
            let mut parts = Vec::new();
            for _ in 0..PASSES {
                if known(&found, order) {
                    break;
                }
                parts = self.about(reference, exponent, order);
                let median = Mixture::of(&weighed(parts.clone()), |_| true).quantile(0.5);
                let change = median.max(LEAST_ORDER) - order;
                order += change;
                if change.abs() < SETTLED {
                    break;
                }
            }
            if !known(&found, order) {
                found.push((order, parts));
            }
        }
        found.into_iter().flat_map(|(_, parts)| parts).collect()
    }

    /// The order that explains two errors against the reference, by bisection: their ratio rises with it.
    fn order_between(&self, [coarse, fine]: [usize; 2], reference: f64, exponent: f64) -> f64 {
        let [a, b] = [coarse, fine].map(|i| self.sizes[i] / reference);
        let ratio = exponent * (self.y[coarse] - self.y[fine]);
        let [mut lo, mut hi] = [LEAST_ORDER, LARGEST_ORDER];
        while hi - lo > SETTLED {
            let order = 0.5 * (lo + hi);
            let power = exponent * order;
            let found = (a.powf(power) - 1.0).ln() - (b.powf(power) - 1.0).ln();
            *(if found < ratio { &mut lo } else { &mut hi }) = order;
        }
        0.5 * (lo + hi)
    }

    fn about(&self, reference: f64, exponent: f64, order: f64) -> Vec<Part> {
        let mut table = Self { against_reference: true, ..self.clone() };
        for (i, size) in self.sizes.iter().enumerate() {
            let log = exponent * (reference / size).ln();
            let share = (order * log).exp();
            let by_order = -share * log / (1.0 - share) / exponent;
            table.x[i] += by_order;
            table.y[i] -= (-share).ln_1p() / exponent - order * by_order;
        }
        table.parts()
    }

    /// Errors against an exact solution, of this order.
    fn without_reference(mut self, reference: f64, exponent: f64, order: f64) -> Self {
        for (y, size) in self.y.iter_mut().zip(&self.sizes) {
            let share = (reference / size).powf(exponent * order.max(LEAST_ORDER));
            *y -= (-share).ln_1p() / exponent;
        }
        self
    }

    fn told_noise(&self) -> bool {
        self.noise.len() == 1
    }

    fn slopes(&self) -> Vec<f64> {
        let slope = |i: usize| (self.y[i] - self.y[i - 1]) / (self.x[i] - self.x[i - 1]);
        (1..self.x.len()).map(slope).collect()
    }

    /// Whether the slopes fall at the finest `fine` levels and from there break downwards and stay there: a floor bends its
    /// first level less than the later ones.
    fn breaks(&self, fine: usize) -> bool {
        let slopes = self.slopes();
        let (before, left) = slopes.split_at(slopes.len() - fine);
        let (Some(before), Some(first)) = (before.last(), left.first()) else { return false };
        let last = left[left.len() - 1];
        let flatter = before - 0.25 * (0.8 * before).max(0.4);
        let least = left.iter().copied().fold(f64::INFINITY, f64::min);
        // Errors that fall again are in no floor, unless they scatter about one.
        let falls_again = last >= flatter && left.iter().sum::<f64>() > 0.0;
        first < before && least < flatter && !falls_again
    }

    /// Slope of the straight line through four and more levels whose slopes neither rise nor fall throughout, by a noise
    /// that nobody told, and the deviation of logarithms of errors from it.
    fn scattered(&self) -> Option<[f64; 2]> {
        let changes: Vec<f64> = self.slopes().windows(2).map(|pair| pair[1] - pair[0]).collect();
        let up = changes.iter().filter(|change| **change > 0.0).count();
        let products: f64 = self.x.iter().zip(&self.y).map(|(x, y)| x * y).sum();
        let squares: f64 = self.x.iter().map(|x| x * x).sum();
        let slope = products / squares;
        let left: f64 = self.x.iter().zip(&self.y).map(|(x, y)| (y - slope * x).powi(2)).sum();
        let scatter = (left / (self.x.len() as f64 - 2.0)).sqrt();
        let turns = changes.len() > 1 && up > 0 && up < changes.len();
        (!self.told_noise() && turns).then_some([slope, scatter])
    }

    /// The last slope is below the one before: a floor, not a reference.
    fn flattens(&self) -> bool {
        matches!(self.slopes()[..], [.., before, last] if last < before)
    }

    /// The largest slope before a break beyond which there is one level, or the errors are nearly flat.
    fn before_floor(&self) -> Option<f64> {
        let (levels, flat) = (self.sizes.len(), self.flat);
        let slopes = self.slopes();
        let before = slopes[..slopes.len() - flat].iter().copied().fold(f64::NAN, f64::max);
        let (from, to) = (levels - 1 - flat, levels - 1);
        let after = (self.y[to] - self.y[from]) / (self.x[to] - self.x[from]);
        (flat == 1 || flat > 1 && after < FLAT * before).then_some(before)
    }

    /// The level after which the slopes fall most: where a floor begins.
    fn break_down(&self) -> usize {
        let slopes = self.slopes();
        let falls = slopes.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
        let steepest = falls.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(at, _)| at);
        steepest + 1
    }

    /// Readings with log weights.
    fn parts(&self) -> Vec<Part> {
        let levels = self.sizes.len();
        let mut parts: Vec<Part> = Vec::new();
        for fine in 0..=levels - FEWEST {
            // A long floor begins at the break or one level later.
            let looked_at = fine < FINE.len() || fine == self.flat || fine + 1 == self.flat;
            if fine > 0 && !(looked_at && self.breaks(fine)) {
                continue;
            }
            let most = if fine > 0 { COARSE_OF_FINE } else { levels };
            for coarse in 0..=(levels - fine - FEWEST).min(most) {
                let last = COARSE.len() - 1;
                let halved = 0.5f64.powi(coarse.saturating_sub(last) as i32);
                let left_out = (coarse + fine) as f64 * LEFT.ln();
                let prior = FINE[fine.min(FINE.len() - 1)] * COARSE[coarse.min(last)] * halved;
                self.read(coarse, fine, prior.ln() + left_out, &mut parts);
            }
        }
        parts
    }

    /// Readings of the remaining levels, with log weights.
    fn read(&self, coarse: usize, fine: usize, log_prior: f64, parts: &mut Vec<Part>) {
        let levels = coarse..self.sizes.len() - fine;
        let (coarsest, finest) = (self.sizes[levels.start], self.sizes[levels.end - 1]);
        let base = Base::new(self.scales[levels.clone()].iter().map(|scale| scale * scale));
        let noise = self.noise.iter().map(|(s, share)| base.noise(*s, log_prior + share.ln()));
        let long = levels.len() >= FLOOR_LEVELS;
        let kept = Kept { coarse, fine, long, noise: noise.collect(), levels };
        // The likeliest reading of so few levels is out of reach.
        if kept.noise.iter().all(|noise| noise.most + LIKELIEST < self.best.get() - LEAST) {
            return;
        }
        let fine_end = long && fine == 0 && coarse <= COARSE_OF_FINE;
        let anchors = match self.flat {
            flat if flat > 0 && fine_end => vec![finest, self.sizes[self.sizes.len() - 1 - flat]],
            _ => vec![finest],
        };
        let slopes = &self.slopes()[kept.levels.start..kept.levels.end - 1];
        let flattest = slopes.iter().copied().fold(f64::INFINITY, f64::min);
        let steepest = slopes.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (anchor, run) in anchors.iter().flat_map(|at| runs().map(move |run| (*at, run))) {
            let family = run[0].family;
            let needs_more = family.at_the_fine_end() || family == Family::Slow;
            // Any two slopes that rise may be those of a reference.
            let may_be_short = family.is_reference() && coarse + fine == 0;
            let skipped = needs_more && !fine_end && !may_be_short
                || family == Family::Scattered
                // Of two slopes that noise has made equal nothing follows.
                || run[0].straight() && !long
                || family.is_reference() && self.against_reference
                || anchor > finest && family != Family::Floor
                // With a floor no slope is above the order, against a reference none below.
                || family == Family::Floor && run[0].power < steepest - NEAR_SLOPE
                || family.is_reference() && run[0].power > flattest + NEAR_SLOPE;
            if skipped {
                continue;
            }
            let sizes = self.sizes[kept.levels.clone()].iter();
            let terms: Vec<[f64; 3]> =
                sizes.map(|h| run[0].powers(h / coarsest, h / anchor)).collect();
            // Nor is the first slope so far below the order that the largest floor does not take it there, or above it by more
            // than a reference adds.
            let apart = self.x[coarse] - self.x[coarse + 1];
            let first = || run[0].power + run[run.len() - 1].first_slope(&terms, apart);
            if family == Family::Floor && first() > steepest + NEAR_SLOPE
                || family.is_reference() && first() < flattest - NEAR_SLOPE
            {
                continue;
            }
            // Nodes of one power differ in D alone, in which the evidence is smooth unless the sign changes: between two that
            // are out of reach none is looked at.
            let stride = if run.len() < LONG_RUN { 1 } else { STRIDE };
            let every = run.iter().step_by(stride);
            let looked: Vec<f64> =
                every.map(|node| self.look(node, &terms, &kept, parts)).collect();
            for (at, node) in run.iter().enumerate().filter(|(at, _)| at % stride != 0) {
                let mut near = looked[at / stride..].iter().take(2);
                if node.size < -1.0 || near.any(|weight| *weight > self.seen.get() - OUT_OF_REACH) {
                    self.look(node, &terms, &kept, parts);
                }
            }
        }
        if fine == 0 && coarse <= COARSE_OF_SCATTER {
            self.read_scattered(&kept, log_prior, parts);
        }
    }

    /// Floors that scatter, beginning near any level but the coarsest.
    fn read_scattered(&self, kept: &Kept, log_prior: f64, parts: &mut Vec<Part>) {
        let (first, last) = (kept.levels.start, kept.levels.end - 1);
        let sizes = &self.sizes[kept.levels.clone()];
        let log_prior = log_prior - ((last - first) as f64).ln();
        let unknown = if self.told_noise() { &[(1.0, 1.0)][..] } else { &BESIDE_SCATTER[..] };
        for anchor in first + 1..=last {
            if self.y[anchor] - self.y[last] > FALLEN {
                continue;
            }
            let [fall, width] = [&self.y, &self.x].map(|of| of[first] - of[anchor]);
            let orders = (fall - HIDDEN[0]) / width..=(fall + HIDDEN[1]) / width;
            let serves = |run: &&[Node]| {
                run[0].family == Family::Scattered && orders.contains(&run[0].power)
            };
            for run in runs().filter(serves) {
                let powers = |h: &f64| run[0].powers(h / sizes[0], h / self.sizes[anchor]);
                let powers: Vec<[f64; 3]> = sizes.iter().map(powers).collect();
                for (node, (s, share)) in
                    run.iter().flat_map(|n| unknown.iter().map(move |s| (n, s)))
                {
                    let log_prior = log_prior + share.ln() + node.log_prior;
                    self.look_scattered(node, &powers, kept, (*s, log_prior), parts);
                }
            }
        }
    }

    /// One node of a floor that scatters, beside noise s: every level has its own deviation.
    fn look_scattered(
        &self,
        node: &Node,
        powers: &[[f64; 3]],
        kept: &Kept,
        (s, log_prior): (f64, f64),
        parts: &mut Vec<Part>,
    ) {
        let first = kept.levels.start;
        let variance = |i: usize| {
            let [own, floor] = [s * self.scales[first + i], SCATTER * node.share(powers[i][0])];
            own * own + floor * floor
        };
        let noise = Base::new((0..powers.len()).map(variance)).noise(1.0, log_prior);
        let least = self.best.get() - LEAST;
        if noise.most < least {
            return;
        }
        let row = |i: usize| self.row(first + i, node, &node.terms(powers[i]), variance(i));
        let component = Gram::of((0..powers.len()).map(row)).component(&noise, node.order(), least);
        let part = Part { coarse: kept.coarse, floored: true, scattered: true, ..Part::default() };
        self.keep(component.log_evidence, &component, part, parts);
    }

    /// A level under a node, its logarithm known to this variance.
    fn row(&self, level: usize, node: &Node, found: &Terms, variance: f64) -> Row {
        Row {
            x: self.x[level] + found.by_order,
            y: self.y[level] - found.g + node.order()[0] * found.by_order,
            nuisances: found.nuisances,
            weight: 1.0 / variance,
        }
    }

    /// Keeps a reading that is not far below the likeliest; false if it is.
    fn keep(&self, weight: f64, found: &Component, part: Part, parts: &mut Vec<Part>) -> bool {
        let near = weight >= self.best.get() - LEAST;
        if near {
            self.best.set(self.best.get().max(weight));
            let deviation = found.deviation(CLOSEST);
            parts.push(Part { weight, mean: found.mean, deviation, ..part });
        }
        near
    }

    /// Readings by one node, for each noise; the log weight at the noise of the first look.
    fn look(&self, node: &Node, terms: &[[f64; 3]], kept: &Kept, parts: &mut Vec<Part>) -> f64 {
        // Coarse meshes leave or are read, not both.
        if node.far() && (kept.coarse > COARSE_OF_FINE || !kept.long && node.size > 0.0) {
            return f64::NEG_INFINITY;
        }
        // A sign that changes beyond the finest level with no order left is a reference that is subtracted.
        let beyond =
            node.family == Family::Bend && 1.0 + node.size * terms[terms.len() - 1][0] <= 0.0;
        // Of three levels a reference is no more than a wider interval: it leaves no order that a failure would miss.
        let unstated = node.family.is_reference() && kept.long;
        let floored = node.family == Family::Floor || unstated || kept.fine > 0;
        let row = |(i, term): (usize, &[f64; 3])| {
            let scale = self.scales[i];
            self.row(i, node, &node.terms(*term), scale * scale)
        };
        let gram = Gram::of(kept.levels.clone().zip(terms).map(row));
        let (mut seen, mut largest) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        // From the largest noise on, until the residuals are too large for the noise.
        for noise in kept.noise.iter().rev() {
            let prior = match kept.long && !self.told_noise() && !self.differences {
                true => node.log_prior_at(noise.size),
                false => node.log_prior,
            };
            let out_of_reach = self.best.get() - LEAST;
            let coarsely = noise.size >= LOOK || self.told_noise();
            if coarsely && noise.size > LOOK && !beyond && prior + noise.most < out_of_reach {
                continue;
            }
            // Those of smaller noise need no more than that they are below.
            let least =
                if coarsely { f64::NEG_INFINITY } else { out_of_reach.min(largest) - prior };
            let component = gram.component(noise, node.order(), least);
            let weight = prior + component.log_evidence;
            if coarsely {
                seen = weight;
            }
            if beyond && component.mean < LEAST_ORDER {
                break;
            }
            let outside = node.last || !self.told_noise() && noise.size == LARGEST_NOISE;
            let crossing = node.family == Family::Bend && node.size < -1.0;
            let part = Part { coarse: kept.coarse, floored, outside, crossing, ..Part::default() };
            if !self.keep(weight, &component, part, parts) && weight < largest && !coarsely {
                break;
            }
            largest = largest.max(weight);
        }
        self.seen.set(self.seen.get().max(seen));
        seen
    }
}

/// What the readings of the same levels share.
struct Kept {
    levels: std::ops::Range<usize>,
    /// So many coarse and fine levels are dropped.
    coarse: usize,
    fine: usize,
    /// Levels enough for a floor.
    long: bool,
    noise: Vec<Noise>,
}
