//! Which term of a scene is at fault when one of its orders or constants is not what it must be.
//!
//! A ladder of variants takes one term of (5.1)-(5.5) away at a time and keeps u, the loads derived anew.
//! In each u(t) is put into V^h, so that the history is the only source of errors: with a history the
//! order in k is judged, without one the discrete solution is the exact one and any error convicts. A
//! second ladder has one term at a time beside elasticity, on courses in time that the trapezoidal rule
//! integrates exactly; memory and ζ come with a control where the scene lacks them, so that a fault of
//! their common time rule is told from one of either. Where everything in V^h is sound and an order in h
//! is not, the same removals are run outside V^h. The suspect that takes part in everything that fails,
//! and in the least of what passes, is named.

mod trial;

pub use trial::{Outcome, Suspect};

use std::collections::{BTreeMap, BTreeSet};

use self::trial::{Trial, trials_in_space, trials_in_time};
use algebra::linalg::{dot, larger};
use fem::contact::{KKT_ALLOWED, LoadError, kkt_residual};
use judge::claim::{Claim, Place, Relation, Standing, Statement};
use judge::record::{CaseRecord, NormError, Status};
use judge::verdict::{Decision, Variable, Verdict};
use rayon::prelude::*;
use report::{Chapter, Findings};
use run::sweep::{
    CasePlan, Cost, MemoryLimit, Overrides, Refused, ScenePlan, admit_plan, judge_plan,
    run_contact_case,
};
use scene::setup::{MeshData, Setup, SetupError, Subject};
use scene::{Body, Data, Direction, Extension, Scene};

/// What a diagnosis found.
#[derive(Debug, Clone, Default)]
pub struct Diagnosis {
    /// Name of the scene, and the fingerprint of its text.
    pub scene: [String; 2],
    /// Verdicts of the scene, before any trial.
    pub verdicts: Vec<Verdict>,
    /// The trials, empty where nothing had to be diagnosed.
    pub outcomes: Vec<Outcome>,
    /// Whom they convict; none where nothing had to be diagnosed.
    pub finding: Option<Finding>,
    /// The finding in one sentence.
    pub sentence: String,
}

/// Judges a scene with the solver that `prepare` puts into its setup and, if a verdict is not as
/// expected (or `always`), runs the trials.
///
/// # Errors
/// A scene without exact solution: its variants have no truth. What the setup refuses.
pub fn diagnose(
    scene: &Scene,
    prepare: &Prepare<'_>,
    always: bool,
) -> Result<Diagnosis, SetupError> {
    scene.without(
        &[Extension::Friction],
        "sweep diagnose",
        "its variants change the stresses on the contact side, and so what friction must be there",
    )?;
    has_exact_solution(scene)?;
    let mut found = Diagnosis {
        scene: [scene.name.clone(), scene.source.hash.clone()],
        verdicts: run_cases(scene.clone(), prepare, |_, _, verdicts| verdicts)?,
        ..Diagnosis::default()
    };
    let wrongly: Vec<&Verdict> =
        found.verdicts.iter().filter(|verdict| !verdict.as_expected()).collect();
    // Where the errors are those that the exact solution predicts, and the scene predicts another order of them.
    let contradiction = |verdict: &&Verdict| {
        let Verdict { norm, variable, predicted, contradicted_by, .. } = verdict;
        contradicted_by.map(|order| {
            format!(
                "{norm} has the errors of order {order:.2} in {} that the exact solution predicts, and [[predicts]] says {predicted}",
                variable.name()
            )
        })
    };
    let contradicted: Vec<String> = wrongly.iter().filter_map(contradiction).collect();
    // Of a scene that is not judged the trials alone say something.
    let always = always || found.verdicts.is_empty();
    if !always && wrongly.is_empty() {
        found.sentence = "nothing to diagnose: every verdict is as expected".into();
    } else if !always && contradicted.len() == wrongly.len() {
        let finding = found.finding.insert(Finding::Prediction);
        found.sentence = format!("{}: {}", sentence(finding, &[]), contradicted.join("; "));
    } else {
        let in_space = wrongly.iter().any(|verdict| verdict.variable != Variable::K);
        let (outcomes, finding) = examine(scene, prepare, in_space || always);
        found.sentence = match finding == Finding::NothingFails && wrongly.is_empty() {
            true => "nothing is wrong, because every variant shows what it must".into(),
            false => [vec![sentence(&finding, &outcomes)], contradicted].concat().join("; "),
        };
        (found.outcomes, found.finding) = (outcomes, Some(finding));
    }
    Ok(found)
}

impl Diagnosis {
    /// The claims of verdicts and trials; trials that are unresolved or could not be run claim nothing.
    pub fn findings(&self) -> Findings {
        let verdict = |of: &Verdict| {
            let decision = match of.as_expected() {
                true => Decision::Pass,
                false if of.decision == Decision::Unresolved => Decision::Unresolved,
                false => Decision::Fail,
            };
            order(of, "the scene", decision)
        };
        let says = |outcome: &&Outcome| outcome.decision != Decision::Unresolved;
        let trials = self.outcomes.iter().filter(says).map(|outcome| outcome.claim.clone());
        let claims: Vec<Claim> = self.verdicts.iter().map(verdict).chain(trials).collect();
        let [name, hash] = &self.scene;
        let title = (Chapter::Diagnose, format!("Which term is at fault: {name}"));
        let mut findings = Findings::new(title, Some([name, hash]), claims);
        findings.document.answer(self.sentence.clone());
        findings.table(
            "trials",
            &self.outcomes,
            "Variants of the scene.",
            "trial = name; terms = terms; asked = claim/line; must be = claim/relation; > = claim/right; >shows = claim/left 3; \
             because = claim/note",
        );
        let culprits = self.finding.as_ref().map_or(Vec::new(), Finding::culprits);
        findings.numbers(serde_json::json!({
            "verdicts": self.verdicts, "culprits": culprits, "sentence": self.sentence,
        }));
        findings
    }
}

/// Refuses a diagnosis that would take more memory than there may be, `jobs` cases at a time: the cases of the scene,
/// and the first trial of each ladder, of which the others lack a term. A scene or trial that cannot be set up takes
/// none.
///
/// # Errors
/// [`Refused`].
pub fn admit_diagnosis(scene: &Scene, jobs: usize, limit: &MemoryLimit) -> Result<(), Refused> {
    if has_exact_solution(scene).is_err() {
        return Ok(());
    }
    let first = |trials: Vec<Trial>| trials.into_iter().next().map(|(variant, _)| (variant, jobs));
    // Trials run side by side, and share no mesh.
    let ladders = [first(trials_in_time(scene)), first(trials_in_space(scene))];
    for (scene, times) in std::iter::once((scene.clone(), 1)).chain(ladders.into_iter().flatten()) {
        let Ok(subject) = Subject::new(scene) else { continue };
        let plan = ScenePlan::new(subject, &Overrides::default());
        let kept = |cases: &[(&CasePlan, &Cost)]| -> f64 {
            (times - 1) as f64 * cases.iter().map(|(_, cost)| cost.kept_bytes).sum::<f64>()
        };
        admit_plan(&plan, jobs, limit, kept)?;
    }
    Ok(())
}

/// Runs the trials of a scene with an exact solution. With `in_space`, those outside V^h follow where
/// everything in V^h is sound.
pub fn examine(scene: &Scene, prepare: &Prepare<'_>, in_space: bool) -> (Vec<Outcome>, Finding) {
    let run_all = |trials: Vec<Trial>| -> Vec<Outcome> {
        trials.into_par_iter().map(|trial| run(trial, prepare)).collect()
    };
    let mut outcomes = run_all(trials_in_time(scene));
    let sound = outcomes.iter().all(|outcome| outcome.decision != Decision::Fail);
    let predicts_in_space = scene.predicts.iter().any(|p| p.variable != Direction::K);
    if in_space && sound && predicts_in_space {
        // All terms first: only where they fail the dearer ladder has something to tell.
        let mut ladder = trials_in_space(scene);
        let removals = ladder.split_off(1.min(ladder.len()));
        outcomes.extend(run_all(ladder));
        if outcomes.iter().any(|outcome| outcome.decision == Decision::Fail) {
            outcomes.extend(run_all(removals));
        }
    }
    let finding = culprit(&outcomes);
    (outcomes, finding)
}

fn has_exact_solution(scene: &Scene) -> Result<(), SetupError> {
    let (message, hint) = match &scene.body {
        Body::Abstract(_) => (
            "an abstract problem has no terms to remove",
            "name a scene of the contact problem; `sweep gronwall` examines the history of this one",
        ),
        Body::Contact(body) if !matches!(body.data, Data::Exact { .. }) => (
            "the scene has no exact solution, so nothing would be known about a variant with a term removed",
            "name a scene with [exact], from which the loads of every variant are derived",
        ),
        Body::Contact(_) => return Ok(()),
    };
    Err(scene.error("scene.name", message, hint).into())
}

// A trial run and judged.

/// Puts the solver under test into the setup of a variant.
pub type Prepare<'a> = dyn Fn(Setup) -> Setup + Sync + 'a;

/// An exact variant is met if its relative errors are below this: results promise nine digits, and
/// rounding stays three to five orders below on the coarse meshes of the trials.
pub const EXACT_WITHIN: f64 = 1e-9;

/// What a verdict says of an order, decided like this.
fn order(verdict: &Verdict, at: &str, decision: Decision) -> Claim {
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

/// A case that was run, on its mesh.
type Case<'a> = (&'a MeshData, CaseRecord);

/// Runs the cases of a scene with the solver that `prepare` puts in, and shows all of them with their verdicts to `see`.
fn run_cases<T>(
    scene: Scene,
    prepare: &Prepare<'_>,
    see: impl FnOnce(&Setup, &[Case<'_>], Vec<Verdict>) -> T,
) -> Result<T, SetupError> {
    let setup = prepare(Setup::new(scene)?);
    let plan = ScenePlan::new(Subject::Contact(Box::new(setup)), &Overrides::default());
    let Subject::Contact(setup) = &plan.subject else { unreachable!("a body stays one") };
    let ns: BTreeSet<u32> = plan.cases.iter().filter_map(|case| case.n).collect();
    let meshes: BTreeMap<u32, MeshData> = ns
        .into_par_iter()
        .map(|n| MeshData::new(setup, n, None).map(|data| (n, data)))
        .collect::<Result<_, _>>()?;
    let one = |case: &CasePlan| -> Option<Case<'_>> {
        let data = meshes.get(&case.n?)?;
        Some((data, plan.record(case, || Ok(run_contact_case(setup, data, case)))))
    };
    let cases: Vec<Case<'_>> = plan.cases.par_iter().filter_map(one).collect();
    let records: Vec<CaseRecord> = cases.iter().map(|(_, record)| record.clone()).collect();
    Ok(see(setup, &cases, judge_plan(&plan, &records, true)))
}

fn run((variant, mut outcome): Trial, prepare: &Prepare<'_>) -> Outcome {
    let asks_for_order = variant.judge;
    let shown = run_cases(variant, prepare, |setup, cases, verdicts| {
        if !asks_for_order {
            exactness(setup, cases, &mut outcome)?;
        } else if let Some(worst) = [Decision::Fail, Decision::Unresolved, Decision::Pass]
            .into_iter()
            .find_map(|decision| verdicts.iter().rfind(|of| of.decision == decision))
        {
            outcome.decision = worst.decision;
            outcome.claim = order(worst, &outcome.name, worst.decision);
        }
        if !outcome.suspects.iter().any(|suspect| suspect.is_term())
            && outcome.decision == Decision::Fail
        {
            // Of elasticity and loads one is not at fault: what solves the equations of its 𝒜 under the loads of the truth has the
            // right loads; what does not, has them wrong, or does not solve.
            let solves = |(data, record): &Case<'_>| -> bool {
                let mut largest = 0.0f64;
                let marched = setup.scheme.march(setup, data, record.steps, &mut |view| {
                    let load = data.truth.load(view.t)?;
                    let residual = kkt_residual(&data.space, &setup.model, view, &load);
                    largest = larger(largest, residual);
                    Ok(())
                });
                marched.is_ok() && largest <= KKT_ALLOWED
            };
            let solved = cases.iter().all(solves);
            let acquitted = if solved { Suspect::Loads } else { Suspect::Elasticity };
            outcome.suspects.retain(|&suspect| suspect != acquitted);
        }
        Ok::<_, LoadError>(())
    });
    let said = match shown {
        Ok(Ok(())) => return outcome,
        Ok(Err(error)) => error.to_string(),
        Err(error) => error.to_string(),
    };
    outcome.claim.note = format!("not run: {}", said.lines().next().unwrap_or_default());
    outcome
}

/// The largest error of an exact variant, relative to the solution; without a norm it says nothing.
fn exactness(setup: &Setup, cases: &[Case<'_>], outcome: &mut Outcome) -> Result<(), LoadError> {
    let mut worst: Option<(f64, &str, String)> = None;
    for (data, record) in cases {
        if let Status::Failed { reason } = &record.status {
            worst = Some((f64::NAN, "", format!("no solution: {reason}")));
            break;
        }
        // Largest ‖ε(u_n)‖ and ‖σ_n‖ of the truth; the latter measures pressures too.
        let (mut sizes, d) = ([f64::MIN_POSITIVE; 2], data.space.mesh.dimension);
        for &t in setup.grid(record.steps).times() {
            let moments = data.truth.moments(t)?;
            for (size, field) in sizes.iter_mut().zip([&moments.strain, &moments.stress]) {
                let tensors = data.space.points().zip(field.at.chunks_exact(d * (d + 1) / 2));
                let square: f64 = tensors.map(|(at, tensor)| at.weight * dot(tensor, tensor)).sum();
                *size = size.max(square.sqrt());
            }
        }
        for NormError { norm, error, .. } in &record.errors {
            let size = sizes[usize::from(norm != judge::record::V_MAX)];
            let relative = error.unwrap_or(f64::NAN) / size;
            if worst.as_ref().is_none_or(|(most, ..)| relative > *most || relative.is_nan()) {
                let note = format!("{norm} is {relative:.1e} of the solution");
                worst = Some((relative, norm, note));
            }
        }
    }
    let Some((left, norm, note)) = worst else { return Ok(()) };
    let statement = Statement { source: "exact", says: "error / solution <= 1e-9" };
    let comma = if norm.is_empty() { "" } else { ", " };
    let place = Place { at: format!("{}{comma}{norm}", outcome.name), ..Place::default() };
    outcome.claim = Claim { note, ..Claim::at_most(statement, place, [left, EXACT_WITHIN], 0.0) };
    let holds = outcome.claim.standing() == Standing::Passes;
    outcome.decision = if holds { Decision::Pass } else { Decision::Fail };
    Ok(())
}

// From trials to a culprit: what takes part wherever something fails, and least often where all is well.

/// Whom the trials convict.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// One of these alone explains every failure; more than one where no trial tells them apart.
    One(Vec<Suspect>),
    /// No single suspect takes part in every failed trial without one that passes; these two together do.
    Two(Suspect, Suspect),
    /// Trials fail, and no two suspects explain them.
    Unexplained,
    NothingFails,
    /// What the scene predicts, not its solver: the errors are those that the exact solution has.
    Prediction,
}

/// The suspects of which one takes part in every failed trial, and in the fewest that pass; or two of
/// which one does, and neither in any that passes.
///
/// A defect in a term that a solution does not excite passes, so a passed trial speaks against a suspect
/// without acquitting it; a failed trial acquits whatever did not take part. Trials that are unresolved
/// or could not be run say nothing.
pub fn culprit(outcomes: &[Outcome]) -> Finding {
    let with = |decision: Decision| outcomes.iter().filter(move |o| o.decision == decision);
    if with(Decision::Fail).next().is_none() {
        return Finding::NothingFails;
    }
    // What every run has explains every failure, and is suspected only if a run with nothing else fails.
    let everywhere = [Suspect::Elasticity, Suspect::Loads];
    let apart = |suspect: &Suspect| everywhere.contains(suspect) || *suspect == Suspect::Space;
    let bare_fails = with(Decision::Fail).any(|outcome| outcome.suspects.iter().all(apart));
    let suspected = Suspect::ALL.iter().map(|(suspect, ..)| *suspect);
    let suspected = suspected.filter(|suspect| bare_fails || !everywhere.contains(suspect));
    let suspected: Vec<Suspect> = suspected.collect();
    // In how many trials that pass some of them take part, where some do in each that fails.
    let explains = |suspects: &[Suspect]| {
        let takes_part = |o: &&Outcome| suspects.iter().any(|suspect| o.suspects.contains(suspect));
        let all = with(Decision::Fail).all(|outcome| takes_part(&outcome));
        all.then(|| with(Decision::Pass).filter(takes_part).count())
    };
    let single = suspected.iter().filter_map(|&one| Some((explains(&[one])?, one)));
    let single: Vec<(usize, Suspect)> = single.collect();
    let pairs = suspected.iter().flat_map(|&a| suspected.iter().map(move |&b| (a, b)));
    let pairs = pairs.filter(|(a, b)| a < b);
    let pair = pairs.filter_map(|(a, b)| Some((explains(&[a, b])?, a, b))).min();
    match (single.iter().min(), pair) {
        // Two that are never sound go before one that is: each of the two has failed without the other.
        (Some(&(1.., _)), Some((0, a, b))) | (None, Some((_, a, b))) => Finding::Two(a, b),
        (Some(&(fewest, _)), _) => {
            let least = single.into_iter().filter(|(passes, _)| *passes == fewest);
            Finding::One(least.map(|(_, suspect)| suspect).collect())
        }
        (None, None) => Finding::Unexplained,
    }
}

/// The finding in one sentence.
pub fn sentence(finding: &Finding, outcomes: &[Outcome]) -> String {
    let none = "not among the terms";
    let (head, said) = match finding {
        Finding::NothingFails => (none, "every variant shows what it must".into()),
        Finding::Prediction => (none, "the prediction is wrong, the program is sound".into()),
        Finding::Unexplained => (none, "the trials that fail have nothing in common".into()),
        Finding::Two(a, b) => ("culprits", format!("{}, and {}", a.words(), b.words())),
        Finding::One(convicted) => match convicted[..] {
            [one] => ("culprit", format!("{} ({})", one.words(), evidence(one, outcomes))),
            _ => {
                let names: Vec<&str> = convicted.iter().map(|suspect| suspect.words()).collect();
                let is_term = convicted.iter().any(|suspect| suspect.is_term());
                let said = format!("{} (no trial tells them apart)", names.join("; or "));
                (if is_term { "culprit" } else { none }, said)
            }
        },
    };
    format!("{head}: {said}")
}

/// What removal restores, or which trials fail.
fn evidence(suspect: Suspect, outcomes: &[Outcome]) -> String {
    let all = outcomes.iter().find(|outcome| outcome.removed.is_none());
    let removed = outcomes.iter().find(|outcome| outcome.removed == Some(suspect));
    if let (Some(all), Some(removed)) = (all, removed)
        && all.decision == Decision::Fail
        && removed.decision == Decision::Pass
    {
        return format!("removing it restores {}; with it {}", removed.shown(), all.shown());
    }
    let failed = |outcome: &&Outcome| outcome.decision == Decision::Fail;
    let names: Vec<&str> =
        outcomes.iter().filter(failed).map(|outcome| outcome.name.as_str()).collect();
    format!("what fails has it: {}", names.join("; "))
}

impl Outcome {
    /// What was observed, in a few words.
    fn shown(&self) -> String {
        let Claim { statement, left, note, .. } = &self.claim;
        match self.claim.relation {
            Relation::Order(..) if !left.is_nan() => {
                statement.source.replacen("order", &format!("order {left:.2}"), 1)
            }
            Relation::AtMost(_) if self.decision == Decision::Pass => "exactness".to_owned(),
            _ => note.clone(),
        }
    }
}

impl Finding {
    /// Their names in JSON.
    pub fn culprits(&self) -> Vec<&'static str> {
        match self {
            Self::One(suspects) => suspects.iter().map(|suspect| suspect.name()).collect(),
            Self::Two(a, b) => vec![a.name(), b.name()],
            Self::Prediction => vec!["prediction"],
            Self::Unexplained | Self::NothingFails => Vec::new(),
        }
    }
}
