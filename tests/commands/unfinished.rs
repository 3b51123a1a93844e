//! Source: the contract of `sweep report DIR`: it rebuilds what the records say, and claims no more than they hold.
//! Goal: of a sweep that has not come to its end, what is missing is named on the terminal and on the page, with exit code
//!   2: cases, rows, scenes without any row, a line that was cut off; rows that were changed are refused; a directory that
//!   a sweep writes to is left alone; a finished sweep on any grid owes nothing.
//! Data: steady and affine on small grids; their tables, cut.

use crate::program::{Folder, code, ends, refuses, stderr, stdout, sweep};
use std::path::PathBuf;

/// Both scenes on a grid that is not in their files, in `out`.
fn finished(folder: &Folder) -> PathBuf {
    let out = folder.argument("out");
    let grid = ["--n", "4,8,16", "--steps", "4,8", "--quiet"];
    let output = sweep(&[&["run", "affine", "steady", "--out", &out], &grid[..]].concat());
    assert!(code(&output) < 2, "{}", stderr(&output));
    folder.at("out/cases.csv")
}

/// `report` says this, and the page too.
#[track_caller]
fn owes(folder: &Folder, words: &[&str]) {
    let output = sweep(&["report", &folder.argument("out")]);
    let said = stderr(&output);
    assert_eq!(code(&output), 2, "{said}{}", stdout(&output));
    let page = folder.read("out/index.html");
    for word in words {
        assert!(said.contains(word), "{word}: {said}");
    }
    for id in words.iter().filter(|word| word.contains(":N")) {
        assert!(page.contains(id), "{id} is not on the page");
    }
}

#[test]
fn a_finished_sweep_owes_nothing_on_any_grid() {
    let folder = Folder::new("owes-nothing");
    finished(&folder);
    let output = sweep(&["report", &folder.argument("out")]);
    assert!(code(&output) < 2, "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    // The grid of the file, and a part with few cases.
    let out = folder.argument("as-written");
    assert!(code(&sweep(&["run", "steady", "--out", &out, "--quiet"])) < 2);
    assert!(code(&sweep(&["report", &out])) < 2);
    let part = folder.argument("part");
    let grid = ["run", "affine", "--n", "2,4", "--steps", "4,8", "--out", &part, "--quiet"];
    let some = [&grid[..], &["--only", "affine:n4:N8", "affine:n2:N4"]].concat();
    ends(0, &some);
    let output = sweep(&["report", &part]);
    assert!(code(&output) < 2, "{}", stderr(&output));
}

#[test]
fn what_is_missing_is_named() {
    let folder = Folder::new("missing-named");
    let table = finished(&folder);
    let whole = std::fs::read_to_string(&table).expect("a table");
    let rows = |keep: &dyn Fn(&str) -> bool| {
        let mut kept: Vec<&str> = whole.lines().filter(|line| keep(line)).collect();
        kept.push("");
        std::fs::write(&table, kept.join("\n")).expect("a table");
    };
    // A case.
    rows(&|line| !line.starts_with("affine,2,8,4,"));
    owes(&folder, &["1 case missing", "affine:n8:N4", "--resume"]);
    // One row of a case.
    rows(&|line| !line.starts_with("affine,2,8,4,") || !line.contains(",stress_L2_max,"));
    owes(&folder, &["1 case missing", "affine:n8:N4"]);
    // All of a scene.
    rows(&|line| !line.starts_with("steady,"));
    owes(&folder, &["6 cases missing", "steady:n4:N4"]);
    let page = folder.read("out/index.html");
    assert!(page.contains("id=\"steady\""), "the scene has vanished");
    // All.
    rows(&|line| line.starts_with("scene,"));
    owes(&folder, &["12 cases missing", "affine:n4:N4", "and 2 more"]);
    let output = sweep(&["report", &folder.argument("out")]);
    assert!(!stdout(&output).contains("judge = false"), "{}", stdout(&output));
    // A last line that was cut off.
    std::fs::write(&table, &whole[..whole.len() - 9]).expect("a table");
    owes(&folder, &["last line of cases.csv is incomplete", "1 case missing", "steady:n16:N8"]);
    // More than whole cases: a line of which nothing is missing elsewhere.
    std::fs::write(&table, format!("{whole}stea")).expect("a table");
    owes(&folder, &["last line of cases.csv is incomplete"]);
    // What was there is there again, and with it the verdicts.
    std::fs::write(&table, &whole).expect("a table");
    assert!(code(&sweep(&["report", &folder.argument("out")])) < 2);
    // Nobody knows of anything.
    rows(&|line| line.starts_with("scene,"));
    std::fs::remove_file(folder.at("out/provenance.json")).expect("removed");
    refuses(&["report", &folder.argument("out")], &["no cases"]);
}

/// Results that somebody wrote into the table are results of nothing.
#[test]
fn a_changed_row_is_refused() {
    let folder = Folder::new("changed-row");
    let table = finished(&folder);
    let whole = std::fs::read_to_string(&table).expect("a table");
    let row = whole.lines().nth(3).expect("a row");
    let mut fields: Vec<&str> = row.split(',').collect();
    fields[9] = "1e-3";
    std::fs::write(&table, whole.replacen(row, &fields.join(","), 1)).expect("a table");
    let [unmerged, merged] = ["out", "merged"].map(|name| folder.argument(name));
    for command in
        [&["report", &unmerged][..], &["merge", &unmerged, "--incomplete", "--out", &merged]]
    {
        let output = sweep(command);
        assert_eq!((code(&output), stdout(&output).as_str()), (2, ""), "{}", stderr(&output));
        assert!(stderr(&output).contains("cases.csv:4: "), "{}", stderr(&output));
        assert!(stderr(&output).contains("--resume"), "{}", stderr(&output));
    }
}

#[test]
fn a_directory_that_a_sweep_writes_to_is_left_alone() {
    let folder = Folder::new("held");
    let table = finished(&folder);
    let before = std::fs::read(&table).expect("a table");
    let held = run::sweep::OutputDirectory::take(&folder.at("out")).expect("a directory");
    refuses(&["report", &folder.argument("out")], &["is writing here"]);
    assert!(std::fs::read(&table).expect("a table") == before);
    drop(held);
    assert!(code(&sweep(&["report", &folder.argument("out")])) < 2);
    // A name without a table makes no directory.
    let nowhere = folder.argument("nowhere");
    let output = ends(2, &["report", &nowhere]);
    assert!(stderr(&output).contains("nowhere/cases.csv") && !folder.at("nowhere").exists());
}
