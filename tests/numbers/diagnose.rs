//! Source: Theorem 7 on u(t) in V^h; the exactness of the trapezoidal rule on linear integrands.
//! Goal: a defect of the solver is named by the term whose removal restores the prediction; of a sound solver nothing
//!   is said on any judged scene of the contact problem. `make sabotage` diagnoses every defect of its catalogue.
//! Data: shipped scenes.

use crate::shipped::{edited, scene_of, text};
use crate::wrong::{nothing_at_zero, scheme, see_kernels};
use fem::contact::{CaseError, CaseInfo, Observer};
use judge::claim::Claim;
use judge::verdict::Decision;
use rayon::prelude::*;
use scene::setup::{MeshData, Setup, YieldFormula};
use scene::{Data, Extension, Registry, Scene};
use studies::diagnose::{Finding, Outcome, Suspect, culprit, diagnose, examine, sentence};
use vhi::Newton;
use vhi::law::{AnyProjection, MemoryKernel, VonMises};

fn shipped_scene(name: &str) -> Scene {
    scene_of(text(name))
}

fn show(defect: &str, outcomes: &[Outcome]) {
    println!("--- {defect}");
    for outcome in outcomes {
        let Outcome { name, terms, decision, claim, .. } = outcome;
        println!("  {name:<26} {terms:<44} {:<10} {}", decision.name(), claim.note);
    }
}

fn with_kernel(mut setup: Setup, seen: fn(&dyn MemoryKernel, f64) -> f64) -> Setup {
    see_kernels(&mut setup.model, seen);
    setup
}

fn with_gap(mut setup: Setup, seen: fn(f64) -> f64) -> Setup {
    for boundary in &mut setup.model.boundary {
        let gap = std::mem::replace(&mut boundary.gap, Box::new(|_, _| 0.0));
        boundary.gap = Box::new(move |x, t| seen(gap(x, t)));
    }
    setup
}

fn with_projection(
    mut setup: Setup,
    change: impl Fn(VonMises<YieldFormula>, &Setup) -> VonMises<YieldFormula>,
) -> Setup {
    let stated = setup.scene_projection().filter(|_| setup.model.projection.is_some());
    setup.model.projection = stated.map(|sound| AnyProjection::new(change(sound, &setup)));
    setup
}

fn with_scheme<F>(setup: Setup, march: F) -> Setup
where
    F: Fn(&Setup, &MeshData, u32, &mut Observer<'_>) -> Result<CaseInfo, CaseError>
        + Send
        + Sync
        + 'static,
{
    Setup { scheme: scheme(march), ..setup }
}

/// The judged scenes with an exact solution that `diagnose` takes and that are among these.
fn nothing_is_said(among: &dyn Fn(&str) -> bool, at_least: usize) {
    let folder = crate::shipped::path("affine").parent().expect("a folder").to_owned();
    let registry = Registry::open(&folder).unwrap_or_else(|error| panic!("{error}"));
    let of = |name: &str| {
        let scene = shipped_scene(name);
        let exact = scene.as_contact().is_some_and(|b| matches!(b.data, Data::Exact { .. }));
        let is_taken = scene.without(&[Extension::Friction], "", "").is_ok();
        (exact && scene.judge && is_taken && among(name)).then_some(scene)
    };
    let scenes: Vec<Scene> = registry.names().filter_map(of).collect();
    scenes.par_iter().for_each(|scene| {
        let name = &scene.name;
        let (outcomes, finding) = examine(scene, &|setup| setup, false);
        show(&format!("{name}: sound"), &outcomes);
        assert_eq!(finding, Finding::NothingFails, "{name}");
        let passed = outcomes.iter().filter(|o| o.decision == Decision::Pass).count();
        assert!(2 * passed > outcomes.len(), "{name}: {passed} of {}", outcomes.len());
    });
    assert!(scenes.len() >= at_least, "{} scenes", scenes.len());
}

#[test]
fn a_sound_solver_is_not_accused() {
    nothing_is_said(&|name| ["affine", "signorini", "steady"].contains(&name), 3);
}

#[test]
#[ignore = "a minute: make test-long"]
fn long_a_sound_solver_is_not_accused_on_any_scene() {
    // It is `pure-box` on finer meshes.
    nothing_is_said(&|name| name != "pure-box-fine", 80);
}

/// The verdicts of the scene decide whether there is something to diagnose; the sentence says what removal restores.
#[test]
#[ignore = "sweeps in space: make test-long"]
fn long_the_sentence_names_what_removal_restores() {
    let scene = shipped_scene("in-space");
    let no_end = |s| with_kernel(s, nothing_at_zero);
    let found = diagnose(&scene, &no_end, false).unwrap_or_else(|error| panic!("{error}"));
    println!("{}", found.sentence);
    assert!(!found.verdicts.iter().all(|verdict| verdict.as_expected()));
    let words =
        "culprit: the memory term B (removing it restores order 2.00 in k; with it order 1.0";
    assert!(found.sentence.starts_with(words), "{}", found.sentence);
    let sound = diagnose(&scene, &|setup| setup, false).unwrap_or_else(|error| panic!("{error}"));
    assert!(sound.outcomes.is_empty() && sound.finding.is_none());
    assert!(sound.sentence.starts_with("nothing to diagnose"), "{}", sound.sentence);
}

/// Two defects: no term takes part in all that fails.
#[test]
fn two_culprits_are_two() {
    let both = |s: Setup| {
        let s = with_projection(s, |p, _| VonMises { mu: 1.02 * p.mu, ..p });
        with_gap(s, |gap| 0.99 * gap)
    };
    let (outcomes, finding) = examine(&shipped_scene("steady"), &both, false);
    show("steady: mu and gap", &outcomes);
    println!("{}", sentence(&finding, &outcomes));
    assert_eq!(finding, Finding::Two(Suspect::Projection, Suspect::Gap));
}

/// A solver that panics has failed; it does not end the diagnosis.
#[test]
fn a_panic_is_a_failed_trial() {
    let panics = |setup: Setup| {
        with_scheme(setup, |setup, data, steps, observe| {
            assert!(setup.model.memory.is_empty(), "seeded");
            data.march(setup, steps, &Newton::default(), observe)
        })
    };
    let (_, finding) = examine(&shipped_scene("affine"), &panics, false);
    assert_eq!(finding, Finding::One(vec![Suspect::Memory]));
}

/// An outcome as the inference sees it.
fn outcome(suspects: &[Suspect], decision: Decision) -> Outcome {
    Outcome {
        name: "a trial".into(),
        terms: String::new(),
        removed: None,
        suspects: suspects.to_vec(),
        decision,
        claim: Claim::default(),
    }
}

/// The inference on made-up trials: what takes part in all that fails and in the least that passes.
#[test]
fn the_inference_is_by_elimination() {
    use Decision::{Fail, Pass, Unresolved};
    use Suspect::*;
    let found = |trials: &[(&[Suspect], Decision)]| {
        let outcomes: Vec<Outcome> = trials.iter().map(|(s, d)| outcome(s, *d)).collect();
        culprit(&outcomes)
    };
    let one = |suspect: Suspect| Finding::One(vec![suspect]);
    let both: &[Suspect] = &[Memory, Gap, Elasticity, Loads];
    let (memory, gap): (&[Suspect], &[Suspect]) =
        (&[Memory, Elasticity, Loads], &[Gap, Elasticity, Loads]);
    assert_eq!(found(&[(both, Pass), (memory, Pass)]), Finding::NothingFails);
    assert_eq!(found(&[(both, Fail), (gap, Pass)]), one(Memory));
    assert_eq!(found(&[(both, Fail), (memory, Fail), (gap, Pass)]), one(Memory));
    // What every run has is not accused while a run without the terms is sound.
    assert_eq!(
        found(&[(both, Fail), (&[Elasticity, Loads], Pass)]),
        Finding::One(vec![Memory, Gap])
    );
    // Neither an unresolved trial nor one that could not be run says anything.
    assert_eq!(found(&[(both, Fail), (gap, Pass), (memory, Unresolved)]), one(Memory));
    assert_eq!(found(&[(memory, Unresolved)]), Finding::NothingFails);
    // Each term fails alone: two, or what they share.
    assert_eq!(found(&[(memory, Fail), (gap, Fail)]), Finding::Two(Memory, Gap));
    let rule: &[Suspect] = &[Accumulation, TimeRule, Elasticity, Loads];
    let with_rule: &[Suspect] = &[Memory, TimeRule, Elasticity, Loads];
    assert_eq!(found(&[(rule, Fail), (with_rule, Fail)]), one(TimeRule));
    // The bare run fails: elasticity, whose loads were acquitted.
    assert_eq!(found(&[(both, Fail), (&[Elasticity], Fail)]), one(Elasticity));
    let three: [&[Suspect]; 3] = [&[Memory], &[Gap], &[Projection]];
    assert_eq!(found(&three.map(|s| (s, Fail))), Finding::Unexplained);
}

/// r^0.7447 is not in H²: what the trials ask of it is an order, and no constant from interpolation.
#[test]
fn a_singular_solution_is_asked_for_its_order_alone() {
    let four = edited(&text("corner"), "n = [24, 48, 96]", "n = [12, 24, 48, 96]");
    let found = diagnose(&scene_of(four), &|setup| setup, true).unwrap_or_else(|e| panic!("{e}"));
    show("corner", &found.outcomes);
    assert_eq!(found.finding, Some(Finding::NothingFails), "{}", found.sentence);
    let order = found.outcomes.iter().find(|outcome| outcome.name == "all terms, in h");
    let order = order.expect("a trial in h");
    assert_eq!(order.decision, Decision::Pass, "{}", order.claim.note);
    assert!(!order.claim.note.contains("C_h"), "{}", order.claim.note);
    // Of a smooth solution the constant is asked for.
    let smooth = diagnose(&shipped_scene("viscoelastic"), &|setup| setup, true).expect("a scene");
    let order = smooth.outcomes.iter().find(|outcome| outcome.name == "all terms, in h");
    assert!(order.is_some_and(|order| order.claim.note.contains("C_h is ")));
}
