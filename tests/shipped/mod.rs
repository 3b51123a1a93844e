//! Shipped scenes for the tests: by name or from an edited text, and their marches.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fem::contact::{CaseError, CaseInfo, Discretization, Evolution, Model, StepView, march};
use fem::norms::{StepErrors, step_errors};
use scene::setup::{AbstractSetup, MeshData, Setup, Subject, TruthLoad};
use scene::{Body, Registry, Scene, Source};
use studies::study::StudyError;
use studies::theory::bound::run_to;
use vhi::{Newton, StepState};

/// The path of a shipped scene.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("manufactured/{name}.toml"))
}

/// Its text.
pub fn text(name: &str) -> String {
    std::fs::read_to_string(path(name)).expect("a shipped scene")
}

/// `text` with `from`, which must stand there exactly once, replaced by `to`.
pub fn edited(text: &str, from: &str, to: &str) -> String {
    assert_eq!(text.matches(from).count(), 1, "`{from}` must stand in the text once");
    text.replace(from, to)
}

/// A scene from a text that stands beside the shipped ones, or what is wrong with it.
fn read(text: String) -> Result<Scene, String> {
    let source = Source::from_text("manufactured/edited.toml", text);
    Scene::from_source(source).map_err(|error| error.to_string())
}

/// A scene from a text that stands beside the shipped ones.
pub fn scene_of(text: String) -> Scene {
    read(text).unwrap_or_else(|error| panic!("{error}"))
}

/// The same, ready to compute.
pub fn setup_of(text: String) -> Setup {
    Setup::new(scene_of(text)).unwrap_or_else(|error| panic!("{error}"))
}

/// A scene without a mesh, ready to compute.
pub fn abstract_of(text: String) -> AbstractSetup {
    AbstractSetup::new(scene_of(text)).unwrap_or_else(|error| panic!("{error}"))
}

/// What the reader or the set-up says of a text that one of them refuses.
#[track_caller]
pub fn refusal(text: String) -> String {
    let found = read(text).and_then(|scene| Subject::new(scene).map_err(|e| e.to_string()));
    found.map(drop).expect_err("a scene that is refused")
}

/// A shipped scene, ready to compute.
pub fn setup(name: &str) -> Setup {
    setup_of(text(name))
}

pub fn registry() -> Registry {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manufactured");
    Registry::open(&folder).unwrap_or_else(|error| panic!("{error}"))
}

/// All shipped scenes of a body that can be set up, one after the other: a setup takes some ten milliseconds.
pub fn bodies() -> impl Iterator<Item = Setup> {
    let registry = registry();
    let names: Vec<String> = registry.names().map(str::to_owned).collect();
    let scene = move |name: String| registry.load(&name).unwrap_or_else(|error| panic!("{error}"));
    let contact = names.into_iter().map(scene).filter(|s| matches!(s.body, Body::Contact(_)));
    contact.filter_map(|scene| Setup::new(scene).ok())
}

/// `setup` on a small mesh.
pub fn on_a_mesh(setup: &Setup) -> MeshData {
    let n = if setup.scene.dimension == 2 { 6 } else { 2 };
    // Scenes with regions or a mesh from a file do not have every n.
    let data = [n, 8, 4, 1, 2].into_iter().find_map(|n| MeshData::new(setup, n, None).ok());
    data.unwrap_or_else(|| panic!("{} has no mesh", setup.scene.name))
}

/// `setup` on the mesh n, without a reference run.
pub fn on_mesh(setup: &Setup, n: u32) -> MeshData {
    MeshData::new(setup, n, None).unwrap_or_else(|error| panic!("{error}"))
}

/// Marches `model`, which may differ from the model of `setup`, under the loads of `setup`.
pub fn run(
    setup: &Setup,
    model: &Model,
    data: &MeshData,
    steps: u32,
    mut see: impl FnMut(&StepView<'_>),
) -> Result<CaseInfo, CaseError> {
    let mut load = TruthLoad(&*data.truth);
    let grid = setup.grid(steps);
    march(&data.space, model, &grid, &mut load, &Newton::default(), &mut |view| {
        see(view);
        Ok(())
    })
}

/// The errors of every time level of `model` against the truth of `setup`.
pub fn errors(setup: &Setup, model: &Model, data: &MeshData, steps: u32) -> Vec<StepErrors> {
    let mut found = Vec::new();
    run(setup, model, data, steps, |view| {
        let moments = data.truth.moments(view.t).expect("the truth is finite");
        found.push(step_errors(&data.space, model, view, &moments));
    })
    .unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(found.len(), steps as usize + 1);
    found
}

/// max over n ≥ 0 of ‖ε(u_n - u_n^{kh})‖; NaN if one of them is.
pub fn v_max(setup: &Setup, model: &Model, data: &MeshData, steps: u32) -> f64 {
    let all = errors(setup, model, data, steps);
    all.iter().fold(0.0, |worst, e| if e.v.is_nan() || e.v > worst { e.v } else { worst })
}

/// |a - b| relative to |b|; for b = 0 anything but 0 is infinitely far.
pub fn relative(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { (a - b).abs() / b.abs() }
}

/// A fixture, a JSON document of values from outside.
pub fn fixture(name: &str) -> serde_json::Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/fixtures/{name}.json"));
    let text = std::fs::read_to_string(&path).expect("a fixture");
    serde_json::from_str(&text).expect("a fixture in JSON")
}

/// A number of a fixture; a missing one fails the test.
pub fn number(value: &serde_json::Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("the fixture has no number `{key}`: {value}"))
}

/// A change of the space on which a scene is solved.
pub type Change = fn(&mut Discretization);

/// Weights of the vertex rule of quadratic elements by the shares of a facet in its corners and its midpoints.
pub fn weigh_facets(space: &mut Discretization, [corner, middle]: [f64; 2]) {
    let (d, trace) = (space.mesh.dimension, &mut space.trace);
    trace.points.iter_mut().for_each(|point| point.weight = 0.0);
    for f in 0..trace.measure.len() {
        for (a, i) in trace.facet(f).to_vec().into_iter().enumerate() {
            let share = if a < d { corner } else { middle };
            trace.points[i as usize].weight += share * trace.measure[f];
        }
    }
}

/// V_max of a march on a changed space, measured on the sound one.
pub fn v_max_on_changed(
    setup: &Setup,
    n: u32,
    steps: u32,
    change: Change,
) -> Result<(f64, CaseInfo), CaseError> {
    let data = on_mesh(setup, n);
    let space = setup.space(n).unwrap_or_else(|error| panic!("{error}"));
    let mut space = Arc::into_inner(space).expect("nobody else has it");
    change(&mut space);
    let (mut load, mut worst) = (TruthLoad(&*data.truth), 0.0f64);
    let mut see = |view: &StepView<'_>| {
        let truth = data.truth.moments(view.t)?;
        worst = worst.max(step_errors(&data.space, &setup.model, view, &truth).v);
        Ok(())
    };
    let (grid, newton) = (setup.grid(steps), Newton::default());
    let info = march(&space, &setup.model, &grid, &mut load, &newton, &mut see)?;
    Ok((worst, info))
}

/// Displacements of quadratic triangles whose midpoints follow their corners: linear functions in place of quadratic ones.
pub fn midpoints_between_corners(space: &Discretization, u: &[f64]) -> Vec<f64> {
    let mut u = u.to_vec();
    for nodes in space.nodes.cells.chunks_exact(6) {
        for (middle, [a, b]) in [(3, [0, 1]), (4, [1, 2]), (5, [2, 0])] {
            let at = |a: usize| 2 * nodes[a] as usize;
            (0..2).for_each(|i| u[at(middle) + i] = 0.5 * (u[at(a) + i] + u[at(b) + i]));
        }
    }
    u
}

/// Runs to level `number`, leaves it open, and shows it with its solution.
pub fn at_level<T>(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    number: usize,
    see: impl FnOnce(&mut Evolution<'_>, StepState) -> Result<T, StudyError>,
) -> Result<T, StudyError> {
    let (grid, mut load) = (setup.grid(steps), TruthLoad(&*data.truth));
    let mut level = Evolution::new(&data.space, &setup.model, &grid, &mut load)?;
    let state = run_to(&mut level, number, |_, _, _| Ok(()))?;
    see(&mut level, state)
}
