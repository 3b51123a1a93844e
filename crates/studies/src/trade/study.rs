//! The trade of a scene: a grid of runs, each knob at three of them, and what the numbers say.

use super::extrapolation::{Extrapolated, in_space, in_time};
use super::measure::Bench;
use super::optimum::{Coupling, along_path, coupling};
use super::trial::{Table, mark_fronts};
use super::turned::turn;
use super::{Candidates, Knob, Models, Price, Rival, Trial, Variant, knobs};
use fem::space::Element;
use files::FileError;
use scene::Norm;
use scene::setup::{SetupError, Subject, check_step_sizes};
use serde::Serialize;

/// What a trade runs.
#[derive(Debug, Clone, PartialEq)]
pub struct TradeRuns {
    /// Cells per unit length.
    pub n: Vec<u32>,
    /// Numbers of steps.
    pub steps: Vec<u32>,
    /// CPU seconds for the knobs.
    pub budget: f64,
    /// The other elements, with the n of their meshes.
    pub elements: Vec<(Element, Vec<u32>)>,
}

impl TradeRuns {
    /// The scene as written, then with each of its knobs turned; other elements only as planned.
    fn variants(&self, plain: Variant) -> Result<Vec<Variant>, SetupError> {
        let scene = plain.setup.scene.clone();
        let planned = |element| self.elements.iter().any(|(listed, _)| *listed == element);
        let taken = |knob: &Knob| !matches!(knob, Knob::Element(element) if !planned(*element));
        let turned = knobs(&plain.setup).into_iter().filter(taken);
        let turned = turned.map(|knob| Variant::new(&scene, knob));
        std::iter::once(Ok(plain)).chain(turned).collect()
    }

    /// The variants with another element, and the n of their meshes.
    fn rivals<'a>(
        &'a self,
        variants: &'a [Variant],
    ) -> impl Iterator<Item = (&'a Variant, &'a [u32])> {
        self.elements.iter().filter_map(|(element, n)| {
            let of = |variant: &&Variant| variant.knob == Knob::Element(*element);
            Some((variants.iter().find(of)?, &n[..]))
        })
    }
}

/// Why a trade has no result.
#[derive(Debug, thiserror::Error)]
pub enum TradeError {
    /// A scene or mesh is at fault.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The table could not be written.
    #[error(transparent)]
    Table(#[from] FileError),
    /// Not one run came to its end.
    #[error("every run failed; the first: {first}")]
    AllFailed {
        /// The message of the first run.
        first: String,
    },
}

/// Called with each row as soon as it is known.
pub(crate) type Heard<'a> = dyn FnMut(&Trial) + 'a;

/// A power s of k = c h^s, with the exponents by which cost grows as the error falls on such a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Path {
    /// s.
    pub exponent: f64,
    /// The exponent by the models.
    pub modelled: Option<f64>,
    /// Between the coarsest and the finest run of the grid on the path.
    pub measured: Option<f64>,
}

/// A finished trade.
#[derive(Serialize)]
pub struct Study {
    /// The scene's name.
    pub scene: String,
    /// The fingerprint of the scene's text.
    pub fingerprint: String,
    /// The norm of the errors.
    pub norm: Norm,
    /// Largest ‖ε(u)‖ of the truth.
    pub size: f64,
    /// All rows in the order in which they were run.
    pub trials: Vec<Trial>,
    /// What the runs as written say.
    #[serde(flatten)]
    pub(crate) models: Models,
    /// The path of optima.
    pub(crate) coupling: Option<Coupling>,
    /// The price list.
    pub(crate) prices: Vec<Price>,
    /// What couplings of k to h cost.
    pub(crate) paths: Vec<Path>,
    /// What Richardson's extrapolation is worth, in time and in space.
    #[serde(rename = "extrapolation")]
    pub(crate) extrapolated: Vec<Extrapolated>,
    /// The other elements, compared at equal error.
    pub(crate) elements: Vec<Rival>,
}

impl Study {
    /// Runs the trade; every row is in `table` as soon as it is known.
    ///
    /// # Errors
    /// [`TradeError`]; a run that fails is a row.
    pub fn run(
        bench: &mut Bench,
        plan: &TradeRuns,
        table: &Table,
        heard: &mut Heard<'_>,
    ) -> Result<Self, TradeError> {
        let scene = bench.plain.setup.scene.clone();
        check_step_sizes(&Subject::new(scene.clone())?, &plan.steps)?;
        let mut trials: Vec<Trial> = Vec::new();
        let mut keep = |trial: Trial, trials: &mut Vec<Trial>| -> Result<(), FileError> {
            heard(&trial);
            trials.push(trial);
            table.write(trials)
        };
        let plain = Variant::new(&scene, Knob::AsWritten)?;
        for &n in &plan.n {
            for &steps in &plan.steps {
                keep(bench.trial(&plain, n, steps), &mut trials)?;
            }
            for fine in 0..plan.steps.len() {
                let steps = plan.steps[fine];
                let of = |steps: u32| trials.iter().find(|t| t.n == n && t.steps == steps);
                let half = of(steps / 2).filter(|_| steps.is_multiple_of(2));
                let row = of(steps).zip(half).filter(|_| bench.norm == Norm::VMax);
                if let Some(row) = row.and_then(|(fine, half)| bench.extrapolated(fine, half)) {
                    keep(row, &mut trials)?;
                }
            }
        }
        let first = trials.first().and_then(|trial| trial.outcome.as_ref().err().cloned());
        if trials.iter().all(|trial| trial.done().is_none()) {
            return Err(TradeError::AllFailed { first: first.unwrap_or_default() });
        }
        let on_mesh = bench.plain.setup.body.data.is_interpolated();
        let variants = plan.variants(plain)?;
        for (variant, n) in plan.rivals(&variants) {
            for &n in n {
                for &steps in &plan.steps {
                    keep(bench.trial(variant, n, steps), &mut trials)?;
                }
            }
        }
        // Two more: half the cells, half the steps.
        let runs = (variants.len() as u32 + 2) * (bench.repeats + 1);
        let mut prices = Vec::new();
        for (i, [n, steps]) in
            places(&trials, scene.dimension, runs, plan.budget).into_iter().enumerate()
        {
            let halves = if i == 0 { halves(&trials, n, steps, on_mesh) } else { Vec::new() };
            prices.extend(turn(bench, &variants, (n, steps), &halves, &mut trials, &mut keep)?);
        }
        // By knob, as a list of prices is read.
        prices.sort_by_key(|price| prices_rank(&variants, price));
        let study = Self::of(bench, &variants, trials, prices, plan)?;
        table.write(&study.trials)?;
        Ok(study)
    }

    fn of(
        bench: &Bench,
        variants: &[Variant],
        mut trials: Vec<Trial>,
        prices: Vec<Price>,
        plan: &TradeRuns,
    ) -> Result<Self, SetupError> {
        mark_fronts(&mut trials, &prices);
        let setup = &bench.plain.setup;
        let models = Models::fit(bench, &bench.plain, &trials, [&plan.n, &plan.steps]);
        let both = models.both();
        let coupling = both.and_then(|(error, cost)| coupling(error, cost));
        let best = coupling.map(|path| path.exponent);
        let exponents = [Some(0.5), Some(1.0), Some(2.0), best].into_iter().flatten();
        let mut paths: Vec<Path> = exponents
            .map(|exponent| Path {
                exponent,
                modelled: both.and_then(|(error, cost)| along_path(error, cost, exponent)),
                measured: measured_along(&trials, exponent),
            })
            .collect();
        paths.sort_by(|a, b| a.exponent.total_cmp(&b.exponent));
        paths.dedup_by(|a, b| a.exponent == b.exponent);
        let candidates = Candidates::new(setup, true)?;
        let compared = |(variant, n): (&Variant, &[u32])| {
            let rival = Models::fit(bench, variant, &trials, [n, &plan.steps]);
            Rival::new(&candidates, &models, variant.knob, rival, &trials)
        };
        let extrapolated = [in_time(&trials), in_space(bench, &trials)];
        Ok(Self {
            scene: setup.scene.name.clone(),
            fingerprint: setup.scene.source.hash.clone(),
            norm: bench.norm,
            size: bench.size,
            coupling,
            paths,
            extrapolated: extrapolated.into_iter().flatten().collect(),
            elements: plan.rivals(variants).map(compared).collect(),
            prices,
            trials,
            models,
        })
    }

    /// The rows of the scene as written.
    pub(crate) fn plain(&self) -> impl Iterator<Item = &Trial> {
        plain(&self.trials)
    }
}

/// The rows of the scene as written.
pub(super) fn plain(trials: &[Trial]) -> impl Iterator<Item = &Trial> {
    trials.iter().filter(|trial| trial.knob == Knob::AsWritten)
}

/// Runs at which knobs are turned: the largest that the budget bears `runs` times, the one with the next coarser mesh and
/// the same steps, and the one with the fewest steps on the same mesh, to see on what a price depends.
///
/// The largest is that of most cells and steps: the seconds of short runs depend on chance.
fn places(trials: &[Trial], dimension: usize, runs: u32, budget: f64) -> Vec<[u32; 2]> {
    let done = |trial: &&Trial| trial.done().is_some();
    let seconds = |trial: &Trial| trial.done().map_or(f64::INFINITY, |run| run.seconds);
    // The others cost less than the first.
    let borne = |trial: &&Trial| 3.0 * f64::from(runs) * seconds(trial) <= budget;
    let size = |trial: &Trial| f64::from(trial.n).powi(dimension as i32) * f64::from(trial.steps);
    // Of equal ones that with more steps, so that there are fewer steps to compare with.
    let by_size = |a: &&Trial, b: &&Trial| size(a).total_cmp(&size(b)).then(a.steps.cmp(&b.steps));
    let first = plain(trials).filter(done).filter(borne).max_by(by_size);
    let Some(first) = first.or_else(|| plain(trials).filter(done).min_by(by_size)) else {
        return Vec::new();
    };
    let coarser = plain(trials).filter(done).filter(|t| t.steps == first.steps && t.n < first.n);
    let second = coarser.max_by_key(|trial| trial.n);
    let fewer = plain(trials).filter(done).filter(|t| t.n == first.n && t.steps < first.steps);
    let third = fewer.min_by_key(|trial| trial.steps);
    [Some(first), second, third].into_iter().flatten().map(|trial| [trial.n, trial.steps]).collect()
}

/// Half the cells and half the steps of a run, as far as the grid has them.
fn halves(trials: &[Trial], n: u32, steps: u32, on_mesh: bool) -> Vec<(&'static str, (u32, u32))> {
    let there = |(n, steps): (u32, u32)| {
        plain(trials).any(|t| t.n == n && t.steps == steps && t.done().is_some())
    };
    // Where the data depend on the mesh, half the cells are another problem.
    let cells = (!on_mesh && n.is_multiple_of(2)).then_some(("half the cells", (n / 2, steps)));
    let fewer = steps.is_multiple_of(2).then_some(("half the steps", (n, steps / 2)));
    [cells, fewer].into_iter().flatten().filter(|(_, place)| there(*place)).collect()
}

/// Where a price stands in the list: halves first, then the knobs in their order, Richardson's scheme last.
fn prices_rank(variants: &[Variant], price: &Price) -> usize {
    match variants.iter().position(|variant| variant.knob.name() == price.what) {
        Some(knob) => knob,
        None if price.what == Knob::Extrapolated.name() => variants.len(),
        None => 0,
    }
}

/// The exponent between the ends of the path k ~ h^s on the grid.
fn measured_along(trials: &[Trial], s: f64) -> Option<f64> {
    let first = plain(trials).filter(|t| t.done().is_some()).min_by_key(|t| (t.n, t.steps))?;
    let on_path = |trial: &&Trial| {
        let [cells, steps] = [first.h / trial.h, first.k / trial.k];
        // Grids of whole numbers meet a path to rounding or not at all.
        (steps / cells.powf(s) - 1.0).abs() < 1e-9 && cells > 1.0
    };
    let last = plain(trials).filter(|t| t.done().is_some()).filter(on_path).max_by_key(|t| t.n)?;
    let (coarse, fine) = (first.done()?, last.done()?);
    let exponent = (fine.seconds / coarse.seconds).ln() / (coarse.error / fine.error).ln();
    exponent.is_finite().then_some(exponent)
}

#[cfg(test)]
mod tests {
    use super::super::trial::trial;
    use super::*;

    fn written(n: u32, steps: u32, seconds: f64) -> Trial {
        trial(Knob::AsWritten, [n, steps], 1.0, seconds)
    }

    /// Even where the run with the fewest steps took longest there are three places.
    #[test]
    fn knobs_are_turned_at_the_same_places_whatever_the_clock_says() {
        let expected = vec![[8, 4], [4, 4], [8, 2]];
        for slow in [[4, 2], [4, 4], [8, 2], [8, 4]] {
            let seconds = |n, steps| if [n, steps] == slow { 2.0 } else { 1.0 };
            let of = |n: u32| [2, 4].map(|steps| written(n, steps, seconds(n, steps)));
            let trials = [of(4), of(8)].concat();
            assert_eq!(places(&trials, 2, 1, 60.0), expected, "{slow:?}");
        }
        // Of 4² · 8 and 8² · 2 the first.
        let trials = [(4, 2), (4, 8), (8, 2)].map(|(n, steps)| written(n, steps, 1.0));
        assert_eq!(places(&trials, 2, 1, 60.0), [[4, 8], [4, 2]]);
        assert_eq!(places(&trials, 3, 1, 60.0), [[8, 2], [4, 2]]);
        // What the budget does not bear is left out.
        let trials = [written(4, 4, 1.0), written(8, 4, 100.0)];
        assert_eq!(places(&trials, 2, 1, 60.0), [[4, 4]]);
        assert_eq!(places(&trials, 2, 100, 60.0), [[4, 4]]);
    }
}
