//! A trial run and judged.

use rayon::prelude::*;

use super::term::{SceneTerms, Suspect};
use super::trial::{Question, Trial};
use algebra::linalg::larger;
use fem::contact::{KKT_ALLOWED, LoadError, kkt_residual};
use judge::record::{CaseRecord, Status};
use judge::verdict::{Decision, Verdict};
use run::sweep::{CasePlan, Overrides, ScenePlan, judge_plan, run_contact_case};
use scene::Scene;
use scene::setup::{MeshData, Setup, SetupError, Subject};

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

/// A scene run by the solver under test.
pub(crate) struct Cases {
    pub plan: ScenePlan,
    /// One per case, in order.
    pub records: Vec<CaseRecord>,
    /// One per mesh.
    meshes: Vec<(u32, MeshData)>,
}

impl Cases {
    /// The cases with the setup and the mesh of each, of a body.
    fn run(&self) -> impl Iterator<Item = (&Setup, &MeshData, &CaseRecord)> {
        self.records.iter().filter_map(|record| match &self.plan.subject {
            Subject::Contact(setup) => Some((&**setup, mesh(&self.meshes, record.n)?, record)),
            Subject::Abstract(_) => None,
        })
    }
}

fn mesh(meshes: &[(u32, MeshData)], n: Option<u32>) -> Option<&MeshData> {
    meshes.iter().find(|(known, _)| Some(*known) == n).map(|(_, data)| data)
}

/// Runs the cases of a scene with the solver that `prepare` puts in.
///
/// # Errors
/// What the setup refuses.
pub(crate) fn run_cases(scene: &Scene, prepare: &Prepare<'_>) -> Result<Cases, SetupError> {
    let setup = prepare(Setup::new(scene.clone())?);
    let plan = ScenePlan::new(Subject::Contact(Box::new(setup)), &Overrides::default());
    let Subject::Contact(setup) = &plan.subject else {
        return Ok(Cases { plan, records: Vec::new(), meshes: Vec::new() });
    };
    let mut ns: Vec<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
    ns.sort_unstable();
    ns.dedup();
    let meshes: Vec<(u32, MeshData)> = ns
        .into_par_iter()
        .map(|n| MeshData::new(setup, n, None).map(|data| (n, data)))
        .collect::<Result<_, _>>()?;
    let one = |case: &CasePlan| {
        let data = mesh(&meshes, case.n)?;
        Some(plan.record(case, || Ok(run_contact_case(setup, data, case))))
    };
    let records = plan.cases.par_iter().filter_map(one).collect();
    Ok(Cases { plan, records, meshes })
}

pub(crate) fn run(trial: &Trial, prepare: &Prepare<'_>) -> Outcome {
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
    let cases = match run_cases(&trial.scene, prepare) {
        Ok(cases) => cases,
        Err(error) => {
            let said = error.to_string();
            outcome.reason = format!("not run: {}", said.lines().next().unwrap_or_default());
            return outcome;
        }
    };
    match trial.question {
        Question::Order => {
            let verdicts = judge_plan(&cases.plan, &cases.records, true);
            let rising = [Decision::Pass, Decision::Unresolved, Decision::Fail];
            let badness = |verdict: &Verdict| rising.iter().position(|d| *d == verdict.decision);
            let verdict = verdicts.into_iter().max_by_key(badness);
            if let Some(verdict) = verdict {
                outcome.decision = verdict.decision;
                outcome.reason = verdict.reason.clone();
                outcome.verdict = Some(verdict);
            }
        }
        Question::Exact => exactness(&cases, &mut outcome),
    }
    if trial.terms == SceneTerms::NONE && outcome.decision == Decision::Fail {
        outcome.suspects.retain(|&suspect| suspect != acquitted(&cases));
    }
    outcome
}

/// Of elasticity and loads the one that is not at fault: what solves the equations of its 𝒜 under
/// the loads of the truth has the right loads; what does not, has them wrong, or does not solve.
fn acquitted(cases: &Cases) -> Suspect {
    let solves = |(setup, data, record): (&Setup, &MeshData, &CaseRecord)| -> bool {
        let mut largest = 0.0f64;
        let marched = setup.scheme.march(setup, data, record.steps, &mut |view| {
            let load = data.truth.load(view.t)?;
            largest = larger(largest, kkt_residual(&data.space, &setup.model, view, &load));
            Ok(())
        });
        marched.is_ok() && largest <= KKT_ALLOWED
    };
    if cases.run().all(solves) { Suspect::Loads } else { Suspect::Elasticity }
}

/// The errors of an exact variant, relative to the solution.
fn exactness(cases: &Cases, outcome: &mut Outcome) {
    let mut worst: Option<(String, f64)> = None;
    for (setup, data, record) in cases.run() {
        if let Status::Failed { reason } = &record.status {
            outcome.decision = Decision::Fail;
            outcome.reason = format!("no solution: {reason}");
            return;
        }
        let sizes = match sizes(data, setup.grid(record.steps).times()) {
            Ok(sizes) => sizes,
            Err(reason) => {
                outcome.reason = format!("not run: {reason}");
                return;
            }
        };
        for entry in &record.errors {
            let size = if entry.norm == judge::record::V_MAX { sizes[0] } else { sizes[1] };
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
fn sizes(data: &MeshData, times: &[f64]) -> Result<[f64; 2], LoadError> {
    let mut largest = [f64::MIN_POSITIVE; 2];
    for &t in times {
        let moments = data.truth.moments(t)?;
        for (size, field) in largest.iter_mut().zip([&moments.strain, &moments.stress]) {
            let d = data.space.mesh.dimension;
            let tensors = data.space.points().zip(field.at.chunks_exact(d * (d + 1) / 2));
            let square: f64 = tensors
                .map(|(at, tensor)| at.weight * tensor.iter().map(|v| v * v).sum::<f64>())
                .sum();
            *size = size.max(square.sqrt());
        }
    }
    Ok(largest)
}
