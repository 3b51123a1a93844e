//! Bayesian inference of the order of a table: all readings of its levels, weighed by their evidence.
//!
//! Model: log e = c + p log h + g(h) + noise, g a next term of unknown size and power ([`next_term`]). Coarse levels
//! may be dropped one by one; a dropped level costs as much as one explained with density 1/3 per unit of log e. Fine
//! levels are dropped only where the slopes break downwards, as into a floor. Each reading gives a normal distribution
//! of p in closed form ([`evidence`]); the posterior is their mixture. Deterministic: equal tables have equal answers.

mod claim;
mod evidence;
mod grid;
mod mixture;
mod next_term;

use super::level::{deviation, unexplained};
use super::{Direction, FitError, Interval, Level, Point, Sample, power_of_log, samples, screen};
use evidence::{Base, Noise};
use mixture::{Mixture, Part};
use next_term::{Family, NODES};

#[cfg(test)]
mod tests;

pub use claim::{Claim, ClaimError, Ruling, TOLERANCE};
pub use grid::{GridPosterior, infer_grid};

/// An order needs so many levels.
pub const FEWEST: usize = 3;
/// Noise of log e if unknown, with weights.
const NOISE: [(f64, f64); 6] =
    [(0.0005, 0.25), (0.001, 0.25), (0.003, 0.25), (0.01, 0.2), (0.03, 0.04), (0.1, 0.01)];
const LEAST_NOISE: f64 = 0.0005;
/// Prior of dropping so many coarse levels; halved for each further one.
const COARSE: [f64; 6] = [0.6, 0.2, 0.1, 0.05, 0.03, 0.02];
/// Prior of dropping so many fine levels.
const FINE: [f64; 4] = [1.0, 0.03, 0.015, 0.008];
/// Density per unit of log e of a dropped level.
const LEFT: f64 = 1.0 / 3.0;
/// A reading with a floor needs more levels than an order has parameters.
const FLOOR_LEVELS: usize = 4;
/// Readings below exp(-16) of the likeliest are dropped.
const LEAST: f64 = 16.0;
/// Levels of a long table beyond which the coarsest are dropped at once.
const LONGEST: usize = 12;

/// What a table says of its order.
#[derive(Debug, Clone)]
pub struct Posterior {
    pub order: f64,
    /// 95 % interval with equal tails.
    pub interval: Interval,
    /// Coarse levels, from the coarsest, that carry less than half of the evidence.
    pub coarse_left_out: usize,
    /// Largest step affected by an unstated floor, if a floor is likelier than not.
    pub floor_from: Option<f64>,
    /// Slopes of log e between neighbouring levels, coarse to fine; empty for a grid.
    pub slopes: Vec<f64>,
    /// All readings, those without a floor, those with one.
    all: Mixture,
    sound: Mixture,
    floored: Mixture,
    floor: f64,
    /// A level left out that the others do not explain, in words: nothing is confirmed then.
    unexplained: Option<String>,
}

/// The levels of a line that serve, and what they say of the order.
#[derive(Debug, Clone)]
pub struct LineReading {
    pub samples: Vec<Sample>,
    pub posterior: Posterior,
}

impl LineReading {
    /// Reads points with the relative standard deviations of their errors, if known; see [`infer`]. Points without a step
    /// in this direction do not count.
    pub fn of(
        measured: &[(Point, Option<f64>)],
        direction: Direction,
        noise: Option<f64>,
        log: f64,
    ) -> Result<Self, FitError> {
        let there = measured.iter().filter(|(point, _)| !direction.step(point).is_nan());
        let levels = there.map(|(point, sigma)| {
            // Of a level that is left out, the deviation may be none: a share of nothing.
            let sigma = sigma.filter(|_| screen(point).is_ok());
            Level::of(point, direction, sigma)
        });
        let posterior = infer(&levels.collect::<Result<Vec<_>, _>>()?, noise, log)?;
        let points: Vec<Point> = measured.iter().map(|(point, _)| *point).collect();
        Ok(Self { samples: samples(&points, direction)?, posterior })
    }
}

/// Order of a table of steps h and errors e.
pub fn order(table: &[(f64, f64)]) -> Result<Posterior, FitError> {
    let levels = table.iter().map(|&(h, error)| Level::new(h, error));
    infer(&levels.collect::<Result<Vec<_>, _>>()?, None, 0.0)
}

/// Posterior of the order. Levels in any order, each once; levels near their floors, and errors of exactly 0, are left
/// out, and confirm nothing if the others do not explain them. `noise`: relative standard deviation of the errors, if
/// known; `log`: power M of a factor |log h|^M.
///
/// # Errors
/// [`FitError::TooFew`] below three levels, [`FitError::RepeatedStep`], [`FitError::Level`] for a noise that is none,
/// [`FitError::Log`], [`FitError::NoLogarithm`] with a factor |log h|^M.
pub fn infer(levels: &[Level], noise: Option<f64>, log: f64) -> Result<Posterior, FitError> {
    let (mut serving, left_out): (Vec<Level>, Vec<Level>) =
        levels.iter().partition(|level| level.screened().is_ok());
    serving.sort_by(|a, b| b.size().total_cmp(&a.size()));
    let table = Table::new(&serving, noise, log)?;
    let parts = table.parts();
    let [sound, floored] =
        [false, true].map(|with_floor| Mixture::of(&parts, |part| part.floored == with_floor));
    let all = sound.union(&floored);
    let floor = floored.weight / all.weight;
    let mut leaving = vec![0.0; levels.len()];
    parts.iter().for_each(|part| leaving[part.coarse] += part.weight);
    let beyond = |coarse: &usize| leaving[*coarse..].iter().sum::<f64>() > 0.5 * all.weight;
    let coarse_left_out = (1..levels.len()).take_while(beyond).count();
    let interval = Interval { lo: all.quantile(0.025), hi: all.quantile(0.975) };
    Ok(Posterior {
        order: all.quantile(0.5),
        unexplained: unexplained(&left_out, &serving, interval, log),
        interval,
        coarse_left_out,
        floor_from: (floor > 0.5).then(|| table.break_down()),
        slopes: table.slopes(),
        all,
        sound,
        floored,
        floor,
    })
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

struct Table {
    sizes: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    scales: Vec<f64>,
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
        let levels = &levels[levels.len().saturating_sub(LONGEST)..];
        let factor = |size: f64| if log == 0.0 { 0.0 } else { log * size.ln().abs().ln() };
        // One noise for all levels (unknown or given), or one per level.
        let given = |level: &Level| level.sigma().or(noise).map(|sigma| sigma.max(LEAST_NOISE));
        let known: Option<Vec<f64>> = levels.iter().map(given).collect();
        Ok(Self {
            sizes: levels.iter().map(Level::size).collect(),
            x: levels.iter().map(|level| level.size().ln()).collect(),
            y: levels.iter().map(|level| level.error().ln() - factor(level.size())).collect(),
            noise: if known.is_some() { vec![(1.0, 1.0)] } else { NOISE.to_vec() },
            scales: known.unwrap_or_else(|| vec![1.0; levels.len()]),
        })
    }

    fn slopes(&self) -> Vec<f64> {
        let slope = |i: usize| (self.y[i] - self.y[i - 1]) / (self.x[i] - self.x[i - 1]);
        (1..self.x.len()).map(slope).collect()
    }

    /// Whether the slopes fall at the finest `fine` levels and from there break downwards: a floor bends its first
    /// level less than the later ones.
    fn breaks(&self, fine: usize) -> bool {
        let slopes = self.slopes();
        let (before, left) = slopes.split_at(slopes.len() - fine);
        let (Some(before), Some(first)) = (before.last(), left.first()) else { return false };
        let least = left.iter().copied().fold(f64::INFINITY, f64::min);
        first < before && least < before - 0.25 * (0.8 * before).max(0.4)
    }

    /// The step after which the slopes fall most: where a floor begins.
    fn break_down(&self) -> f64 {
        let slopes = self.slopes();
        let falls = slopes.windows(2).map(|pair| pair[1] - pair[0]).enumerate();
        let steepest = falls.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(at, _)| at);
        self.sizes[steepest + 1]
    }

    fn parts(&self) -> Vec<Part> {
        let levels = self.x.len();
        let mut parts: Vec<Part> = Vec::new();
        for (fine, prior) in FINE.iter().enumerate() {
            if fine + FEWEST > levels || (fine > 0 && !self.breaks(fine)) {
                continue;
            }
            for coarse in 0..=levels - fine - FEWEST {
                let last = COARSE.len() - 1;
                let halved = 0.5f64.powi(coarse.saturating_sub(last) as i32);
                let left_out = (coarse + fine) as f64 * LEFT.ln();
                let log_prior = (prior * COARSE[coarse.min(last)] * halved).ln() + left_out;
                self.read(coarse, fine, log_prior, &mut parts);
            }
        }
        let largest = parts.iter().map(|part| part.weight).fold(f64::NEG_INFINITY, f64::max);
        // Those dropped sum to less than a thousandth of the likeliest.
        parts.retain(|part| part.weight > largest - LEAST);
        parts.iter_mut().for_each(|part| part.weight = (part.weight - largest).exp());
        parts
    }

    /// Readings of the remaining levels, with log weights.
    fn read(&self, coarse: usize, fine: usize, log_prior: f64, parts: &mut Vec<Part>) {
        let kept = coarse..self.x.len() - fine;
        let (coarsest, finest) = (self.sizes[kept.start], self.sizes[kept.end - 1]);
        let of = |values: &'_ [f64]| values[kept.clone()].to_vec();
        let (observed, base) = Base::new(&of(&self.x), &of(&self.y), &of(&self.scales));
        let noise = self.noise.iter().map(|(s, share)| base.noise(*s, log_prior + share.ln()));
        let noise: Vec<Noise> = noise.collect();
        // Neighbouring nodes share their power, so powers are computed once for them.
        let mut terms: Vec<[f64; 2]> = Vec::new();
        let mut power = None;
        for node in NODES.iter() {
            let floored = node.family == Family::Floor;
            if floored && (kept.len() < FLOOR_LEVELS || fine > 0) {
                continue;
            }
            if power != Some((node.family, node.power)) {
                power = Some((node.family, node.power));
                let sizes = self.sizes[kept.clone()].iter();
                terms = sizes.map(|h| node.powers(h / coarsest, h / finest)).collect();
            }
            let nexts = terms.iter().map(|term| node.terms(*term));
            let gram = base.gram(observed.iter().copied().zip(nexts));
            for noise in &noise {
                let component = base.component(&gram, noise, node.order());
                parts.push(Part {
                    weight: node.log_prior + component.log_evidence,
                    mean: component.mean,
                    deviation: component.deviation,
                    floored: floored || fine > 0,
                    coarse,
                });
            }
        }
    }
}
