//! Source: the contract of --until-resolved: the cheapest cases first, one more for each claim that is not settled.
//! Goal: verdicts as with all cases, from fewer of them; a wrong claim gets the cases that confirm its failure; what is
//!   left is said and is no failure, neither for the baseline nor for report and --resume; scenes that need all their
//!   cases have them and say so.
//! Data: affine with its predicted constant, with none and with a wrong order.

use crate::program::{Folder, code, json, lasting, stderr, stdout, sweep, timeless};
use crate::shipped::{edited, text};

/// Numbers of steps that were run.
fn steps(folder: &Folder, path: &str) -> Vec<String> {
    let rows = timeless(&folder.at(&format!("{path}/cases.csv")));
    let mut steps: Vec<String> = rows.iter().skip(1).map(|row| row[3].clone()).collect();
    steps.dedup();
    steps
}

fn affine(folder: &Folder, file: &str, changes: &[(&str, &str)]) -> String {
    let edited_scene =
        changes.iter().fold(text("affine"), |scene, (old, new)| edited(&scene, old, new));
    folder.file(file, &edited_scene)
}

#[test]
fn the_predicted_constant_settles_three_levels_and_errors_alone_four() {
    let folder = Folder::new("until-resolved");
    let run = |scene: &str, out: &str| {
        let output = sweep(&["run", scene, "--until-resolved", "--out", &folder.argument(out)]);
        assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
        stdout(&output)
    };
    let said = run(&affine(&folder, "affine.toml", &[]), "out");
    assert_eq!(steps(&folder, "out"), ["4", "8", "16"]);
    assert!(said.contains("until resolved: 2 of 5 cases not run, about"), "{said}");
    let finer = ("steps = [4, 8, 16, 32, 64]", "steps = [16, 32, 64, 128, 256]");
    let without = [("order = 2.0\n", "order = 2.0\nconstant = false\n"), finer];
    run(&affine(&folder, "alone.toml", &without), "alone");
    assert_eq!(steps(&folder, "alone"), ["16", "32", "64", "128"]);
}

#[test]
fn what_is_left_is_missing_to_nobody() {
    let folder = Folder::new("until-resolved-rest");
    let out = folder.argument("out");
    let gate = ["gate", "affine", "--until-resolved", "--out", &out];
    let output = sweep(&gate);
    assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
    assert!(stdout(&output).contains("no deviation"), "{}", stdout(&output));
    let same = lasting(&folder.at("out/verdict.json"));
    let report = sweep(&["report", &out]);
    assert_eq!(code(&report), 0, "{}", stderr(&report));
    let resumed =
        sweep(&["run", "affine", "--until-resolved", "--resume", "--json", "--out", &out]);
    assert_eq!(code(&resumed), 0, "{}", stderr(&resumed));
    let left = &json(&resumed)["not_run"][0];
    assert_eq!((&left["scene"], &left["cases"][0]["steps"]), (&"affine".into(), &32.into()));
    assert_eq!(steps(&folder, "out"), ["4", "8", "16"]);
    // Without the flag the other two are run as well, and the verdict is the same.
    let all = sweep(&["run", "affine", "--resume", "--out", &out]);
    assert_eq!(code(&all), 0, "{}", stderr(&all));
    assert_eq!(steps(&folder, "out").len(), 5);
    let now = lasting(&folder.at("out/verdict.json"));
    assert_ne!(now, same, "two more levels");
    for document in [&same, &now] {
        assert_eq!(document["verdicts"][0]["verdict"], "pass", "{document}");
    }
}

/// Order 3 is claimed where it is 2: four levels fail, and a fifth confirms it.
#[test]
fn a_failure_is_confirmed() {
    let folder = Folder::new("until-resolved-fail");
    let wrong = [("order = 2.0", "order = 3.0"), ("16, 32, 64]", "16, 32, 64, 128, 256]")];
    let scene = affine(&folder, "wrong.toml", &wrong);
    let output = sweep(&["gate", &scene, "--until-resolved", "--out", &folder.argument("out")]);
    assert_eq!(code(&output), 1, "{}{}", stdout(&output), stderr(&output));
    assert_eq!(steps(&folder, "out").len(), 5, "{}", stdout(&output));
    // It stays confirmed: going on asks for nothing more.
    let resumed = ["run", &scene, "--until-resolved", "--resume", "--out", &folder.argument("out")];
    let output = sweep(&resumed);
    assert_eq!(code(&output), 1, "{}{}", stdout(&output), stderr(&output));
    assert_eq!(steps(&folder, "out").len(), 5, "{}", stdout(&output));
    // A scene that has to stay open needs every case to do so.
    let open = [("order = 2.0", "order = 1.0"), ("[scene]", "[scene]\nexpect = \"unresolved\"")];
    let scene = affine(&folder, "open.toml", &open);
    let output = sweep(&["gate", &scene, "--until-resolved", "--out", &folder.argument("open")]);
    assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
    assert!(stderr(&output).contains("all cases are run of affine"), "{}", stderr(&output));
    assert_eq!(steps(&folder, "open").len(), 5);
}
