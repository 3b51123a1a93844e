//! The trade of a scene: a grid of runs, each setting at three of them, and what the rows say: pure functions of rows.

use super::bench::{Bench, EXTRAPOLATED, Table, Trial};
use super::cost::CostSample;
use super::extrapolation::{Extrapolated, in_space, in_time};
use super::optimum::{Choice, Choices, Coupling, Law, MOST, NoAnswer, coupling};
use super::settings::settings;
use super::{Cost, ErrorModel, Outcome, SPAN};
use files::FileError;
use judge::fit::{Point, Sample, local_slopes};
use scene::setup::{Setup, SetupError, Subject, check_step_sizes};
use scene::{Change, Norm};
use serde::{Serialize, Serializer};

/// What a trade runs.
#[derive(Debug, Clone, PartialEq)]
pub struct TradeRuns {
    /// Cells per unit length.
    pub n: Vec<u32>,
    /// Numbers of steps.
    pub steps: Vec<u32>,
    /// CPU seconds for the settings.
    pub budget: f64,
    /// The other elements, with the n of their meshes.
    pub elements: Vec<(Change, Vec<u32>)>,
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
    /// What each setting changes.
    pub(crate) prices: Vec<Price>,
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
        heard: &mut dyn FnMut(&Trial),
    ) -> Result<Self, TradeError> {
        let scene = bench.setup.scene.clone();
        check_step_sizes(&Subject::new(scene.clone())?, &plan.steps)?;
        let mut trials: Vec<Trial> = Vec::new();
        let mut keep = |trials: &mut Vec<Trial>, trial: Trial| {
            heard(&trial);
            trials.push(trial);
            table.write(trials)
        };
        for &n in &plan.n {
            let keep = &mut |trial| keep(&mut trials, trial);
            bench.runs(&Change::none(), n, &plan.steps, keep)?;
        }
        if trials.iter().all(|trial| trial.done().is_none()) {
            let first = trials.iter().find_map(|trial| trial.outcome.as_ref().err().cloned());
            return Err(TradeError::AllFailed { first: first.unwrap_or_default() });
        }
        for (element, meshes) in &plan.elements {
            for &n in meshes {
                bench.runs(element, n, &plan.steps, &mut |trial| keep(&mut trials, trial))?;
            }
        }
        let elements = plan.elements.iter().map(|(element, _)| element.clone());
        let changes: Vec<Change> = settings(&bench.setup).into_iter().chain(elements).collect();
        let places = places(&trials, scene.dimension, changes.len() as u32, plan.budget);
        for &[n, steps] in &places {
            for change in &changes {
                // Another element may have been run there on one of its meshes.
                if at(change.words(), &trials, [n, steps]).is_none() {
                    bench.runs(change, n, &[steps], &mut |trial| keep(&mut trials, trial))?;
                }
            }
        }
        let on_mesh = bench.setup.body.data.is_interpolated();
        let prices = prices(&trials, &places, &changes, on_mesh);
        mark_front(&mut trials, &prices);
        let models = Models::of(AS_WRITTEN, &trials, &bench.setup);
        let finest = || plain(&trials).filter(|t| t.done().is_some());
        let finest = finest()
            .map(|t| t.h)
            .zip(finest().map(|t| t.k))
            .reduce(|a, b| (a.0.min(b.0), a.1.min(b.1)));
        let exponents = finest.and_then(|(h, k)| Some(models.cost.as_ref().ok()?.exponents(h, k)));
        let choices = Choices::new(&bench.setup, true)?;
        let elements = plan.elements.iter().map(|(element, _)| {
            Rival::new(&choices, &models, element.words(), &trials, &bench.setup)
        });
        Ok(Self {
            elements: elements.collect(),
            coupling: models.error.as_ref().ok().zip(exponents).and_then(|(e, ab)| coupling(e, ab)),
            extrapolated: [in_time(&trials), in_space(&trials, &bench.setup)]
                .into_iter()
                .flatten()
                .collect(),
            fingerprint: scene.source.hash,
            scene: scene.name,
            norm: bench.norm,
            size: bench.size,
            models,
            prices,
            trials,
        })
    }
}

/// The words of no change.
pub(super) const AS_WRITTEN: &str = "as written";

/// The rows of the scene as written.
pub(super) fn plain(trials: &[Trial]) -> impl Iterator<Item = &Trial> {
    of(AS_WRITTEN, trials)
}

fn of<'a>(change: &str, trials: &'a [Trial]) -> impl Iterator<Item = &'a Trial> {
    trials.iter().filter(move |trial| trial.change == change)
}

fn at<'a>(change: &str, trials: &'a [Trial], [n, steps]: [u32; 2]) -> Option<&'a Trial> {
    of(change, trials).find(|trial| [trial.n, trial.steps] == [n, steps])
}

/// Runs at which settings are changed: the largest that the budget bears `runs` times, the one with the next coarser mesh
/// and the same steps, and the one with the fewest steps on the same mesh, to see on what a price depends.
fn places(trials: &[Trial], dimension: usize, runs: u32, budget: f64) -> Vec<[u32; 2]> {
    let done = |trial: &&Trial| trial.done().is_some();
    let seconds = |trial: &Trial| trial.done().map_or(f64::INFINITY, |run| run.seconds);
    // The others cost less than the first.
    let borne = |trial: &&Trial| 3.0 * f64::from(runs) * seconds(trial) <= budget;
    // That of most cells and steps: the seconds of short runs depend on chance. Of equal ones that with more steps, so
    // that there are fewer steps to compare with.
    let size = |trial: &Trial| f64::from(trial.n).powi(dimension as i32) * f64::from(trial.steps);
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

/// Errors that differ by a smaller part are one: a setting that buys the sixth digit buys nothing.
const TIE: f64 = 0.01;

/// Times of two single runs that differ by a smaller factor are one: a machine that does other work slows down by as much.
const NOISE: f64 = 1.25;

/// What a setting does to time and error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Price {
    /// The setting, or the coarser step.
    pub what: String,
    /// Where: n and N of the run that it is compared with.
    pub n: u32,
    /// Number of steps there.
    pub steps: u32,
    /// Seconds of that run over seconds with the setting.
    pub speed: f64,
    /// Error with the setting over error without, less one.
    pub error: f64,
    /// Memory with the setting over memory without.
    pub bytes: f64,
    /// All of it in one sentence.
    pub words: String,
}

impl Price {
    fn new(what: &str, plain: &Trial, other: &Trial) -> Option<Self> {
        let without = plain.done()?;
        let over = |part: fn(&Outcome) -> f64| {
            other.done().map_or(f64::NAN, |with| part(with) / part(without))
        };
        let [time, error, bytes] =
            [over(|run| run.seconds), over(|run| run.error) - 1.0, over(|run| run.bytes)];
        let speed = 1.0 / time;
        let place = format!("n = {}, N = {}", plain.n, plain.steps);
        let words = match &other.outcome {
            Err(reason) => format!("{what}: fails ({place}): {reason}"),
            Ok(_) => {
                let time = match speed {
                    fast if fast >= NOISE => format!("{fast:.2} times faster"),
                    slow if slow <= 1.0 / NOISE => format!("{time:.2} times slower"),
                    _ => format!("no difference in time beyond {NOISE} times"),
                };
                let memory = match bytes {
                    ratio if !(0.95..1.05).contains(&ratio) => {
                        format!(", {ratio:.2} times the memory")
                    }
                    _ => String::new(),
                };
                format!("{what}: {time}, {}{memory} ({place})", change_of_error(error))
            }
        };
        Some(Self { what: what.into(), n: plain.n, steps: plain.steps, speed, error, bytes, words })
    }

    fn is_tie(&self) -> bool {
        self.speed < NOISE && self.speed > 1.0 / NOISE && self.error.abs() <= TIE
    }
}

/// A relative change with two digits, at least a ten-thousandth of a percent.
fn change_of_error(change: f64) -> String {
    let percent = 100.0 * change;
    if percent.abs() < 1e-4 {
        return "same error".to_owned();
    }
    let digits = (1.0 - percent.abs().log10().floor()).max(0.0) as usize;
    format!("{percent:+.digits$} % error")
}

/// The price list: half the cells and half the steps of the first place, as far as the grid has them, then each change,
/// and Richardson's scheme last. Where the data depend on the mesh, half the cells are another problem.
fn prices(trials: &[Trial], places: &[[u32; 2]], changes: &[Change], on_mesh: bool) -> Vec<Price> {
    let price = |what: &str, change: &str, place, other| {
        Price::new(what, at(AS_WRITTEN, trials, place)?, at(change, trials, other)?)
    };
    let half = |&place: &[u32; 2]| {
        let [n, steps] = place;
        let cells = (!on_mesh && n % 2 == 0).then_some(("half the cells", [n / 2, steps]));
        let fewer = (steps % 2 == 0).then_some(("half the steps", [n, steps / 2]));
        [cells, fewer].into_iter().flatten().map(move |(what, other)| (what, place, other))
    };
    let halves = places.iter().take(1).flat_map(half);
    let halves = halves.filter_map(|(what, place, other)| price(what, AS_WRITTEN, place, other));
    let changes = changes.iter().map(Change::words).chain([EXTRAPOLATED]);
    let all = changes.flat_map(|words| {
        places.iter().filter_map(move |&place| price(words, words, place, place))
    });
    halves.chain(all).collect()
}

/// Indices of the points (cost, error) that no other point beats: none is as good in both and better in one. They are
/// sorted by cost; of equal points the first is kept, and of errors that differ by a part below `tie` that which costs less.
/// A point that is not finite is not on the front.
pub fn front(points: &[[f64; 2]], tie: f64) -> Vec<usize> {
    let finite = |i: &usize| points[*i].iter().all(|value| value.is_finite());
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&a, &b| {
        let [[x, e], [y, f]] = [points[a], points[b]];
        x.total_cmp(&y).then(e.total_cmp(&f)).then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i][1] < (1.0 - tie) * least;
        least = if better { points[i][1] } else { least };
        better
    });
    order
}

/// Marks the settings that are ties, and the runs that no other beats in error and time.
fn mark_front(trials: &mut [Trial], prices: &[Price]) {
    for trial in &mut *trials {
        let is_of = |p: &&Price| p.what == trial.change && [p.n, p.steps] == [trial.n, trial.steps];
        trial.tie = prices.iter().find(is_of).is_some_and(Price::is_tie);
    }
    let place = |trial: &Trial| match trial.done().filter(|_| !trial.tie) {
        Some(run) => [run.seconds, run.error],
        None => [f64::NAN; 2],
    };
    let places: Vec<[f64; 2]> = trials.iter().map(place).collect();
    front(&places, TIE).into_iter().for_each(|i| trials[i].front = true);
}

/// Models of error and cost.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Models {
    /// The error, or why it was not fitted.
    #[serde(rename = "error_model", serialize_with = "or_reason")]
    pub error: Result<ErrorModel, String>,
    /// The cost, likewise.
    #[serde(rename = "cost_model", serialize_with = "or_reason")]
    pub cost: Result<Cost, String>,
    /// The least and the largest n and N that they rest on.
    #[serde(skip)]
    range: [[u32; 2]; 2],
}

impl Models {
    /// Fits the rows of a change.
    fn of(change: &str, trials: &[Trial], setup: &Setup) -> Self {
        let done = || of(change, trials).filter_map(|trial| Some((trial, trial.done()?)));
        let point = |(t, run): (&Trial, &Outcome)| Point {
            h: t.h,
            k: t.k,
            error: run.error,
            floor: run.floor,
        };
        let points: Vec<Point> = done().map(point).collect();
        let sample =
            |(t, run): (&Trial, &Outcome)| CostSample { h: t.h, k: t.k, seconds: run.seconds };
        let samples: Vec<CostSample> = done().map(sample).collect();
        let rows = || of(change, trials).map(|t| [t.n, t.steps]);
        let least = rows().fold([u32::MAX; 2], |a, b| [a[0].min(b[0]), a[1].min(b[1])]);
        let most = rows().fold([0; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        let one = done().all(|(t, _)| t.n == most[0]) || done().all(|(t, _)| t.steps == most[1]);
        let (dimension, horizon) = (setup.scene.dimension, setup.scene.time.horizon);
        let cost = match one {
            true => Err("the runs are on one mesh or have one number of steps: what each costs cannot be told apart".to_owned()),
            false => Cost::fit(&samples, dimension, horizon).ok_or_else(|| "no parts fit the times".into()),
        };
        let differences = differences(change, trials);
        let error = ErrorModel::fit(&points, &differences, setup.body.data.is_interpolated());
        Self { error, cost, range: [least, most] }
    }

    /// What they say of runs up to `most`.
    pub(super) fn law(&self, most: [u32; 2]) -> Result<Law<'_>, NoAnswer> {
        let missing = |what, reason: &String| {
            NoAnswer::Refused(format!("the {what} have no model: {reason}"))
        };
        let error = self.error.as_ref().map_err(|reason| missing("errors", reason))?;
        let cost = self.cost.as_ref().map_err(|reason| missing("times", reason))?;
        Ok(Law {
            error: Box::new(|h, k| error.error(h, k)),
            seconds: Box::new(|h, k| cost.seconds(h, k)),
            range: [self.range[0], most],
            made: SPAN * self.range[1][0],
        })
    }

    /// How many times beyond the runs a choice lies, in words; none within them.
    pub(super) fn beyond(&self, choice: &Choice) -> Option<String> {
        let part = |name: &str, value: u32, most: u32| {
            let times = f64::from(value) / f64::from(most);
            (value > most).then(|| format!("{name} is {times:.1} times the largest that was run"))
        };
        let most = self.range[1];
        let parts = [part("n", choice.n, most[0]), part("N", choice.steps, most[1])];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    }
}

/// A model, or `{"reason": …}`.
fn or_reason<T: Serialize, S: Serializer>(
    found: &Result<T, String>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match found {
        Ok(model) => model.serialize(serializer),
        Err(reason) => serializer.collect_map([("reason", reason)]),
    }
}

/// C k^q without space error, from runs with k and k/2 on the finest mesh that has them: ‖u_k - u_{k/2}‖ = C k^q (1 - 2^-q). The factor
/// is that of the order which the differences themselves show.
fn differences(change: &str, trials: &[Trial]) -> Vec<Sample> {
    let halved = |t: &&Trial| t.done().is_some_and(|run| run.apart.is_some());
    let Some(n) = of(change, trials).filter(halved).map(|t| t.n).max() else { return Vec::new() };
    let pair = |fine: &Trial| {
        let coarse = at(change, trials, [n, fine.steps / 2])?;
        let error = fine.done()?.apart.filter(|apart| *apart > 0.0)?;
        Some(Sample { step: coarse.k, error })
    };
    let apart: Vec<Sample> = of(change, trials).filter(|t| t.n == n).filter_map(pair).collect();
    let Some(order) = local_slopes(&apart).last().copied().filter(|order| *order > 0.0) else {
        return Vec::new();
    };
    let missing = 1.0 - 2f64.powf(-order);
    apart.into_iter().map(|s| Sample { error: s.error / missing, ..s }).collect()
}

/// Errors at which elements are compared.
const LEVELS: u32 = 5;

/// Another element, on meshes of about as many nodes, beside the scene as written.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Rival {
    /// The change.
    pub change: String,
    /// What its runs say.
    #[serde(flatten)]
    pub models: Models,
    /// Errors from the largest that was measured to the least, with the cheapest run of each. Empty where a model is missing.
    pub equal_error: Vec<Equal>,
    /// Who wins where, in words.
    pub words: String,
}

/// The cheapest runs of the scene as written and of the rival whose errors are predicted to be at most this.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Equal {
    /// The error.
    pub error: f64,
    /// The scene as written.
    pub as_written: Choice,
    /// The rival.
    pub rival: Choice,
    /// Seconds of the one over seconds of the other.
    pub speed: f64,
    /// Whether they are finer than what was run.
    pub extrapolates: [bool; 2],
}

impl Rival {
    /// Compares the rows of a change with those of the scene as written.
    fn new(
        choices: &Choices<'_>,
        plain: &Models,
        change: &str,
        trials: &[Trial],
        setup: &Setup,
    ) -> Self {
        let models = Models::of(change, trials, setup);
        let errors = || {
            let rows = of(AS_WRITTEN, trials).chain(of(change, trials));
            rows.filter_map(|t| Some(t.done()?.error)).filter(|error| *error > 0.0)
        };
        let (lo, hi) = (errors().fold(f64::INFINITY, f64::min), errors().fold(0.0, f64::max));
        let level = |i: u32| hi * (lo / hi).powf(f64::from(i) / f64::from(LEVELS - 1));
        let (mut words, mut equal_error) =
            (format!("{change}: not compared at equal error, for want of a model"), Vec::new());
        if let (Ok(first), Ok(second)) = (plain.law(MOST), models.law(MOST)) {
            let equal = |error: f64| {
                let as_written = choices.by(&first, error, MOST[0])?;
                let rival = choices.by(&second, error, MOST[0])?;
                let far = [plain.beyond(&as_written), models.beyond(&rival)];
                let (speed, extrapolates) =
                    (as_written.seconds / rival.seconds, far.map(|far| far.is_some()));
                Some(Equal { error, as_written, rival, speed, extrapolates })
            };
            equal_error = (0..LEVELS).map(level).filter_map(equal).collect();
            // Times are told apart where they differ by more than what both models miss of the runs.
            let missed =
                [plain, &models].map(|of| of.cost.as_ref().map_or(0.0, |cost| cost.residual));
            words = verdict(change, &equal_error, missed[0] + missed[1]);
        }
        Self { change: change.into(), models, equal_error, words }
    }
}

/// Who wins where: neighbours with the same winner are one range of errors.
fn verdict(name: &str, levels: &[Equal], unsure: f64) -> String {
    let winner = |at: &Equal| match at.speed.ln() {
        log if log > unsure => Some(true),
        log if log < -unsure => Some(false),
        _ => None,
    };
    let ranges = levels.chunk_by(|a, b| winner(a) == winner(b)).map(|range| {
        let [first, last] = [range[0], range[range.len() - 1]];
        let span = |a: String, b: String| if a == b { a } else { format!("{a} to {b}") };
        let errors = span(format!("{:.1e}", first.error), format!("{:.1e}", last.error));
        let times = |invert: bool| {
            let of = |at: Equal| format!("{:.1}", if invert { 1.0 / at.speed } else { at.speed });
            span(of(first), of(last))
        };
        match winner(&first) {
            Some(true) => format!("{name} wins at {errors} ({} times faster)", times(false)),
            Some(false) => format!("as written wins at {errors} ({} times faster)", times(true)),
            None => format!("no difference at {errors}"),
        }
    });
    let ranges: Vec<String> = ranges.collect();
    match ranges.is_empty() {
        true => format!("{name}: no error is in reach of both"),
        false => format!("at equal error {}", ranges.join("; ")),
    }
}

#[cfg(test)]
pub(super) fn row(change: &str, [n, steps]: [u32; 2], error: f64, seconds: f64) -> Trial {
    Trial {
        change: change.into(),
        n,
        steps,
        h: 1.0 / f64::from(n),
        k: 1.0 / f64::from(steps),
        dofs: 0,
        tie: false,
        front: false,
        outcome: Ok(Outcome { error, seconds, ..Outcome::default() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Even where the run with the fewest steps took longest there are three places.
    #[test]
    fn settings_are_changed_at_the_same_places_whatever_the_clock_says() {
        let written = |n, steps, seconds| row(AS_WRITTEN, [n, steps], 1.0, seconds);
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

    #[test]
    fn a_price_says_what_is_bought_and_paid() {
        let plain = row(AS_WRITTEN, [64, 16], 0.5, 3.1);
        let price = |error, seconds| {
            let other = row("strong loads", [64, 16], error, seconds);
            Price::new("strong loads", &plain, &other).expect("a price")
        };
        let words = price(0.5001, 1.0).words;
        assert!(words.starts_with("strong loads: 3.10 times faster, +0.020 % error"), "{words}");
        let words = price(0.25, 6.2).words;
        assert!(words.contains("2.00 times slower, -50 % error"), "{words}");
        // Single runs tell no fifth of the time, and a setting that moves nothing else is a tie.
        let same = price(0.5 + 1e-8, 2.6);
        assert!(
            same.is_tie()
                && same.words.contains("no difference")
                && same.words.contains(", same error")
        );
        assert!(!price(0.25, 3.1).is_tie() && !price(0.5, 1.0).is_tie());
        let failed = Trial { outcome: Err("KKT".into()), ..plain.clone() };
        let none = Price::new("contact exact", &plain, &failed).expect("a price");
        assert!(none.words.contains("fails") && none.speed.is_nan() && !none.is_tie());
        assert!(Price::new("x", &failed, &plain).is_none());
        for (change, words) in
            [(0.000123, "+0.012 %"), (-0.0456, "-4.6 %"), (1.0, "+100 %"), (0.0099, "+0.99 %")]
        {
            assert!(change_of_error(change).starts_with(words), "{words}");
        }
    }

    #[test]
    fn the_front_by_hand() {
        let points = [[1.0, 3.0], [2.0, 2.0], [2.0, 1.0], [3.0, 1.0], [0.5, f64::NAN], [4.0, 0.5]];
        assert_eq!(front(&points, 0.0), [0, 2, 5]);
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]], 0.0), [0]);
        // The sixth digit at four times the time is no better error; many small steps down are one in the end.
        let ties = [[1.0, 1.0], [4.0, 0.999_999], [5.0, 0.995], [6.0, 0.985]];
        assert_eq!(front(&ties, 0.01), [0, 3]);
    }

    /// (4 u_k - u_2k)/3 and differences of order 2 hide below an error of h: their constant is found all the same.
    #[test]
    fn hidden_errors_are_known_from_differences() {
        let run = |steps: u32| {
            let k = 1.0 / f64::from(steps);
            let mut trial = row(AS_WRITTEN, [8, steps], 0.5, 1.0);
            // ‖u_k - u_2k‖ = 3 · 4 k², of 4 k² and 16 k².
            trial.outcome.as_mut().expect("a run").apart = (steps > 2).then_some(12.0 * k * k);
            trial
        };
        // A finer mesh with one number of steps has no differences.
        let runs = [[2, 4, 8].map(run).to_vec(), vec![row(AS_WRITTEN, [16, 8], 0.5, 1.0)]].concat();
        let found = differences(AS_WRITTEN, &runs);
        for (sample, k) in found.iter().zip([0.5f64, 0.25]) {
            // 16 digits through two powers.
            assert!(
                (sample.error / (4.0 * k * k) - 1.0).abs() < 1e-12 && sample.step == k,
                "{found:?}"
            );
        }
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn ranges_name_their_winner() {
        let answer = |seconds| Choice { n: 8, steps: 4, h: 0.125, k: 0.25, error: 0.1, seconds };
        let level = |error: f64, speed: f64| Equal {
            error,
            as_written: answer(speed),
            rival: answer(1.0),
            speed,
            extrapolates: [false; 2],
        };
        let levels = [level(0.1, 0.5), level(0.05, 1.02), level(0.02, 3.0), level(0.01, 8.0)];
        assert_eq!(
            verdict("element P2", &levels, 0.1),
            "at equal error as written wins at 1.0e-1 (2.0 times faster); no difference at 5.0e-2; element P2 wins at 2.0e-2 to 1.0e-2 (3.0 to 8.0 times faster)"
        );
        // What the models miss decides nothing.
        assert!(verdict("element P2", &levels[..1], 0.7).ends_with("no difference at 1.0e-1"));
        assert!(verdict("element P2", &[], 0.1).contains("no error is in reach"));
    }
}
