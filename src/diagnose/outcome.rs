//! A trial run and judged.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rayon::prelude::*;

use super::term::{Suspect, Terms};
use super::trial::{Question, Trial};
use crate::contact::{KKT_ALLOWED, LoadError, kkt_residual};
use crate::record::{CaseRecord, NormError, Status};
use crate::scene::Scene;
use crate::setup::{MeshData, Setup, SetupError, Subject};
use crate::sweep::{CasePlan, Overrides, ScenePlan, judge_scene, run_contact_case};
use crate::verdict::{Decision, Verdict};

/// Puts the solver under test into the setup of a variant.
pub type Prepare<'a> = dyn Fn(Setup) -> Setup + Sync + 'a;

/// An exact variant is met if its relative errors are below this: results promise nine digits, and
/// rounding stays three to five orders below on the coarse meshes of the trials.
pub const EXACT_WITHIN: f64 = 1e-9;

/// What a trial showed.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Name of the variant.
    pub name: String,
    /// Its terms in words.
    pub terms: String,
    /// What it had to show.
    pub question: Question,
    /// Pass: a sound solver shows this. Fail: it does not.
    pub decision: Decision,
    /// The verdict where an order was asked.
    pub verdict: Option<Verdict>,
    /// The largest relative error and its norm, where exactness was asked.
    pub error: Option<(String, f64)>,
    /// Why, in one sentence.
    pub reason: String,
    /// What took part.
    pub suspects: Vec<Suspect>,
    /// The term that it lacks, in the ladder of removals.
    pub removed: Option<Suspect>,
}

/// Runs the cases of a scene one by one with the solver that `prepare` puts in; the records in order.
///
/// # Errors
/// What the setup refuses.
pub fn records(
    scene: &Scene,
    prepare: &Prepare<'_>,
) -> Result<(ScenePlan, Vec<CaseRecord>), SetupError> {
    let setup = prepare(Setup::new(scene.clone())?);
    let plan = ScenePlan::new(Subject::Contact(Box::new(setup)), &Overrides::default());
    let Subject::Contact(setup) = &plan.subject else { return Ok((plan, Vec::new())) };
    let mut ns: Vec<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
    ns.sort_unstable();
    ns.dedup();
    let meshes: Vec<(u32, MeshData)> = ns
        .into_par_iter()
        .map(|n| MeshData::new(setup, n, None).map(|data| (n, data)))
        .collect::<Result<_, _>>()?;
    let run = |case: &CasePlan| {
        let data = meshes.iter().find(|(n, _)| Some(*n) == case.n).map(|(_, data)| data);
        data.map(|data| one_case(setup, data, case))
    };
    let found = plan.cases.par_iter().filter_map(run).collect();
    Ok((plan, found))
}

/// A solver under test may panic: that is a failed case, not the end of the diagnosis.
fn one_case(setup: &Setup, data: &MeshData, case: &CasePlan) -> CaseRecord {
    let run = |case: &CasePlan| run_contact_case(setup, data, case);
    catch_unwind(AssertUnwindSafe(|| run(case))).unwrap_or_else(|_| {
        let reason = "the solver ended with an internal error".to_owned();
        CaseRecord { status: Status::Failed { reason }, ..empty(setup, data, case) }
    })
}

fn empty(setup: &Setup, data: &MeshData, case: &CasePlan) -> CaseRecord {
    let nothing = |norm: &crate::scene::Norm| NormError {
        norm: norm.name().into(),
        error: None,
        floor: None,
    };
    CaseRecord {
        scene: setup.scene.name.clone(),
        dimension: setup.scene.dimension as u32,
        n: case.n,
        steps: case.steps,
        h: Some(data.space.mesh.h()),
        k: setup.grid(case.steps).largest_step(),
        dofs: data.space.dofs() as u64,
        elements: data.space.mesh.cell_count() as u64,
        status: Status::Skipped,
        newton_iterations: 0,
        active_set_changes: 0,
        factorizations: 0,
        seconds_load: 0.0,
        seconds_assemble: 0.0,
        seconds_factor: 0.0,
        seconds_solve: 0.0,
        seconds_total: 0.0,
        peak_history_bytes: 0,
        errors: case.norms.iter().map(nothing).collect(),
    }
}

/// Runs a trial and judges it.
pub fn run(trial: &Trial, prepare: &Prepare<'_>) -> Outcome {
    let mut outcome = Outcome {
        name: trial.scene.name.clone(),
        terms: trial.terms.words(),
        question: trial.question,
        decision: Decision::Unresolved,
        verdict: None,
        error: None,
        reason: String::new(),
        suspects: trial.suspects.clone(),
        removed: trial.removed,
    };
    let (plan, records) = match records(&trial.scene, prepare) {
        Ok(found) => found,
        Err(error) => {
            outcome.reason = format!("not run: {}", first_line(&error.to_string()));
            return outcome;
        }
    };
    match trial.question {
        Question::Order => {
            let verdicts = judge_scene(&trial.scene, &records, &plan.keys(), &[]);
            let verdict = verdicts.into_iter().max_by_key(|verdict| badness(verdict.decision));
            if let Some(verdict) = verdict {
                outcome.decision = verdict.decision;
                outcome.reason = verdict.reason.clone();
                outcome.verdict = Some(verdict);
            }
        }
        Question::Exact => exactness(&plan, &records, &mut outcome),
    }
    if trial.terms == Terms::NONE && outcome.decision == Decision::Fail {
        outcome.suspects.retain(|&suspect| suspect != acquitted(&plan, &records));
    }
    outcome
}

/// Of elasticity and loads the one that is not at fault: what solves the equations of its own 𝒜 under
/// the loads of the truth has the right loads; what does not, has them wrong, or does not solve.
fn acquitted(plan: &ScenePlan, records: &[CaseRecord]) -> Suspect {
    let Subject::Contact(setup) = &plan.subject else { return Suspect::Loads };
    let solves = |record: &CaseRecord| -> bool {
        let Ok(data) = MeshData::new(setup, record.n.unwrap_or_default(), None) else {
            return false;
        };
        let mut largest = 0.0f64;
        let marched = setup.scheme.march(setup, &data, record.steps, &mut |view| {
            let load = data.truth.load(view.t)?;
            let residual = kkt_residual(&data.space, &setup.model, view, &load);
            largest = if residual.is_nan() { f64::INFINITY } else { largest.max(residual) };
            Ok(())
        });
        marched.is_ok() && largest <= KKT_ALLOWED
    };
    if records.iter().all(solves) { Suspect::Loads } else { Suspect::Elasticity }
}

fn badness(decision: Decision) -> u8 {
    match decision {
        Decision::Pass => 0,
        Decision::Unresolved => 1,
        Decision::Fail => 2,
    }
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// The errors of an exact variant, relative to the solution.
fn exactness(plan: &ScenePlan, records: &[CaseRecord], outcome: &mut Outcome) {
    let Subject::Contact(setup) = &plan.subject else { return };
    let mut worst: Option<(String, f64)> = None;
    for record in records {
        if let Status::Failed { reason } = &record.status {
            outcome.decision = Decision::Fail;
            outcome.reason = format!("no solution: {reason}");
            return;
        }
        let sizes = match sizes(setup, record) {
            Ok(sizes) => sizes,
            Err(reason) => {
                outcome.reason = format!("not run: {reason}");
                return;
            }
        };
        for entry in &record.errors {
            let size = if entry.norm == crate::record::V_MAX { sizes[0] } else { sizes[1] };
            let relative = entry.error.unwrap_or(f64::NAN) / size;
            let larger = worst.as_ref().is_none_or(|(_, known)| {
                !known.is_nan() && (relative.is_nan() || relative > *known)
            });
            if larger {
                worst = Some((entry.norm.clone(), relative));
            }
        }
    }
    let Some((norm, relative)) = worst else { return };
    let met = relative <= EXACT_WITHIN;
    outcome.decision = if met { Decision::Pass } else { Decision::Fail };
    let compared = if met { "within" } else { "above" };
    outcome.reason =
        format!("{norm} is {relative:.1e} of the solution, {compared} {EXACT_WITHIN:.0e}");
    outcome.error = Some((norm, relative));
}

/// Largest ‖ε(u_n)‖ and ‖σ_n‖ of the truth; the latter measures pressures too.
fn sizes(setup: &Setup, record: &CaseRecord) -> Result<[f64; 2], String> {
    let n = record.n.unwrap_or_default();
    let data =
        MeshData::new(setup, n, None).map_err(|error| first_line(&error.to_string()).to_owned())?;
    let grid = setup.grid(record.steps);
    let mut largest = [f64::MIN_POSITIVE; 2];
    for &t in grid.times() {
        let moments = data.truth.moments(t).map_err(|error: LoadError| error.to_string())?;
        for (size, field) in largest.iter_mut().zip([&moments.strain, &moments.stress]) {
            let components = field.mean.len() / data.space.geometry.measure.len().max(1);
            let square: f64 = field
                .mean
                .chunks(components.max(1))
                .zip(&data.space.geometry.measure)
                .map(|(mean, measure)| measure * mean.iter().map(|v| v * v).sum::<f64>())
                .sum();
            *size = size.max(square.sqrt());
        }
    }
    Ok(largest)
}
