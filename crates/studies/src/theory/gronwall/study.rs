//! The study of a scene: errors on grids and over horizons, and differences under perturbed loads, each under its bounds.
//!
//! Two discrete solutions with loads f and f + δf satisfy
//!
//! ```text
//! m0 ‖u_n - ũ_n‖ ≤ ‖δf_n‖_* + Σ_p ω_p Σ'_j w_nj κ_p(n, j) ‖u_j - ũ_j‖
//! ```
//!
//! by the argument of (3.19)-(3.21) with both inequalities discrete: the same constants, no
//! truncation, and e_0 > 0 allowed. ‖·‖_* is dual to ‖·‖_X; for a body ‖v‖_V = ‖ε(v)‖_ℋ.

use super::recurrence::{Bounds, Envelopes, Estimate};
use super::recurrence::{GronwallError, InTime, refused};
use super::scenes::FiniteInTime;
use super::scenes::{ContactInTime, REFERENCE_STEPS};
use algebra::linalg::{largest, signed_unit};
use fem::contact::Discretization;
use judge::claim::{Claim, Place, Statement};
use report::{Axis, Chapter, Chart, Datum, Findings, Part, Run, Scale, Series, digits, precise};
use run::sweep::{Runs, lowest_common_multiple};
use scene::setup::{Setup, Subject};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// What is asked of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyRuns {
    /// Mesh cells per unit length; none for abstract scenes.
    pub n: Option<u32>,
    /// Numbers N of steps.
    pub steps: Vec<u32>,
    /// Horizons T, at the step of the largest N; none if empty.
    pub horizons: Vec<f64>,
}

/// A run with its bounds.
pub(super) struct Bounded {
    /// Its name in the table of levels.
    part: String,
    pub estimate: Estimate,
    pub envelopes: Envelopes,
}

impl Bounded {
    pub(super) fn new(part: String, estimate: Estimate) -> Result<Self, GronwallError> {
        let steps = estimate.grid.steps() as u32;
        let envelopes =
            estimate.envelopes().map_err(|source| GronwallError::Step { steps, source })?;
        Ok(Self { part, estimate, envelopes })
    }

    /// Every link of the chain, on a mesh with so many cells.
    pub(super) fn claims(&self, n: Option<u32>) -> Vec<Claim> {
        let steps = Some(self.estimate.grid.steps() as u32);
        let at = if self.part == "time" { String::new() } else { self.part.clone() };
        self.envelopes.claims(&self.estimate, &Place { n, steps, level: None, at })
    }

    /// The bound over e_n at every n ≥ 1, none where e_n is not above 20 floors: at T, and the least.
    fn over_error(&self, bound: &[f64]) -> [Option<f64>; 2] {
        let Estimate { error, floor, .. } = &self.estimate;
        let ratio = |n: usize| (error[n] > 20.0 * floor).then(|| bound[n] / error[n]);
        let last = bound.len().saturating_sub(1);
        [ratio(last), (1..=last).filter_map(ratio).reduce(f64::min)]
    }

    /// Its rows in the table of levels.
    fn levels(&self) -> Vec<Value> {
        let (e, bounds, grid) = (&self.estimate, &self.envelopes, &self.estimate.grid);
        let at = |values: &Option<Vec<f64>>, n: usize| values.as_ref().map(|values| values[n]);
        let level = |n: usize| {
            let [g_zeta, g_memory] = e.truncation.each_ref().map(|part| part.get(n));
            let [weighted, primed] = [bounds.weighted[n], bounds.primed[n]];
            json!({
                "part": self.part, "steps": grid.steps(), "k": grid.largest_step(), "n": n,
                "t": grid.time(n), "error": e.error[n], "g_zeta": g_zeta, "g_memory": g_memory,
                "source": e.source[n], "weighted": weighted, "primed": primed,
                "closed": bounds.closed[n], "limit": bounds.limit[n],
                "printed": at(&bounds.printed, n), "printed_closed": at(&bounds.printed_closed, n),
            })
        };
        (0..=grid.steps()).map(level).collect()
    }
}

/// Runs everything.
///
/// # Errors
/// [`GronwallError`].
pub fn study(subject: &Subject, plan: &StudyRuns) -> Result<Findings, GronwallError> {
    let (scene, n) = (subject.scene(), plan.n);
    let in_time = prepare(subject, n, &plan.steps)?;
    let measured = |&steps: &u32| Bounded::new("time".into(), in_time.measure(steps)?);
    let grids = plan.steps.iter().map(measured).collect::<Result<Vec<_>, _>>()?;
    let finest = plan.steps.iter().copied().max().unwrap_or(1);
    let perturbed = perturbations(&*in_time, finest)?;
    let k = scene.time.horizon / f64::from(finest);
    let horizons = match plan.horizons.is_empty() {
        true => None,
        false => Some(horizons(subject, n, k, &plan.horizons)?),
    };

    let over = horizons.iter().flat_map(|(_, rows)| rows);
    let mut claims: Vec<Claim> = grids.iter().chain(over).flat_map(|run| run.claims(n)).collect();
    claims.extend(perturbed.iter().map(|(_, run)| stability(run, n)));
    let title = (Chapter::Gronwall, format!("Envelopes: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    let longest = horizons.iter().filter_map(|(_, rows)| rows.last());
    let all = grids.iter().chain(longest).chain(perturbed.iter().map(|(_, run)| run));
    let keys = "part,steps,k,n,t,error,g_zeta,g_memory,source,weighted,primed,closed,limit,printed,printed_closed";
    findings.tables.push((".csv", keys, all.flat_map(Bounded::levels).collect()));
    findings.number("n", n);
    findings.number("truth", in_time.truth());
    let mesh = n.map_or_else(String::new, |n| format!(", n = {n}"));
    if let Some(run) = grids.iter().max_by_key(|run| run.estimate.grid.steps()) {
        findings.document.answer(answer(run));
        let shows = "measured error and the envelopes of (3.24) over t (sweep gronwall).";
        findings.document.figure("gronwall-envelope", shows, over_time(&scene.name, &mesh, run));
    }
    findings.document.words(format!("The truth is{mesh}: {}.", in_time.truth()));
    findings.table(
        "grids",
        grids.iter().map(grid_row).collect::<Vec<_>>(),
        "Bound over error at t = T for N steps; e and g at T; the bounds as printed need C₂k < 1.",
        ">N = steps; >C₂k = C2_k 6; >e_N = error_end; >g_N = truncation_end; >weighted = effectivity/weighted/at_end 7; \
         >primed = effectivity/primed/at_end 7; >closed = effectivity/closed/at_end 7; >k → 0 = effectivity/limit/at_end 7; \
         >printed = effectivity/printed/at_end 7; >(3.24) = effectivity/printed_closed/at_end 7",
    );
    findings.table(
        "perturbations",
        perturbed.iter().map(perturbed_row).collect::<Vec<_>>(),
        "Two loads f and f + δf at the largest N, δf at random and of this size; growth is m0 max‖u − v‖/max‖δf‖, then the least bound over difference.",
        ">size = size; >max ‖δf‖ = load; >max ‖u − v‖ = difference; >growth = growth; >least = least_effectivity",
    );
    let constants = in_time.constants();
    findings.number("constants", constants.iter().copied().collect::<BTreeMap<_, _>>());
    findings.document.table(
        "Constants of the inequality.",
        constants.iter().map(|(name, value)| {
            [("constant", Run::formula(written(name))), (">value", precise(*value, 7))]
        }),
    );
    let horizons = horizons.map(|(truth, runs)| (truth, Value::from(horizon_rows(&runs))));
    if let Some((truth, rows)) = &horizons {
        findings.document.rows(
            format!(
                "Long times at k = {}; maxima over [0, T]; the truth is: {truth}. Growth is d(log error)/dT, to compare with C₂.",
                digits(k, 5)
            ),
            rows,
            ">T = horizon; >error = error; >weighted = weighted; >primed = primed; >closed = closed; >(3.24) = printed_closed; \
             >growth = growth; >C₂ = c2",
        );
        let shows = "error and bounds over the horizon (sweep gronwall --horizons).";
        findings.document.figure("gronwall-horizon", shows, over_horizon(&scene.name, k, rows));
    }
    let horizons = horizons.map(|(truth, rows)| json!({ "k": k, "truth": truth, "rows": rows }));
    findings.number("horizons", horizons);
    Ok(findings)
}

/// How far each bound is above the error at the end of the finest run.
fn answer(finest: &Bounded) -> String {
    let times = |bound: &[f64]| digits(finest.over_error(bound)[0].unwrap_or(f64::NAN), 3);
    let Bounds { weighted, primed, closed, .. } = &finest.envelopes;
    let halved = finest.estimate.weights.are_the_papers();
    format!(
        "At t = T and N = {} the weighted envelope is {} times the measured error, the envelope with {} {} times, its closed form {} times.",
        finest.estimate.grid.steps(),
        times(weighted),
        if halved { "halved ends" } else { "one β_φ for all" },
        times(primed),
        times(closed)
    )
}

/// A constant as a reader writes it, by its key in files.
fn written(key: &'static str) -> &'static str {
    let symbols = [
        ("lipschitz", "Lipschitz constant of S"),
        ("yielding", "μ L_κ √|Ω|"),
        ("memory_norm", "‖ℬ‖"),
        ("c_j_squared_bound", "c_j², upper bound"),
        ("c_j_squared", "c_j²"),
        ("r_norm", "‖R‖"),
        ("q_norm", "‖q‖"),
    ];
    symbols.iter().find(|(known, _)| *known == key).map_or(key, |(_, symbol)| symbol)
}

fn grid_row(run: &Bounded) -> Value {
    let (estimate, [zeta, memory]) = (&run.estimate, &run.estimate.truncation);
    let g: Vec<f64> = zeta.iter().zip(memory).map(|(z, b)| z + b).collect();
    let k = estimate.grid.largest_step();
    let effectivity = run.envelopes.map(|bound| {
        let [at_end, least] = run.over_error(bound);
        json!({ "at_end": at_end, "least": least })
    });
    json!({
        "steps": estimate.grid.steps(),
        "k": k,
        "C2_k": estimate.c2() * estimate.weights.of_step(k),
        "error_end": estimate.error.last(),
        "error_max": largest(&estimate.error),
        "truncation_end": g.last(),
        "truncation_max": largest(&g),
        "floor": estimate.floor,
        "effectivity": effectivity,
    })
}

/// The run with the step k to the longest of `horizons` up to each of them, the longest last, and where the truth comes from:
/// on a uniform grid the run to a shorter horizon is its beginning.
///
/// # Errors
/// A horizon that is no multiple of k; those of the run.
pub(super) fn horizons(
    subject: &Subject,
    n: Option<u32>,
    k: f64,
    horizons: &[f64],
) -> Result<(String, Vec<Bounded>), GronwallError> {
    let scene = subject.scene();
    if scene.time.grid != scene::TimeGrid::Uniform {
        let why = ": horizons at a fixed step need a uniform grid; leave --horizons out";
        return Err(refused(scene, why));
    }
    let mut sorted = horizons.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    let steps: Vec<u32> =
        sorted.iter().map(|&horizon| whole_steps(horizon, k)).collect::<Result<_, _>>()?;
    let (longest, last) = (sorted[sorted.len() - 1], steps[steps.len() - 1]);
    // Formulas are defined for all t; what validation samples over the horizon (exact contact state,
    // constants) is sampled again.
    let mut longer = scene.clone();
    longer.time.horizon = longest;
    let longer = Subject::new(longer)?;
    let in_time = prepare(&longer, n, &[last])?;
    let run = in_time.measure(last)?;
    let upto = |&steps: &u32| Bounded::new("horizon".into(), run.up_to(steps as usize));
    Ok((in_time.truth(), steps.iter().map(upto).collect::<Result<_, _>>()?))
}

/// T/k, if that is a whole number.
fn whole_steps(horizon: f64, k: f64) -> Result<u32, GronwallError> {
    let steps = horizon / k;
    let whole = steps.round();
    let fits =
        whole >= 1.0 && whole <= f64::from(u32::MAX) && (steps - whole).abs() <= 1e-9 * whole;
    if fits { Ok(whole as u32) } else { Err(GronwallError::Horizon { horizon, k }) }
}

/// Error and bounds on each [0, T]: maxima, and log(error(T)/error(T'))/(T - T') from the horizon T' before, to compare with
/// C2.
pub(super) fn horizon_rows(runs: &[Bounded]) -> Vec<Value> {
    let mut before: Option<[f64; 2]> = None;
    let row = |Bounded { estimate, envelopes, .. }: &Bounded| {
        let (steps, error) = (estimate.grid.steps(), largest(&estimate.error));
        let horizon = estimate.grid.time(steps);
        let seen = before.replace([horizon, error]).filter(|[_, e]| *e > 20.0 * estimate.floor);
        let mut row = json!(envelopes.map(|bound| largest(bound)));
        row["horizon"] = json!(horizon);
        row["steps"] = json!(steps);
        row["error"] = json!(error);
        row["truncation"] = json!(largest(&estimate.source) / estimate.m0);
        row["c2"] = json!(estimate.c2());
        row["growth"] = json!(seen.map(|[t, e]| (error / e).ln() / (horizon - t)));
        row
    };
    runs.iter().map(row).collect()
}

/// Relative sizes δ of the perturbations. The difference stays far above the floor, and the largest
/// changes contact and yielding states.
const SIZES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// Adds to the load of a scene at each t_n a random vector of dual norm δ max_m ‖f_m‖_*, for each size δ, and measures the
/// difference of the solutions.
///
/// # Errors
/// A load or a run fails.
pub(super) fn perturbations(
    scene: &dyn InTime,
    steps: u32,
) -> Result<Vec<(f64, Bounded)>, GronwallError> {
    let grid = scene.grid(steps);
    let loads = scene.loads(&grid)?;
    let size = largest(&scene.dual_norms(&loads)?);
    let (undisturbed, floor) = scene.solutions(&grid, &loads)?;
    let mut seed = 1;
    let mut unit: Vec<Vec<f64>> =
        loads.iter().map(|load| load.iter().map(|_| signed_unit(&mut seed)).collect()).collect();
    let norms = scene.dual_norms(&unit)?;
    for (vector, norm) in unit.iter_mut().zip(norms) {
        vector.iter_mut().for_each(|x| *x *= size / norm);
    }
    let one = |share: f64| {
        let moved =
            |(f, d): (&Vec<f64>, &Vec<f64>)| f.iter().zip(d).map(|(f, d)| f + share * d).collect();
        let changed: Vec<Vec<f64>> = loads.iter().zip(&unit).map(moved).collect();
        let (disturbed, other) = scene.solutions(&grid, &changed)?;
        let pairs = undisturbed.iter().zip(&disturbed);
        let source = vec![share * size; unit.len()];
        let error = pairs.map(|(u, v)| scene.distance(u, v)).collect();
        let sources = [source.clone(), source];
        let estimate = Estimate::new(&grid, scene.terms(&grid), error, sources, floor + other);
        Ok((share, Bounded::new(format!("perturbed-{share:e}"), estimate)?))
    };
    SIZES.into_iter().map(one).collect()
}

/// The difference of two solutions stays below its recurrence.
pub(super) fn stability(run: &Bounded, n: Option<u32>) -> Claim {
    let claim = run.claims(n).swap_remove(0);
    let says = "|u - v| <= weighted envelope of |df|";
    Claim { statement: Statement { source: "stability", says }, ..claim }
}

pub(super) fn perturbed_row((size, run): &(f64, Bounded)) -> Value {
    let (estimate, envelopes) = (&run.estimate, &run.envelopes);
    let (load, difference) = (largest(&estimate.source), largest(&estimate.error));
    json!({
        "size": size,
        "steps": estimate.grid.steps(),
        "load": load,
        "difference": difference,
        "growth": estimate.m0 * difference / load,
        "weighted": largest(&envelopes.weighted),
        "primed": largest(&envelopes.primed),
        "least_effectivity": run.over_error(&envelopes.weighted)[1],
    })
}

/// Error and three of its bounds on a logarithmic axis, where the distance of two curves is their ratio.
fn picture(
    scene: &str,
    question: &str,
    x: Axis,
    y: &str,
    [error, weighted, primed, closed]: [Vec<Datum>; 4],
) -> Option<String> {
    let line = |name: &str, part| Series::new(name, vec![part]);
    // The error is above the bounds: where one is attained, both are seen.
    let series = vec![
        line("weighted envelope", Part::Line(weighted)),
        line("primed envelope", Part::Line(primed)),
        line("its closed form", Part::Line(closed)),
        Series { grey: true, ..line("measured error", Part::Dashed(error)) },
    ];
    let chart = Chart::new(&format!("{scene}: Gronwall"), question, x, Axis::new(y, Scale::Log));
    Chart { direct: true, series, ..chart }.svg()
}

fn over_time(
    scene: &str,
    mesh: &str,
    Bounded { estimate, envelopes, .. }: &Bounded,
) -> Option<String> {
    let question = format!(
        "Error in time and its bounds on [0, T], N = {}{mesh}. From the weighted envelope to the closed form each bound lies above the one before.",
        estimate.grid.steps()
    );
    let of = [&estimate.error, &envelopes.weighted, &envelopes.primed, &envelopes.closed];
    let times = || estimate.grid.times().iter().copied();
    let curves = of.map(|values| times().zip(values.iter().copied()).skip(1).collect());
    picture(scene, &question, Axis::new("time t_n", Scale::Linear), "norm of the error", curves)
}

fn over_horizon(scene: &str, k: f64, rows: &Value) -> Option<String> {
    let question = format!(
        "Error and bounds over the horizon at the fixed step k = {k}: uniform in T, or like exp(C₂T)?"
    );
    let value = |row: &Value, key: &str| row[key].as_f64().unwrap_or(f64::NAN);
    let rows = || rows.as_array().into_iter().flatten();
    let curves = ["error", "weighted", "primed", "closed"]
        .map(|key| rows().map(|row| (value(row, "horizon"), value(row, key))).collect());
    picture(scene, &question, Axis::new("horizon T", Scale::Log), "maximum over [0, T]", curves)
}

/// Prepares a scene for grids with these numbers of steps. A body needs `n`, cells per unit length; an
/// abstract scene has none.
///
/// # Errors
/// Constants, loads or a reference run that cannot be had.
pub fn prepare<'a>(
    subject: &'a Subject,
    n: Option<u32>,
    steps: &[u32],
) -> Result<Box<dyn InTime + 'a>, GronwallError> {
    let reason = match (subject, n) {
        (Subject::Contact(setup), Some(n)) => {
            return Ok(Box::new(ContactInTime::new(setup, n, steps)?));
        }
        (Subject::Abstract(setup), None) => return Ok(Box::new(FiniteInTime::new(setup)?)),
        (Subject::Contact(_), None) => "a body needs a mesh: give --n",
        (Subject::Abstract(_), Some(_)) => "an abstract problem has no mesh: remove --n",
    };
    Err(GronwallError::Mesh { reason })
}

/// Nodal vectors of a level that the perturbations hold: f, δf, f + δf, and u of f and of f + δf.
const PERTURBED: f64 = 5.0;

/// The runs of a study of `setup` on the mesh n. Whether u(t) lies in V^h is known on the mesh alone: unless the scene
/// says so, the truth counts as a run with more steps.
pub fn study_runs<'a>(setup: &'a Setup, n: u32, plan: &StudyRuns) -> Runs<'a> {
    let finest = plan.steps.iter().copied().max().unwrap_or(1);
    let common = plan.steps.iter().copied().fold(1, lowest_common_multiple);
    let k = setup.scene.time.horizon / f64::from(finest);
    // Horizons that cannot be are refused by the study.
    let longest = plan.horizons.iter().filter_map(|&horizon| whole_steps(horizon, k).ok()).max();
    let in_space = setup.body.data.is_interpolated();
    let finer = |steps: u32| if in_space { steps } else { REFERENCE_STEPS.saturating_mul(steps) };
    let grid = [Some(common), longest].into_iter().flatten().map(|steps| (n, finer(steps)));
    // u and its histories at the levels of the truth, of another with half the steps, and of the grid itself.
    let a_level = 1.0 + setup.body.material.memory.len() as f64;
    let truth = f64::from(common.max(longest.unwrap_or(0))) + 1.0;
    let truth = if in_space { 0.0 } else { 2.0 * truth };
    let of_grid = f64::from(finest.max(longest.unwrap_or(0))) + 1.0;
    let vectors = a_level * (truth + of_grid) + PERTURBED * of_grid;
    let beside = move |space: &Discretization, _| 8.0 * space.nodes.len() as f64 * vectors;
    Runs { setup, grid: grid.collect(), beside: Box::new(beside) }
}
