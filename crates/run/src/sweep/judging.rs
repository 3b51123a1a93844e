//! From a scene's predictions to verdicts on records.

use super::plan::{CasePlan, ScenePlan};
use judge::fit::{AgainstReference, against_reference};
use judge::record::{CaseRecord, Key, Status, V_MAX};
use judge::verdict;
use judge::verdict::{
    Decision, FloorSource, Foreseen, ForeseenConstant, LeadingLine, MeshAndSteps, Verdict,
};
use leading_error::{Case, InTime, NoConstant, leading_errors, other_error};
use scene::setup::Subject;
use scene::{Data, Hypothesis, LoadForm, Prediction, Scene, Time, TimeGrid};

/// The verdicts of a scene; none if it is not judged. `foreseen` has predicted constants, of this scene and others.
pub fn judge_scene(
    scene: &Scene,
    records: &[CaseRecord],
    expected: &[Key],
    foreseen: &[ForeseenConstant],
) -> Vec<Verdict> {
    if !scene.judge {
        return Vec::new();
    }
    let one = |written: &Prediction| {
        let prediction = prediction(scene, written);
        let known = foreseen.iter().find(|known| {
            known.scene == scene.name
                && known.norm == prediction.norm
                && known.variable == prediction.variable
        });
        let other_error = known.and_then(|known| known.other_error);
        let prediction = verdict::Prediction { other_error, ..prediction };
        let known = known.map(|known| &known.foreseen);
        verdict::judge_foreseen(&scene.name, records, expected, &prediction, known, scene.expect)
    };
    let mut verdicts: Vec<Verdict> = scene.predicts.iter().map(one).collect();
    // Orders do not see a step that is off by a factor on every case.
    let of_scene = records.iter().filter(|record| record.scene == scene.name);
    if let Some(wrong) = of_scene.into_iter().find_map(|record| wrong_size(scene, record)) {
        for verdict in &mut verdicts {
            (verdict.order, verdict.complete) = (Decision::Fail, false);
            verdict.decision = Decision::Fail;
            verdict.reason = format!("{wrong}; {}", verdict.reason);
            verdict.next.clear();
        }
    }
    verdicts
}

/// A recorded h or k that is not that of the mesh or the grid of times, by the scene alone and not by what recorded it.
fn wrong_size(scene: &Scene, record: &CaseRecord) -> Option<String> {
    let h = record.n.zip(scene.as_contact()).map(|(n, body)| body.domain.h(n));
    let k = largest_step(&scene.time, record.steps);
    let wrong = |name: &str, recorded: f64, own: f64, of: &str| {
        // NaN is wrong as well; ends of steps are rounded.
        let same = (recorded / own - 1.0).abs() <= 1e-9;
        let key = record.key();
        (!same).then(|| format!("{key}: {name} = {recorded:?} is recorded, and {own:?} is {of}"))
    };
    let h = h.and_then(|h| wrong("h", record.h.unwrap_or(f64::NAN), h, "the size of its mesh"));
    h.or_else(|| wrong("k", record.k, k?, "the largest step of its grid"))
}

/// The largest step of a grid of N steps in closed form; of random steps that of their generator, unless nobody can have
/// run so many.
fn largest_step(time: &Time, steps: u32) -> Option<f64> {
    const MOST: u32 = 1 << 24;
    let one = 1.0 / f64::from(steps);
    match time.grid {
        TimeGrid::Uniform => Some(time.horizon * one),
        // t_j = T (j/N)^a: the last step, or the first if a < 1.
        TimeGrid::Graded { exponent } => {
            Some(time.horizon * one.powf(exponent).max(1.0 - (1.0 - one).powf(exponent)))
        }
        TimeGrid::Random { seed } if (1..=MOST).contains(&steps) => {
            Some(vhi::history::TimeGrid::random(time.horizon, steps, seed).largest_step())
        }
        TimeGrid::Random { .. } => None,
    }
}

/// The verdicts of a plan on its records: orders, and with `constants` their predicted constants.
pub fn judge_plan(plan: &ScenePlan, records: &[CaseRecord], constants: bool) -> Vec<Verdict> {
    if constants {
        judge_subject(&plan.subject, records, &plan.keys())
    } else {
        judge_scene(plan.scene(), records, &plan.keys(), &[])
    }
}

/// The verdicts on records with all that is known of a scene beforehand.
pub fn judge_subject(subject: &Subject, records: &[CaseRecord], expected: &[Key]) -> Vec<Verdict> {
    let scene = subject.scene();
    let mut foreseen = foresee(subject, records);
    let verdicts = judge_scene(scene, records, expected, &foreseen);
    if verdicts.iter().all(|verdict| verdict.decision == Decision::Pass) {
        return verdicts;
    }
    // What is not refined may be in the way.
    let mut known = InTime::default();
    for (line, written) in foreseen.iter_mut().zip(&scene.predicts) {
        let cases = line_places(scene, records, &prediction(scene, written));
        line.other_error = other_error(subject, written, &cases, &mut known);
    }
    judge_scene(scene, records, expected, &foreseen)
}

/// The predicted constants of a judged scene, on the recorded cases of its predictions.
pub fn foresee(subject: &Subject, records: &[CaseRecord]) -> Vec<ForeseenConstant> {
    if subject.scene().judge { constants(subject, records) } else { Vec::new() }
}

fn line_places(
    scene: &Scene,
    records: &[CaseRecord],
    prediction: &verdict::Prediction,
) -> Vec<Case> {
    let keys = verdict::line_keys(&scene.name, records, prediction);
    keys.iter().map(|key| Case { n: key.n, steps: key.steps }).collect()
}

/// The predicted constants of a scene, on the cases of a plan, before anything is solved.
pub fn foresee_plan(plan: &ScenePlan) -> Vec<ForeseenConstant> {
    // As if every case had an error: its size is in no constant.
    let measured = |case: &CasePlan| {
        let mut record = CaseRecord { status: Status::Converged, ..plan.unmeasured(case) };
        let errors = record.errors.iter_mut();
        errors.for_each(|entry| (entry.error, entry.floor) = (Some(1.0), Some(0.0)));
        record
    };
    constants(&plan.subject, &plan.cases.iter().map(measured).collect::<Vec<_>>())
}

fn constants(subject: &Subject, records: &[CaseRecord]) -> Vec<ForeseenConstant> {
    let (scene, mut known) = (subject.scene(), InTime::default());
    let one = |written: &Prediction| {
        let prediction = prediction(scene, written);
        let cases = line_places(scene, records, &prediction);
        let line = (written.norm, written.variable, written.order);
        let leading = match written.constant {
            true => leading_errors(subject, line, &cases, &mut known),
            false => Err(NoConstant::OptedOut),
        };
        let foreseen = match leading {
            Err(reason) => Foreseen::Nothing { not_predicted: reason.to_string() },
            Ok(leading) => {
                let tolerance = written.constant_within.unwrap_or(leading.tolerance);
                Foreseen::Leading(LeadingLine { tolerance, ..leading })
            }
        };
        let verdict::Prediction { norm, variable, .. } = prediction;
        ForeseenConstant { scene: scene.name.clone(), norm, variable, foreseen, other_error: None }
    };
    scene.predicts.iter().map(one).collect()
}

fn prediction(scene: &Scene, written: &Prediction) -> verdict::Prediction {
    // Nothing is integrated of exact fields in V^h or in ℝ^m, and a reference run has an error.
    let floor = match scene.as_contact().map(|body| &body.data) {
        None | Some(Data::Exact { interpolated: true, .. }) => FloorSource::Solver,
        Some(Data::Exact { form: LoadForm::Strong, .. }) => FloorSource::LoadQuadrature,
        Some(Data::Exact { .. }) => FloorSource::Quadrature,
        Some(_) => FloorSource::Reference,
    };
    verdict::Prediction {
        norm: written.norm.name().into(),
        variable: written.variable,
        order: written.order,
        order_k: written.order_k,
        at_least: written.at_least,
        exact: written.exact,
        why: written.why.clone(),
        window_n: written.window_n.or(scene.window_n),
        window_steps: written.window_steps.or(scene.window_steps),
        floor,
        reference: scene
            .sweep
            .as_ref()
            .and_then(|sweep| sweep.reference)
            .map(|run| MeshAndSteps { n: Some(run.n), steps: run.steps }),
        other_error: None,
        constant_owed: written.constant_within.is_some(),
        unique: ![Hypothesis::Smallness, Hypothesis::StepSize]
            .iter()
            .any(|hypothesis| scene.violates.contains(hypothesis)),
    }
}

// Error of the reference run of a scene with given loads, in V errors.

/// The order of `V_max` in h corrected for the reference, on the three finest meshes at the most steps. None for scenes
/// with an exact solution, or without three meshes of one ratio.
pub fn reference_error(plan: &ScenePlan, records: &[CaseRecord]) -> Option<AgainstReference> {
    let reference = plan.reference?;
    let steps = plan.cases.iter().map(|case| case.steps).max()?;
    let on_line = |record: &&CaseRecord| {
        record.scene == plan.scene().name
            && record.steps == steps
            && record.n.is_some_and(|n| n < reference.n)
    };
    let mut points: Vec<(f64, f64)> = records
        .iter()
        .filter(on_line)
        .filter_map(|record| {
            let entry = record.errors.iter().find(|entry| entry.norm == V_MAX)?;
            Some((1.0 / f64::from(record.n?), entry.error?))
        })
        .collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let last = points.last_chunk::<3>()?;
    against_reference(*last, 1.0 / f64::from(reference.n))
}

/// One line for the terminal.
pub fn reference_in_words(scene: &str, found: &AgainstReference) -> String {
    let AgainstReference { order, measured_order, reference_error, finest: [measured, whole] } =
        found;
    format!(
        "{scene}: V_max in h against its reference run: local order {measured_order:.2}, {order:.2} without the reference's own error of about {reference_error:.1e}; finest error {measured:.2e}, about {whole:.2e} with it"
    )
}
