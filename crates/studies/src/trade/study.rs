//! The trade of a scene: a grid of runs, each setting at three of them, and what they say. What is said is a function of the
//! runs alone.

use super::bench::{Bench, Trial};
use super::bench::{element_meshes, trade_grid};
use super::bench::{elements, settings};
use super::optimum::{NoAnswer, Wanted, coupling};
use super::runs::{Candidate, Models, Price, at, candidates, mark_front, of, places, prices};
use judge::claim::{Claim, Place, Statement};
use judge::fit::FLOORS_ABOVE;
use judge::record::norm_label;
use report::{Axis, Chapter, Chart, Datum, Findings, Mark, Part, Scale, Series, digits};
use run::sweep::{
    CasePlan, Cost, MemoryLimit, Overrides, Refused, ScenePlan, admit_constants, admit_plan,
};
use scene::setup::{Setup, SetupError, Subject, check_step_sizes};
use scene::{Change, Extension, Norm, Scene};
use serde_json::{Value, json};

/// What a trade is asked.
pub struct Trade<'a> {
    pub setup: &'a Setup,
    pub wanted: Wanted,
    /// Cells per unit length and numbers of steps, in place of the scene's.
    pub n: Option<Vec<u32>>,
    pub steps: Option<Vec<u32>>,
    /// Predicted CPU seconds of the grid; the settings take as much again.
    pub budget: f64,
    /// Whether the answer is run.
    pub confirm: bool,
    pub limit: MemoryLimit,
}

/// Why a trade has no result.
#[derive(Debug, thiserror::Error)]
pub enum TradeError {
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error(transparent)]
    Memory(#[from] Refused),
    #[error("every run failed; the first: {first}")]
    AllFailed {
        /// The message of the first run.
        first: String,
    },
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
/// [`TradeError`]; a run that fails is a claim that does.
pub fn trade(
    asked: &Trade<'_>,
    heard: &dyn Fn(&str),
) -> Result<(Findings, Option<NoAnswer>), TradeError> {
    let Trade { setup, wanted, limit, .. } = asked;
    let [n, steps] = trade_grid(setup, &asked.n, &asked.steps, asked.budget)?;
    let admitted = admit_trade(&setup.scene, &n, &steps, limit)?;
    check_step_sizes(&admitted.subject, &steps)?;
    let others = other_elements(setup, [&n, &steps], limit, heard)?;
    let mut bench = Bench::new(setup, wanted.norm)?;
    n.iter().for_each(|&n| bench.runs(&Change::none(), n, &steps, heard));
    if !bench.trials.iter().any(|trial| trial.record.converged()) {
        let first = bench.trials.first().and_then(Trial::failure).unwrap_or_default().into();
        return Err(TradeError::AllFailed { first });
    }
    for (element, meshes) in &others {
        meshes.iter().for_each(|&n| bench.runs(element, n, &steps, heard));
    }
    let elements = others.iter().map(|(element, _)| element.clone());
    let changes: Vec<Change> = settings(setup).into_iter().chain(elements.clone()).collect();
    let dimension = setup.scene.dimension;
    let places = places(&bench.trials, dimension, changes.len() as u32, asked.budget);
    for &[n, steps] in &places {
        for change in &changes {
            // Another element may have been run there on one of its meshes.
            if at(change, &bench.trials, [n, steps]).is_none() {
                bench.runs(change, n, &[steps], heard);
            }
        }
    }
    let on_mesh = setup.body.data.is_interpolated();
    let prices = prices(&bench.trials, &places, &changes, on_mesh);
    mark_front(&mut bench.trials, &prices);
    let models = |change| Models::of(change, &bench.trials, setup);
    let models: Vec<Models> = std::iter::once(Change::none()).chain(elements).map(models).collect();
    let target = wanted.error(bench.size);
    let candidates =
        target.map(|target| candidates(setup, &bench.trials, &models, &prices, target, limit));
    let (candidates, refused) = match candidates.transpose() {
        Ok(found) => (found.unwrap_or_default(), None),
        Err(none) => (Vec::new(), Some(none)),
    };
    let answer = candidates.iter().min_by(|a, b| a.choice.seconds.total_cmp(&b.choice.seconds));
    let confirmed = match answer.filter(|_| asked.confirm) {
        Some(Candidate { change, choice, .. }) => {
            let changed = change.of(&setup.scene).map_err(SetupError::from)?;
            admit_trade(&changed, &[choice.n], &[choice.steps], limit)?;
            bench.runs(change, choice.n, &[choice.steps], heard);
            bench.trials.pop()
        }
        None => None,
    };
    let answer = answer.map(|answer| (answer, confirmed));
    Ok((found(&bench, &models, &prices, &candidates, answer), refused))
}

/// Refuses runs of a scene that would take more memory than there may be: beside a run a bench holds the truth on its mesh
/// and the displacements of all runs there.
fn admit_trade(
    scene: &Scene,
    n: &[u32],
    steps: &[u32],
    limit: &MemoryLimit,
) -> Result<ScenePlan, TradeError> {
    admit_constants(scene, false, limit)?;
    let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
    let plan = ScenePlan::new(Subject::new(scene.clone())?, &overrides);
    let displacements =
        |(case, cost): &(&CasePlan, &Cost)| 8.0 * cost.dofs as f64 * (f64::from(case.steps) + 1.0);
    admit_plan(&plan, 1, limit, |cases| cases.iter().map(displacements).sum())?;
    Ok(plan)
}

/// The other elements with meshes of about as many nodes; what does not fit into memory is left out, and said.
fn other_elements(
    setup: &Setup,
    [n, steps]: [&[u32]; 2],
    limit: &MemoryLimit,
    heard: &dyn Fn(&str),
) -> Result<Vec<(Change, Vec<u32>)>, SetupError> {
    let mut found = Vec::new();
    for (element, change) in elements(setup) {
        let left_out = |why: &str| heard(&format!("{} left out: {why}", change.words()));
        if element.degree() > setup.body.element.degree() && setup.exact.is_none() {
            left_out("the reference run has a lower degree, so it cannot serve as the truth");
            continue;
        }
        let meshes = element_meshes(&setup.scene, n, element);
        // It is compared on the meshes of the scene as written, too.
        match admit_trade(&change.of(&setup.scene)?, &[&meshes[..], n].concat(), steps, limit) {
            Ok(_) => found.push((change, meshes)),
            Err(refused) => left_out(&refused.to_string()),
        }
    }
    Ok(found)
}

/// By what part of itself a predicted error may be off.
const OFF: f64 = 0.25;

/// What can be false in a trade. Nothing is claimed of seconds, which are those of a clock.
fn claims(trials: &[Trial], written: &Models, answer: Option<(&Trial, f64)>) -> Vec<Claim> {
    let place = |trial: &Trial| {
        let ([n, steps], at) = (trial.place(), trial.change.words().to_owned());
        Place { n: Some(n), steps: Some(steps), level: None, at }
    };
    let note = |trial: &Trial, claim: Claim| Claim {
        note: trial.failure().unwrap_or_default().into(),
        ..claim
    };
    let statement =
        Statement { source: "error", says: "20 floors of solver and rounding <= error" };
    let measured = trials.iter().map(|trial| {
        let sides = [FLOORS_ABOVE * trial.floor(), trial.error()];
        note(trial, Claim::at_most(statement, place(trial), sides, 0.0))
    });
    let statement = Statement { source: "error model", says: "|predicted/error - 1| <= 1/4" };
    let fitted = written.error.iter().flat_map(|model| {
        let off = move |trial: &Trial| {
            let [h, k] = trial.steps();
            (model.error(h, k) / trial.error() - 1.0).abs()
        };
        let runs = trials.iter().filter(|trial| trial.change == written.change);
        let runs = runs.filter(|trial| trial.record.converged());
        runs.map(move |trial| Claim::at_most(statement, place(trial), [off(trial), OFF], 0.0))
    });
    let statement = Statement { source: "target", says: "error of the answer <= target" };
    let held = answer.map(|(trial, target)| {
        note(trial, Claim::at_most(statement, place(trial), [trial.error(), target], OFF * target))
    });
    measured.chain(fitted).chain(held).collect()
}

fn found(
    bench: &Bench<'_>,
    models: &[Models],
    prices: &[Price],
    candidates: &[Candidate],
    answer: Option<(&Candidate, Option<Trial>)>,
) -> Findings {
    let (scene, written, norm) = (&bench.setup.scene, &models[0], bench.norm);
    let target = answer.as_ref().map_or(f64::NAN, |(answer, _)| answer.choice.target);
    let real = answer.as_ref().and_then(|(_, real)| real.as_ref());
    let claims = claims(&bench.trials, written, real.map(|real| (real, target)));
    let title = (Chapter::Trade, format!("Cost and error: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    let document = &mut findings.document;
    if let Some((answer, _)) = &answer {
        document.answer(answer_words(bench, answer, real));
    }
    document.words(format!(
        "Errors in {}; the largest strain norm of the truth is {}.",
        norm.name(),
        digits(bench.size, 5)
    ));
    let finest = of(&written.change, &bench.trials).filter(|trial| trial.record.converged());
    let finest = finest.map(Trial::steps).reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]);
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
    document.rows(
        "Cost: CPU seconds a run, a cell (h^-d), an operation of a factorization (h^-3(d-1)), once and a level.",
        &of_changes,
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
    let trials: Value = bench.trials.iter().map(Trial::json).collect();
    let keys = "scene,change,n,steps,h,k,dofs,norm,error,floor,cpu_seconds,load_share,predicted_bytes,history_bytes,newton_iterations,factorizations,tie,front,status,reason";
    findings.tables.push((".csv", keys, trials.clone()));
    findings.table(
        "trials",
        trials,
        "Error, CPU seconds of one run on this machine, the part of the loads, predicted memory; front: no run here is both faster and better, errors within 1 % being one; tie: the run as written within 1.25 times the time and 1 % of the error.",
        "setting = change; >n = n; >N = steps; >error = error; >CPU s = cpu_seconds 3; >in loads = load_share 2; \
         >bytes = predicted_bytes 3; front = front; tie = tie",
    );
    findings.table(
        "prices",
        prices,
        "One setting changed at a time, compared with the run as written. Seconds are from single runs on this machine, so a factor below 1.25 is no difference.",
        "what a setting changes = what; >n = n; >N = steps; >times faster = speed 3; >error, its part = error 2; \
         >memory, times = bytes 3",
    );
    let caption = "Error against CPU seconds, with the Pareto front (sweep trade).";
    let picture = picture(bench, models, answer.as_ref().map(|(answer, _)| *answer));
    findings.document.figure("trade", caption, picture);
    let elements: Vec<Value> = models[1..].iter().map(Models::json).collect();
    let chosen = answer.as_ref().map(|(answer, _)| answer);
    let [of_error, of_cost] = ["error_model", "cost_model"].map(|key| &of_changes[0][key]);
    findings.numbers(json!({
        "norm": norm, "size": bench.size, "error_model": of_error, "cost_model": of_cost,
        "coupling": path, "elements": elements, "answer": chosen,
    }));
    if let Some((Candidate { choice, .. }, Some(real))) = &answer {
        let (error, seconds) = (real.error(), real.seconds());
        let ratios =
            json!({ "error": choice.error / error, "cpu_seconds": choice.seconds / seconds });
        let confirmed = json!({ "error": error, "cpu_seconds": seconds, "ratios": ratios });
        findings.number("confirmed", confirmed);
    }
    findings
}

/// The answer in a sentence, and what its run showed.
fn answer_words(bench: &Bench<'_>, answer: &Candidate, real: Option<&Trial>) -> String {
    let Candidate { change, choice, extrapolates } = answer;
    let part = match bench.norm {
        Norm::VMax => format!(" ({:.3} % of the solution)", 100.0 * choice.target / bench.size),
        _ => String::new(),
    };
    let real = real.map_or(String::new(), |real| {
        format!("; real: error {:.4e}, {:.3} CPU s", real.error(), real.seconds())
    });
    let words = choice.words(&format!(", {}", change.words()), "", extrapolates.as_ref());
    format!("target {:.4e} in {}{part}: {words}{real}", choice.target, bench.norm.name())
}

/// Error against CPU time, a marker per run, with the Pareto front; none without two runs.
fn picture(bench: &Bench<'_>, models: &[Models], answer: Option<&Candidate>) -> Option<String> {
    let mut chart = Chart::new(
        &format!("{}: speed against accuracy", bench.setup.scene.name),
        "The error reached in a given CPU time (one thread of this machine: mesh, loads and march). Each line is one mesh, from few steps to many.",
        Axis::new("CPU time in seconds", Scale::Log),
        Axis::new(format!("error {}", norm_label(bench.norm.name())), Scale::Log),
    );
    let done = || bench.trials.iter().filter(|trial| trial.record.converged());
    let datum = |trial: &Trial| -> Datum { (trial.seconds(), trial.error()) };
    let written = Change::none();
    let mut ns: Vec<u32> = of(&written, &bench.trials).map(|trial| trial.place()[0]).collect();
    ns.dedup();
    for n in ns {
        let runs = done().filter(|trial| trial.change == written && trial.place()[0] == n);
        let data: Vec<Datum> = runs.map(datum).collect();
        let parts = vec![Part::Line(data.clone()), Part::Points(data)];
        chart.series.push(Series::new(format!("n = {n}"), parts));
    }
    for of_element in &models[1..] {
        let runs = done().filter(|trial| trial.change == of_element.change);
        let data: Vec<Datum> = runs.map(datum).collect();
        if data.is_empty() {
            continue;
        }
        chart.series.push(Series::new(of_element.change.words(), vec![Part::Points(data)]));
    }
    let named = |trial: &&Trial| models.iter().any(|of_change| of_change.change == trial.change);
    let settings: Vec<Datum> = done().filter(|trial| !named(trial)).map(datum).collect();
    if !settings.is_empty() {
        let hollow = Series::new("", vec![Part::Hollow(settings)]);
        chart.series.push(Series { grey: true, ..hollow });
        chart.keys.push((Part::Hollow(Vec::new()), "another setting".into()));
    }
    let mut best: Vec<&Trial> = done().filter(|trial| trial.front).collect();
    best.sort_by(|a, b| a.seconds().total_cmp(&b.seconds()));
    let label = |trial: &&Trial| {
        let [n, steps] = trial.place();
        let other =
            if trial.change == written { "" } else { &format!(", {}", trial.change.words()) };
        (datum(trial), format!("n = {n}, N = {steps}{other}"))
    };
    chart.labels = best.iter().map(label).collect();
    let front = Part::Dashed(chart.labels.iter().map(|(place, _)| *place).collect());
    chart.series.push(Series { grey: true, ..Series::new("Pareto front", vec![front]) });
    if let Some(Candidate { choice, .. }) = answer {
        let label = format!("target {}", digits(choice.target, 4));
        chart.horizontals.push(Mark { at: choice.target, label });
        let name = format!("recommended, predicted: n = {}, N = {}", choice.n, choice.steps);
        let place = vec![(choice.seconds, choice.error)];
        chart.series.push(Series::new(name, vec![Part::Points(place)]));
    }
    chart.svg()
}

#[cfg(test)]
mod tests {
    use super::super::runs::{failed, row};
    use super::*;

    /// Whether a trade of these runs, with the error h/2, holds what it claims.
    fn holds(trials: &[Trial], answer: Option<(&Trial, f64)>) -> bool {
        use crate::trade::models::{ErrorModel, Term};
        use judge::fit::{ErrorCombination, Interval};
        let interval = Interval::around(1.0, 0.0);
        let error = ErrorModel {
            model: ErrorCombination::Sum,
            space: Some(Term { constant: 0.5, order: 1.0, interval }),
            time: None,
            source: String::new(),
            residual: 0.0,
        };
        let (change, cost) = (Change::none(), Err(String::new()));
        let models = Models { change, error: Ok(error), cost, range: [[4, 2], [8, 2]] };
        Claim::all_hold(&claims(trials, &models, answer))
    }

    #[test]
    fn a_failed_run_a_wrong_model_and_a_missed_target_are_said() {
        let of = |change: &str, n: u32, part: f64| row(change, [n, 2], part / f64::from(n), 1.0);
        let sound = [of("as written", 4, 0.5), of("as written", 8, 0.52), of("contact", 8, 5.0)];
        let answer = of("as written", 16, 0.5);
        assert!(holds(&sound, None) && holds(&sound, Some((&answer, 0.03))));
        assert!(
            !holds(&sound, Some((&answer, 0.02))) && !holds(&sound, Some((&failed(&answer), 0.1)))
        );
        for wrong in [of("as written", 8, 0.8), of("as written", 8, 0.3), failed(&sound[1])] {
            assert!(!holds(&[sound[0].clone(), wrong], None));
        }
        assert!(!holds(&[sound[0].clone(), failed(&sound[2])], None));
        // An error that is rounding is none.
        let mut rounding = sound[0].clone();
        rounding.record.errors[0].floor = Some(0.01);
        assert!(!holds(&[rounding], None) && !holds(&[], None));
    }
}
