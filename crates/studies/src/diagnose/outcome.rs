//! A trial run and judged.

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use super::term::{SceneTerms, Suspect};
use super::trial::{Question, Trial};
use algebra::linalg::larger;
use fem::contact::{KKT_ALLOWED, LoadError, kkt_residual};
use judge::claim::{Claim, Place, Relation, Standing, Statement};
use judge::record::{CaseRecord, Status};
use judge::verdict::{Decision, Variable, Verdict};
use run::sweep::{CasePlan, Overrides, ScenePlan, judge_plan, run_contact_case};
use scene::Scene;
use scene::setup::{MeshData, Setup, SetupError, Subject};

/// Puts the solver under test into the setup of a variant.
pub type Prepare<'a> = dyn Fn(Setup) -> Setup + Sync + 'a;

/// An exact variant is met if its relative errors are below this: results promise nine digits, and
/// rounding stays three to five orders below on the coarse meshes of the trials.
pub const EXACT_WITHIN: f64 = 1e-9;

/// What a trial showed.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Outcome {
    /// Name of the variant.
    pub name: String,
    /// Its terms in words.
    pub terms: String,
    /// The term that it lacks, in the ladder of removals.
    pub removed: Option<Suspect>,
    /// What took part.
    pub suspects: Vec<Suspect>,
    /// Pass: a sound solver shows this. Fail: it does not. Unresolved: it says nothing.
    #[serde(rename = "verdict")]
    pub decision: Decision,
    /// What it had to show; its note says why it does or does not.
    pub claim: Claim,
}

impl Outcome {
    /// Of a trial that says nothing.
    fn silent(trial: &Trial, note: String) -> Self {
        Self {
            name: trial.change.words().to_owned(),
            terms: trial.terms.words(),
            removed: trial.removed,
            suspects: trial.suspects.clone(),
            decision: Decision::Unresolved,
            claim: Claim { note, ..Claim::default() },
        }
    }
}

/// What a verdict says of an order, decided like this.
pub(super) fn order(verdict: &Verdict, at: &str, decision: Decision) -> Claim {
    let source = match verdict.variable {
        Variable::H => "order in h",
        Variable::K => "order in k",
        Variable::Joint => "order in h and k",
        Variable::Path => "order along a path",
    };
    Claim {
        statement: Statement { source, says: "as predicted" },
        place: Place { at: format!("{at}, {}", verdict.norm), ..Place::default() },
        left: verdict.observed.unwrap_or(f64::NAN),
        relation: Relation::Order(verdict.predicted, decision),
        accuracy: 0.0,
        note: verdict.reason.clone(),
    }
}

/// A case that was run, by its setup on its mesh.
pub(crate) type Case<'a> = (&'a Setup, &'a MeshData, CaseRecord);

/// Runs the cases of a scene with the solver that `prepare` puts in, and shows all of them to `see`.
///
/// # Errors
/// What the setup refuses.
pub(crate) fn run_cases<T>(
    scene: Scene,
    prepare: &Prepare<'_>,
    see: impl FnOnce(&ScenePlan, &[Case<'_>]) -> T,
) -> Result<T, SetupError> {
    let setup = Box::new(prepare(Setup::new(scene)?));
    let plan = ScenePlan::new(Subject::Contact(setup), &Overrides::default());
    let Subject::Contact(setup) = &plan.subject else { return Ok(see(&plan, &[])) };
    let ns: BTreeSet<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
    let meshes: BTreeMap<u32, MeshData> = ns
        .into_par_iter()
        .map(|n| MeshData::new(setup, n, None).map(|data| (n, data)))
        .collect::<Result<_, _>>()?;
    let one = |case: &CasePlan| -> Option<Case<'_>> {
        let data = meshes.get(&case.n?)?;
        Some((&**setup, data, plan.record(case, || Ok(run_contact_case(setup, data, case)))))
    };
    let cases: Vec<Case<'_>> = plan.cases.par_iter().filter_map(one).collect();
    Ok(see(&plan, &cases))
}

/// The verdicts of cases.
pub(crate) fn verdicts(plan: &ScenePlan, cases: &[Case<'_>]) -> Vec<Verdict> {
    let records: Vec<CaseRecord> = cases.iter().map(|(.., record)| record.clone()).collect();
    judge_plan(plan, &records, true)
}

pub(crate) fn run(scene: &Scene, trial: &Trial, prepare: &Prepare<'_>) -> Outcome {
    let name = trial.change.words();
    let see = |plan: &ScenePlan, cases: &[Case<'_>]| {
        let found = match trial.question {
            Question::Order => {
                let rising = [Decision::Pass, Decision::Unresolved, Decision::Fail];
                let badness = |of: &Verdict| rising.iter().position(|d| *d == of.decision);
                let worst = verdicts(plan, cases).into_iter().max_by_key(badness);
                Ok(worst.map(|verdict| (verdict.decision, order(&verdict, name, verdict.decision))))
            }
            Question::Exact => exactness(cases, name),
        };
        let (decision, claim) = match found {
            Ok(Some(found)) => found,
            Ok(None) => return Outcome::silent(trial, String::new()),
            Err(reason) => return Outcome::silent(trial, format!("not run: {reason}")),
        };
        let mut outcome = Outcome { decision, claim, ..Outcome::silent(trial, String::new()) };
        if trial.terms == SceneTerms::NONE && decision == Decision::Fail {
            outcome.suspects.retain(|&suspect| suspect != acquitted(cases));
        }
        outcome
    };
    let found = trial.of(scene).map_err(SetupError::from).and_then(|s| run_cases(s, prepare, see));
    found.unwrap_or_else(|error| {
        let said = error.to_string();
        Outcome::silent(trial, format!("not run: {}", said.lines().next().unwrap_or_default()))
    })
}

/// Of elasticity and loads the one that is not at fault: what solves the equations of its 𝒜 under
/// the loads of the truth has the right loads; what does not, has them wrong, or does not solve.
fn acquitted(cases: &[Case<'_>]) -> Suspect {
    let solves = |(setup, data, record): &Case<'_>| -> bool {
        let mut largest = 0.0f64;
        let marched = setup.scheme.march(setup, data, record.steps, &mut |view| {
            let load = data.truth.load(view.t)?;
            largest = larger(largest, kkt_residual(&data.space, &setup.model, view, &load));
            Ok(())
        });
        marched.is_ok() && largest <= KKT_ALLOWED
    };
    if cases.iter().all(solves) { Suspect::Loads } else { Suspect::Elasticity }
}

/// The largest error of an exact variant, relative to the solution; none without a norm.
fn exactness(cases: &[Case<'_>], name: &str) -> Result<Option<(Decision, Claim)>, LoadError> {
    let statement = Statement { source: "exact", says: "error / solution <= 1e-9" };
    let claim = |left: f64, at: String, note: String| {
        let place = Place { at, ..Place::default() };
        let claim = Claim { note, ..Claim::at_most(statement, place, [left, EXACT_WITHIN], 0.0) };
        let holds = claim.standing() == Standing::Passes;
        (if holds { Decision::Pass } else { Decision::Fail }, claim)
    };
    let mut worst: Option<(&str, f64)> = None;
    for (setup, data, record) in cases {
        if let Status::Failed { reason } = &record.status {
            return Ok(Some(claim(f64::NAN, name.into(), format!("no solution: {reason}"))));
        }
        let sizes = sizes(data, setup.grid(record.steps).times())?;
        for entry in &record.errors {
            let size = if entry.norm == judge::record::V_MAX { sizes[0] } else { sizes[1] };
            let relative = entry.error.unwrap_or(f64::NAN) / size;
            if worst.is_none_or(|(_, most)| relative > most || relative.is_nan()) {
                worst = Some((&entry.norm, relative));
            }
        }
    }
    let found = |(norm, relative)| {
        let note = format!("{norm} is {relative:.1e} of the solution");
        claim(relative, format!("{name}, {norm}"), note)
    };
    Ok(worst.map(found))
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
