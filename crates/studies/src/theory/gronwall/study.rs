//! The study of a scene: errors on grids, and differences under perturbed loads, each under its bounds.
//!
//! Two discrete solutions with loads f and f + δf satisfy
//!
//! ```text
//! m0 ‖u_n - ũ_n‖ ≤ ‖δf_n‖_* + Σ_p ω_p Σ'_j w_nj κ_p(n, j) ‖u_j - ũ_j‖
//! ```
//!
//! by the argument of (3.19)-(3.21) with both inequalities discrete: the same constants, no
//! truncation, and e_0 > 0 allowed. ‖·‖_* is dual to ‖·‖_X; for a body ‖v‖_V = ‖ε(v)‖_ℋ.

use super::recurrence::{Envelopes, Estimate, InTime};
use super::scenes::{ContactInTime, FiniteInTime, REFERENCE_STEPS, in_steps};
use crate::study::{Asked, Result, StudyError};
use algebra::linalg::{largest, signed_unit};
use fem::contact::Discretization;
use judge::claim::{Claim, Place, Statement};
use report::{Axis, Chapter, Chart, Findings, Part, Scale, Series};
use run::sweep::{Runs, admit_constants, lowest_common_multiple};
use scene::Scene;
use scene::setup::{Setup, Subject};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Most steps taken from the scene's list: the weighted envelope takes O(N²).
const MOST_STEPS: u32 = 1024;

/// `sweep gronwall`.
///
/// # Errors
/// [`StudyError`].
pub fn of_scene(scene: Scene, asked: &Asked) -> Result<Findings> {
    let mut own = scene.sweep.clone().unwrap_or_default();
    own.steps.retain(|steps| *steps <= MOST_STEPS);
    let n = asked.mesh().or(own.n.first().copied());
    let mut steps = asked.steps.clone().unwrap_or(own.steps);
    if steps.is_empty() {
        return Err(StudyError::other("no numbers of steps: give --steps 16,32,64"));
    }
    steps.sort_unstable();
    steps.dedup();
    if let Some(n) = n.filter(|_| scene.as_contact().is_some()) {
        scene.check_cells(n)?;
    }
    scene.check_steps(&steps)?;
    admit_constants(&scene, true, &asked.limit)?;
    let subject = Subject::new(scene)?;
    // An abstract problem keeps a few numbers per level.
    if let (Subject::Contact(setup), Some(n)) = (&subject, n) {
        study_runs(setup, n, &steps).admit(&asked.limit)?;
    }
    let scene = subject.scene();
    let in_time = prepare(&subject, n, &steps)?;
    let measured = |&steps: &u32| Bounded::new("time".into(), in_time.measure(steps)?);
    let grids = steps.iter().map(measured).collect::<Result<Vec<_>, _>>()?;
    let finest = steps.last().copied().unwrap_or(1);
    let perturbed = perturbations(&*in_time, finest)?;
    let mut claims: Vec<Claim> = grids.iter().flat_map(|run| run.claims(n)).collect();
    claims.extend(perturbed.iter().map(|run| stability(run, n)));
    let title = (Chapter::Gronwall, format!("Envelopes: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    let all = grids.iter().chain(&perturbed);
    let keys = "part,steps,k,n,t,error,g_zeta,g_memory,source,weighted,primed,closed,printed,printed_closed";
    let levels = |run: &Bounded| -> Vec<Value> {
        let (e, grid) = (&run.estimate, &run.estimate.grid);
        let level = |n: usize| {
            let [g_zeta, g_memory] = e.truncation.each_ref().map(|part| part.get(n));
            let mut row = json!({
                "part": run.part, "steps": grid.steps(), "k": grid.largest_step(), "n": n,
                "t": grid.time(n), "error": e.error[n], "g_zeta": g_zeta, "g_memory": g_memory,
                "source": e.source[n],
            });
            for (name, bound) in run.envelopes.each(|bound| bound[n].into()) {
                row[name] = bound;
            }
            row
        };
        (0..=grid.steps()).map(level).collect()
    };
    findings.tables.push((".csv", keys, all.flat_map(levels).collect()));
    findings.number("n", n);
    findings.number("truth", in_time.truth());
    let mesh = n.map_or_else(String::new, |n| format!(", n = {n}"));
    // Error and three of its bounds on a logarithmic axis, where the distance of two curves is their ratio.
    if let Some(Bounded { estimate, envelopes, .. }) = grids.last() {
        let question = format!(
            "Error in time and its bounds on [0, T], N = {}{mesh}. From the weighted envelope to the closed form each bound lies above the one before.",
            estimate.grid.steps()
        );
        let times = || estimate.grid.times().iter().copied();
        let curve = |values: &[f64]| times().zip(values.iter().copied()).skip(1).collect();
        let line = |name: &str, part| Series::new(name, vec![part]);
        // The error is above the bounds: where one is attained, both are seen.
        let series = vec![
            line("weighted envelope", Part::Line(curve(&envelopes.weighted))),
            line("primed envelope", Part::Line(curve(&envelopes.primed))),
            line("its closed form", Part::Line(curve(&envelopes.closed))),
            Series { grey: true, ..line("measured error", Part::Dashed(curve(&estimate.error))) },
        ];
        let x = Axis::new("time t_n", Scale::Linear);
        let y = Axis::new("norm of the error", Scale::Log);
        let chart = Chart::new(&format!("{}: Gronwall", scene.name), &question, x, y);
        let shows = "measured error and the envelopes of (3.24) over t (sweep gronwall).";
        let drawn = Chart { series, ..chart }.svg();
        findings.document.figure("gronwall-envelope", shows, drawn);
    }
    findings.document.words(format!("The truth is{mesh}: {}.", in_time.truth()));
    findings.table(
        "grids",
        grids.iter().map(grid_row).collect::<Vec<_>>(),
        "Bound over error at t = T for N steps; e and g at T; the bounds as printed need C₂k < 1.",
        ">N = steps; >C₂k = C2_k 6; >e_N = error_end; >g_N = truncation_end; >weighted = effectivity/weighted/at_end 7; \
         >primed = effectivity/primed/at_end 7; >closed = effectivity/closed/at_end 7; \
         >printed = effectivity/printed/at_end 7; >(3.24) = effectivity/printed_closed/at_end 7",
    );
    let constants = in_time.constants();
    findings.number("constants", constants.iter().copied().collect::<BTreeMap<_, _>>());
    let rows = constants.iter().map(|(name, value)| json!({ "name": name, "value": value }));
    let columns = "constant = name formula; >value = value 7";
    findings.document.rows("Constants of the inequality.", &rows.collect(), columns);
    Ok(findings)
}

/// A run with its bounds.
pub(super) struct Bounded {
    /// Its name in the table of levels.
    part: String,
    pub estimate: Estimate,
    pub envelopes: Envelopes,
}

impl Bounded {
    pub(super) fn new(part: String, estimate: Estimate) -> Result<Self> {
        let steps = estimate.grid.steps() as u32;
        let envelopes = estimate.envelopes().map_err(|source| in_steps(steps, source))?;
        Ok(Self { part, estimate, envelopes })
    }

    /// Every link of the chain, on a mesh with so many cells.
    pub(super) fn claims(&self, n: Option<u32>) -> Vec<Claim> {
        let steps = Some(self.estimate.grid.steps() as u32);
        let at = if self.part == "time" { String::new() } else { self.part.clone() };
        self.envelopes.claims(&self.estimate, &Place { n, steps, level: None, at })
    }
}

fn grid_row(run: &Bounded) -> Value {
    let (estimate, [zeta, memory]) = (&run.estimate, &run.estimate.truncation);
    let g: Vec<f64> = zeta.iter().zip(memory).map(|(z, b)| z + b).collect();
    let k = estimate.grid.largest_step();
    let Estimate { error, floor, .. } = estimate;
    // A bound over e_n, none where e_n is not above 20 floors: at T, and the least for n ≥ 1.
    let effectivity = run.envelopes.each(|bound| {
        let ratio = |n: usize| (error[n] > 20.0 * floor).then(|| bound[n] / error[n]);
        let least = (1..bound.len()).filter_map(ratio).reduce(f64::min);
        json!({ "at_end": ratio(estimate.grid.steps()), "least": least })
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

/// Relative sizes δ of the perturbations. The difference stays far above the floor, and the largest
/// changes contact and yielding states.
const SIZES: [f64; 3] = [1e-1, 1e-2, 1e-3];

/// Adds to the load of a scene at each t_n a random vector of dual norm δ max_m ‖f_m‖_*, for each size δ, and measures the
/// difference of the solutions.
///
/// # Errors
/// A load or a run fails.
pub(super) fn perturbations(scene: &dyn InTime, steps: u32) -> Result<Vec<Bounded>> {
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
        Bounded::new(format!("perturbed-{share:e}"), estimate)
    };
    SIZES.into_iter().map(one).collect()
}

/// The difference of two solutions stays below its recurrence.
pub(super) fn stability(run: &Bounded, n: Option<u32>) -> Claim {
    let claim = run.claims(n).swap_remove(0);
    let says = "|u - v| <= weighted envelope of |df|";
    Claim { statement: Statement { source: "stability", says }, ..claim }
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
) -> Result<Box<dyn InTime + 'a>> {
    let reason = match (subject, n) {
        (Subject::Contact(setup), Some(n)) => {
            return Ok(Box::new(ContactInTime::new(setup, n, steps)?));
        }
        (Subject::Abstract(setup), None) => return Ok(Box::new(FiniteInTime::new(setup)?)),
        (Subject::Contact(_), None) => "a body needs a mesh: give --n",
        (Subject::Abstract(_), Some(_)) => "an abstract problem has no mesh: remove --n",
    };
    Err(StudyError::other(reason))
}

/// Nodal vectors of a level that the perturbations hold: f, δf, f + δf, and u of f and of f + δf.
const PERTURBED: f64 = 5.0;

/// The runs of a study of `setup` on the mesh n. Whether u(t) lies in V^h is known on the mesh alone: unless the scene
/// says so, the truth counts as a run with more steps.
pub fn study_runs<'a>(setup: &'a Setup, n: u32, steps: &[u32]) -> Runs<'a> {
    let finest = steps.iter().copied().max().unwrap_or(1);
    let common = steps.iter().copied().fold(1, lowest_common_multiple);
    let in_space = setup.body.data.is_interpolated();
    let finer = if in_space { common } else { REFERENCE_STEPS.saturating_mul(common) };
    // u and its histories at the levels of the truth, of another with half the steps, and of the grid itself.
    let a_level = 1.0 + setup.body.material.memory.len() as f64;
    let truth = if in_space { 0.0 } else { 2.0 * (f64::from(common) + 1.0) };
    let of_grid = f64::from(finest) + 1.0;
    let vectors = a_level * (truth + of_grid) + PERTURBED * of_grid;
    let beside = move |space: &Discretization, _| 8.0 * space.nodes.len() as f64 * vectors;
    Runs { setup, grid: vec![(n, finer)], beside: Box::new(beside) }
}
