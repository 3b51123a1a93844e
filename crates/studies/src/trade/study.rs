//! The trade of a scene: it is run on one grid as written and with each change that it offers, and what the runs say is a
//! function of them alone: models of error and cost, the cheapest run with an error, what each change buys.

use super::bench::{Bench, Trial, changes, element_meshes, trade_grid};
use super::models::CostSample;
use super::optimum::{Choice, Choices, Law, NoAnswer, Wanted, coupling};
use super::{Cost, ErrorModel, SPAN};
use crate::study::StudyError;
use judge::claim::{Claim, Place, Statement};
use judge::fit::{FLOORS_ABOVE, Point, Sample};
use judge::record::norm_label;
use report::{Axis, Chapter, Chart, Datum, Findings, Mark, Part, Scale, Series, digits};
use run::sweep::{
    CasePlan, Cost as CaseCost, MemoryLimit, Overrides, ScenePlan, admit_constants, admit_plan,
};
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
    let [n, steps] =
        trade_grid(setup, &asked.n, &asked.steps, asked.budget / changes.len() as f64)?;
    let admitted = admit_trade(&setup.scene, &n, &steps, limit)?;
    check_step_sizes(&admitted.subject, &steps)?;
    let mut bench = Bench::new(setup, wanted.norm)?;
    let mut models = Vec::new();
    for change in changes {
        let Some(meshes) = meshes(setup, &change, [&n, &steps], limit, heard)? else { continue };
        bench.runs(&change, &meshes, &steps, heard);
        if !bench.trials.iter().any(Trial::converged) {
            let first = bench.trials.first().and_then(|trial| trial.reason.as_deref());
            return Err(StudyError::at("every run failed; the first", first.unwrap_or_default()));
        }
        models.push(Models::of(change, &bench.trials, setup));
    }
    let (mut candidates, mut refused) = (Vec::new(), None);
    if let Some(target) = wanted.error(bench.size) {
        let floors = of(&models[0].change, &bench.trials).map(|trial| trial.floor);
        refused = NoAnswer::admit(target, floors.fold(0.0, f64::max)).err();
        let mut none = None;
        for of_change in models.iter().filter(|_| refused.is_none()) {
            match of_change.cheapest(setup, target, limit) {
                Ok(found) => candidates.push(found),
                Err(why) => none = none.or(Some(why)),
            }
        }
        refused = refused.or(none.filter(|_| candidates.is_empty()));
    }
    // Single runs do not tell whether another setting saves less than a fifth.
    let dear = |found: &Candidate| match found.change == models[0].change {
        true => (1.0 - SAVES) * found.choice.seconds,
        false => found.choice.seconds,
    };
    let answer = candidates.iter().min_by(|a, b| dear(a).total_cmp(&dear(b)));
    let confirmed = match answer.filter(|_| asked.confirm) {
        Some(Candidate { change, choice }) => {
            let changed = change.of(&setup.scene).map_err(SetupError::from)?;
            admit_trade(&changed, &[choice.n], &[choice.steps], limit)?;
            bench.runs(change, &[choice.n], &[choice.steps], heard);
            bench.trials.pop()
        }
        None => None,
    };
    Ok((found(&bench, &models, &candidates, answer, confirmed), refused))
}

/// Refuses runs of a scene that would take more memory than there may be: beside a run a bench holds the truth on its mesh
/// and the displacements of a run.
fn admit_trade(
    scene: &Scene,
    n: &[u32],
    steps: &[u32],
    limit: &MemoryLimit,
) -> Result<ScenePlan, StudyError> {
    admit_constants(scene, false, limit)?;
    let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
    let plan = ScenePlan::new(Subject::new(scene.clone())?, &overrides);
    let displacements = |(case, cost): &(&CasePlan, &CaseCost)| {
        8.0 * cost.dofs as f64 * (f64::from(case.steps) + 1.0)
    };
    admit_plan(&plan, 1, limit, |cases| cases.iter().map(displacements).sum())?;
    Ok(plan)
}

/// The meshes of a change: those of the scene, or with about as many nodes of another element. None if errors cannot be
/// measured or memory does not hold them, which is said.
fn meshes(
    setup: &Setup,
    change: &Change,
    [n, steps]: [&[u32]; 2],
    limit: &MemoryLimit,
    heard: &dyn Fn(&str),
) -> Result<Option<Vec<u32>>, SetupError> {
    let changed = change.of(&setup.scene)?;
    let own = setup.body.element;
    let element = changed.as_contact().map_or(own, |body| body.element);
    let meshes = match element == own {
        true => n.to_vec(),
        false => element_meshes(&setup.scene, n, element),
    };
    let lower = element.degree() > own.degree() && setup.exact.is_none();
    let why = match admit_trade(&changed, &meshes, steps, limit) {
        _ if lower => {
            "the reference run has a lower degree, so it cannot serve as the truth".into()
        }
        Ok(_) => return Ok(Some(meshes)),
        Err(refused) => refused.to_string(),
    };
    heard(&format!("{} left out: {why}", change.words()));
    Ok(None)
}

fn of<'a>(change: &'a Change, trials: &'a [Trial]) -> impl Iterator<Item = &'a Trial> {
    trials.iter().filter(move |trial| trial.change == *change)
}

fn at<'a>(change: &Change, trials: &'a [Trial], place: [u32; 2]) -> Option<&'a Trial> {
    trials.iter().find(|trial| trial.change == *change && trial.place() == place)
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

/// Models of error and cost of the runs with a change, or why there are none.
#[derive(Debug, Clone)]
struct Models {
    change: Change,
    error: Result<ErrorModel, String>,
    cost: Result<Cost, String>,
    /// The least and the largest n and N that they rest on.
    range: [[u32; 2]; 2],
}

impl Models {
    fn of(change: Change, trials: &[Trial], setup: &Setup) -> Self {
        let done: Vec<&Trial> = of(&change, trials).filter(|trial| trial.converged()).collect();
        let points =
            done.iter().map(|&&Trial { h, k, error, floor, .. }| Point { h, k, error, floor });
        let samples = done.iter().map(|&&Trial { h, k, seconds, .. }| CostSample { h, k, seconds });
        let in_time =
            done.iter().filter_map(|trial| Some(Sample { step: trial.k, error: trial.in_time? }));
        let bound = |pick: fn(u32, u32) -> u32| {
            let places = of(&change, trials).map(Trial::place);
            places.reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])]).unwrap_or_default()
        };
        let [least, most] = [bound(u32::min), bound(u32::max)];
        let one = [0, 1].iter().any(|&i| done.iter().all(|trial| trial.place()[i] == most[i]));
        let (dimension, horizon) = (setup.scene.dimension, setup.scene.time.horizon);
        let cost = match one {
            true => Err("the runs use a single mesh or a single number of steps, so their costs cannot be separated".to_owned()),
            false => Cost::fit(&samples.collect::<Vec<_>>(), dimension, horizon).ok_or_else(|| "no parts fit the times".into()),
        };
        let in_time: Vec<Sample> = in_time.collect();
        let on_mesh = setup.body.data.is_interpolated();
        let error = ErrorModel::fit(&points.collect::<Vec<_>>(), &in_time, on_mesh);
        Self { change, error, cost, range: [least, most] }
    }

    /// The cheapest run whose predicted error is the target or less.
    fn cheapest(
        &self,
        setup: &Setup,
        target: f64,
        limit: &MemoryLimit,
    ) -> Result<Candidate, NoAnswer> {
        let missing = |what, reason: &String| {
            NoAnswer::Refused(format!("the {what} have no model: {reason}"))
        };
        let error = self.error.as_ref().map_err(|reason| missing("errors", reason))?;
        let cost = self.cost.as_ref().map_err(|reason| missing("times", reason))?;
        let changed = Setup::new(self.change.of(&setup.scene).map_err(SetupError::from)?)?;
        let choices = Choices::new(&changed, true)?;
        let law = Law {
            error: Box::new(|h, k| error.error(h, k)),
            seconds: Box::new(|h, k| cost.seconds(h, k)),
            range: [self.range[0], choices.most()],
            made: SPAN * self.range[1][0],
        };
        let choice = choices.cheapest(&law, target, limit)?;
        Ok(Candidate { change: self.change.clone(), choice })
    }

    fn json(&self) -> Value {
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

/// The cheapest run with a change that has the error which is wanted.
#[derive(Debug, Clone, Serialize)]
struct Candidate {
    change: Change,
    #[serde(flatten)]
    choice: Choice,
}

/// Another setting or element is the answer where it saves this part of the time at least.
const SAVES: f64 = 0.2;

/// What a change does to time and error in the largest run that was made with and without it.
fn price(change: &Change, trials: &[Trial]) -> Option<Value> {
    let both = |plain: &Trial| {
        let other = at(change, trials, plain.place())?;
        let speed = plain.seconds / other.seconds;
        let error = other.error / plain.error - 1.0;
        let [n, steps] = plain.place();
        let price =
            json!({ "what": change, "n": n, "steps": steps, "speed": speed, "error": error });
        speed.is_finite().then_some(price)
    };
    of(&Change::none(), trials).filter_map(both).last()
}

/// By what part of itself a predicted error may be off.
const OFF: f64 = 0.25;

/// What can be false in a trade. Nothing is claimed of seconds, which are those of a clock.
fn claims(trials: &[Trial], written: &Models, answer: Option<(&Trial, f64)>) -> Vec<Claim> {
    let place = |trial: &Trial| {
        let at = trial.change.words().to_owned();
        Place { n: Some(trial.n), steps: Some(trial.steps), level: None, at }
    };
    let note = |trial: &Trial, claim: Claim| Claim {
        note: trial.reason.clone().unwrap_or_default(),
        ..claim
    };
    let statement =
        Statement { source: "error", says: "20 floors of solver and rounding <= error" };
    let measured = trials.iter().map(|trial| {
        let sides = [FLOORS_ABOVE * trial.floor, trial.error];
        note(trial, Claim::at_most(statement, place(trial), sides, 0.0))
    });
    let statement = Statement { source: "error model", says: "|predicted/error - 1| <= 1/4" };
    let fitted = written.error.iter().flat_map(|model| {
        let off = move |of: &Trial| (model.error(of.h, of.k) / of.error - 1.0).abs();
        let runs = trials.iter().filter(|trial| trial.change == written.change);
        let runs = runs.filter(|trial| trial.converged());
        runs.map(move |trial| Claim::at_most(statement, place(trial), [off(trial), OFF], 0.0))
    });
    let statement = Statement { source: "target", says: "error of the answer <= target" };
    let held = answer.map(|(trial, target)| {
        note(trial, Claim::at_most(statement, place(trial), [trial.error, target], OFF * target))
    });
    measured.chain(fitted).chain(held).collect()
}

fn found(
    bench: &Bench<'_>,
    models: &[Models],
    candidates: &[Candidate],
    answer: Option<&Candidate>,
    confirmed: Option<Trial>,
) -> Findings {
    let (scene, written, norm) = (&bench.setup.scene, &models[0], bench.norm);
    let target = answer.map_or(f64::NAN, |answer| answer.choice.target);
    let claims = claims(&bench.trials, written, confirmed.as_ref().map(|real| (real, target)));
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
    let finest = of(&written.change, &bench.trials).filter(|trial| trial.converged());
    let finest =
        finest.map(|trial| [trial.h, trial.k]).reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]);
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
    let of_changes: Value = models.iter().map(Models::json).collect();
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
    let points: Vec<Datum> =
        bench.trials.iter().map(|trial| (trial.seconds, trial.error)).collect();
    let best = front(&points, TIE);
    let mut trials = bench.trials.clone();
    best.iter().for_each(|&i| trials[i].front = true);
    let trials = json!(trials);
    let keys = "scene,change,n,steps,h,k,dofs,norm,error,floor,cpu_seconds,load_share,history_bytes,newton_iterations,factorizations,front,status,reason";
    findings.tables.push((".csv", keys, trials.clone()));
    findings.table(
        "trials",
        trials,
        "Error, CPU seconds of one run on this machine, the part of the loads; front: no run here is both faster and better, errors within 1 % being one.",
        "setting = change; >n = n; >N = steps; >error = error; >CPU s = cpu_seconds 3; >in loads = load_share 2; front = front",
    );
    let prices = models[1..].iter().filter_map(|one| price(&one.change, &bench.trials));
    findings.table(
        "prices",
        prices.collect::<Vec<_>>(),
        "What a change does to the largest run that was made with and without it. Seconds are from single runs on this machine, so a factor below 1.25 is no difference.",
        "what is changed = what; >n = n; >N = steps; >times faster = speed 3; >error, its part = error 2",
    );
    let caption = "Error against CPU seconds, with the Pareto front (sweep trade).";
    findings.document.figure("trade", caption, picture(bench, models, &best, target));
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

/// Error against CPU time, a marker per run, with the Pareto front and the target; none without two runs.
fn picture(bench: &Bench<'_>, models: &[Models], best: &[usize], target: f64) -> Option<String> {
    let mut chart = Chart::new(
        &format!("{}: speed against accuracy", bench.setup.scene.name),
        "The error reached in a given CPU time (one thread of this machine: mesh, loads and march), in runs from few cells and steps to many.",
        Axis::new("CPU time in seconds", Scale::Log),
        Axis::new(format!("error {}", norm_label(bench.norm.name())), Scale::Log),
    );
    let datum = |trial: &Trial| -> Datum { (trial.seconds, trial.error) };
    for Models { change, .. } in models {
        let data: Vec<Datum> = of(change, &bench.trials).map(datum).collect();
        chart.series.push(Series::new(change.words(), vec![Part::Points(data)]));
    }
    let label = |&i: &usize| {
        let trial = &bench.trials[i];
        (datum(trial), format!("n = {}, N = {}", trial.n, trial.steps))
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
    use scene::Norm;

    fn row(change: &str, [n, steps]: [u32; 2], error: f64, seconds: f64) -> Trial {
        Trial {
            scene: "scene".into(),
            change: Change::new(change, Ok),
            n,
            steps,
            h: 1.0 / f64::from(n),
            k: 1.0 / f64::from(steps),
            dofs: 0,
            norm: Norm::VMax,
            error,
            floor: 0.0,
            seconds,
            load_share: 0.5,
            history_bytes: 0,
            newton_iterations: 0,
            factorizations: 0,
            front: false,
            status: "converged",
            reason: None,
            in_time: None,
        }
    }

    #[test]
    fn a_price_says_what_is_bought_and_paid() {
        let written = |place| row("as written", place, 0.5, 3.1);
        let other = row("strong loads", [64, 16], 0.25, 6.2);
        // The largest run has no price where it fails with the change.
        let trials = [
            written([32, 16]),
            written([64, 16]),
            written([64, 32]),
            other.clone(),
            row("strong loads", [64, 32], f64::NAN, f64::NAN),
        ];
        let found = price(&other.change, &trials).expect("a price");
        assert_eq!((&found["n"], &found["steps"]), (&64.into(), &16.into()));
        assert_eq!((&found["speed"], &found["error"]), (&0.5.into(), &(-0.5).into()));
        assert!(price(&Change::new("contact exact", Ok), &trials).is_none());
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
