//! The trade of a scene: it is run on one grid as written and with each change that it offers, and what the runs say is a
//! function of them alone: models of error and cost, the cheapest run with an error, what each change buys.

use super::SPAN;
use super::bench::{Bench, Trial, changes, element_meshes, trade_grid};
use super::models::{CostModel, ErrorModel};
use super::optimum::{Choice, Choices, Law, NoAnswer, Wanted, coupling};
use crate::study::StudyError;
use judge::claim::{Claim, Place, Statement};
use judge::fit::{FLOORS_ABOVE, Point, Sample};
use judge::record::norm_label;
use report::{Axis, Chapter, Chart, Datum, Findings, Mark, Part, Scale, Series, digits};
use run::sweep::{CasePlan, Cost, MemoryLimit, Overrides, ScenePlan, admit_constants, admit_plan};
use scene::setup::{Setup, SetupError, Subject, check_step_sizes};
use scene::{Change, Extension, Scene};
use serde::Serialize;
use serde_json::{Value, json};

/// What a trade is asked.
pub struct Trade<'a> {
    pub setup: &'a Setup,
    pub wanted: Wanted,
    /// Cells per unit length and numbers of steps, in place of the scene's.
    pub n: Option<Vec<u32>>,
    pub steps: Option<Vec<u32>>,
    /// Predicted CPU seconds of all runs.
    pub budget: f64,
    /// Whether the answer is run.
    pub confirm: bool,
    pub limit: MemoryLimit,
}

/// The scene set up, if errors can be measured in it.
///
/// # Errors
/// It has no mesh, no truth, or a rule in time whose order is not known.
pub fn measurable(scene: &Scene) -> Result<Setup, SetupError> {
    let why = "its models assume the order of the time rule";
    scene.without(&[Extension::SingularKernel], "sweep trade", why)?;
    let message = "an abstract problem has one step and no mesh to trade against";
    let hint = "sweep run measures its errors over k";
    scene.refuse_if(scene.as_contact().is_none(), "scene.kind", message, hint)?;
    let setup = Setup::new(scene.clone())?;
    let reference = scene.sweep.as_ref().is_some_and(|sweep| sweep.reference.is_some());
    let unmeasured = setup.exact.is_none() && !reference;
    let message =
        "the scene has neither an exact solution nor a reference run: no error can be measured";
    let hint = "add reference = { n = …, steps = … } to [sweep]; `sweep solve --estimate` estimates the error of one run";
    scene.refuse_if(unmeasured, "scene.name", message, hint)?;
    Ok(setup)
}

/// Runs a trade; `heard` is told of each run. If no run has the error that is wanted, the reason stands beside the findings.
///
/// # Errors
/// [`StudyError`]; a run that fails is a claim that does.
pub fn trade(
    asked: &Trade<'_>,
    heard: &dyn Fn(&str),
) -> Result<(Findings, Option<NoAnswer>), StudyError> {
    let Trade { setup, wanted, limit, .. } = asked;
    let changes = changes(setup);
    let budget = asked.budget / changes.len() as f64;
    let [n, steps] = trade_grid(setup, [&asked.n, &asked.steps], budget)?;
    let mut bench = Bench::new(setup, wanted.norm)?;
    let mut settings: Vec<Setting> = Vec::new();
    for change in changes {
        let meshes = match admitted(setup, &change, [&n, &steps], limit) {
            Ok(meshes) => meshes,
            Err(refused) if settings.is_empty() => return Err(refused),
            Err(refused) => {
                heard(&format!("{} left out: {refused}", change.words()));
                continue;
            }
        };
        let trials = bench.runs(&change, &meshes, &steps, heard);
        if settings.is_empty() && !trials.iter().any(Trial::converged) {
            let first = trials.first().and_then(|trial| trial.reason.as_deref());
            return Err(StudyError::at("every run failed; the first", first.unwrap_or_default()));
        }
        settings.push(Setting::of(change, trials, setup));
    }
    let target = wanted.error(bench.size);
    let candidates = target.map(|target| candidates(&settings, setup, target?, limit));
    let (candidates, refused) = match candidates.transpose() {
        Ok(found) => (found.unwrap_or_default(), None),
        Err(none) => (Vec::new(), Some(none)),
    };
    // Single runs do not tell whether another setting saves less than a fifth.
    let dear = |found: &Candidate| match found.change == settings[0].change {
        true => (1.0 - SAVES) * found.choice.seconds,
        false => found.choice.seconds,
    };
    let answer = candidates.iter().min_by(|a, b| dear(a).total_cmp(&dear(b)));
    let confirmed = match answer.filter(|_| asked.confirm) {
        Some(Candidate { change, choice: Choice { n, steps, .. } }) => {
            admit_trade(change.of(&setup.scene)?, [&[*n], &[*steps]], limit)?;
            bench.runs(change, &[*n], &[*steps], heard).pop()
        }
        None => None,
    };
    Ok((found(&bench, &settings, &candidates, answer, confirmed), refused))
}

/// The meshes of a change: those of the scene, or with about as many nodes of another element; or why its errors cannot be
/// measured.
fn admitted(
    setup: &Setup,
    change: &Change,
    [n, steps]: [&[u32]; 2],
    limit: &MemoryLimit,
) -> Result<Vec<u32>, StudyError> {
    let (changed, own) = (change.of(&setup.scene)?, setup.body.element);
    let element = changed.as_contact().map_or(own, |body| body.element);
    if element.degree() > own.degree() && setup.exact.is_none() {
        let why = "the reference run has a lower degree, so it cannot serve as the truth";
        return Err(StudyError::other(why));
    }
    let meshes = match element == own {
        true => n.to_vec(),
        false => element_meshes(&setup.scene, n, element),
    };
    admit_trade(changed, [&meshes, steps], limit)?;
    Ok(meshes)
}

/// Refuses runs of a scene that would take more memory than there may be: beside a run a bench holds the truth on its mesh
/// and the displacements of a run.
fn admit_trade(
    scene: Scene,
    [n, steps]: [&[u32]; 2],
    limit: &MemoryLimit,
) -> Result<(), StudyError> {
    admit_constants(&scene, false, limit)?;
    let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
    let plan = ScenePlan::new(Subject::new(scene)?, &overrides);
    let displacements =
        |(case, cost): &(&CasePlan, &Cost)| 8.0 * cost.dofs as f64 * (f64::from(case.steps) + 1.0);
    admit_plan(&plan, 1, limit, |cases| cases.iter().map(displacements).sum())?;
    check_step_sizes(&plan.subject, steps)?;
    Ok(())
}

/// Errors that differ by a smaller part are one: a setting that buys the sixth digit buys nothing.
const TIE: f64 = 0.01;

/// Indices of the points (cost, error) that no other point beats: none is as good in both and better in one. They are
/// sorted by cost; of equal points the first is kept, and of errors that differ by a part below `tie` that which costs less.
/// A point that is not finite is not on the front.
pub fn front(points: &[Datum], tie: f64) -> Vec<usize> {
    let finite = |i: &usize| points[*i].0.is_finite() && points[*i].1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&a, &b| {
        let [(x, e), (y, f)] = [points[a], points[b]];
        x.total_cmp(&y).then(e.total_cmp(&f)).then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < (1.0 - tie) * least;
        least = if better { points[i].1 } else { least };
        better
    });
    order
}

/// The runs with a change, from few cells and steps to many, and models of their error and cost, or why there are none.
struct Setting {
    change: Change,
    trials: Vec<Trial>,
    error: Result<ErrorModel, String>,
    cost: Result<CostModel, &'static str>,
}

impl Setting {
    fn of(change: Change, trials: Vec<Trial>, setup: &Setup) -> Self {
        let done = || trials.iter().filter(|trial| trial.converged());
        let point = |&Trial { h, k, error, floor, .. }: &Trial| Point { h, k, error, floor };
        let in_time = |trial: &Trial| Some(Sample { step: trial.k, error: trial.in_time? });
        let points: Vec<Point> = done().map(point).collect();
        let in_time: Vec<Sample> = done().filter_map(in_time).collect();
        let times: Vec<_> = done().map(|trial| [trial.h, trial.k, trial.seconds]).collect();
        let error = ErrorModel::fit(&points, &in_time, setup.body.data.is_interpolated());
        let cost = CostModel::fit(&times, setup.scene.dimension, setup.scene.time.horizon);
        Self { change, trials, error, cost }
    }

    /// The cheapest run whose predicted error is the target or less.
    fn cheapest(
        &self,
        setup: &Setup,
        target: f64,
        limit: &MemoryLimit,
    ) -> Result<Candidate, NoAnswer> {
        let missing =
            |what, reason: &str| NoAnswer::Refused(format!("the {what} have no model: {reason}"));
        let error = self.error.as_ref().map_err(|reason| missing("errors", reason))?;
        let cost = self.cost.as_ref().map_err(|reason| missing("times", reason))?;
        let [least, most] = [self.trials.first(), self.trials.last()]
            .map(|trial| trial.map(Trial::place).unwrap_or_default());
        let changed = Setup::new(self.change.of(&setup.scene).map_err(SetupError::from)?)?;
        let choices = Choices::new(&changed, true)?;
        let law = Law {
            error: Box::new(|h, k| error.error(h, k)),
            seconds: Box::new(|h, k| cost.seconds(h, k)),
            range: [least, choices.most()],
            made: SPAN * most[0],
        };
        let choice = choices.cheapest(&law, target, limit)?;
        Ok(Candidate { change: self.change.clone(), choice })
    }

    fn json(&self) -> Value {
        fn or_reason(found: &Result<impl Serialize, impl Serialize>) -> Value {
            found.as_ref().map_or_else(|reason| json!({ "reason": reason }), |model| json!(model))
        }
        json!({
            "change": self.change,
            "error_model": or_reason(&self.error),
            "cost_model": or_reason(&self.cost),
        })
    }
}

/// The cheapest run with a change that has the error which is wanted.
#[derive(Debug, Clone, Serialize)]
struct Candidate {
    change: Change,
    #[serde(flatten)]
    choice: Choice,
}

/// The cheapest run with each change; the first refusal if there is none at all.
fn candidates(
    settings: &[Setting],
    setup: &Setup,
    target: f64,
    limit: &MemoryLimit,
) -> Result<Vec<Candidate>, NoAnswer> {
    let floors = settings[0].trials.iter().map(|trial| trial.floor);
    NoAnswer::admit(target, floors.fold(0.0, f64::max))?;
    let all: Vec<_> = settings.iter().map(|one| one.cheapest(setup, target, limit)).collect();
    match all.iter().any(Result::is_ok) {
        true => Ok(all.into_iter().flatten().collect()),
        false => all.into_iter().collect(),
    }
}

/// Another setting or element is the answer where it saves this part of the time at least.
const SAVES: f64 = 0.2;

/// What a change does to time and error in the largest run that was made with and without it.
fn price(written: &[Trial], change: &Change, trials: &[Trial]) -> Option<Value> {
    let both = |plain: &Trial| {
        let other = trials.iter().find(|trial| trial.place() == plain.place())?;
        let speed = plain.seconds / other.seconds;
        let error = other.error / plain.error - 1.0;
        let Trial { n, steps, .. } = plain;
        let price =
            json!({ "what": change, "n": n, "steps": steps, "speed": speed, "error": error });
        speed.is_finite().then_some(price)
    };
    written.iter().rev().find_map(both)
}

/// By what part of itself a predicted error may be off.
const OFF: f64 = 0.25;

/// All runs with their changes.
fn all(settings: &[Setting]) -> impl Iterator<Item = (&Change, &Trial)> {
    settings
        .iter()
        .flat_map(|Setting { change, trials, .. }| trials.iter().map(move |trial| (change, trial)))
}

/// What can be false in a trade. Nothing is claimed of seconds, which are those of a clock.
fn claims(settings: &[Setting], answer: Option<(&Candidate, &Trial)>) -> Vec<Claim> {
    let claim = |says: [&'static str; 2], (change, trial): (&Change, &Trial), sides, accuracy| {
        let statement = Statement { source: says[0], says: says[1] };
        let (at, level) = (change.words().to_owned(), None);
        let place = Place { n: Some(trial.n), steps: Some(trial.steps), level, at };
        let note = trial.reason.clone().unwrap_or_default();
        Claim { note, ..Claim::at_most(statement, place, sides, accuracy) }
    };
    let measured = all(settings).map(|run| {
        let sides = [FLOORS_ABOVE * run.1.floor, run.1.error];
        claim(["error", "20 floors of solver and rounding <= error"], run, sides, 0.0)
    });
    let written = &settings[0];
    let fitted = written.error.iter().flat_map(|model| {
        let runs = written.trials.iter().filter(|trial| trial.converged());
        runs.map(move |trial| {
            let off = (model.error(trial.h, trial.k) / trial.error - 1.0).abs();
            let says = ["error model", "|predicted/error - 1| <= 1/4"];
            claim(says, (&written.change, trial), [off, OFF], 0.0)
        })
    });
    let held = answer.map(|(Candidate { change, choice }, trial)| {
        let (says, target) = (["target", "error of the answer <= target"], choice.target);
        claim(says, (change, trial), [trial.error, target], OFF * target)
    });
    measured.chain(fitted).chain(held).collect()
}

fn found(
    bench: &Bench<'_>,
    settings: &[Setting],
    candidates: &[Candidate],
    answer: Option<&Candidate>,
    confirmed: Option<Trial>,
) -> Findings {
    let (scene, written, norm) = (&bench.setup.scene, &settings[0], bench.norm);
    let target = answer.map_or(f64::NAN, |answer| answer.choice.target);
    let claims = claims(settings, answer.zip(confirmed.as_ref()));
    let title = (Chapter::Trade, format!("Cost and error: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    let document = &mut findings.document;
    if let Some(Candidate { change, choice }) = answer {
        let real = confirmed.as_ref().map_or(String::new(), |real| {
            format!("; real: error {:.4e}, {:.3} CPU s", real.error, real.seconds)
        });
        let words = choice.words(&format!(", {}", change.words()), "");
        document.answer(format!("target {target:.4e} in {}: {words}{real}", norm.name()));
    }
    document.words(format!(
        "Errors in {}; the largest strain norm of the truth is {}.",
        norm.name(),
        digits(bench.size, 5)
    ));
    let done = written.trials.iter().filter(|trial| trial.converged());
    let finest =
        done.map(|trial| [trial.h, trial.k]).reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]);
    let exponents =
        written.cost.as_ref().ok().zip(finest).map(|(cost, [h, k])| cost.exponents(h, k));
    let path = written.error.as_ref().ok().zip(exponents).and_then(|(e, ab)| coupling(e, ab));
    if let Some(path) = &path {
        document.words(format!(
            "Cheapest coupling: k = {} h^{:.3}, where space has {:.0} % of the error (of its square, for root-sum-square); an error E costs E^-{:.2}.",
            digits(path.factor, 4),
            path.exponent,
            100.0 * path.space_share,
            path.cost_exponent
        ));
    }
    let of_changes: Value = settings.iter().map(Setting::json).collect();
    document.rows(
        "Error: C_h h^p and C_k k^q, and by what factor a run differs at most (its logarithm).",
        &of_changes,
        "with = change; >C_h = error_model/space/constant; >p = error_model/space/order 4; \
         >from = error_model/space/interval/0 3; >to = error_model/space/interval/1 3; >C_k = error_model/time/constant; \
         >q = error_model/time/order 4; found by = error_model/source; >off by = error_model/residual 2; \
         none because = error_model/reason",
    );
    findings.table(
        "models",
        of_changes,
        "Cost: CPU seconds a run, a cell (h^-d), an operation of a factorization (h^-3(d-1)), once and a level.",
        "with = change; >run = cost_model/parts/0 2; >cell = cost_model/parts/1 2; >cell and level = cost_model/parts/2 2; \
         >operation = cost_model/parts/3 2; >operation and level = cost_model/parts/4 2; >off by = cost_model/residual 2; \
         none because = cost_model/reason",
    );
    findings.table(
        "candidates",
        candidates,
        "The cheapest runs that reach the target error.",
        "with = change; >n = n; >N = steps; >predicted error = error 4; >CPU s = cpu_seconds 3; >bytes = bytes 3",
    );
    let points: Vec<Datum> = all(settings).map(|(_, trial)| datum(trial)).collect();
    let best = front(&points, TIE);
    let row = |(i, (change, trial)): (usize, (&Change, &Trial))| {
        let mut row = json!(trial);
        (row["scene"], row["change"]) = (json!(scene.name), json!(change));
        (row["norm"], row["front"]) = (json!(norm), json!(best.contains(&i)));
        row["status"] = json!(if trial.converged() { "converged" } else { "failed" });
        row
    };
    let trials: Value = all(settings).enumerate().map(row).collect();
    let keys = "scene,change,n,steps,h,k,dofs,norm,error,floor,cpu_seconds,load_share,history_bytes,newton_iterations,factorizations,front,status,reason";
    findings.tables.push((".csv", keys, trials.clone()));
    findings.table(
        "trials",
        trials,
        "Error, CPU seconds of one run on this machine, the part of the loads; front: no run here is both faster and better, errors within 1 % being one.",
        "setting = change; >n = n; >N = steps; >error = error; >CPU s = cpu_seconds 3; >in loads = load_share 2; front = front",
    );
    let prices = settings[1..].iter();
    let prices = prices.filter_map(|one| price(&written.trials, &one.change, &one.trials));
    findings.table(
        "prices",
        prices.collect::<Vec<_>>(),
        "What a change does to the largest run that was made with and without it. Seconds are from single runs on this machine, so a factor below 1.25 is no difference.",
        "what is changed = what; >n = n; >N = steps; >times faster = speed 3; >error, its part = error 2",
    );
    let caption = "Error against CPU seconds, with the Pareto front (sweep trade).";
    findings.document.figure("trade", caption, picture(bench, settings, &best, target));
    findings
        .numbers(json!({ "norm": norm, "size": bench.size, "coupling": path, "answer": answer }));
    if let Some((Candidate { choice, .. }, real)) = answer.zip(confirmed) {
        let Trial { error, seconds, .. } = real;
        let ratios =
            json!({ "error": choice.error / error, "cpu_seconds": choice.seconds / seconds });
        let confirmed = json!({ "error": error, "cpu_seconds": seconds, "ratios": ratios });
        findings.number("confirmed", confirmed);
    }
    findings
}

fn datum(trial: &Trial) -> Datum {
    (trial.seconds, trial.error)
}

/// Error against CPU time, a marker per run, with the Pareto front and the target; none without two runs.
fn picture(bench: &Bench<'_>, settings: &[Setting], best: &[usize], target: f64) -> Option<String> {
    let mut chart = Chart::new(
        &format!("{}: speed against accuracy", bench.setup.scene.name),
        "The error reached in a given CPU time (one thread of this machine: mesh, loads and march), in runs from few cells and steps to many.",
        Axis::new("CPU time in seconds", Scale::Log),
        Axis::new(format!("error {}", norm_label(bench.norm.name())), Scale::Log),
    );
    for Setting { change, trials, .. } in settings {
        let data = trials.iter().map(datum).collect();
        chart.series.push(Series::new(change.words(), vec![Part::Points(data)]));
    }
    let trials: Vec<&Trial> = all(settings).map(|(_, trial)| trial).collect();
    let label = |&i: &usize| {
        let Trial { n, steps, .. } = trials[i];
        (datum(trials[i]), format!("n = {n}, N = {steps}"))
    };
    chart.labels = best.iter().map(label).collect();
    let front = Part::Dashed(chart.labels.iter().map(|(place, _)| *place).collect());
    chart.series.push(Series { grey: true, ..Series::new("Pareto front", vec![front]) });
    if target.is_finite() {
        chart.horizontals.push(Mark { at: target, label: format!("target {}", digits(target, 4)) });
    }
    chart.svg()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(place: [u32; 2], error: f64, seconds: f64) -> Trial {
        let sizes = place.map(|count| 1.0 / f64::from(count));
        Trial { error, seconds, ..Trial::new(place, sizes) }
    }

    #[test]
    fn a_price_says_what_is_bought_and_paid() {
        let written = [[32, 16], [64, 16], [64, 32]].map(|place| run(place, 0.5, 3.1));
        let change = Change::new("strong loads", Ok);
        // The largest run has no price where it fails with the change.
        let trials = [run([64, 16], 0.25, 6.2), run([64, 32], f64::NAN, f64::NAN)];
        let found = price(&written, &change, &trials).expect("a price");
        assert_eq!((&found["n"], &found["steps"]), (&64.into(), &16.into()));
        assert_eq!((&found["speed"], &found["error"]), (&0.5.into(), &(-0.5).into()));
        assert!(price(&written, &change, &[]).is_none());
    }

    #[test]
    fn the_front_by_hand() {
        let points = [(1.0, 3.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (0.5, f64::NAN), (4.0, 0.5)];
        assert_eq!(front(&points, 0.0), [0, 2, 5]);
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)], 0.0), [0]);
        // The sixth digit at four times the time is no better error; many small steps down are one in the end.
        let ties = [(1.0, 1.0), (4.0, 0.999_999), (5.0, 0.995), (6.0, 0.985)];
        assert_eq!(front(&ties, 0.01), [0, 3]);
    }
}
