//! Source: the plan of the house (module order, independence of the manufactured side) and its habits.
//! Goal: imports run one way, the manufactured side names no law, history or solver, files stay short, every shipped
//!   scene is cited and predicts something if it is judged; the scanner itself is shown to catch violations.
//! Data: the files under src/ and manufactured/.

use std::path::{Path, PathBuf};

use gronwall::scene::{Registry, Scene};

/// Each module imports only those before it.
const ORDER: [&str; 28] = [
    "tensor",
    "record",
    "linalg",
    "mesh",
    "space",
    "law",
    "history",
    "vhi",
    "finite",
    "contact",
    "formula",
    "norms",
    "manufactured",
    "scene",
    "setup",
    "external",
    "leading_error",
    "solution",
    "fit",
    "verdict",
    "report",
    "sweep",
    "distributed",
    "trade",
    "theory",
    "diagnose",
    "extremes",
    "cli",
];

/// What a module may import where that is narrower than the order.
const ONLY: [(&str, &[&str]); 3] = [
    ("fit", &["record"]),
    ("verdict", &["record", "fit"]),
    ("report", &["record", "fit", "verdict"]),
];

/// The manufactured side evaluates σ, ζ and histories by itself; what predicts errors must not know the solver either.
const INDEPENDENT: [(&str, &[&str]); 2] = [
    ("manufactured", &["law", "history", "vhi"]),
    ("leading_error", &["law", "vhi", "finite", "norms", "record"]),
];

/// Of modules that both sides use, an independent side may take these items alone: none of them is a law, an assembly
/// or an integral of the problem (`src/manufactured/mod.rs` gives the reasons). Of `history` it is the random grid, of
/// `setup` the scene, its exact solution and the mesh; `.model` is refused by its name.
const SHARED: [(&str, &str, &[&str]); 5] = [
    ("manufactured", "contact", &["Discretization", "LoadError"]),
    ("leading_error", "contact", &["Discretization", "LoadError"]),
    ("leading_error", "history", &["TimeGrid"]),
    ("leading_error", "setup", &["AbstractSetup", "Setup", "Subject"]),
    (
        "manufactured",
        "norms",
        &[
            "CellConstants",
            "ContactSamples",
            "ContactState",
            "Moments",
            "Piecewise",
            "facet_samples",
            "is_locked",
            "linear_projection",
            "state_rule",
        ],
    ),
];

const LONGEST: usize = 400;

/// Paths into this crate that a text names: after `crate::`, after the `super::` that leave `module` (a file at
/// `depth` below src/, its module file counting as its folder), and inside braces after either.
fn paths(text: &str, depth: usize) -> Vec<String> {
    let mut found = Vec::new();
    let outward = "super::".repeat(depth);
    for line in without_comments(text) {
        for prefix in ["crate::", "gronwall::", outward.as_str()] {
            for (at, _) in line.match_indices(prefix).filter(|_| !prefix.is_empty()) {
                let before = line[..at].chars().next_back();
                if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                    continue;
                }
                found.extend(members(&line[at + prefix.len()..]));
            }
        }
    }
    found
}

/// Modules of this crate that a text names.
fn named(text: &str, depth: usize) -> Vec<String> {
    let mut found: Vec<String> = paths(text, depth).iter().map(|path| first(path)).collect();
    found.sort();
    found.dedup();
    found
}

/// Items of a module that a text names; the module itself and all of it are `*`.
fn items(module: &str, text: &str, depth: usize) -> Vec<String> {
    let within = |path: &String| {
        let rest = path.strip_prefix(module)?;
        (first(path) == module).then(|| match rest.strip_prefix("::") {
            Some(rest) => members(rest).iter().map(|item| first(item)).collect(),
            None => vec![String::new()],
        })
    };
    let names: Vec<String> = paths(text, depth).iter().filter_map(within).flatten().collect();
    names.into_iter().map(|name| if name.is_empty() { "*".into() } else { name }).collect()
}

/// The first name of a path.
fn first(path: &str) -> String {
    path.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// Members of a path: `a::b …` has itself, `{a::b, c}` has a::b and c.
fn members(path: &str) -> Vec<String> {
    let Some(list) = path.strip_prefix('{') else { return vec![path.to_owned()] };
    let (mut members, mut nested, mut start) = (Vec::new(), 0, 0);
    for (at, c) in list.char_indices() {
        match c {
            '{' => nested += 1,
            '}' if nested == 0 => {
                members.push(list[start..at].trim().to_owned());
                break;
            }
            '}' => nested -= 1,
            ',' if nested == 0 => {
                members.push(list[start..at].trim().to_owned());
                start = at + 1;
            }
            _ => {}
        }
    }
    members.retain(|member| !member.is_empty());
    members
}

/// Statements of a text on one line each (an import may run over several), comments left out.
fn without_comments(text: &str) -> Vec<String> {
    let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or("")).collect();
    code.join(" ").split(';').map(str::to_owned).collect()
}

/// What is wrong with the imports of a text in the module `own`.
fn violations(own: &str, text: &str, depth: usize) -> Vec<String> {
    let place = |name: &str| ORDER.iter().position(|module| *module == name);
    let mut wrong = Vec::new();
    for name in named(text, depth).iter().filter(|name| *name != own) {
        let Some(target) = place(name) else { continue };
        if place(own).is_none_or(|own| target > own) {
            wrong.push(format!("{own} names {name}, which comes after it"));
        }
        if ONLY.iter().any(|(module, list)| *module == own && !list.contains(&name.as_str())) {
            wrong.push(format!("{own} may not name {name}"));
        }
        let alone = |(side, list): &(&str, &[&str])| *side == own && list.contains(&name.as_str());
        if INDEPENDENT.iter().any(alone) {
            wrong.push(format!("{own} must not share {name} with the solver"));
        }
    }
    if own == "leading_error" && without_comments(text).iter().any(|line| line.contains(".model")) {
        wrong.push(format!("{own} must not read the solver's model"));
    }
    for (_, module, allowed) in SHARED.iter().filter(|(side, ..)| own == *side) {
        for item in items(module, text, depth) {
            if !allowed.contains(&item.as_str()) {
                wrong.push(format!("{own} must not share {module}::{item} with the solver"));
            }
        }
    }
    wrong
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files of a folder with an ending, sorted.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|own| own == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Sources of the library: path below src/, module, depth of the module, text.
fn sources() -> Vec<(String, String, usize, String)> {
    let src = root().join("src");
    let all = files(&src, "rs");
    assert!(all.len() > 100, "{} files", all.len());
    all.iter()
        .map(|path| {
            let below = path.strip_prefix(&src).expect("below src");
            let parts: Vec<String> =
                below.components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
            let module = parts[0].trim_end_matches(".rs").to_string();
            let is_module_file = parts.last().is_some_and(|last| last == "mod.rs");
            let depth = parts.len() - usize::from(is_module_file);
            let text = std::fs::read_to_string(path).expect("a source");
            (parts.join("/"), module, depth, text)
        })
        .collect()
}

#[test]
fn every_module_has_its_place() {
    for (path, module, _, _) in sources() {
        let known = ORDER.contains(&module.as_str()) || ["lib", "bin"].contains(&module.as_str());
        assert!(known, "src/{path}: the module {module} has no place in the order");
    }
}

#[test]
fn imports_run_one_way() {
    let mut wrong = Vec::new();
    for (path, module, depth, text) in sources() {
        if module != "lib" && module != "bin" {
            let found = violations(&module, &text, depth);
            wrong.extend(found.into_iter().map(|what| format!("src/{path}: {what}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn violations_are_caught() {
    let caught = |own: &str, text: &str, depth: usize| !violations(own, text, depth).is_empty();
    assert!(caught("vhi", "use crate::mesh::Mesh;\nuse crate::contact::Model;", 2));
    assert!(caught("vhi", "fn f() -> crate::contact::Model<()> { todo!() }", 2));
    assert!(caught("law", "use crate::{\n    tensor::norm,\n    vhi::Newton,\n};", 2));
    assert!(caught("law", "use super::super::vhi::Newton;", 2));
    assert!(caught("law", "use super::vhi::Newton;", 1));
    assert!(caught("fit", "use crate::mesh::Mesh;", 2));
    assert!(caught("report", "use crate::scene::Scene;", 2));
    assert!(caught("manufactured", "let w = crate::history::Trapezoid;", 2));
    assert!(caught("manufactured", "use crate::{formula::Node, law::Isotropic};", 2));
    assert!(caught("manufactured", "use crate::contact::{Discretization, stress_force};", 2));
    assert!(caught("manufactured", "use crate::{formula::Node, contact::{LoadError, Model}};", 2));
    assert!(caught("manufactured", "let f = crate::contact::stress_force::<2, 3>(g, n);", 2));
    assert!(caught("manufactured", "use crate::contact;", 2));
    assert!(caught("manufactured", "use crate::contact::*;", 2));
    assert!(caught("manufactured", "use super::super::norms::{Moments, step_errors};", 2));
    assert!(caught("leading_error", "use crate::law::Potential;", 2));
    assert!(caught("leading_error", "use crate::history::{TimeGrid, Trapezoid};", 2));
    assert!(caught("leading_error", "use crate::setup::{MeshData, Setup};", 2));
    assert!(caught("leading_error", "use crate::contact::stress_force;", 2));
    assert!(caught("leading_error", "let k = setup.model.memory;", 2));
    // And nothing else is.
    assert!(!caught("leading_error", "use crate::setup::Setup; // not its .model", 2));
    assert!(!caught("manufactured", "use crate::contact::{Discretization, LoadError};", 2));
    assert!(!caught("manufactured", "use crate::{norms::{Moments, is_locked}, mesh::Mesh};", 2));
    assert!(!caught("contact", "use crate::{law::{Isotropic, Potential}, vhi::Newton};", 2));
    assert!(!caught("law", "use super::vhi_like::Newton; // crate::vhi", 2));
    assert!(!caught("history", "use super::super::law::MemoryKernel;", 2));
    assert!(!caught("manufactured", "use super::exact::Exact;", 2));
}

#[test]
fn files_are_short() {
    let long = |lines: usize| lines > LONGEST;
    let found: Vec<String> = sources()
        .iter()
        .map(|(path, _, _, text)| (path, text.lines().count()))
        .filter(|(_, lines)| long(*lines))
        .map(|(path, lines)| format!("src/{path}: {lines} lines"))
        .collect();
    assert!(long(LONGEST + 1) && found.is_empty(), "{}", found.join("\n"));
}

/// What a scene lacks.
fn lacks(scene: &Scene) -> Vec<&'static str> {
    let comments: Vec<&str> =
        scene.source.text.lines().filter_map(|line| line.strip_prefix("# ")).collect();
    let said = |what: &str| comments.iter().any(|line| line.trim_start().starts_with(what));
    [
        (!said("Question: "), "a question"),
        (!said("Source: "), "a source"),
        (scene.judge && scene.predicts.is_empty(), "a prediction, though it is judged"),
        (scene.predicts.iter().any(|p| p.why.trim().is_empty()), "a theorem for a prediction"),
        (scene.judge && scene.sweep.is_none(), "grids to sweep, though it is judged"),
    ]
    .into_iter()
    .filter(|(lacking, _)| *lacking)
    .map(|(_, what)| what)
    .collect()
}

#[test]
fn shipped_scenes_are_complete() {
    let folder = root().join("manufactured");
    let registry = Registry::open(&folder).expect("scenes");
    let names: Vec<&str> = registry.names().collect();
    assert_eq!(names.len(), files(&folder, "toml").len());
    assert!(names.len() >= 13, "{names:?}");
    for name in names {
        let scene = registry.load(name).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(lacks(&scene), Vec::<&str>::new(), "{name}");
    }
}

#[test]
fn an_incomplete_scene_is_caught() {
    let mut scene = Registry::open(&root().join("manufactured"))
        .and_then(|registry| registry.load("steady"))
        .unwrap_or_else(|error| panic!("{error}"));
    scene.predicts.clear();
    scene.source.text = scene.source.text.replace("# Source: ", "# ");
    assert_eq!(lacks(&scene), ["a source", "a prediction, though it is judged"]);
}
