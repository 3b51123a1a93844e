//! Source: a gate that cries wolf is switched off.
//! Goal: the whole gate over seeded perturbations of what no prediction rests on (meshes, levels of refinement, time
//!   grids, numbers of threads): no verdict of the sound program fails, fewer than 2 % are unresolved; a wrong time rule
//!   in one run is counted as failures.
//! Data: all judged scenes that are not marked long. `make false-alarms` runs 200 perturbations, the tests
//!   three of the scenes judged in time.

mod perturbed;
mod program;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

use files::fnv_1a;
use judge::verdict::{Decision, Verdict};
use perturbed::{Draws, perturbed};
use program::Folder;
use run::sweep::{Machine, OutputDirectory, Overrides, ScenePlan, foresee, judge_scene, run_sweep};
use scene::setup::Subject;
use scene::{Direction, Registry, Scene};
use vhi::history::{TimeGrid, TimeRule};

/// Largest share of unresolved verdicts.
const UNRESOLVED: f64 = 0.02;

/// Changes what is solved, never what is predicted.
type Defect = fn(&mut Subject);

/// One verdict of one run.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
struct Outcome {
    run: u64,
    scene: String,
    norm: String,
    variable: String,
    predicted: f64,
    observed: Option<f64>,
    lo: Option<f64>,
    hi: Option<f64>,
    verdict: String,
    as_expected: bool,
    /// n and N of the sweep.
    levels: String,
    reason: String,
}

fn judged() -> Vec<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manufactured");
    let registry = Registry::open(&folder).unwrap_or_else(|error| panic!("{error}"));
    let load = |name: &str| registry.load(name).unwrap_or_else(|error| panic!("{error}"));
    registry.names().map(load).filter(|scene| scene.judge && !scene.long).collect()
}

fn gate(scenes: &[Scene], seed: u64, defect: Option<Defect>) -> Vec<Outcome> {
    let threads = 1 + Draws::new(seed, "threads").below(3);
    let plan = |scene: &Scene| {
        let name = scene.name.clone();
        let mut subject = Subject::new(perturbed(scene.clone(), seed))
            .unwrap_or_else(|error| panic!("run {seed}, {name}: {error}"));
        if let Some(defect) = defect {
            defect(&mut subject);
        }
        pruned(ScenePlan::new(subject, &Overrides::default()))
    };
    let plans: Vec<ScenePlan> = scenes.iter().map(plan).collect();
    let folder = Folder::new("false-alarms");
    let out = OutputDirectory::take(&folder.at("run")).unwrap_or_else(|error| panic!("{error}"));
    let records = run_sweep(&plans, &out, &Machine::with_jobs(threads), false, &())
        .unwrap_or_else(|error| panic!("run {seed}: {error}"));
    let judge = |plan: &ScenePlan| -> Vec<Outcome> {
        judge_scene(plan.scene(), &records, &plan.keys(), &foresee(&plan.subject, &records))
            .iter()
            .map(|verdict| outcome(seed, plan.scene(), verdict))
            .collect()
    };
    plans.iter().flat_map(judge).collect()
}

/// Without the cases that no prediction rests on: of a grid, one line in h, of as few steps as keep the time error below
/// the space error's interval, and the mesh on which the time error is judged.
fn pruned(mut plan: ScenePlan) -> ScenePlan {
    let window = plan.scene().predicts.iter().find_map(|prediction| prediction.window_n);
    let most = plan.cases.iter().map(|case| case.steps).max();
    let enough = plan.cases.iter().map(|case| case.steps).filter(|&steps| steps >= ENOUGH).min();
    let finest = plan.cases.iter().filter_map(|case| case.n).max();
    let judged = window.map_or(finest, |window| Some(window[0]));
    let line = enough.or(most);
    let in_time = plan.scene().predicts.iter().any(|p| p.variable != Direction::H);
    plan.cases.retain(|case| Some(case.steps) == line || (in_time && case.n == judged));
    plan
}

/// Steps of the line in h of a scene that has several: at N = 16 the time error of pure-mild is 1.5 % of the space error
/// on its finest mesh.
const ENOUGH: u32 = 16;

fn outcome(run: u64, scene: &Scene, verdict: &Verdict) -> Outcome {
    let sweep = scene.sweep.as_ref().expect("a judged scene has a sweep");
    Outcome {
        run,
        scene: verdict.scene.clone(),
        norm: verdict.norm.clone(),
        variable: verdict.variable.name().into(),
        predicted: verdict.predicted,
        observed: verdict.observed,
        lo: verdict.interval.map(|interval| interval[0]),
        hi: verdict.interval.map(|interval| interval[1]),
        verdict: verdict.decision.name().into(),
        as_expected: verdict.as_expected(),
        levels: format!("n {:?} N {:?} {:?}", sweep.n, sweep.steps, scene.time.grid),
        reason: verdict.reason.clone(),
    }
}

/// Verdicts, those that failed, and those unresolved, of scenes that must pass; any other verdict than the expected one
/// of the rest is a failure too.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Count {
    verdicts: usize,
    failed: usize,
    unresolved: usize,
}

impl Count {
    fn of<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Self {
        outcomes.into_iter().fold(Self::default(), |count, outcome| {
            let open = outcome.verdict == Decision::Unresolved.name();
            Self {
                verdicts: count.verdicts + 1,
                failed: count.failed + usize::from(!outcome.as_expected && !open),
                unresolved: count.unresolved + usize::from(!outcome.as_expected && open),
            }
        })
    }
}

/// One line a prediction, and what was not as expected.
fn table(outcomes: &[Outcome]) -> String {
    let mut groups: BTreeMap<(&str, &str, &str), Vec<&Outcome>> = BTreeMap::new();
    for outcome in outcomes {
        let key = (&*outcome.scene, &*outcome.norm, &*outcome.variable);
        groups.entry(key).or_default().push(outcome);
    }
    let mut text = String::from("scene, norm, variable, verdicts, failed, unresolved, observed\n");
    for ((scene, norm, variable), group) in &groups {
        let Count { verdicts, failed, unresolved } = Count::of(group.iter().copied());
        let orders = group.iter().filter_map(|outcome| outcome.observed);
        let (lo, hi) = orders.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), order| {
            (lo.min(order), hi.max(order))
        });
        let _ = writeln!(
            text,
            "{scene}, {norm}, {variable}, {verdicts}, {failed}, {unresolved}, {lo:.3} to {hi:.3}"
        );
    }
    for outcome in outcomes.iter().filter(|outcome| !outcome.as_expected) {
        let Outcome { run, scene, norm, variable, verdict, levels, reason, .. } = outcome;
        let _ =
            writeln!(text, "{verdict}: run {run}, {scene} {norm} {variable}: {reason} [{levels}]");
    }
    text
}

/// Runs of the scenes judged in time alone, which cost little: the harness and these scenes stay fit for the long run.
#[test]
#[ignore = "a minute: make test-long"]
fn long_a_perturbed_gate_passes() {
    let mut scenes = judged();
    scenes.retain(|scene| scene.predicts.iter().all(|p| p.variable == Direction::K));
    let outcomes = gate(&scenes, 0, None);
    let count = Count::of(&outcomes);
    println!("{}", table(&outcomes));
    assert!(count.verdicts >= 20, "{count:?}");
    assert_eq!(count.failed, 0);
    // Of one run, 2 % is no measure: one of twenty may be open.
    assert!(count.unresolved <= 1, "{count:?}");
}

/// Left-hand rectangle rule: order 1.
struct Rectangle;

impl TimeRule for Rectangle {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        if j < n { grid.step(j + 1) } else { 0.0 }
    }
}

#[test]
fn a_wrong_time_rule_is_counted_as_failures() {
    let scenes: Vec<Scene> =
        judged().into_iter().filter(|scene| scene.name.starts_with("affine")).collect();
    let sound = Count::of(&gate(&scenes, 1, None));
    assert_eq!((sound.failed, sound.unresolved), (0, 0), "{sound:?}");
    let found = Count::of(&gate(
        &scenes,
        1,
        Some(|subject| {
            let Subject::Contact(setup) = subject else { panic!("a body") };
            setup.model.time_rule = Box::new(Rectangle);
        }),
    ));
    // Every scene of this family is judged in time, in every norm.
    assert!(found.verdicts >= scenes.len() && found.failed == found.verdicts, "{found:?}");
}

/// Where the runs of this build on these scenes are kept, one file each: an interrupted `make false-alarms` goes on, and
/// another build starts anew.
fn kept(scenes: &[Scene]) -> PathBuf {
    let program = std::env::current_exe().and_then(std::fs::read).expect("this program");
    let texts = scenes.iter().flat_map(|scene| scene.source.text.as_bytes());
    let build = format!("{:016x}", fnv_1a(program.iter().chain(texts).copied()));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/false-alarms").join(build);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Scenes of more than a CPU second a run, two thirds of the whole: they take part in every fourth.
const DEAR: [&str; 9] = [
    "affine-random",
    "broken-trace",
    "in-space",
    "l-shape",
    "pure-mild",
    "pure-strong",
    "sourced",
    "sourced-box",
    "steady",
];

/// Run `seed` from its file, or computed and kept.
fn resumed(folder: &Path, scenes: &[Scene], seed: u64) -> Vec<Outcome> {
    let path = folder.join(format!("{seed}.json"));
    if let Ok(bytes) = std::fs::read(&path) {
        return serde_json::from_slice(&bytes).expect("a run, written in one piece");
    }
    let start = Instant::now();
    let takes_part = |scene: &&Scene| seed.is_multiple_of(4) || !DEAR.contains(&&*scene.name);
    let part: Vec<Scene> = scenes.iter().filter(takes_part).cloned().collect();
    let outcomes = gate(&part, seed, None);
    let bytes = serde_json::to_vec_pretty(&outcomes).expect("outcomes");
    files::replace_file(&path, &bytes).expect("a run");
    let Count { verdicts, failed, unresolved } = Count::of(&outcomes);
    let seconds = start.elapsed().as_secs_f64();
    eprintln!(
        "run {seed}: {verdicts} verdicts, {failed} failed, {unresolved} unresolved, {seconds:.0} s"
    );
    outcomes
}

/// `make false-alarms`; RUNS=40 for fewer, SCENES=affine,steady for some of the gate.
#[test]
#[ignore = "an hour"]
fn two_hundred_perturbed_gates_raise_no_alarm() {
    let runs = std::env::var("RUNS").map_or(200, |runs| runs.parse().expect("RUNS: a number"));
    let mut scenes = judged();
    if let Ok(names) = std::env::var("SCENES") {
        scenes.retain(|scene| names.split(',').any(|name| name == scene.name));
    }
    let folder = kept(&scenes);
    // Plain threads: a worker of a pool that waits for the pool of its sweep would begin another run meanwhile.
    let next = AtomicU64::new(0);
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(seed) = Some(next.fetch_add(1, Relaxed)).filter(|&seed| seed < runs)
                {
                    resumed(&folder, &scenes, seed);
                }
            });
        }
    });
    let outcomes: Vec<Outcome> =
        (0..runs).flat_map(|seed| resumed(&folder, &scenes, seed)).collect();
    let count = Count::of(&outcomes);
    println!("{}\n{runs} runs, {count:?}: {}", table(&outcomes), folder.display());
    assert_eq!(count.failed, 0, "false alarms");
    let share = count.unresolved as f64 / count.verdicts as f64;
    assert!(share < UNRESOLVED, "{:.2} % unresolved", 100.0 * share);
}
