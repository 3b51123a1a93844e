//! Source: Theorem 7 on u(t) in V^h; the exactness of the trapezoidal rule on linear integrands.
//! Goal: a defect of the solver is named by the term whose removal restores the prediction; of a sound solver nothing
//!   is said on any judged scene of the contact problem.
//! Data: shipped scenes, `affine` with λ = 2 μ_L where Lamé's numbers matter.

use std::sync::Arc;

use crate::shipped::{edited, scene_of, text};
use crate::wrong::{Weights, first_whole, lagged, nothing_at_zero, rectangle, scheme, see_kernels};
use fem::contact::{CaseError, CaseInfo, Load, LoadError, MemoryTerm, Observer, march};
use formula::{EvaluationPoint, Variable};
use judge::claim::Claim;
use judge::verdict::Decision;
use scene::setup::{MeshData, Setup, TruthLoad, YieldFormula};
use scene::{Data, Extension, Registry, Scene};
use studies::diagnose::{Finding, Outcome, Suspect, culprit, diagnose, examine, sentence};
use vhi::Newton;
use vhi::history::TimeGrid;
use vhi::law::{
    AnyProjection, Isotropic, MemoryKernel, PiecewiseLinear, Potential, Singular, VonMises,
};

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

fn with_rule(mut setup: Setup, weights: fn(&TimeGrid, usize, usize) -> f64) -> Setup {
    setup.model.time_rule = Box::new(Weights(weights));
    setup
}

fn with_kernel(mut setup: Setup, seen: fn(&dyn MemoryKernel, f64) -> f64) -> Setup {
    see_kernels(&mut setup.model, seen);
    setup
}

/// A kernel with another power.
fn with_power(mut setup: Setup, power: f64) -> Setup {
    struct Factor(Box<dyn MemoryKernel>);
    impl MemoryKernel for Factor {
        fn value(&self, lag: f64) -> f64 {
            self.0.factor(lag)
        }
    }
    let changed = |MemoryTerm { kernel, tensor }| {
        let factor = Box::new(Factor(kernel));
        MemoryTerm { kernel: Box::new(Singular { power, factor }), tensor }
    };
    let replaced = |term: MemoryTerm| if term.kernel.power() > 0.0 { changed(term) } else { term };
    setup.model.memory = setup.model.memory.into_iter().map(replaced).collect();
    setup
}

/// Points (r, p) of a law.
type Points = Vec<(f64, f64)>;

fn with_law(mut setup: Setup, law: fn(&[[f64; 2]]) -> Points) -> Setup {
    let written = setup.body.contact.first().and_then(|contact| contact.law.clone());
    if let (Some(boundary), Some(written)) = (setup.model.boundary.first_mut(), written) {
        let wrong =
            PiecewiseLinear::new(law(&written.points), written.slope_before, written.slope_after);
        boundary.potential = Arc::new(wrong.expect("a law")) as Arc<dyn Potential>;
    }
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

/// κ of the solver by the scene's formula with ζ replaced.
fn kappa(setup: &Setup, scale: f64, power_of_zeta: f64) -> YieldFormula {
    let mut graph = setup.scene.formulas.clone();
    let written = setup.body.material.projection.as_ref().expect("a projection").kappa;
    let zeta = graph.variable(Variable::Zeta);
    let (scale, power) = (graph.constant(scale), graph.constant(power_of_zeta));
    let bent = graph.pow(zeta, power);
    let seen = graph.mul(scale, bent);
    let wrong = graph.substitute(written, Variable::Zeta, seen);
    assert!(
        graph
            .evaluate(wrong, &EvaluationPoint { zeta: 1.0, ..EvaluationPoint::default() })
            .is_finite()
    );
    YieldFormula::new(&graph, wrong)
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

/// Newton's method that stops at a share of its residual's size.
fn loose(setup: Setup) -> Setup {
    let solver = Newton { rounding_units: 1e-6 / f64::EPSILON, ..Newton::default() };
    with_scheme(setup, move |setup, data, steps, observe| {
        data.march(setup, steps, &solver, observe)
    })
}

/// A march under loads that are changed, by the time and the first step.
struct Changed<'a> {
    sound: TruthLoad<'a>,
    factor: f64,
    late: f64,
}

impl Load for Changed<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        self.sound.assemble((t - self.late).max(0.0), out)?;
        out.iter_mut().for_each(|force| *force *= self.factor);
        Ok(())
    }
}

/// Loads times a factor, where the solution is not in V^h, and those of earlier in the step.
fn with_loads(setup: Setup, outside: f64, late: f64) -> Setup {
    with_scheme(setup, move |setup, data, steps, observe| {
        let inside = matches!(setup.body.data, Data::Exact { interpolated: true, .. });
        let (grid, factor) = (setup.grid(steps), if inside { 1.0 } else { outside });
        let sound = TruthLoad(&*data.truth);
        let mut load = Changed { sound, factor, late: late * grid.step(1) };
        march(&data.space, &setup.model, &grid, &mut load, &Newton::default(), observe)
    })
}

fn with_kappa(setup: Setup, scale: f64, power_of_zeta: f64) -> Setup {
    let limit = |sound: VonMises<YieldFormula>, setup: &Setup| VonMises {
        mu: sound.mu,
        limit: kappa(setup, scale, power_of_zeta),
    };
    with_projection(setup, limit)
}

type Hook = fn(Setup) -> Setup;

/// Scene, defect, its place, and how it is put in.
fn defects() -> Vec<(&'static str, &'static str, Suspect, Hook)> {
    use Suspect::*;
    vec![
        ("in-space", "rectangle rule", TimeRule, |s| with_rule(s, rectangle)),
        ("in-space", "last weight on the level before", TimeRule, |s| with_rule(s, lagged)),
        ("viscoelastic", "last weight on the level before", TimeRule, |s| with_rule(s, lagged)),
        ("affine", "first weight whole", TimeRule, |s| with_rule(s, first_whole)),
        ("pure-mild", "B(0) missing", Memory, |s| with_kernel(s, nothing_at_zero)),
        ("signorini", "kernel 5 % too large", Memory, |s| {
            with_kernel(s, |b, lag| 1.05 * b.value(lag))
        }),
        ("in-space", "kernel time shifted", Memory, |s| {
            with_kernel(s, |b, lag| b.value(lag + 0.01))
        }),
        ("pure-mild", "kappa constant", Accumulation, |s| with_kappa(s, 0.0, 1.0)),
        ("affine", "zeta squared", Accumulation, |s| with_kappa(s, 1.0, 2.0)),
        ("steady", "mu 2 % too large", Projection, |s| {
            with_projection(s, |p, _| VonMises { mu: 1.02 * p.mu, ..p })
        }),
        ("pure-strong", "mu 2 % too large", Projection, |s| {
            with_projection(s, |p, _| VonMises { mu: 1.02 * p.mu, ..p })
        }),
        ("compliance", "falling branch rises", Compliance, |s| {
            with_law(s, |points| {
                let mirrored = |&[r, p]: &[f64; 2]| (r, if r > 0.04 { 0.16 - p } else { p });
                points.iter().map(mirrored).collect()
            })
        }),
        ("in-space", "kink misplaced", Compliance, |s| {
            with_law(s, |points| points.iter().map(|&[r, p]| (1.1 * r, p)).collect())
        }),
        ("signorini", "gap ignored", Gap, |s| with_gap(s, |_| f64::INFINITY)),
        ("pure-mild", "gap 1 % too large", Gap, |s| with_gap(s, |g| 1.01 * g)),
        ("affine-locked", "gap 1 % too small", Gap, |s| with_gap(s, |g| 0.99 * g)),
        ("stiff", "Lame swapped", Elasticity, |mut s| {
            let swapped = |Isotropic { lambda, mu }| Isotropic { lambda: mu, mu: lambda };
            s.model.elasticity = s.model.elasticity.map(swapped);
            s
        }),
        ("signorini", "gap at every other vertex", Gap, |mut s| {
            for boundary in &mut s.model.boundary {
                let gap = std::mem::replace(&mut boundary.gap, Box::new(|_, _| f64::INFINITY));
                boundary.gap = Box::new(move |x, t| {
                    if (8.0 * x[0]).round() % 2.0 == 0.0 { f64::INFINITY } else { gap(x, t) }
                });
            }
            s
        }),
        ("viscoelastic", "elasticity 1 % too stiff", Elasticity, |mut s| {
            s.model.elasticity = s.model.elasticity.scaled(1.01);
            s
        }),
        ("steady", "loads too large outside V^h", Space, |s| with_loads(s, 1.5, 0.0)),
        ("compliance", "loads of the middle of the step", Loads, |s| with_loads(s, 1.0, 0.5)),
        ("pure-mild", "Newton ends at 1e-6", Solver, loose),
    ]
}

fn named(name: &str) -> Scene {
    match name {
        "stiff" => {
            scene_of(edited(&text("affine"), "\nlambda = 1.0\nmu_L", "\nlambda = 2.0\nmu_L"))
        }
        name => shipped_scene(name),
    }
}

#[test]
#[ignore = "seconds for each scene: make test-long"]
fn long_the_right_term_is_named() {
    let defects = defects();
    let mut right = 0;
    let mut table = Vec::new();
    for (name, defect, place, hook) in &defects {
        let start = std::time::Instant::now();
        let (outcomes, finding) = examine(&named(name), hook, true);
        let hit = finding == Finding::One(vec![*place]);
        right += usize::from(hit);
        show(&format!("{name}: {defect}"), &outcomes);
        table.push(format!(
            "{} {name:<14} {defect:<34} {:<12} {:.2} s {finding:?}",
            if hit { "named " } else { "MISSED" },
            place.name(),
            start.elapsed().as_secs_f64()
        ));
    }
    println!("{}\n{right} of {}", table.join("\n"), defects.len());
    assert!(defects.len() >= 10 && 10 * right >= 8 * defects.len());
}

/// The judged scenes with an exact solution that `diagnose` takes and that are among these.
fn nothing_is_said(among: &dyn Fn(&str) -> bool, at_least: usize) {
    let folder = crate::shipped::path("affine").parent().expect("a folder").to_owned();
    let registry = Registry::open(&folder).unwrap_or_else(|error| panic!("{error}"));
    let mut diagnosed = 0;
    for name in registry.names() {
        let scene = shipped_scene(name);
        let exact = scene.as_contact().is_some_and(|b| matches!(b.data, Data::Exact { .. }));
        let is_taken = scene.without(&[Extension::Friction], "", "").is_ok();
        if !exact || !scene.judge || !is_taken || !among(name) {
            continue;
        }
        let (outcomes, finding) = examine(&scene, &|setup| setup, false);
        show(&format!("{name}: sound"), &outcomes);
        assert_eq!(finding, Finding::NothingFails, "{name}");
        let passed = outcomes.iter().filter(|o| o.decision == Decision::Pass).count();
        assert!(2 * passed > outcomes.len(), "{name}: {passed} of {}", outcomes.len());
        diagnosed += 1;
    }
    assert!(diagnosed >= at_least, "{diagnosed} scenes");
}

#[test]
fn a_sound_solver_is_not_accused() {
    nothing_is_said(&|name| ["affine", "signorini", "steady"].contains(&name), 3);
}

/// Quadratic elements and kernels that are infinite at s = t: of a sound solver nothing is said, and defects have their names.
#[test]
#[ignore = "seconds for each defect: make test-long"]
fn long_quadratic_elements_and_singular_kernels_are_diagnosed() {
    nothing_is_said(&|name| ["quadratic-memory", "singular-contact"].contains(&name), 2);
    use Suspect::*;
    let defects: [(&str, Suspect, Hook); 6] = [
        ("quadratic-memory", Memory, |s| with_kernel(s, |b, lag| 1.02 * b.value(lag))),
        ("quadratic-memory", Projection, |s| {
            with_projection(s, |p, _| VonMises { mu: 1.02 * p.mu, ..p })
        }),
        ("quadratic-memory", Accumulation, |s| with_kappa(s, 1.0, 2.0)),
        ("quadratic-compliance", Compliance, |mut s| {
            for boundary in &mut s.model.boundary {
                let sound = std::mem::replace(&mut boundary.shift, Box::new(|_| 0.0));
                boundary.shift = Box::new(move |x| sound(x) + 0.01);
            }
            s
        }),
        ("singular-contact", Memory, |s| with_power(s, 0.45)),
        ("singular-contact", Gap, |s| with_gap(s, |g| 0.5 * g)),
    ];
    for (name, place, hook) in defects {
        let (outcomes, finding) = examine(&shipped_scene(name), &hook, false);
        show(name, &outcomes);
        // A scene whose only nonlinear term is at fault has no trial that acquits the iteration.
        let named = match &finding {
            Finding::One(suspects) => suspects.as_slice(),
            _ => &[],
        };
        let all = named.iter().all(|suspect| [place, Solver].contains(suspect));
        assert!(all && named.contains(&place), "{name}: {finding:?}");
    }
}

#[test]
#[ignore = "a minute: make test-long"]
fn long_a_sound_solver_is_not_accused_on_any_scene() {
    // It is `pure-box` on finer meshes.
    nothing_is_said(&|name| name != "pure-box-fine", 10);
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
