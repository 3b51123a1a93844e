//! Source: the contracts of the command line (exit codes, JSON keys, files); others rely on them.
//! Goal: 0 only where all verdicts pass, 1 where one fails or is unresolved, 2 where it could not judge; every table
//!   has its JSON (its keys: json_reference), and the help says what the main job is.
//! Data: affine and steady (small, judged), edited copies of shipped scenes, tables by hand.

use std::process::Output;

use crate::program::{
    Folder, code, command, ends, json, refuses, stderr, stdout, sweep, unwrapped,
};
use crate::shipped::{edited, text};
use serde_json::Value;

/// Runs a scene into `out` of the folder; the exit code and verdict.json.
#[track_caller]
fn run(folder: &Folder, scene: &str, grid: &[&str]) -> (i32, Value) {
    let out = folder.argument("out");
    let mut arguments = vec!["run", scene, "--out", &out];
    arguments.extend(grid);
    let output = sweep(&arguments);
    let verdict = std::fs::read_to_string(folder.at("out/verdict.json"));
    let verdict = verdict.unwrap_or_else(|error| panic!("{error}: {}", stderr(&output)));
    (code(&output), serde_json::from_str(&verdict).expect("JSON"))
}

fn decisions(document: &Value) -> Vec<&str> {
    let verdicts = document["verdicts"].as_array().expect("verdicts").iter();
    verdicts.map(|verdict| verdict["verdict"].as_str().expect("a verdict")).collect()
}

const SMALL: [&str; 4] = ["--n", "4", "--steps", "4,8,16"];

#[test]
fn verdicts_that_pass_are_zero() {
    let folder = Folder::new("pass");
    let (exit, document) = run(&folder, "affine", &SMALL);
    assert_eq!((exit, decisions(&document)), (0, vec!["pass"]));
    for file in ["cases.csv", "index.html", "affine-k.svg", "provenance.json"] {
        assert!(folder.at("out").join(file).exists(), "no {file}");
    }
}

#[test]
fn verdicts_that_fail_or_are_not_as_expected_are_one() {
    let folder = Folder::new("fail");
    let third = edited(&text("affine"), "order = 2.0", "order = 3.0");
    let failing = folder.file("affine.toml", &third);
    let (exit, document) = run(&folder, &failing, &SMALL);
    assert_eq!((exit, decisions(&document)), (1, vec!["fail"]));
    // A scene built to fail passes by failing, and fails by passing.
    let heading = "name = \"affine\"\n";
    let expected = |scene: &str| edited(scene, heading, &format!("{heading}expect = \"fail\"\n"));
    let failing = folder.file("affine.toml", &expected(&third));
    assert_eq!(run(&folder, &failing, &SMALL).0, 0);
    let passing = folder.file("affine.toml", &expected(&text("affine")));
    let (exit, document) = run(&folder, &passing, &SMALL);
    assert_eq!((exit, decisions(&document)), (1, vec!["pass"]));
}

#[test]
fn unresolved_is_one() {
    let folder = Folder::new("unresolved");
    // Two points give no interval.
    let (exit, document) = run(&folder, "affine", &["--n", "4", "--steps", "4,8"]);
    assert_eq!((exit, decisions(&document)), (1, vec!["unresolved"]));
    // The steep front is pre-asymptotic up to n = 64 (0.78, 0.84, then 1.00): without its window no order is told.
    let all = edited(&text("pure-strong"), "window_n = [32, 128]\n", "");
    let scene = folder.file("pure-strong.toml", &all);
    let (exit, document) = run(&folder, &scene, &["--n", "16,32,64", "--steps", "16"]);
    assert_eq!((exit, decisions(&document)), (1, vec!["unresolved"]), "{document}");
}

/// No verdict is no verdict: a run says so, a gate cannot judge.
#[test]
fn scenes_without_judgement_are_measured_and_never_gated() {
    let folder = Folder::new("unjudged");
    let small = text("punch").replace("n = [8, 16, 32]", "n = [4, 8]");
    let small =
        edited(&small, "reference = { n = 128, steps = 64 }", "reference = { n = 16, steps = 8 }");
    let small = edited(&small, "steps = [8, 16, 32]", "steps = [4]");
    let scene = folder.file("punch.toml", &small);
    let out = folder.argument("out");
    let output = ends(0, &["run", &scene, "--out", &out]);
    let said = stdout(&output);
    assert!(said.contains("nothing was judged") && said.contains("2 cases, 0 failed\n"), "{said}");
    assert!(!said.contains("verdict ") && !said.contains("as expected"), "{said}");
    let page = folder.read("out/index.html");
    assert!(page.contains("nothing was judged") && !page.contains("of 0 verdicts"));
    let rebuilt = ends(0, &["report", &out, "--scenes", &folder.argument("")]);
    assert!(stdout(&rebuilt).contains("nothing was judged"));
    // A gate refuses before it computes anything.
    let gated = folder.argument("gated");
    let output = sweep(&["gate", &scene, "--out", &gated]);
    assert_eq!((code(&output), stdout(&output).as_str()), (2, ""));
    let message = stderr(&output);
    assert!(message.contains("nothing to judge") && message.contains("punch"), "{message}");
    assert!(!folder.at("gated").exists());
    // One judged scene is something to judge.
    let judged = folder.file("affine.toml", &text("affine"));
    let mixed = ["gate", &scene, &judged, "--n", "4", "--steps", "4,8", "--out", &gated];
    ends(1, &mixed);
}

#[test]
fn a_solver_that_gives_up_is_two() {
    let folder = Folder::new("gives-up");
    // 1 + (k/2) b(0)/4 < 0 at k = 1: no step has a positive definite tangent.
    let strong = edited(&text("viscoelastic"), "-exp(-t)", "-50*exp(-t)");
    let strong = edited(&strong, "dimension = 2", "dimension = 2\nviolates = [\"3.4\"]");
    let scene = folder.file("viscoelastic.toml", &strong);
    let (exit, document) = run(&folder, &scene, &["--n", "4", "--steps", "1,2"]);
    assert_eq!((exit, decisions(&document)), (2, vec!["fail"]));
    let failures = document["failures"].as_array().expect("failures");
    assert_eq!(failures.len(), 2);
    assert!(failures[0]["reason"].as_str().is_some_and(|r| r.contains("not positive definite")));
    let table = folder.read("out/cases.csv");
    assert!(
        table.lines().skip(1).all(|row| row.contains(",,,failed,")),
        "no error, no floor: {table}"
    );
    refuses(&["solve", &scene, "--n", "4", "--steps", "1", "--json"], &["step 1 (t = 1)"]);
}

#[test]
fn a_fit_is_plain_to_read() {
    let folder = Folder::new("plain");
    let printed = |rows: &str, aim: &[&str]| {
        let table = folder.file("table.csv", &format!("h,error\n{rows}\n"));
        let text = stdout(&sweep(&[&["fit", &table], aim].concat()));
        assert!(text.lines().all(|line| line == line.trim_end()), "trailing blanks: {text:?}");
        text
    };
    let three = "0.2,0.6\n0.1,0.3\n0.05,0.15";
    assert!(!printed(three, &[]).contains("predicted"));
    assert!(printed(three, &["--p", "1"]).contains("predicted 1: pass, within 0.15 of 1"));
    let one = printed("0.2,0.6", &["--p", "1"]);
    assert!(one.contains("unresolved, 1 point, an order needs"), "{one}");
}

#[test]
fn a_fit_says_nothing_of_absent_columns() {
    let folder = Folder::new("absent");
    let table = folder.file("table.csv", "h,error\n0.2,0.6\n0.1,0.3\n0.05,0.15\n");
    let rows = json(&sweep(&["fit", &table, "--p", "1", "--json"]));
    let variables: Vec<&Value> =
        rows.as_array().expect("rows").iter().map(|r| &r["variable"]).collect();
    assert_eq!(variables, ["h"]);
    // Without k there is none to judge.
    ends(1, &["fit", &table, "--p", "1", "--q", "2"]);
    let of_k = |key: &&String| key.ends_with("_k") || key.starts_with("models");
    assert_eq!(rows[0].as_object().expect("a row").keys().find(of_k), None);
}

#[test]
fn list_and_check_have_their_json() {
    let list = json(&sweep(&["list", "--json"]));
    let scenes = list.as_array().expect("scenes");
    assert!(scenes.len() >= 13);
    let plan = json(&sweep(&["check", "affine", "--json"]));
    let cases = plan["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 5);
    for case in cases {
        assert_eq!(case["plan"], "newton");
        assert!(case["memory_bytes_predicted"].as_f64().is_some_and(|value| value > 0.0));
        // 4 × 4 squares, 25 vertices, 5 of them clamped, two unknowns each.
        assert_eq!(case["dofs"], 40);
    }
    let punch = json(&sweep(&["check", "punch", "--json"]));
    assert!(punch["reference"].is_object() && plan["reference"].is_null());
    let findings = plan["findings"].as_array().expect("findings");
    assert!(findings.len() >= 10);
    for finding in findings {
        let status = finding["status"].as_str().expect("a status");
        assert!(["verified", "fact", "weak"].contains(&status), "{finding}");
    }
}

#[test]
fn what_solve_prints_is_of_its_grid() {
    let punch = json(&sweep(&["solve", "punch", "--n", "4", "--steps", "4", "--json"]));
    let rows = punch["normal_displacement"].as_array().expect("rows");
    assert!(rows.len() == 5 && rows.iter().all(|row| row.as_array().is_some_and(|r| r.len() == 3)));
    assert!(punch["kkt_residual"].as_f64().is_some_and(|r| r <= 1e-9));
    // g = ∞ has no distance to it.
    let linear = json(&sweep(&["solve", "linear-punch", "--n", "4", "--steps", "4", "--json"]));
    assert!(linear["min_normal_gap"].is_null() && linear["max_normal_displacement"].is_number());
}

/// A stiff layer above a block, written with a two-sided law: it pulls.
const PULLS: &str = r#"
[scene]
name = "layer"
question = "Does a stiff layer press?"
dimension = 2
judge = false
[domain]
shape = "rectangle"
size = [1.0, 1.0]
clamped = ["bottom"]
traction = ["left", "right"]
contact = ["top"]
[time]
horizon = 1.0
[material]
E = 10.0
nu = 0.3
[contact]
law = { kind = "linear", stiffness = 1e4 }
shift = "(x - 0.5)^2 - 0.02"
[loads]
body = ["0", "0"]
"#;

/// A law of a layer that also pulls is named with the force and the law that presses alone; that one works as it is printed.
#[test]
fn a_law_that_pulls_is_said_with_the_one_that_does_not() {
    let folder = Folder::new("pulls");
    let scene = folder.file("pulls.toml", PULLS);
    let solve = |scene: &str| sweep(&["solve", scene, "--n", "8", "--steps", "1"]);
    let words = |output: &Output| {
        (stdout(output) + &stderr(output)).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let (pulled, checked) = (solve(&scene), sweep(&["check", &scene]));
    let instead = "law = { kind = \"piecewise-linear\", points = [[0.0, 0.0]], slope_before = 0.0, slope_after = 10000.0 }";
    for (output, says) in [(&pulled, "pulls the body with -"), (&checked, "the body is pulled")] {
        assert_eq!(code(output), 0, "{}", stderr(output));
        assert!(
            words(output).contains(says) && words(output).contains(instead),
            "{}",
            words(output)
        );
    }
    let written = "law = { kind = \"linear\", stiffness = 1e4 }";
    let pressing = folder.file("presses.toml", &edited(PULLS, written, instead));
    let output = solve(&pressing);
    assert_eq!(code(&output), 0);
    assert!(!words(&output).contains("pull"), "{}", words(&output));
    assert!(words(&output).contains("the contact force is 0."), "{}", words(&output));
    assert!(!words(&sweep(&["check", &pressing])).contains("pulled"));
}

/// Where no level depends on another one step is as good as many: the error in h alone, and files of the run beside it.
#[test]
fn one_step_without_a_history_has_an_estimate_and_files() {
    let folder = Folder::new("estimate-one-step");
    let files = folder.argument("vtu");
    let estimated = |steps: &str, more: &[&str]| {
        let words = ["solve", "steady", "--n", "16", "--steps", steps, "--estimate", "--json"];
        json(&sweep(&[&words[..], more].concat()))
    };
    let (one, four) = (estimated("1", &["--vtu", &files]), estimated("4", &[]));
    for (one, four) in
        one["norms"].as_array().unwrap().iter().zip(four["norms"].as_array().unwrap())
    {
        assert_eq!(one["unknown"], serde_json::json!([]));
        assert_eq!(one["time"]["value"], 0.0);
        // The same level, to the accuracy of Newton's method.
        let [one, four] = [one, four].map(|norm| norm["value"].as_f64().expect("an error"));
        assert!(one > 0.0 && (one / four - 1.0).abs() < 1e-6, "{one} {four}");
    }
    for name in ["steady.pvd", "steady_0000.vtu", "steady_0001.vtu"] {
        assert!(folder.at("vtu").join(name).exists(), "{name}");
    }
    // A memory couples the levels: one step says nothing of k.
    let coupled = ["solve", "signorini", "--n", "8", "--steps", "1", "--estimate", "--json"];
    let unknown = json(&sweep(&coupled))["norms"][0]["unknown"].to_string();
    assert!(unknown.contains("N = 1 is no multiple of 4"), "{unknown}");
}

/// `--resume` with other cases keeps what is there, or refuses and touches nothing.
#[test]
fn resume_loses_no_records() {
    let folder = Folder::new("keeps");
    run(&folder, "affine", &SMALL);
    let more: [(&str, &[&str]); 2] = [
        ("affine", &["--n", "4", "--steps", "32", "--resume"]),
        ("steady", &["--n", "8", "--resume"]),
    ];
    for (scene, grid) in more {
        run(&folder, scene, grid);
        let table = folder.read("out/cases.csv");
        for start in ["affine,2,4,4,", "affine,2,4,8,", "affine,2,4,16,"] {
            let rows = table.lines().filter(|row| row.starts_with(start)).count();
            assert_eq!(rows, 6, "rows of {start} after {scene} {grid:?}");
        }
    }
}

/// The words of a help text, whatever the line breaks.
fn help(arguments: &[&str]) -> String {
    let output = ends(0, arguments);
    unwrapped(&stdout(&output))
}

#[test]
fn the_help_says_what_the_main_job_is() {
    let main = help(&["--help"]);
    assert!(
        main.contains(
            "[default: manufactured, where that folder is; else those inside the program]"
        ),
        "{main}"
    );
    assert!(main.contains("Without a command") && main.contains("reports/latest"), "{main}");
    let run = help(&["run", "--help"]);
    assert!(
        run.contains("[default: reports/latest]")
            && run.contains("[default: number of processors]")
    );
    assert!(run.contains("not marked long"), "{run}");
}

/// A terminal has lines of its width; in a pipe a finding is one line, which `grep` shows whole.
#[test]
fn lines_fit_the_terminal() {
    let longest = |text: &str| text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    for arguments in [&["check", "punch"][..], &["check", "abstract-contact"], &["--help"]] {
        for width in [80, 100, 140] {
            let mut shown = command(arguments);
            let output = shown.env("COLUMNS", width.to_string()).output().expect("the binary runs");
            let text = stdout(&output);
            assert!(longest(&text) <= width, "{arguments:?} {width}:\n{text}");
        }
    }
    let mut piped = command(&["check", "punch"]);
    let text = stdout(&piped.env_remove("COLUMNS").output().expect("the binary runs"));
    let algorithm = text.lines().find(|line| line.starts_with("algorithm ")).expect("a line");
    assert!(algorithm.ends_with("have cost a new one") && longest(&text) > 140, "{text}");
}

#[test]
fn audits_hold_and_say_what_they_checked() {
    let folder = Folder::new("audit");
    let grid = ["--n", "4,8", "--steps", "2,4"];
    let out = folder.argument("out");
    let output = ends(0, &[&["audit", "compliance", "--json", "--out", &out], &grid[..]].concat());
    let document = json(&output);
    assert_eq!(
        (document["holds"].as_bool(), document["rule"].as_str()),
        (Some(true), Some("vertex"))
    );
    // Nine inequalities in four runs.
    assert_eq!(document["claims"].as_array().map(Vec::len), Some(36));
    for file in ["compliance-audit-claims.csv", "compliance-audit.json"] {
        assert!(folder.at("out").join(file).exists(), "no {file}");
    }
    // What a reader of the text sees.
    let output = sweep(&[&["audit", "compliance"], &grid[..]].concat());
    assert!(stdout(&output).contains("36 claims, and every one holds"), "{}", stdout(&output));
}

#[test]
fn what_cannot_be_audited_is_two() {
    refuses(&["audit", "punch"], &["no exact solution"]);
    ends(2, &["audit"]);
}

/// Completions and man pages know the commands and their options; --quiet leaves results alone.
#[test]
fn what_is_generated_knows_the_commands() {
    for shell in ["bash", "zsh", "fish"] {
        let text = stdout(&sweep(&["completions", shell]));
        assert!(text.contains("gronwall") && text.contains("resume"), "{shell}: {text}");
    }
    let page = stdout(&sweep(&["man"]));
    assert!(page.contains(".TH sweep") && page.contains("Exit codes"), "{page}");
    let name = page.split(".SH NAME").nth(1).and_then(|rest| rest.split(".SH").next());
    // `whatis` shows this line.
    assert!(name.is_some_and(|name| name.trim().len() < 110 && !name.contains(". ")), "{name:?}");
    let folder = Folder::new("man");
    ends(0, &["man", "--out", &folder.argument("man")]);
    assert!(folder.at("man/sweep-run.1").exists() && folder.at("man/sweep.1").exists());
}

#[test]
fn quiet_says_errors_alone() {
    let folder = Folder::new("quiet");
    let out = folder.argument("out");
    let small = ["run", "affine", "--n", "4", "--steps", "4,8,16", "--out", &out];
    let usual = sweep(&small);
    assert!(stderr(&usual).contains("3 cases"), "{}", stderr(&usual));
    let quiet = sweep(&[&["--quiet"], &small[..]].concat());
    assert_eq!((stderr(&quiet), stdout(&quiet)), (String::new(), stdout(&usual)));
    // No colour where there is no terminal.
    assert!(!stdout(&usual).contains('\u{1b}'));
    refuses(&["--quiet", "run", "afine"], &["did you mean `affine`"]);
}
