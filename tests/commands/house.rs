//! Source: the plan of the house (what each crate may know, the order of modules in a crate, independence of the
//!   manufactured side) and its habits.
//! Goal: crates and imports run one way, the manufactured side names no law, history or solver, files stay below 800 lines, every
//!   shipped scene is cited and predicts something if it is judged; the scanner itself is shown to catch violations.
//! Data: the files under crates/, src/ and manufactured/.

use std::path::PathBuf;

use scene::{Registry, Scene};

use crate::program::files_below;

/// What each crate may know, and the order of its modules: each imports those before it. The compiler sees to it that no
/// crate names another; this table, that nobody adds one to a Cargo.toml in passing.
const HOUSE: [(&str, &[&str], &[&str]); 14] = [
    ("files", &[], &[]),
    ("algebra", &[], &["tensor", "linalg"]),
    ("formula", &[], &[]),
    ("vhi", &["algebra"], &["law", "history", "finite"]),
    ("fem", &["algebra", "vhi"], &["mesh", "space", "contact", "norms"]),
    // σ, ζ and histories are evaluated apart from the solver: no law, no history, no inequality.
    ("exact", &["fem", "formula"], &[]),
    ("fit", &["files"], &[]),
    ("judge", &["files", "fit"], &["record", "table", "verdict"]),
    ("scene", &["algebra", "exact", "fem", "files", "formula", "judge", "vhi"], &["setup"]),
    ("guarantee", &["algebra", "exact", "fem", "formula", "scene", "vhi"], &[]),
    ("leading_error", &["algebra", "exact", "fem", "formula", "judge", "scene", "vhi"], &[]),
    (
        "run",
        &["algebra", "exact", "fem", "files", "formula", "judge", "leading_error", "scene", "vhi"],
        &["external", "sweep", "merge"],
    ),
    ("report", &["files", "judge"], &[]),
    (
        "studies",
        &[
            "algebra",
            "exact",
            "fem",
            "files",
            "formula",
            "guarantee",
            "judge",
            "report",
            "run",
            "scene",
            "vhi",
        ],
        &["portrait", "solution", "trade", "theory", "diagnose", "extremes"],
    ),
];

/// What must not know the solver, by crate or module, and of crates that both sides use the modules and items that it may
/// take alone: none of them is a law, an assembly or an integral of the problem (`crates/exact/src/lib.rs` gives the
/// reasons). Of `vhi` it is the random grid; `.model` of a setup is refused by its name.
const INDEPENDENT: [(&str, &str, &[&str]); 7] = [
    ("exact", "vhi", &[]),
    ("exact", "fem", FEM_OF_EXACT),
    (
        "leading_error",
        "judge",
        &["verdict::LeadingLine", "verdict::LeadingPoint", "verdict::MeshAndSteps"],
    ),
    ("leading_error", "vhi", &["history::TimeGrid"]),
    ("leading_error", "fem", FEM_OF_LEADING_ERROR),
    ("leading_error", "scene", &["setup::AbstractSetup", "setup::Setup", "setup::Subject", "*"]),
    ("judge", "fem", &[]),
];

/// `m::*` is all of a module; `*` all outside of modules that are named.
const FEM_OF_LEADING_ERROR: &[&str] =
    &["contact::Discretization", "contact::LoadError", "mesh::*", "space::*"];
const FEM_OF_EXACT: &[&str] = &[
    "contact::Discretization",
    "contact::LoadError",
    "mesh::*",
    "norms::AtPoints",
    "norms::ContactSamples",
    "norms::ContactState",
    "norms::Moments",
    "norms::Piecewise",
    "norms::facet_samples",
    "norms::is_locked",
    "norms::state_rule",
    "space::*",
];

const LONGEST: usize = 800;

/// Full paths that a text of a crate names in it and in others: `crate::a::b` is `name::a::b`, and what a `super::` that
/// leaves a module (a file at `depth` below src/, its module file counting as its folder) leads to.
fn paths(name: &str, text: &str, depth: usize) -> Vec<Vec<String>> {
    let outward = "super::".repeat(depth);
    let mut found = Vec::new();
    for line in without_comments(text) {
        let mut prefixes = vec![(String::from("crate::"), name)];
        if depth > 0 {
            prefixes.push((outward.clone(), name));
        }
        prefixes.extend(HOUSE.iter().map(|(other, ..)| (format!("{other}::"), *other)));
        for (prefix, named) in &prefixes {
            for (at, _) in line.match_indices(prefix.as_str()) {
                let before = line[..at].chars().next_back();
                if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                    continue;
                }
                for path in flat(&line[at + prefix.len()..]) {
                    found.push([vec![String::from(*named)], path].concat());
                }
            }
        }
    }
    found
}

/// The paths of `a::{b, c::d}` and the like, name by name.
pub(crate) fn flat(text: &str) -> Vec<Vec<String>> {
    if let Some(list) = text.strip_prefix('{') {
        return members(list).iter().flat_map(|member| flat(member)).collect();
    }
    let name: String =
        text.chars().take_while(|c| c.is_alphanumeric() || "_*".contains(*c)).collect();
    if name.is_empty() {
        return vec![vec![String::from("*")]];
    }
    match text[name.len()..].strip_prefix("::") {
        Some(rest) => {
            let below = flat(rest).into_iter();
            below.map(|path| [vec![name.clone()], path].concat()).collect()
        }
        None => vec![vec![name]],
    }
}

/// Members of a list up to the brace that closes it.
fn members(list: &str) -> Vec<String> {
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
pub(crate) fn without_comments(text: &str) -> Vec<String> {
    let code: Vec<&str> = text.lines().map(|line| line.split("//").next().unwrap_or("")).collect();
    code.join(" ").split(';').map(str::to_owned).collect()
}

/// What is wrong with the imports of a text in a module of a crate.
fn violations(of: &str, module: &str, text: &str, depth: usize) -> Vec<String> {
    let Some((_, known, order)) = HOUSE.iter().find(|(name, ..)| *name == of) else {
        return Vec::new();
    };
    let place = |name: &str| order.iter().position(|module| *module == name);
    let mut wrong = Vec::new();
    for path in paths(of, text, depth) {
        let (named, inside) = (&path[0], path[1..].join("::"));
        if *named == of {
            let target = path.get(1).and_then(|name| place(name));
            if place(module).zip(target).is_some_and(|(here, target)| target > here) {
                wrong.push(format!("{module} names {inside}, which comes after it"));
            }
            continue;
        }
        if !known.contains(&named.as_str()) {
            wrong.push(format!("{of} names {named}"));
        }
        for (side, shared, allowed) in INDEPENDENT {
            let within = path.get(1).map_or("*", String::as_str);
            let is_module =
                HOUSE.iter().any(|(name, _, modules)| name == named && modules.contains(&within));
            let taken = allowed.contains(&inside.as_str())
                || is_module && allowed.contains(&format!("{within}::*").as_str())
                || !is_module && within != "*" && allowed.contains(&"*");
            if [of, module].contains(&side) && shared == named && !taken {
                wrong.push(format!("{side} must not share {named}::{inside} with the solver"));
            }
        }
    }
    if of == "leading_error" && without_comments(text).iter().any(|line| line.contains(".model")) {
        wrong.push(format!("{of} must not read the solver's model"));
    }
    wrong
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A file of a crate.
pub(crate) struct Source {
    pub(crate) path: String,
    pub(crate) of: String,
    pub(crate) module: String,
    pub(crate) depth: usize,
    pub(crate) text: String,
}

/// Sources of all crates, those of the program as the crate "src".
pub(crate) fn sources() -> Vec<Source> {
    let mut found = Vec::new();
    let crates =
        HOUSE.iter().map(|(name, ..)| (*name, root().join("crates").join(name).join("src")));
    for (of, src) in crates.chain([("src", root().join("src"))]) {
        for path in files_below(&src, "rs") {
            let below = path.strip_prefix(&src).expect("below src");
            let parts: Vec<String> =
                below.components().map(|c| c.as_os_str().to_string_lossy().into_owned()).collect();
            let module = parts[0].trim_end_matches(".rs").to_string();
            let is_module_file =
                parts.last().is_some_and(|last| ["mod.rs", "lib.rs"].contains(&last.as_str()));
            let depth = parts.len() - usize::from(is_module_file);
            let text = std::fs::read_to_string(&path).expect("a source");
            let path = path.strip_prefix(root()).expect("below the root").display().to_string();
            found.push(Source { path, of: of.into(), module, depth, text });
        }
    }
    assert!(found.len() > 400, "{} files", found.len());
    found
}

/// Crates of a dependency tree with the features that they are built with.
fn features(of: &[&str]) -> std::collections::BTreeSet<String> {
    let tree = std::process::Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--prefix", "none", "--format", "{p} {f}", "--edges"])
        .args(of)
        .output()
        .expect("cargo tree");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let lines = String::from_utf8(tree.stdout).expect("text");
    lines.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

/// A crate with one feature more is another build, and so is all that stands on it: minutes for each of the two commands.
#[test]
fn the_two_commands_share_one_build_of_their_dependencies() {
    let program = features(&["normal", "--package", "gronwall"]);
    let tests = features(&["normal,dev", "--workspace", "--exclude", "gronwall-python"]);
    let wheel = features(&["normal", "--package", "gronwall-python"]);
    assert!(program.iter().any(|line| line.starts_with("nalgebra ")), "{program:?}");
    let apart: Vec<&String> = program.difference(&tests).collect();
    assert!(apart.is_empty(), "the tests build these with other features: {apart:#?}");
    let apart: Vec<&String> =
        program.difference(&wheel).filter(|line| !line.starts_with("gronwall ")).collect();
    assert!(apart.is_empty(), "the wheel builds these with other features: {apart:#?}");
    let alone = features(&["normal", "--package", "gronwall-algebra"]);
    assert!(alone.difference(&tests).next().is_some(), "a crate alone asks for fewer features");
}

#[test]
fn crates_know_what_the_table_says() {
    let mut folders: Vec<PathBuf> = files_below(&root().join("crates"), "toml");
    folders.retain(|path| path.ends_with("Cargo.toml"));
    assert_eq!(folders.len(), HOUSE.len(), "{folders:?}");
    for (name, known, _) in HOUSE {
        let text = std::fs::read_to_string(root().join(format!("crates/{name}/Cargo.toml")));
        let text = text.expect("a crate");
        let named = |line: &str| {
            let dependency = line.strip_suffix(".workspace = true")?;
            HOUSE.iter().any(|(name, ..)| *name == dependency).then(|| dependency.to_owned())
        };
        let mut dependencies: Vec<String> = text.lines().filter_map(named).collect();
        dependencies.sort();
        assert_eq!(dependencies, known, "{name}");
        // One way: what is known stands before.
        let place = |name: &str| HOUSE.iter().position(|(other, ..)| *other == name);
        assert!(known.iter().all(|known| place(known) < place(name)), "{name}");
    }
}

#[test]
fn imports_run_one_way() {
    let mut wrong = Vec::new();
    for Source { path, of, module, depth, text } in sources() {
        let found = violations(&of, &module, &text, depth);
        wrong.extend(found.into_iter().map(|what| format!("{path}: {what}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn violations_are_caught() {
    let caught = |of: &str, module: &str, text: &str, depth: usize| {
        !violations(of, module, text, depth).is_empty()
    };
    assert!(caught("vhi", "law", "use fem::mesh::Mesh;\nuse vhi::Newton;", 2));
    assert!(caught("vhi", "law", "fn f() -> crate::finite::Model<()> { todo!() }", 2));
    assert!(caught("vhi", "law", "use crate::{\n    law::norm,\n    history::Sums,\n};", 2));
    assert!(caught("vhi", "law", "use super::super::history::Sums;", 2));
    assert!(caught("vhi", "law", "use super::history::Sums;", 1));
    assert!(caught("fit", "line", "use judge::verdict::Verdict;", 2));
    assert!(caught("judge", "record", "use crate::verdict::Verdict;", 2));
    assert!(caught("report", "page", "use scene::Scene;", 2));
    assert!(caught("exact", "parts", "let w = vhi::history::Trapezoid;", 2));
    assert!(caught("exact", "parts", "use fem::contact::{Discretization, stress_force};", 2));
    assert!(caught("exact", "parts", "use fem::{mesh::Mesh, contact::{LoadError, Model}};", 2));
    assert!(caught("exact", "parts", "let f = fem::contact::stress_force::<2, 3>(g, n);", 2));
    assert!(caught("exact", "parts", "use fem::contact;", 2));
    assert!(caught("exact", "parts", "use fem::contact::*;", 2));
    assert!(caught("exact", "parts", "use fem::*;", 2));
    assert!(caught("exact", "parts", "use fem::norms::{Moments, step_errors};", 2));
    assert!(caught("leading_error", "sums", "use vhi::law::Potential;", 2));
    assert!(caught("leading_error", "sums", "use vhi::history::{TimeGrid, Trapezoid};", 2));
    assert!(caught("leading_error", "sums", "use scene::setup::{MeshData, Setup};", 2));
    assert!(caught("leading_error", "sums", "use fem::contact::stress_force;", 2));
    assert!(caught("leading_error", "sums", "use fem::norms::Moments;", 2));
    assert!(caught("leading_error", "sums", "use judge::record::Key;", 2));
    assert!(caught("leading_error", "sums", "let k = setup.model.memory;", 2));
    // And nothing else is.
    assert!(!caught("leading_error", "sums", "use scene::setup::Setup; // not its .model", 2));
    assert!(!caught("leading_error", "sums", "use scene::{Data, Norm};", 2));
    assert!(!caught("exact", "parts", "use fem::contact::{Discretization, LoadError};", 2));
    assert!(!caught("exact", "parts", "use fem::{norms::{Moments, is_locked}, mesh::Mesh};", 2));
    assert!(!caught("fem", "contact", "use vhi::{law::{Isotropic, Potential}, Newton};", 2));
    assert!(!caught("vhi", "law", "use super::history_like::Newton; // crate::history", 2));
    assert!(!caught("vhi", "history", "use super::super::law::MemoryKernel;", 2));
    assert!(!caught("exact", "parts", "use super::exact::Exact;", 2));
}

#[test]
fn files_are_short() {
    let long = |lines: usize| lines > LONGEST;
    let found: Vec<String> = sources()
        .iter()
        .map(|source| (&source.path, source.text.lines().count()))
        .filter(|(_, lines)| long(*lines))
        .map(|(path, lines)| format!("{path}: {lines} lines"))
        .collect();
    assert!(long(LONGEST + 1) && found.is_empty(), "{}", found.join("\n"));
}

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
    assert_eq!(names.len(), files_below(&folder, "toml").len());
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
