//! Source: `sweep explain` says what a run takes before it is run.
//! Goal: the factorizations and solves that it says are those that the run counts, or it leaves them to the run; the
//!   plan that it names is the one that the counters show. A wrong number is seen.
//! Mesh: 12 × 12 squares or 3 × 3 × 3 cubes, 6 steps; the two linear punches with a load that does not separate, memory
//!   that is no multiple of the elasticity, rules on facets, graded and random grids, as a polygon, as a box.

use crate::program::{Folder, code, json, sweep};
use crate::shipped::{edited, text};

const STEPS: u64 = 6;

/// A scene: its name, its text with one case, n, and whether its counters are known before it is run.
struct Variant {
    name: String,
    text: String,
    n: u64,
    plan: &'static str,
    known: bool,
}

const LOAD: [&str; 2] = ["-3*t*x", "-3*sin(t*x)"];
const MEMORY: [&str; 2] = ["lambda = 0.25", "lambda = 0.31"];
const GRADED: [&str; 2] = ["kind = \"uniform\"", "kind = \"graded\", exponent = 2.0"];
const RANDOM: [&str; 2] = ["kind = \"uniform\"", "kind = \"random\", seed = 3"];
const GAUSS: [&str; 2] = ["\"vertex\"", "\"gauss\""];
const EXACT: [&str; 2] = ["\"vertex\"", "\"exact\""];
const POLYGON: [&str; 2] = [
    "shape = \"rectangle\"\nsize = [1.0, 1.0]",
    "shape = \"polygon\"\nvertices = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]",
];
const BOX: [&str; 2] =
    ["shape = \"rectangle\"\nsize = [1.0, 1.0]", "shape = \"box\"\nsize = [1.0, 1.0, 1.0]"];
const IN_SPACE: [&str; 2] = ["dimension = 2", "dimension = 3"];
const BODY: [&str; 2] = ["body = [\"0\", \"-3*t*x\"]", "body = [\"0\", \"-3*t*x\", \"0\"]"];
const SIDES: [&str; 2] =
    ["traction = [\"left\", \"right\"]", "traction = [\"left\", \"right\", \"front\", \"back\"]"];

fn variant(scene: &str, edits: &[[&str; 2]], plan: &'static str, known: bool) -> Variant {
    let body = text(scene);
    let (head, _) = body.split_once("[sweep]").expect("a sweep");
    let n = if edits.contains(&BOX) { 3 } else { 12 };
    let plain = edits.iter().fold(head.to_string(), |text, [from, to]| edited(&text, from, to));
    let reference = format!("reference = {{ n = {}, steps = {} }}", 2 * n, 2 * STEPS);
    let text = format!("{plain}[sweep]\nn = [{n}]\nsteps = [{STEPS}]\n{reference}\n");
    let name = edits.iter().fold(scene.to_string(), |name, [_, to]| format!("{name}, {to}"));
    Variant { name, text, n, plan, known }
}

fn variants() -> Vec<Variant> {
    let linear = |edits: &[[&str; 2]], plan, known| variant("linear-punch", edits, plan, known);
    let contact = |edits: &[[&str; 2]], plan, known| variant("elastic-punch", edits, plan, known);
    vec![
        linear(&[], "linear", true),
        linear(&[LOAD], "linear", true),
        linear(&[MEMORY], "linear", true),
        linear(&[MEMORY, LOAD], "linear", true),
        linear(&[GRADED], "linear", true),
        linear(&[RANDOM, LOAD], "linear", true),
        linear(&[MEMORY, GRADED], "linear", true),
        linear(&[MEMORY, RANDOM], "linear", true),
        linear(&[POLYGON], "linear", true),
        linear(&[BOX, IN_SPACE, BODY, SIDES], "linear", true),
        linear(&[BOX, IN_SPACE, BODY, SIDES, MEMORY], "linear", true),
        contact(&[], "condensed", true),
        contact(&[LOAD], "condensed", true),
        contact(&[MEMORY], "condensed", true),
        contact(&[GAUSS], "condensed", true),
        contact(&[EXACT, LOAD], "condensed", true),
        contact(&[GAUSS, MEMORY], "condensed", true),
        contact(&[GRADED, GAUSS], "condensed", true),
        contact(&[RANDOM, MEMORY], "condensed", true),
        contact(&[POLYGON, GAUSS], "condensed", true),
        contact(&[BOX, IN_SPACE, BODY, SIDES], "newton", false),
        variant("punch", &[], "newton", false),
    ]
}

/// Factorizations and solves that `explain` says, and those that `solve` counts.
fn said_and_counted(variant: &Variant) -> [[Option<u64>; 2]; 2] {
    let folder = Folder::new("explained");
    let file = folder.file("scene.toml", &variant.text);
    let explained = sweep(&["explain", &file, "--json"]);
    assert_eq!(code(&explained), 0, "{}: {explained:?}", variant.name);
    let explained = json(&explained);
    let case = &explained["cases"][0];
    assert_eq!(case["plan"], variant.plan, "{}", variant.name);
    let [n, steps] = [variant.n, STEPS].map(|number| number.to_string());
    let solved = sweep(&["solve", &file, "--n", &n, "--steps", &steps, "--json"]);
    assert_eq!(code(&solved), 0, "{}: {solved:?}", variant.name);
    let solved = json(&solved);
    let numbers = |of: &serde_json::Value, keys: [&str; 2]| keys.map(|key| of[key].as_u64());
    [
        numbers(case, ["factorizations", "solves"]),
        numbers(&solved, ["factorizations", "linear_solves"]),
    ]
}

#[test]
fn what_is_said_is_what_is_counted() {
    for variant in variants() {
        let [said, counted] = said_and_counted(&variant);
        let name = &variant.name;
        assert!(counted.iter().all(|count| count.is_some_and(|count| count > 0)), "{name}");
        match variant.known {
            true => assert_eq!(said, counted, "{name}"),
            false => assert_eq!(said, [None, None], "{name}"),
        }
    }
}

/// What is said follows the scene: another memory is a factor more, and on a grid that is not uniform one a level.
#[test]
fn another_scene_has_other_counters() {
    let of = |edits: &[[&str; 2]]| {
        let [said, _] = said_and_counted(&variant("linear-punch", edits, "linear", true));
        said.map(|count| count.expect("a number"))
    };
    assert_eq!(of(&[]), [1, STEPS + 1]);
    assert_eq!(of(&[MEMORY]), [2, STEPS + 1]);
    assert_eq!(of(&[MEMORY, GRADED]), [STEPS + 1, STEPS + 1]);
}
