//! Source: (3.4), and the strong monotonicity of a step (docs/THEORY.md, section 4).
//! Goal: a step size at which nothing guarantees one solution is refused with the way out; one beyond (3.4) runs with a
//!   warning and a label; a declared violation runs, labelled, and an unnecessary declaration is said to be one.
//! Data: punch with other horizons. m0 = 1.5; (3.4): k < 0.75; monotone: k < 2·1.5/(0.05 + 1) = 2.857.

use crate::program::{Folder, code, ends, json, stderr, stdout, sweep};
use crate::shipped::{edited, text};

/// punch over a horizon, with steps 2 and 4, and more in its heading.
fn punch(horizon: &str, heading: &str) -> String {
    let scene = edited(&text("punch"), "horizon = 1.0", &format!("horizon = {horizon}"));
    let scene = edited(&scene, "judge = false\n", &format!("judge = false\n{heading}\n"));
    let scene = edited(&scene, "n = [8, 16, 32]\nsteps = [8, 16, 32]", "n = [4]\nsteps = [2, 4]");
    edited(&scene, "reference = { n = 128, steps = 64 }", "reference = { n = 8, steps = 8 }")
}

#[test]
fn an_unguaranteed_step_size_is_refused_with_the_way_out() {
    let folder = Folder::new("step-size");
    let scene = folder.file("punch.toml", &punch("8.0", ""));
    let out = folder.argument("out");
    let as_written = sweep(&["run", &scene, "--out", &out]);
    let given = sweep(&["run", &scene, "--steps", "2", "--out", &out]);
    let one = sweep(&["solve", &scene, "--n", "4", "--steps", "2"]);
    for output in [as_written, given, one] {
        assert_eq!((code(&output), stdout(&output).as_str()), (2, ""));
        let message = stderr(&output);
        for phrase in ["N = 2", "k = 4,", "k < 2.8571", "N = 3 steps", "violates = [\"3.4\"]"] {
            assert!(message.contains(phrase), "no `{phrase}` in {message}");
        }
    }
    assert_eq!(folder.names(), ["punch.toml"]);
    // The number of steps that the message proposes is accepted.
    ends(0, &["solve", &scene, "--n", "4", "--steps", "3"]);
}

/// A graded grid is judged by its largest step: T (1 - (1 - 1/N)²) is 2.857 or more up to N = 5.
#[test]
fn the_largest_step_counts() {
    let folder = Folder::new("graded");
    let graded = edited(
        &punch("8.0", ""),
        "grid = { kind = \"uniform\" }",
        "grid = { kind = \"graded\", exponent = 2.0 }",
    );
    let scene = folder.file("punch.toml", &graded);
    let output = ends(2, &["solve", &scene, "--n", "4", "--steps", "4"]);
    let message = stderr(&output);
    assert!(message.contains("k = 3.5,") && message.contains("N = 6 steps"), "{message}");
}

#[test]
fn a_declared_violation_runs_with_its_label() {
    let folder = Folder::new("violates");
    let scene = folder.file("punch.toml", &punch("8.0", "violates = [\"3.4\"]"));
    let out = folder.argument("out");
    let output = ends(0, &["run", &scene, "--out", &out]);
    let said = "violates (3.4) on purpose";
    assert!(stderr(&output).contains("warning: punch: k = 4 (N = 2)"), "{}", stderr(&output));
    assert!(stderr(&output).contains(said));
    for file in ["verdict.json", "index.html"] {
        let written = std::fs::read_to_string(folder.at("out").join(file)).expect("a report");
        assert!(written.contains(said), "{file}");
    }
    // A report that is rebuilt keeps it.
    ends(0, &["report", &out, "--scenes", &folder.argument("")]);
    let written = std::fs::read_to_string(folder.at("out").join("verdict.json")).expect("a report");
    assert!(written.contains(said));
}

#[test]
fn between_the_two_bounds_there_is_a_warning() {
    let folder = Folder::new("between");
    let out = folder.argument("out");
    let scene = folder.file("punch.toml", &punch("2.0", ""));
    let output = ends(0, &["run", &scene, "--out", &out, "--json"]);
    let label = json(&output)["provenance"]["step_sizes"]["punch"].as_str().map(str::to_owned);
    let label = label.expect("a label");
    for phrase in ["k = 1 (N = 2)", "above the bound k < 0.75 of (3.4)", "for k < 2.8571"] {
        assert!(label.contains(phrase) && stderr(&output).contains(phrase), "{label}");
    }
}

#[test]
fn within_the_theorem_nothing_is_said_but_a_needless_declaration() {
    let folder = Folder::new("within");
    let plain = folder.file("punch.toml", &punch("1.0", ""));
    let output = sweep(&["solve", &plain, "--n", "4", "--steps", "4"]);
    assert_eq!((code(&output), stderr(&output).as_str()), (0, ""));
    let declared = folder.file("declared.toml", &punch("1.0", "violates = [\"3.4\"]"));
    let output = ends(0, &["solve", &declared, "--n", "4", "--steps", "4"]);
    assert!(stderr(&output).contains("note: punch: violates = [\"3.4\"] is not needed"));
}
