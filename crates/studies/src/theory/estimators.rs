//! Reliability and efficiency of two estimators on runs whose error is known: the estimate of `solve --estimate`, from
//! coarser companions, and the guaranteed bound.
//!
//! Reliable: the bound is at least the error, up to the error in time, which it does not bound; the interval of the estimate
//! holds the error. Its ends are the constants between which the quotient stays: for aligned or orthogonal differences of
//! an order that is off by at most 1/2. Efficient: the quotient of bound (estimate) and error does not grow under refinement,
//! its order in the step is at least 0. That of error over estimate is likewise, so that the estimate does not fall behind.

use crate::guarantee::{BoundedLevel, Guarantee};
use crate::study::{Asked, StudyError};
use crate::trade::estimate::{companion_runs, companions, norm_estimate};
use fem::contact::{Discretization, LoadError, StepView};
use fem::norms::step_errors;
use judge::Order;
use judge::claim::{Claim, Place, Relation, Statement};
use judge::fit::{Decision, Interval};
use report::{Axis, Chapter, Chart, Findings, Part, Scale, Series};
use run::sweep::admit_constants;
use scene::setup::{MeshData, Setup};
use scene::{Direction, Norm, Prediction, Scene};
use serde_json::{Value, json};

/// Largest n taken from a scene's list, and most steps.
const FINEST: u32 = 64;
const MOST_STEPS: u32 = 256;
/// Runs of a ladder: an order needs three.
const RUNS: usize = 3;
/// The companions of a run have a fourth of its n and N.
const SPAN: u32 = 4;
/// Rounding of a norm of strains, relative to it.
const ROUNDING: f64 = 1e-12;
/// An error below this many errors in time, or roundings, is not one in space.
const IN_SPACE: f64 = 10.0;

const BOUND: Statement =
    Statement { source: "bound, reliable", says: "error <= bound + error in time" };
const BOUND_TREND: Statement =
    Statement { source: "bound, efficient", says: "bound/error does not grow" };
const ESTIMATE: Statement =
    Statement { source: "estimate, interval", says: "the interval holds the error" };
const ESTIMATE_TREND: Statement =
    Statement { source: "estimate, efficient", says: "estimate/error does not grow" };
const ERROR_TREND: Statement =
    Statement { source: "estimate, reliable", says: "error/estimate does not grow" };

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
        let runs: Vec<[u32; 2]> = match along {
            Direction::H => {
                steps.last().map_or_else(Vec::new, |&last| ns.iter().map(|&n| [n, last]).collect())
            }
            _ => {
                ns.first().map_or_else(Vec::new, |&n| steps.iter().map(|&last| [n, last]).collect())
            }
        };
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

/// One run with what the estimators say of it.
struct Run {
    place: Place,
    step: f64,
    /// ‖ε(u - u^{kh})‖, largest over the levels, and ‖ε(u^{kh})‖.
    error: f64,
    size: f64,
    estimate: Result<(f64, Interval), String>,
    /// The bounds, and what the error in time adds to the error in the energy norm.
    bound: Result<(Guarantee, f64), String>,
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
    let runs = ladder.runs.iter().map(|&run| compare(setup, ladder.along, run));
    let runs = runs.collect::<Result<Vec<_>, StudyError>>()?;
    let (mut claims, mut rows) = (Vec::new(), Vec::new());
    let (mut bounds, mut estimates) = (Vec::new(), Vec::new());
    for run in &runs {
        let mut row = json!({
            "n": run.place.n, "steps": run.place.steps, "step": run.step, "error": run.error,
            "estimate": null, "estimate_over_error": null, "no_estimate": null,
            "energy_error": null, "bound": null, "bound_over_error": null, "no_bound": null,
        });
        match &run.estimate {
            Ok((value, interval)) => {
                let value = (under_test.estimate)(*value, run.step);
                let scale = value / run.estimate.as_ref().map_or(1.0, |(value, _)| *value);
                let [low, high] = [interval.lo, interval.hi].map(|end| scale * end);
                claims.push(Claim {
                    statement: ESTIMATE,
                    place: run.place.clone(),
                    left: run.error,
                    relation: Relation::Within([low, high]),
                    accuracy: ROUNDING * run.size,
                    note: String::new(),
                });
                if run.error > IN_SPACE * ROUNDING * run.size {
                    estimates.push((run.step, value / run.error));
                }
                row["estimate"] = value.into();
                row["estimate_over_error"] = (value / run.error).into();
            }
            Err(why) => row["no_estimate"] = why.clone().into(),
        }
        match &run.bound {
            Ok((found, in_time)) => {
                let seen = bounded(run, found, *in_time, under_test.bound);
                row["bound"] = seen.bound.into();
                row["energy_error"] = seen.error.into();
                row["bound_over_error"] = seen.quotient.into();
                if let (Some(quotient), Direction::H) = (seen.quotient, ladder.along) {
                    bounds.push((run.step, quotient));
                }
                claims.push(seen.claim);
            }
            Err(why) => row["no_bound"] = why.clone().into(),
        }
        rows.push(row);
    }
    let inverse: Vec<(f64, f64)> =
        estimates.iter().map(|(step, value)| (*step, 1.0 / value)).collect();
    let name = ladder.along.name();
    let ladders = [(ESTIMATE_TREND, &estimates), (ERROR_TREND, &inverse), (BOUND_TREND, &bounds)];
    claims.extend(
        ladders
            .into_iter()
            .filter(|(_, ladder)| !ladder.is_empty())
            .map(|(statement, quotients)| does_not_grow(statement, name, quotients)),
    );
    if claims.is_empty() {
        let why = runs.first().and_then(|run| run.estimate.as_ref().err().cloned());
        return Err(StudyError::other(format!(
            "neither estimator says anything of `{}`: {}",
            setup.scene.name,
            why.unwrap_or_default()
        )));
    }
    Ok(found(setup, name, claims, rows, [("estimate", estimates), ("bound", bounds)]))
}

fn found(
    setup: &Setup,
    along: &str,
    claims: Vec<Claim>,
    rows: Vec<Value>,
    curves: [(&str, Vec<(f64, f64)>); 2],
) -> Findings {
    let scene = &setup.scene;
    let title = (Chapter::Estimators, format!("Estimators: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    findings.number("along", along);
    let series = curves.into_iter().filter(|(_, points)| !points.is_empty());
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
        rows,
        "Errors of the runs, in V and in the energy norm, and what was said of them.",
        "n = n; >N = steps; >error = error 4; >estimate = estimate 4; >estimate/error = estimate_over_error 4; \
         >energy error = energy_error 4; >bound = bound 4; >bound/error = bound_over_error 4; \
         no estimate = no_estimate; no bound = no_bound",
    );
    findings
}

/// What the bound of a run says.
struct Seen {
    claim: Claim,
    bound: f64,
    error: f64,
    /// None where the error is one in time, or rounding.
    quotient: Option<f64>,
}

fn bounded(
    run: &Run,
    found: &Guarantee,
    in_time: f64,
    read: &dyn Fn(&BoundedLevel, f64) -> f64,
) -> Seen {
    let h = run.step;
    let claim = |level: &BoundedLevel| {
        let place = Place { level: Some(level.n), ..run.place.clone() };
        let error = level.error.unwrap_or(f64::NAN);
        Claim::at_most(BOUND, place, [error, read(level, h) + in_time], ROUNDING * level.size)
    };
    let claims: Vec<Claim> = found.levels.iter().map(claim).collect();
    let worst = Claim::worst(&claims).first().map(|(worst, _)| (*worst).clone());
    let largest = |of: &dyn Fn(&BoundedLevel) -> f64| {
        found.levels.iter().map(of).fold(0.0, |largest, value| match value.is_nan() {
            true => value,
            false => f64::max(largest, value),
        })
    };
    let bound = largest(&|level| read(level, h));
    let error = largest(&|level| level.error.unwrap_or(f64::NAN));
    let of_space = error > IN_SPACE * (in_time + ROUNDING * largest(&|level| level.size));
    Seen {
        claim: worst.unwrap_or_default(),
        bound,
        error,
        quotient: of_space.then(|| bound / error),
    }
}

/// The claim that quotients do not grow as the step falls.
fn does_not_grow(statement: Statement, along: &str, quotients: &[(f64, f64)]) -> Claim {
    let verdict = Order::of(quotients).exact_solution().predicted(0.0).at_least().judge();
    let (left, decision, note) = match verdict {
        Ok(verdict) => {
            let Interval { lo, hi } = verdict.posterior.interval;
            let note = format!("in [{lo:.3}, {hi:.3}], {}", verdict.ruling.reason);
            (verdict.posterior.order, verdict.ruling.decision, note)
        }
        Err(error) => (f64::NAN, Decision::Unresolved, format!("no trend: {error}")),
    };
    let place = Place { at: format!("{} runs in {along}", quotients.len()), ..Place::default() };
    Claim { statement, place, left, relation: Relation::Order(0.0, decision), accuracy: 0.0, note }
}

/// Runs a case with its companions, and measures its error.
fn compare(setup: &Setup, along: Direction, [n, steps]: [u32; 2]) -> Result<Run, StudyError> {
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
    let found = companions(setup, n, steps, &mut watch).map_err(StudyError::other)?;
    let error = error.map_err(StudyError::other)?;
    let differences = found.norms.iter().find(|differences| differences.norm == Norm::VMax);
    let estimate = differences.map(|differences| norm_estimate(setup, &found, differences));
    let in_time = estimate.as_ref().and_then(|estimate| estimate.time.as_ref().ok()?.at(1.0));
    let total = |estimate: &crate::trade::estimate::Estimate| {
        estimate.total().ok_or_else(|| estimate.reasons().join("; "))
    };
    let largest = setup.model.elasticity.eigenvalues(setup.scene.dimension).1;
    let bound = match setup.body.data.is_interpolated() {
        true => Err("the data depend on the mesh, so the error has no part in h".to_owned()),
        false => found.bound.map(|found| {
            // Without an estimate in time there is no telling what it adds.
            let in_time = in_time.map_or(f64::INFINITY, |(_, interval)| interval.hi);
            (found, largest.sqrt() * in_time)
        }),
    };
    let step = match along {
        Direction::K => setup.grid(steps).largest_step(),
        _ => 1.0 / f64::from(n),
    };
    Ok(Run {
        place: Place { n: Some(n), steps: Some(steps), ..Place::default() },
        step,
        error,
        size: found.size,
        estimate: estimate.as_ref().map_or_else(|| Err("no norm".into()), total),
        bound,
    })
}
