//! Source: the contract of --extend: cases that unresolved verdicts name are run, said, recorded and judged.
//! Goal: a grid that is too short is lengthened until its order is decided, and no further; an error at its floor is
//!   left as it is; budget and rounds bound the cost; --resume and report give the same verdicts with the same provenance.
//! Data: viscoelastic and signorini on short grids, a block whose error is rounding.

use crate::program::{Folder, code, json, lasting, stderr, stdout, sweep, timeless};
use crate::shipped::{edited, text};
use serde_json::Value;

/// viscoelastic on two meshes: no order has an interval there.
fn short(folder: &Folder) -> String {
    let scene = edited(&text("viscoelastic"), "n = [8, 16, 32, 64]", "n = [4, 8]");
    folder.file("viscoelastic.toml", &edited(&scene, "steps = [16]", "steps = [4]"))
}

fn document(folder: &Folder, path: &str) -> Value {
    let text = std::fs::read_to_string(folder.at(path)).expect("a document");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn a_short_grid_is_lengthened_until_the_order_is_decided() {
    let folder = Folder::new("extend");
    let (scene, out) = (short(&folder), folder.argument("out"));
    let without = sweep(&["run", &scene, "--out", &folder.argument("without")]);
    assert_eq!(code(&without), 1, "{}", stdout(&without));
    let open = document(&folder, "without/verdict.json");
    assert_eq!(open["verdicts"][0]["verdict"], "unresolved", "{open:#}");
    assert_eq!(open["verdicts"][0]["next"][0]["steps"], 4, "{open:#}");

    let extended = sweep(&["run", &scene, "--out", &out, "--extend"]);
    assert_eq!(code(&extended), 0, "{}{}", stdout(&extended), stderr(&extended));
    let said = stderr(&extended);
    assert!(
        said.contains("extend: viscoelastic: adds n = ") && said.contains("V_max in h"),
        "{said}"
    );
    let closed = document(&folder, "out/verdict.json");
    assert_eq!(closed["verdicts"][0]["verdict"], "pass", "{closed:#}");
    assert!(closed["verdicts"][0].get("next").is_none(), "a passed verdict asks for nothing");
    let added = &closed["provenance"]["added_cases"]["viscoelastic"];
    assert_eq!(added[0]["n"], open["verdicts"][0]["next"][0]["n"], "{added:#}");
    assert_eq!(added[0]["round"], 1);
    let table = timeless(&folder.at("out/cases.csv"));
    let rows = |n: &str| table.iter().filter(|row| row[2] == n).count();
    assert_eq!(rows(&added[0]["n"].to_string()), rows("4"), "added cases are cases like others");

    // From the records alone, and resumed without --extend: the same verdicts, the same provenance.
    let before = std::fs::read(folder.at("out/verdict.json")).expect("verdicts");
    let same = lasting(&folder.at("out/verdict.json"));
    let again = sweep(&["report", &out]);
    assert_eq!(code(&again), 0, "{}", stderr(&again));
    assert_eq!(std::fs::read(folder.at("out/verdict.json")).expect("verdicts"), before);
    let resumed = sweep(&["run", &scene, "--out", &out, "--resume"]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    assert!(stderr(&resumed).contains("already recorded"), "{}", stderr(&resumed));
    assert_eq!(lasting(&folder.at("out/verdict.json")), same);
    assert_eq!(timeless(&folder.at("out/cases.csv")), table);
    // A gate of the same kind.
    let gate = sweep(&["gate", &scene, "--out", &folder.argument("gate"), "--extend"]);
    assert_eq!(code(&gate), 0, "{}{}", stdout(&gate), stderr(&gate));
}

/// Three coarse meshes of signorini are likely to have order 1 and no more; a fourth tells.
#[test]
fn an_interval_that_is_too_wide_is_narrowed() {
    let folder = Folder::new("extend-wide");
    let scene = edited(&text("signorini"), "n = [8, 16, 32, 64]", "n = [2, 4, 8]");
    let scene = folder.file("signorini.toml", &edited(&scene, "steps = [16]", "steps = [4]"));
    let output = sweep(&["run", &scene, "--out", &folder.argument("out"), "--extend"]);
    assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
    let said = stderr(&output);
    assert!(
        said.contains("adds n = 16, steps = 4") && said.contains("with probability 82 %"),
        "{said}"
    );
    let verdict = &document(&folder, "out/verdict.json")["verdicts"][0];
    let ends = verdict["interval"].as_array().expect("an interval");
    let width = ends[1].as_f64().expect("an end") - ends[0].as_f64().expect("an end");
    assert!(
        width <= 0.3 && verdict["points_used"].as_array().map(Vec::len) == Some(4),
        "{verdict}"
    );
}

/// Without the recorded cases the table would be refused: what --resume restores is needed.
#[test]
fn records_beyond_the_grid_are_refused_without_their_provenance() {
    let folder = Folder::new("extend-lost");
    let (scene, out) = (short(&folder), folder.argument("out"));
    assert_eq!(code(&sweep(&["run", &scene, "--out", &out, "--extend"])), 0);
    let path = folder.at("out/provenance.json");
    let mut provenance: Value =
        serde_json::from_slice(&std::fs::read(&path).expect("provenance")).expect("JSON");
    provenance.as_object_mut().expect("an object").remove("added_cases").expect("added cases");
    std::fs::write(&path, provenance.to_string()).expect("a file");
    let resumed = sweep(&["run", &scene, "--out", &out, "--resume"]);
    assert_eq!(code(&resumed), 2);
    assert!(stderr(&resumed).contains("is no case of this sweep"), "{}", stderr(&resumed));
}

#[test]
fn a_budget_is_kept_and_said() {
    let folder = Folder::new("extend-budget");
    let (scene, out) = (short(&folder), folder.argument("out"));
    let poor = sweep(&["run", &scene, "--out", &out, "--extend", "--budget", "0"]);
    assert_eq!(code(&poor), 1, "unresolved stays unresolved");
    let said = stderr(&poor);
    assert!(said.contains("of CPU time, 0.0 s are left of the budget"), "{said}");
    assert_eq!(timeless(&folder.at("out/cases.csv")).iter().filter(|r| r[2] == "4").count() % 3, 0);
    assert!(document(&folder, "out/verdict.json")["provenance"].get("added_cases").is_none());
    // Resumed with a budget it goes on.
    let rich = sweep(&["run", &scene, "--out", &out, "--extend", "--resume"]);
    assert_eq!(code(&rich), 0, "{}", stderr(&rich));
    for wrong in ["-1", "NaN", "inf", "much"] {
        let budget = format!("--budget={wrong}");
        let output = sweep(&["run", &scene, "--out", &out, "--extend", &budget]);
        assert_eq!(code(&output), 2, "{wrong}");
    }
    assert_eq!(
        code(&sweep(&["run", &scene, "--out", &out, "--budget", "1"])),
        2,
        "without --extend"
    );
}

/// An elastic block whose displacement is in V^h: every error is rounding.
const ROUNDING: &str = r#"
[scene]
name = "rounding"
question = "What is the order of an error that is rounding?"
dimension = 2
[domain]
shape = "rectangle"
size = [1.0, 1.0]
clamped = ["top"]
traction = ["left", "right", "bottom"]
[time]
horizon = 1.0
[material]
lambda = 1.0
mu_L = 1.0
[exact]
u = ["0.1*t*(1 - y)", "-0.2*t*(1 - y)"]
[sweep]
n = [2, 4, 8]
steps = [2]
[[predicts]]
norm = "V_max"
variable = "h"
order = 1.0
why = "(5.26)"
"#;

#[test]
fn an_error_at_its_floor_is_left_as_it_is() {
    let folder = Folder::new("extend-floor");
    let path = folder.file("rounding.toml", ROUNDING);
    let output = sweep(&["run", &path, "--out", &folder.argument("out"), "--extend"]);
    assert_eq!(code(&output), 1, "{}{}", stdout(&output), stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("extend: rounding: V_max in h: no case would help"), "{said}");
    assert!(said.contains("lower the floor"), "{said}");
    assert!(document(&folder, "out/verdict.json")["provenance"].get("added_cases").is_none());
}

/// Order 1 is within the tolerance of 1.12, and likelier below it: three rounds, no more.
#[test]
fn an_order_that_no_case_settles_ends_after_three_rounds() {
    let folder = Folder::new("extend-rounds");
    let scene = short(&folder);
    let text = std::fs::read_to_string(&scene).expect("the scene");
    let text = edited(&text, "n = [4, 8]", "n = [1, 2]");
    let scene = folder.file("viscoelastic.toml", &edited(&text, "order = 1.0", "order = 1.12"));
    let output = sweep(&["run", &scene, "--out", &folder.argument("out"), "--extend"]);
    assert_eq!(code(&output), 1, "{}{}", stdout(&output), stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("V_max in h: still open after 3 rounds"), "{said}");
    let added = &document(&folder, "out/verdict.json")["provenance"]["added_cases"]["viscoelastic"];
    assert_eq!(added.as_array().map(Vec::len), Some(3), "{added:#}");
    assert_eq!(added[2]["round"], 3);
}

/// Loads in strong form jump inside cells: it is their quadrature that hides the errors, and not the solver.
#[test]
fn errors_below_the_floor_of_strong_loads_name_the_load_quadrature() {
    let folder = Folder::new("strong-floor");
    let scene = edited(&text("compliance"), "[exact]", "[exact]\nform = \"strong\"");
    let scene = edited(&scene, "n = [8, 16, 32, 64]", "n = [4, 8, 16]");
    let scene = folder.file("compliance.toml", &edited(&scene, "steps = [16]", "steps = [4]"));
    let output = sweep(&["run", &scene, "--json", "--out", &folder.argument("out")]);
    assert_eq!(code(&output), 1, "{}", stderr(&output));
    let found = &json(&output)["verdicts"][0];
    let reason = found["reason"].as_str().expect("a reason");
    assert!(reason.contains("load quadrature") && reason.contains("sweep floors"), "{found:#}");
    assert!(!reason.contains("solver"), "{reason}");
    // The scene alone knows it: from the records the reason is the same.
    let report = sweep(&["report", &folder.argument("out")]);
    assert_eq!(code(&report), 1, "{}", stderr(&report));
    assert_eq!(document(&folder, "out/verdict.json")["verdicts"][0]["reason"], found["reason"]);
}

/// No finer mesh lowers an order that is settled above its prediction: none is run, and the way out is another one.
#[test]
fn an_order_that_is_settled_too_high_asks_for_no_mesh() {
    let folder = Folder::new("extend-too-high");
    let scene = short(&folder);
    let text = std::fs::read_to_string(&scene).expect("the scene");
    let text = edited(&text, "n = [4, 8]", "n = [4, 8, 16, 32]");
    let scene = folder.file("viscoelastic.toml", &edited(&text, "order = 1.0", "order = 0.6"));
    let output = sweep(&["run", &scene, "--out", &folder.argument("out"), "--extend"]);
    assert_eq!(code(&output), 1, "{}{}", stdout(&output), stderr(&output));
    let said = stderr(&output);
    assert!(
        said.contains("no case would help") && said.contains("state the higher order"),
        "{said}"
    );
    let found = document(&folder, "out/verdict.json");
    assert_eq!(found["verdicts"][0]["next"].as_array().map_or(0, Vec::len), 0, "{found:#}");
    assert!(found["provenance"].get("added_cases").is_none());
}

#[test]
fn json_of_a_run_names_the_next_cases() {
    let folder = Folder::new("extend-json");
    let scene = short(&folder);
    let output = sweep(&["run", &scene, "--json", "--out", &folder.argument("out")]);
    let next = &json(&output)["verdicts"][0]["next"];
    assert!(next[0]["n"].is_u64() && next[0]["steps"].is_u64(), "{next:#}");
}
