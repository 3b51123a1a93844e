//! What `--resume` does not trust: rows that were changed, numbers that no measurement gives, files that a killed process
//! left, a pipe in the place of the table.

use judge::record::{CaseRecord, read, write_sorted};

use crate::program::{Folder, code, refuses, stderr, sweep, timeless};

const SWEEP: [&str; 6] = ["run", "affine", "--n", "2,4", "--steps", "4,8"];

/// Four cases in `out`.
fn swept(folder: &Folder) {
    let output = sweep(&[&SWEEP[..], &["--out", &folder.argument("out"), "--quiet"]].concat());
    assert!(code(&output) < 2, "{}", stderr(&output));
}

/// What resuming says on stderr; the records are those of `expected` again.
#[track_caller]
fn resumed(folder: &Folder, expected: &[Vec<String>]) -> String {
    let out = folder.argument("out");
    let output = sweep(&[&SWEEP[..], &["--out", &out, "--resume"]].concat());
    assert!(code(&output) < 2, "{}", stderr(&output));
    assert_eq!(timeless(&folder.at("out/cases.csv")), expected);
    stderr(&output)
}

#[test]
fn a_changed_row_is_run_again_and_said() {
    let folder = Folder::new("doubt-changed");
    swept(&folder);
    let table = folder.at("out/cases.csv");
    let (whole, expected) = (std::fs::read_to_string(&table).expect("a table"), timeless(&table));
    let row = whole.lines().nth(2).expect("a row");
    // An error, a floor, a number of unknowns, a status, a step.
    for (column, value) in
        [(9, "0.001"), (9, "NaN"), (9, "-0.1"), (10, "0.5"), (6, "7"), (5, "0.3")]
    {
        let mut fields: Vec<&str> = row.split(',').collect();
        fields[column] = value;
        std::fs::write(&table, whole.replacen(row, &fields.join(","), 1)).expect("a table");
        let said = resumed(&folder, &expected);
        assert!(said.contains("line 3: changed"), "{column} {value}: {said}");
        assert!(said.contains("4 cases, 3 already recorded"), "{column} {value}: {said}");
    }
    // Seconds are nobody's result; nothing is said of a table that nobody touched.
    let mut fields: Vec<&str> = row.split(',').collect();
    fields[19] = "99.5";
    let seconds = fields.join(",");
    for text in [&whole, &whole.replacen(row, &seconds, 1)] {
        std::fs::write(&table, text).expect("a table");
        let said = resumed(&folder, &expected);
        assert!(!said.contains("changed"), "{said}");
    }
    // Rows without checksums.
    let bare: Vec<&str> =
        whole.lines().map(|line| line.rsplit_once(',').expect("a field").0).collect();
    std::fs::write(&table, bare.join("\n") + "\n").expect("a table");
    let said = resumed(&folder, &expected);
    assert!(said.contains("without checksums") && said.starts_with("warning"), "{said}");
}

/// Whole rows that say what cannot be.
#[test]
fn numbers_that_no_measurement_gives_are_run_again_and_said() {
    let folder = Folder::new("doubt-unsound");
    swept(&folder);
    let table = folder.at("out/cases.csv");
    let (sound, expected) = (read(&table).expect("records"), timeless(&table));
    type Change = fn(&mut CaseRecord);
    let changes: [(Change, &str); 4] = [
        (|case| case.errors[0].error = Some(f64::NAN), "NaN"),
        (|case| case.errors[0].error = Some(-1e-3), "-0.001"),
        (|case| case.errors[0].error = Some(f64::INFINITY), "inf"),
        (|case| case.errors[0].floor = Some(-1.0), "-1.0"),
    ];
    for (change, word) in changes {
        let mut records = sound.clone();
        change(&mut records[1]);
        write_sorted(&table, &records).expect("a table");
        let said = resumed(&folder, &expected);
        assert!(said.contains("no measurement") && said.contains(word), "{word}: {said}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn unfinished_files_of_a_killed_process_go() {
    let folder = Folder::new("doubt-partial");
    swept(&folder);
    // No process has a number that long.
    folder.file("out/index.html.4294967295.partial", "half");
    folder.file("out/mine.partial", "mine");
    let expected = timeless(&folder.at("out/cases.csv"));
    resumed(&folder, &expected);
    assert!(!folder.at("out/index.html.4294967295.partial").exists());
    assert!(folder.at("out/mine.partial").exists());
}

#[cfg(unix)]
#[test]
fn a_pipe_in_the_place_of_a_file_is_refused() {
    let folder = Folder::new("doubt-pipe");
    swept(&folder);
    for name in ["cases.csv", "provenance.json"] {
        let kept = std::fs::read(folder.at("out").join(name)).expect("a file");
        let pipe = folder.at("out").join(name);
        std::fs::remove_file(&pipe).expect("removed");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status();
        assert!(made.expect("mkfifo runs").success());
        let out = folder.argument("out");
        for command in [&[&SWEEP[..], &["--out", &out, "--resume"]].concat()[..], &["report", &out]]
        {
            refuses(command, &[name, "a pipe"]);
        }
        std::fs::remove_file(&pipe).and_then(|()| std::fs::write(&pipe, kept)).expect("a file");
    }
    // What a user names may be a pipe, and comes to an end.
    let bounded = ["--baseline", "/dev/zero", "--out", &folder.argument("other")];
    let gate = [&["gate", "affine", "--n", "2,4", "--steps", "4,8"], &bounded[..]].concat();
    for command in [&["fit", "/dev/zero"][..], &gate] {
        refuses(command, &["more than 256 MiB"]);
    }
}

/// Files of the directory belong to the sweep; what a link in their place names does not.
#[cfg(unix)]
#[test]
fn links_in_the_directory_are_replaced_and_not_followed() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new("doubt-link");
    let target = folder.file("precious", "precious");
    std::fs::create_dir(folder.at("out")).expect("a folder");
    let names =
        ["index.html", "verdict.json", "cases.csv", "provenance.json", ".lock", "report.md"];
    // `cases.csv` as a link to something else would be no table, which a fresh sweep does not read.
    for name in names {
        symlink(&target, folder.at("out").join(name)).expect("a link");
    }
    swept(&folder);
    for name in names {
        let known = std::fs::symlink_metadata(folder.at("out").join(name)).expect("a file");
        assert!(known.is_file(), "{name} is still a link");
    }
    assert_eq!(std::fs::read_to_string(&target).expect("a file"), "precious");
    // A file that the user names is where the link leads.
    let link = folder.argument("link.json");
    symlink(folder.file("named.json", ""), &link).expect("a link");
    let named = ["gate", "affine", "--n", "2,4", "--steps", "4,8", "--quiet", "--json", &link];
    assert!(code(&sweep(&[&named[..], &["--out", &folder.argument("out")]].concat())) < 2);
    assert!(std::fs::symlink_metadata(&link).expect("a link").is_symlink());
    assert!(!std::fs::read(folder.at("named.json")).expect("a file").is_empty());
}
