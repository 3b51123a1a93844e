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

mod culprit;
mod outcome;
mod term;
mod trial;
mod variant;

use rayon::prelude::*;

pub use culprit::{Finding, culprit, sentence};
pub use outcome::{EXACT_WITHIN, Outcome, Prepare};
pub use term::Suspect;
pub(crate) use trial::{Trial, trials_in_space, trials_in_time};

use judge::claim::{Claim, Relation};
use judge::verdict::{Decision, Variable, Verdict};
use report::{Chapter, Findings, Row, Run, precise};
use run::sweep::{CasePlan, Cost, MemoryLimit, Overrides, Refused, ScenePlan, admit_plan};
use scene::setup::{SetupError, Subject};
use scene::{Body, Data, Direction, Extension, Scene};

/// What a diagnosis found.
#[derive(Debug, Clone)]
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
        verdicts: outcome::run_cases(scene.clone(), prepare, outcome::verdicts)?,
        outcomes: Vec::new(),
        finding: None,
        sentence: String::new(),
    };
    let wrongly: Vec<&Verdict> =
        found.verdicts.iter().filter(|verdict| !verdict.as_expected()).collect();
    let contradicted: Vec<String> =
        wrongly.iter().filter_map(|verdict| contradiction(verdict)).collect();
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
            outcome::order(of, "the scene", decision)
        };
        let says = |outcome: &&Outcome| outcome.decision != Decision::Unresolved;
        let trials = self.outcomes.iter().filter(says).map(|outcome| outcome.claim.clone());
        let claims: Vec<Claim> = self.verdicts.iter().map(verdict).chain(trials).collect();
        let [name, hash] = &self.scene;
        let title = (Chapter::Diagnose, format!("Which term is at fault: {name}"));
        let mut findings = Findings::new(title, Some([name, hash]), claims);
        findings.document.answer(self.sentence.clone());
        let row = |outcome: &Outcome| -> Row<'_, 5> {
            let claim = &outcome.claim;
            let asked = match claim.relation {
                Relation::Order(order, _) => format!("order ≥ {order}"),
                _ => format!("error below {EXACT_WITHIN:.0e}"),
            };
            [
                ("trial", Run::plain(&*outcome.name)),
                ("terms", Run::plain(&*outcome.terms)),
                ("must show", Run::plain(asked)),
                (">shows", precise(Some(claim.left).filter(|left| left.is_finite()), 3)),
                ("because", Run::plain(&*claim.note)),
            ]
        };
        findings.document.table("Variants of the scene.", self.outcomes.iter().map(row));
        findings.number("verdicts", &self.verdicts);
        findings.number("trials", &self.outcomes);
        findings.number("culprits", self.finding.as_ref().map_or(Vec::new(), Finding::culprits));
        findings.number("sentence", &self.sentence);
        findings
    }
}

/// Where the errors are those that the exact solution predicts, and the scene predicts another order of them.
fn contradiction(verdict: &Verdict) -> Option<String> {
    let Verdict { norm, variable, predicted, .. } = verdict;
    verdict.contradicted_by.map(|order| {
        format!(
            "{norm} has the errors of order {order:.2} in {} that the exact solution predicts, and [[predicts]] says {predicted}",
            variable.name()
        )
    })
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
    let first = |trials: Vec<Trial>| Some((trials.first()?.of(scene).ok()?, jobs));
    let ladders = [first(trials_in_time(scene)), first(trials_in_space(scene))];
    // Trials run side by side, and share no mesh.
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
        trials.par_iter().map(|trial| outcome::run(scene, trial, prepare)).collect()
    };
    let mut outcomes = run_all(trials_in_time(scene));
    let sound = outcomes.iter().all(|outcome| outcome.decision != Decision::Fail);
    let predicts_in_space = scene.predicts.iter().any(|p| p.variable != Direction::K);
    if in_space && sound && predicts_in_space {
        // All terms first: only where they fail the dearer ladder has something to tell.
        let mut ladder = trials_in_space(scene);
        let removals = ladder.split_off(1.min(ladder.len()));
        let all = run_all(ladder);
        let fails = all.iter().any(|outcome| outcome.decision == Decision::Fail);
        outcomes.extend(all);
        if fails {
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
