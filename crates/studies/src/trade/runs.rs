//! What the runs of a trade say, as functions of them alone: where settings are changed and what each buys, the front, models
//! of error and cost, and the cheapest run with an error.

use super::bench::Trial;
use super::bench::settings;
use super::models::CostSample;
use super::optimum::{Choice, Choices, Law, NoAnswer};
use super::{Cost, ErrorModel, SPAN};
use judge::fit::{Point, Sample, local_slopes};
use run::sweep::MemoryLimit;
use scene::Change;
use scene::setup::{Setup, SetupError};
use serde::Serialize;
use serde_json::{Value, json};

pub(super) fn of<'a>(change: &'a Change, trials: &'a [Trial]) -> impl Iterator<Item = &'a Trial> {
    trials.iter().filter(move |trial| trial.change == *change)
}

pub(super) fn at<'a>(change: &Change, trials: &'a [Trial], place: [u32; 2]) -> Option<&'a Trial> {
    trials.iter().find(|trial| trial.change == *change && trial.place() == place)
}

/// Runs at which settings are changed: the largest that the budget allows `runs` times, the one with the next coarser mesh
/// and the same steps, and the one with the fewest steps on the same mesh, to see on what a price depends.
pub(super) fn places(trials: &[Trial], dimension: usize, runs: u32, budget: f64) -> Vec<[u32; 2]> {
    let written = Change::none();
    let done = || of(&written, trials).filter(|trial| trial.record.converged());
    // The others cost less than the first.
    let borne = |trial: &&Trial| 3.0 * f64::from(runs) * trial.seconds() <= budget;
    // That of most cells and steps: the seconds of short runs depend on chance. Of equal ones that with more steps, so
    // that there are fewer steps to compare with.
    let size = |[n, steps]: [u32; 2]| f64::from(n).powi(dimension as i32) * f64::from(steps);
    let by_size = |a: &[u32; 2], b: &[u32; 2]| size(*a).total_cmp(&size(*b)).then(a[1].cmp(&b[1]));
    let first = done().filter(borne).map(Trial::place).max_by(by_size);
    let Some(first) = first.or_else(|| done().map(Trial::place).min_by(by_size)) else {
        return Vec::new();
    };
    let all = || done().map(Trial::place);
    let second = all().filter(|place| place[1] == first[1] && place[0] < first[0]).max();
    let third = all().filter(|place| place[0] == first[0] && place[1] < first[1]).min();
    [Some(first), second, third].into_iter().flatten().collect()
}

/// Errors that differ by a smaller part are one: a setting that buys the sixth digit buys nothing.
const TIE: f64 = 0.01;

/// Times of two single runs that differ by a smaller factor are one: a machine that does other work slows down by as much.
const NOISE: f64 = 1.25;

/// What a setting does to time and error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Price {
    /// The setting, or the coarser step.
    pub what: String,
    /// n and N of the run that it is compared with.
    pub n: u32,
    pub steps: u32,
    /// Seconds of that run over seconds with the setting.
    pub speed: f64,
    /// Error with the setting over error without, less one.
    pub error: f64,
    /// Memory with the setting over memory without.
    pub bytes: f64,
}

impl Price {
    /// NaN where the run with the setting fails; none where that without it does.
    fn new(what: &str, plain: &Trial, other: &Trial) -> Option<Self> {
        let (what, [n, steps]) = (what.to_owned(), plain.place());
        let speed = plain.seconds() / other.seconds();
        let (error, bytes) = (other.error() / plain.error() - 1.0, other.bytes / plain.bytes);
        plain.record.converged().then_some(Self { what, n, steps, speed, error, bytes })
    }

    fn is_tie(&self) -> bool {
        self.speed < NOISE && self.speed > 1.0 / NOISE && self.error.abs() <= TIE
    }
}

/// The price list: half the cells and half the steps of the first place, as far as the grid has them, then each change.
/// Where the data depend on the mesh, half the cells are another problem.
pub(super) fn prices(
    trials: &[Trial],
    places: &[[u32; 2]],
    changes: &[Change],
    on_mesh: bool,
) -> Vec<Price> {
    let written = Change::none();
    let price = |what: &str, change: &Change, place, other| {
        Price::new(what, at(&written, trials, place)?, at(change, trials, other)?)
    };
    let mut found = Vec::new();
    if let Some(&[n, steps]) = places.first() {
        let cells = (!on_mesh && n % 2 == 0).then_some(("half the cells", [n / 2, steps]));
        let fewer = (steps % 2 == 0).then_some(("half the steps", [n, steps / 2]));
        let halves = [cells, fewer].into_iter().flatten();
        found.extend(halves.filter_map(|(what, half)| price(what, &written, [n, steps], half)));
    }
    for change in changes {
        found.extend(places.iter().filter_map(|&at| price(change.words(), change, at, at)));
    }
    found
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
pub(super) fn mark_front(trials: &mut [Trial], prices: &[Price]) {
    for trial in &mut *trials {
        let is_of = |p: &&Price| p.what == trial.change.words() && [p.n, p.steps] == trial.place();
        trial.tie = prices.iter().find(is_of).is_some_and(Price::is_tie);
    }
    let place =
        |trial: &Trial| if trial.tie { [f64::NAN; 2] } else { [trial.seconds(), trial.error()] };
    let places: Vec<[f64; 2]> = trials.iter().map(place).collect();
    front(&places, TIE).into_iter().for_each(|i| trials[i].front = true);
}

/// Models of error and cost of the runs with a change, or why there are none.
#[derive(Debug, Clone)]
pub(super) struct Models {
    pub change: Change,
    pub error: Result<ErrorModel, String>,
    pub cost: Result<Cost, String>,
    /// The least and the largest n and N that they rest on.
    pub range: [[u32; 2]; 2],
}

impl Models {
    pub(super) fn of(change: Change, trials: &[Trial], setup: &Setup) -> Self {
        let done = || of(&change, trials).filter(|trial| trial.record.converged());
        let point = |trial: &Trial| {
            let [h, k] = trial.steps();
            Point { h, k, error: trial.error(), floor: trial.floor() }
        };
        let points: Vec<Point> = done().map(point).collect();
        let sample = |trial: &Trial| {
            let [h, k] = trial.steps();
            CostSample { h, k, seconds: trial.seconds() }
        };
        let samples: Vec<CostSample> = done().map(sample).collect();
        let bound = |pick: fn(u32, u32) -> u32| {
            let places = of(&change, trials).map(Trial::place);
            places.reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])]).unwrap_or_default()
        };
        let [least, most] = [bound(u32::min), bound(u32::max)];
        let one = [0, 1].iter().any(|&i| done().all(|trial| trial.place()[i] == most[i]));
        let (dimension, horizon) = (setup.scene.dimension, setup.scene.time.horizon);
        let cost = match one {
            true => Err("the runs use a single mesh or a single number of steps, so their costs cannot be separated".to_owned()),
            false => Cost::fit(&samples, dimension, horizon).ok_or_else(|| "no parts fit the times".into()),
        };
        let differences = differences(&change, trials);
        let error = ErrorModel::fit(&points, &differences, setup.body.data.is_interpolated());
        Self { change, error, cost, range: [least, most] }
    }

    /// What they say of runs up to `most`.
    fn law(&self, most: [u32; 2]) -> Result<Law<'_>, NoAnswer> {
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

    pub(super) fn json(&self) -> Value {
        fn or_reason(found: &Result<impl Serialize, String>) -> Value {
            found.as_ref().map_or_else(|reason| json!({ "reason": reason }), |model| json!(model))
        }
        json!({
            "change": self.change,
            "error_model": or_reason(&self.error),
            "cost_model": or_reason(&self.cost),
        })
    }
}

/// C k^q without space error, from runs with k and k/2 on the finest mesh that has them: ‖u_k - u_{k/2}‖ = C k^q (1 - 2^-q). The factor
/// is that of the order which the differences themselves show.
fn differences(change: &Change, trials: &[Trial]) -> Vec<Sample> {
    let halved = |trial: &&Trial| trial.apart.is_some();
    let Some(n) = of(change, trials).filter(halved).map(|trial| trial.place()[0]).max() else {
        return Vec::new();
    };
    let pair = |fine: &Trial| {
        let coarse = at(change, trials, [n, fine.record.steps / 2])?;
        let error = fine.apart.filter(|apart| *apart > 0.0)?;
        Some(Sample { step: coarse.record.k, error })
    };
    let finest = of(change, trials).filter(|trial| trial.place()[0] == n);
    let apart: Vec<Sample> = finest.filter_map(pair).collect();
    let Some(order) = local_slopes(&apart).last().copied().filter(|order| *order > 0.0) else {
        return Vec::new();
    };
    let missing = 1.0 - 2f64.powf(-order);
    apart.into_iter().map(|s| Sample { error: s.error / missing, ..s }).collect()
}

/// The cheapest run with a change whose predicted error is the target or less.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Candidate {
    pub change: Change,
    #[serde(flatten)]
    pub choice: Choice,
    /// How many times n and N exceed the largest that were run, where they do.
    pub extrapolates: Option<String>,
}

/// A setting is taken where it saves this part of the time at least, which single runs tell, and moves the error by less
/// than `MOVES`.
const SAVES: f64 = 0.2;
const MOVES: f64 = 0.05;

/// The cheapest runs of the scene as written, with its best setting, and with the other elements.
pub(super) fn candidates(
    setup: &Setup,
    trials: &[Trial],
    models: &[Models],
    prices: &[Price],
    target: f64,
    limit: &MemoryLimit,
) -> Result<Vec<Candidate>, NoAnswer> {
    let written = Change::none();
    let floors = of(&written, trials).map(Trial::floor);
    NoAnswer::admit(target, floors.fold(0.0, f64::max))?;
    let (mut found, mut none) = (Vec::new(), None);
    for of_change in models {
        let changed = Setup::new(of_change.change.of(&setup.scene).map_err(SetupError::from)?)?;
        let choices = Choices::new(&changed, true)?;
        let mut keep = |change: Change, law: &Law<'_>| {
            let found_one = choices.cheapest(law, target, limit);
            let choice = found_one.map_err(|why| none.get_or_insert(why)).ok()?;
            let extrapolates = choice.beyond(of_change.range[1], 1.0);
            found.push(Candidate { change, choice, extrapolates });
            Some(choice)
        };
        let law = match of_change.law(choices.most()) {
            Ok(law) => law,
            Err(why) if of_change.change == written => return Err(why),
            Err(_) => continue,
        };
        let plain = keep(of_change.change.clone(), &law);
        let of_written = plain.filter(|_| of_change.change == written);
        let best = of_written.and_then(|choice| best_setting(settings(setup), prices, choice));
        if let Some((change, [time, error])) = best {
            let law = Law {
                error: Box::new(|h, k| error * (law.error)(h, k)),
                seconds: Box::new(|h, k| time * (law.seconds)(h, k)),
                ..law
            };
            keep(change, &law);
        }
    }
    match none {
        Some(why) if found.is_empty() => Err(why),
        _ => Ok(found),
    }
}

/// The setting that saves most time at next to no error, with its factors of time and error in the run nearest to a
/// choice; it must save time wherever it was changed.
fn best_setting(
    settings: Vec<Change>,
    prices: &[Price],
    choice: Choice,
) -> Option<(Change, [f64; 2])> {
    let factors = |change: Change| {
        let prices = || prices.iter().filter(|price| price.what == change.words());
        let ratio = |a: u32, b: u32| (f64::from(a) / f64::from(b)).ln().abs();
        let away = |price: &Price| ratio(price.n, choice.n) + ratio(price.steps, choice.steps);
        let nearest = prices().min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let saves =
            |price: &Price| price.speed >= 1.0 / (1.0 - SAVES) && price.error.abs() <= MOVES;
        let nearest = [1.0 / nearest.speed, 1.0 + nearest.error];
        prices().all(saves).then_some((change, nearest))
    };
    settings.into_iter().filter_map(factors).min_by(|a, b| a.1[0].total_cmp(&b.1[0]))
}

#[cfg(test)]
pub(super) fn row(change: &str, [n, steps]: [u32; 2], error: f64, seconds: f64) -> Trial {
    use judge::record::{CaseRecord, NormError, Status};
    let k = 1.0 / f64::from(steps);
    let entry = NormError { norm: "V_max".into(), error: Some(error), floor: Some(0.0) };
    let record = CaseRecord {
        status: Status::Converged,
        seconds_total: seconds,
        errors: vec![entry],
        ..CaseRecord::without_work("scene", Some(n), steps, k)
    };
    Trial { bytes: 1e7, ..Trial::new(&Change::new(change, Ok), record) }
}

#[cfg(test)]
pub(super) fn failed(trial: &Trial) -> Trial {
    use judge::record::{CaseRecord, Status};
    let status = Status::Failed { reason: "KKT".into() };
    let record = CaseRecord { status, errors: Vec::new(), ..trial.record.clone() };
    Trial { record, ..trial.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(n: u32, steps: u32, seconds: f64) -> Trial {
        row(Change::none().words(), [n, steps], 1.0, seconds)
    }

    /// Even where the run with the fewest steps took longest there are three places.
    #[test]
    fn settings_are_changed_at_the_same_places_whatever_the_clock_says() {
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
        let plain = row("as written", [64, 16], 0.5, 3.1);
        let price = |error, seconds| {
            let other = row("strong loads", [64, 16], error, seconds);
            Price::new("strong loads", &plain, &other).expect("a price")
        };
        let Price { speed, error, bytes, .. } = price(0.25, 6.2);
        assert_eq!((speed, error, bytes), (0.5, -0.5, 1.0));
        // Single runs tell no fifth of the time, and a setting that moves nothing else is a tie.
        assert!(price(0.5 + 1e-8, 2.6).is_tie());
        assert!(!price(0.25, 3.1).is_tie() && !price(0.5, 1.0).is_tie());
        let none = Price::new("contact exact", &plain, &failed(&plain)).expect("a price");
        assert!(none.speed.is_nan() && none.error.is_nan() && !none.is_tie());
        assert!(Price::new("x", &failed(&plain), &plain).is_none());
        // A run that failed has no numbers: loads are no part of its time.
        let [ran, lost] = [&plain, &failed(&plain)].map(|trial| trial.json()["load_share"].clone());
        assert!(ran.is_number() && lost.is_null(), "{ran} {lost}");
    }

    /// Of a few settings that which saves most time is taken, unless it moves the error or saves none somewhere.
    #[test]
    fn a_setting_is_taken_where_it_saves_time_and_moves_no_error() {
        let price = |what: &str, n, time: f64, error| {
            let plain = row("as written", [n, 4], 1.0, 1.0);
            Price::new(what, &plain, &row(what, [n, 4], 1.0 + error, time)).expect("a price")
        };
        let prices = [
            price("wrong", 8, 0.1, 0.2),
            price("here", 8, 0.2, 0.01),
            price("here", 4, 0.9, 0.01),
            price("good", 8, 0.6, 0.02),
            price("good", 4, 0.7, 0.03),
        ];
        let choice = Choice {
            target: 1.0,
            n: 5,
            steps: 4,
            h: 0.2,
            k: 0.25,
            error: 1.0,
            seconds: 1.0,
            bytes: 1.0,
        };
        let settings = |names: &[&str]| names.iter().map(|name| Change::new(*name, Ok)).collect();
        let (change, [time, error]) =
            best_setting(settings(&["wrong", "here", "good"]), &prices, choice).expect("a setting");
        // Those of the nearest place.
        assert_eq!((change.words(), time, error), ("good", 0.7, 1.03));
        assert!(best_setting(settings(&["wrong", "here"]), &prices, choice).is_none());
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

    /// Differences of order 2 hide below an error of h: their constant is found all the same.
    #[test]
    fn hidden_errors_are_known_from_differences() {
        let run = |steps: u32| {
            let k = 1.0 / f64::from(steps);
            // ‖u_k - u_2k‖ = 3 · 4 k², of 4 k² and 16 k².
            Trial { apart: (steps > 2).then_some(12.0 * k * k), ..written(8, steps, 1.0) }
        };
        // A finer mesh with one number of steps has no differences.
        let runs = [[2, 4, 8].map(run).to_vec(), vec![written(16, 8, 1.0)]].concat();
        let found = differences(&Change::none(), &runs);
        for (sample, k) in found.iter().zip([0.5f64, 0.25]) {
            // 16 digits through two powers.
            let off = sample.error / (4.0 * k * k) - 1.0;
            assert!(off.abs() < 1e-12 && sample.step == k, "{found:?}");
        }
        assert_eq!(found.len(), 2);
    }
}
