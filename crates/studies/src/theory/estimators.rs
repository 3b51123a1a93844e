//! Reliability and efficiency of two estimators on runs whose error is known: the estimate of `solve --estimate`, from
//! coarser companions, and the guaranteed bound.
//!
//! Reliable: the bound is at least the error, up to the error in time, which it does not bound; the interval of the estimate
//! holds the error. Its ends are the constants between which the quotient stays: for aligned or orthogonal differences of
//! an order that is off by at most 1/2. Efficient: the quotient of bound (estimate) and error does not grow under refinement,
//! its order in the step is at least 0. That of error over estimate is likewise, so that the estimate does not fall behind.

use crate::study::{Asked, StudyError};
use crate::trade::SPAN;
use crate::trade::estimate::{companion_runs, companions, norm_estimate};
use algebra::linalg::larger;
use fem::contact::{Discretization, LoadError, StepView};
use fem::norms::step_errors;
use guarantee::BoundedLevel;
use judge::Order;
use judge::claim::{Claim, Place, Relation, Statement};
use judge::fit::{Decision, Interval};
use report::{Axis, Chapter, Chart, Findings, Part, Scale, Series};
use run::sweep::admit_constants;
use scene::setup::{MeshData, Setup};
use scene::{Direction, Norm, Prediction, Scene};
use serde::Serialize;

/// Largest n taken from a scene's list, and most steps.
const FINEST: u32 = 64;
const MOST_STEPS: u32 = 256;
/// Runs of a ladder: an order needs three.
const RUNS: usize = 3;
/// Rounding of a norm of strains, relative to it.
const ROUNDING: f64 = 1e-12;
/// An error below this many errors in time, or roundings, is not one in space.
const IN_SPACE: f64 = 10.0;

/// `sweep estimators`.
///
/// # Errors
/// [`StudyError`].
pub fn of_scene(scene: Scene, asked: &Asked) -> Result<Findings, StudyError> {
    admit_constants(&scene, true, &asked.limit)?;
    let setup = Setup::new(scene)?;
    let ladder = Ladder::new(&setup, asked)?;
    for [n, steps] in &ladder.runs {
        companion_runs(&setup, *n, *steps).admit(&asked.limit)?;
    }
    estimators(&setup, &ladder, &Estimators::default())
}

/// The runs that are compared, one step being refined.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder {
    pub along: Direction,
    /// n and N of each.
    pub runs: Vec<[u32; 2]>,
}

impl Ladder {
    /// Of a scene with an exact solution, on the meshes and steps that are asked for or those of its list.
    ///
    /// # Errors
    /// No exact solution, or too few runs with companions.
    pub fn new(setup: &Setup, asked: &Asked) -> Result<Self, StudyError> {
        let scene = &setup.scene;
        let message = || format!("`{}` has no exact solution to compare with", scene.name);
        scene.refuse_if(
            setup.exact.is_none(),
            "exact",
            message(),
            "choose a scene with [exact]",
        )?;
        let (mut ns, mut steps) = asked.grid(scene, FINEST)?;
        let of_v_in_h = |p: &Prediction| p.norm == Norm::VMax && p.variable == Direction::H;
        let in_h = scene.predicts.iter().any(of_v_in_h);
        let along = if in_h { Direction::H } else { Direction::K };
        let alone = setup.model.memory.is_empty() && setup.kappa.lipschitz == 0.0;
        // In k any mesh with companions will do.
        let coarsest = ns.first().map(|n| n.next_multiple_of(SPAN));
        ns.retain(|n| n.is_multiple_of(SPAN) || setup.body.data.is_interpolated());
        if ns.is_empty() && along == Direction::K && asked.n.is_none() {
            ns.extend(coarsest);
        }
        steps.retain(|&n| {
            alone || n.is_multiple_of(SPAN) && (asked.steps.is_some() || n <= MOST_STEPS)
        });
        for list in [&mut ns, &mut steps] {
            list.sort_unstable();
            list.dedup();
        }
        // In h with the most steps, in k on the coarsest mesh.
        match along {
            Direction::H => steps = steps.split_off(steps.len().saturating_sub(1)),
            _ => ns.truncate(1),
        }
        let runs = ns.iter().flat_map(|&n| steps.iter().map(move |&steps| [n, steps]));
        let runs: Vec<[u32; 2]> = runs.collect();
        if runs.len() < RUNS {
            return Err(StudyError::other(format!(
                "`{}` has {} runs with companions for a ladder in {}, and an order needs {RUNS}: give --n and --steps, multiples of {SPAN}",
                scene.name,
                runs.len(),
                along.name()
            )));
        }
        Ok(Self { along, runs })
    }
}

/// The estimators under test: what is read from a bounded level, and from an estimate.
pub struct Estimators<'a> {
    /// The bound of a level, with h.
    pub bound: &'a dyn Fn(&BoundedLevel, f64) -> f64,
    /// An estimated error, with the step.
    pub estimate: &'a dyn Fn(f64, f64) -> f64,
}

impl Default for Estimators<'_> {
    fn default() -> Self {
        Self { bound: &|level, _| level.bound, estimate: &|value, _| value }
    }
}

/// One run with what the estimators say of it; files have its numbers.
#[derive(Default, Serialize)]
struct Run {
    n: u32,
    steps: u32,
    step: f64,
    /// ‖ε(u - u^{kh})‖, largest over the levels, and ‖ε(u^{kh})‖.
    error: f64,
    #[serde(skip)]
    size: f64,
    estimate: Option<f64>,
    estimate_over_error: Option<f64>,
    no_estimate: Option<String>,
    energy_error: Option<f64>,
    bound: Option<f64>,
    /// None where the error is one in time, or rounding.
    bound_over_error: Option<f64>,
    no_bound: Option<String>,
    #[serde(skip)]
    claims: Vec<Claim>,
}

/// Compares both estimators with the errors of all runs of a ladder.
///
/// # Errors
/// A run, or the truth.
pub fn estimators(
    setup: &Setup,
    ladder: &Ladder,
    under_test: &Estimators<'_>,
) -> Result<Findings, StudyError> {
    let runs = ladder.runs.iter().map(|&run| compare(setup, ladder.along, run, under_test));
    let runs = runs.collect::<Result<Vec<_>, StudyError>>()?;
    let (scene, along) = (&setup.scene, ladder.along.name());
    let quotients = |of: fn(&Run) -> Option<f64>| -> Vec<(f64, f64)> {
        runs.iter().filter_map(|run| Some((run.step, of(run)?))).collect()
    };
    let estimates = quotients(|run| {
        run.estimate_over_error.filter(|_| run.error > IN_SPACE * ROUNDING * run.size)
    });
    let inverse: Vec<_> = estimates.iter().map(|(step, value)| (*step, 1.0 / value)).collect();
    let in_h = ladder.along == Direction::H;
    let bounds = if in_h { quotients(|run| run.bound_over_error) } else { Vec::new() };
    let mut claims: Vec<Claim> = runs.iter().flat_map(|run| run.claims.clone()).collect();
    for (source, says, quotients) in [
        ("estimate, efficient", "estimate/error does not grow", &estimates),
        ("estimate, reliable", "error/estimate does not grow", &inverse),
        ("bound, efficient", "bound/error does not grow", &bounds),
    ] {
        if quotients.is_empty() {
            continue;
        }
        // They do not grow as the step falls.
        let verdict = Order::of(quotients).exact_solution().predicted(0.0).at_least().judge();
        let (left, decision, note) = match verdict {
            Ok(verdict) => {
                let Interval { lo, hi } = verdict.posterior.interval;
                let note = format!("in [{lo:.3}, {hi:.3}], {}", verdict.ruling.reason);
                (verdict.posterior.order, verdict.ruling.decision, note)
            }
            Err(error) => (f64::NAN, Decision::Unresolved, format!("no trend: {error}")),
        };
        let at = format!("{} runs in {along}", quotients.len());
        let (statement, place) = (Statement { source, says }, Place { at, ..Place::default() });
        let relation = Relation::Order(0.0, decision);
        claims.push(Claim { statement, place, left, relation, accuracy: 0.0, note });
    }
    if claims.is_empty() {
        let why = runs.first().and_then(|run| run.no_estimate.as_deref()).unwrap_or_default();
        return Err(StudyError::other(format!(
            "neither estimator says anything of `{}`: {why}",
            scene.name
        )));
    }
    let title = (Chapter::Estimators, format!("Estimators: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    findings.number("along", along);
    let curves = [("estimate", estimates), ("bound", bounds)].into_iter();
    let series = curves.filter(|(_, points)| !points.is_empty());
    let series: Vec<Series> =
        series.map(|(name, points)| Series::new(name, vec![Part::Line(points)])).collect();
    if !series.is_empty() {
        let x = Axis::new(along, Scale::Log);
        let y = Axis::new("over the error", Scale::Log);
        let question = "Estimate and guaranteed bound over the true error; 1 is the error itself.";
        let chart = Chart::new(&format!("{}: estimators", scene.name), question, x, y);
        let shows = "estimate and bound over the error (sweep estimators).";
        findings.document.figure("estimators", shows, Chart { series, ..chart }.svg());
    }
    findings.table(
        "runs",
        runs,
        "Errors of the runs, in V and in the energy norm, and what was said of them.",
        "n = n; >N = steps; >error = error 4; >estimate = estimate 4; >estimate/error = estimate_over_error 4; \
         >energy error = energy_error 4; >bound = bound 4; >bound/error = bound_over_error 4; \
         no estimate = no_estimate; no bound = no_bound",
    );
    Ok(findings)
}

impl Run {
    fn place(&self) -> Place {
        Place { n: Some(self.n), steps: Some(self.steps), ..Place::default() }
    }
}

/// Runs a case with its companions, measures its error, and compares it with what the estimators say.
fn compare(
    setup: &Setup,
    along: Direction,
    [n, steps]: [u32; 2],
    under_test: &Estimators<'_>,
) -> Result<Run, StudyError> {
    let data = MeshData::new(setup, n, None)?;
    let mut error: Result<f64, LoadError> = Ok(0.0);
    let mut watch = |space: &Discretization, view: &StepView<'_>| {
        if let Ok(largest) = &error {
            let largest = *largest;
            error = data
                .truth
                .moments(view.t)
                .map(|truth| step_errors(space, &setup.model, view, &truth).v.max(largest));
        }
    };
    let found = companions(setup, n, steps, &mut watch)?;
    let mut run = Run {
        n,
        steps,
        step: match along {
            Direction::K => setup.grid(steps).largest_step(),
            _ => 1.0 / f64::from(n),
        },
        error: error?,
        size: found.size,
        ..Run::default()
    };
    let differences = found.norms.iter().find(|differences| differences.norm == Norm::VMax);
    let estimate = differences.map(|differences| norm_estimate(setup, &found, differences));
    let estimate = estimate.ok_or_else(|| StudyError::other("no norm"))?;
    match estimate.total() {
        Some((raw, interval)) => {
            let value = (under_test.estimate)(raw, run.step);
            let ends = [interval.lo, interval.hi].map(|end| value / raw * end);
            let says = "the interval holds the error";
            run.claims.push(Claim {
                statement: Statement { source: "estimate, interval", says },
                place: run.place(),
                left: run.error,
                relation: Relation::Within(ends),
                accuracy: ROUNDING * run.size,
                note: String::new(),
            });
            (run.estimate, run.estimate_over_error) = (Some(value), Some(value / run.error));
        }
        None => run.no_estimate = Some(estimate.reasons().join("; ")),
    }
    // Without an estimate in time there is no telling what it adds.
    let in_time = estimate.time.ok().and_then(|time| time.at(1.0));
    let in_time = in_time.map_or(f64::INFINITY, |(_, interval)| interval.hi);
    let largest = setup.model.elasticity.eigenvalues(setup.scene.dimension).1;
    match found.bound {
        _ if setup.body.data.is_interpolated() => {
            let why = "the data depend on the mesh, so the error has no part in h";
            run.no_bound = Some(why.into());
        }
        Ok(found) => {
            // The error in time adds to the error in the energy norm.
            let in_time = largest.sqrt() * in_time;
            let read = |level: &BoundedLevel| (under_test.bound)(level, run.step);
            let error = |level: &BoundedLevel| level.error.unwrap_or(f64::NAN);
            let says = "error <= bound + error in time";
            let claim = |level: &BoundedLevel| {
                let statement = Statement { source: "bound, reliable", says };
                let place = Place { level: Some(level.n), ..run.place() };
                let sides = [error(level), read(level) + in_time];
                Claim::at_most(statement, place, sides, ROUNDING * level.size)
            };
            let claims: Vec<Claim> = found.levels.iter().map(claim).collect();
            let most =
                |of: &dyn Fn(&BoundedLevel) -> f64| found.levels.iter().map(of).fold(0.0, larger);
            let (bound, error) = (most(&read), most(&error));
            let of_space = error > IN_SPACE * (in_time + ROUNDING * most(&|level| level.size));
            let worst = Claim::worst(&claims).first().map(|(worst, _)| (*worst).clone());
            run.claims.push(worst.unwrap_or_default());
            (run.bound, run.energy_error) = (Some(bound), Some(error));
            run.bound_over_error = of_space.then(|| bound / error);
        }
        Err(why) => run.no_bound = Some(why),
    }
    Ok(run)
}
