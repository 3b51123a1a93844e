//! What stdout and stderr take, and what that means for the exit code: a reader that goes away changes nothing, results
//! that were lost are never a success, and a message that nobody can read changes nothing either.

use std::fs::File;
use std::process::{Command, Stdio};

use crate::program::{Folder, code, command, files_below, refuses, stderr, sweep};
use crate::shipped::{edited, text};

/// A command and its exit code where its output is read.
type Case = (Vec<String>, i32);

/// Commands of each exit code, with what they read below the folder.
fn cases(folder: &Folder) -> Vec<Case> {
    let wrong = edited(&text("steady"), "order = 1.0", "order = 2.0");
    let wrong = folder.file("wrong.toml", &wrong);
    let table =
        folder.file("table.csv", "h,error\n0.5,0.5\n0.25,0.25\n0.125,0.125\n0.0625,0.0625\n");
    let grid = ["--n", "8,16,32"];
    let kept = folder.argument("kept");
    let run = |scene: &str, out: &str, code: i32| {
        let output = sweep(&[&["run", scene, "--out", out, "--quiet"], &grid[..]].concat());
        assert_eq!(crate::program::code(&output), code, "{}", stderr(&output));
    };
    run(&wrong, &kept, 1);
    let owned = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect::<Vec<String>>();
    let out = folder.argument("out");
    let merged = folder.argument("merged");
    let more = ["--out", &out, "--quiet"];
    vec![
        (owned(&[&["run", "steady"], &more[..], &grid].concat()), 0),
        (owned(&[&["run", "steady", "--json"], &more[..], &grid].concat()), 0),
        (owned(&[&["run", &wrong], &more[..], &grid].concat()), 1),
        (owned(&[&["gate", &wrong], &more[..], &grid].concat()), 1),
        (owned(&[&["gate", "steady", "--github"], &more[..], &grid].concat()), 0),
        (owned(&["fit", &table, "--p", "1"]), 0),
        (owned(&["fit", &table, "--p", "2"]), 1),
        (owned(&["solve", "affine", "--n", "4", "--steps", "4", "--json"]), 0),
        (owned(&["report", &kept]), 1),
        (owned(&["merge", &kept, "--incomplete", "--out", &merged]), 2),
        (owned(&["list"]), 0),
        (owned(&["--help"]), 0),
        (owned(&["run", "--help"]), 0),
        (owned(&["fit", "no-such-file"]), 2),
        (owned(&["--no-such-option"]), 2),
    ]
}

fn with(arguments: &[String], stdout: Stdio, stderr: Stdio) -> std::process::Output {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let child = command(&words).stdout(stdout).stderr(stderr).spawn().expect("a process");
    child.wait_with_output().expect("a status")
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").expect("/dev/full").into()
}

/// A pipe that nobody reads: its reader has ended before it is written to.
fn closed() -> Stdio {
    let mut reader = Command::new("true").stdin(Stdio::piped()).spawn().expect("true runs");
    let pipe = reader.stdin.take().expect("a pipe");
    let mut reader_ended = reader;
    // `wait` would close the end of the pipe that was taken.
    reader_ended.wait().expect("a status");
    pipe.into()
}

#[test]
fn what_was_lost_is_no_success_and_a_reader_that_left_changes_nothing() {
    let folder = Folder::new("delivered");
    for (arguments, expected) in cases(&folder) {
        let on_full = with(&arguments, full(), Stdio::piped());
        let said = stderr(&on_full);
        assert_eq!(code(&on_full), 2, "{arguments:?} on a full disk: {said}");
        let errors: Vec<&str> = said.lines().filter(|line| line.contains("error:")).collect();
        assert_eq!(errors.len(), 1, "{arguments:?}: {said}");
        if expected < 2 {
            assert!(said.contains("standard output"), "{arguments:?}: {said}");
        }
        let to_nobody = with(&arguments, closed(), Stdio::piped());
        let said = stderr(&to_nobody);
        assert_eq!(code(&to_nobody), expected, "{arguments:?} into a closed pipe: {said}");
        assert!(!said.contains("panicked"), "{said}");
        // Messages that cannot be written.
        for messages in [full(), closed()] {
            let output = with(&arguments, Stdio::piped(), messages);
            assert_eq!(code(&output), expected, "{arguments:?} without stderr");
        }
    }
}

/// The files of a run are there although nobody reads its table.
#[test]
fn files_are_written_all_the_same() {
    let folder = Folder::new("all-the-same");
    let words = |file: &str| {
        let (out, file) = (folder.argument("out"), folder.argument(file));
        ["gate", "affine", "--n", "2,4", "--steps", "4", "--out", &out, "--json", &file, "--github"]
            .map(str::to_owned)
    };
    let summary = folder.argument("summary.md");
    let read = |to: Stdio, file: &str| {
        let arguments = words(file);
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let mut gate = command(&arguments);
        gate.env("GITHUB_STEP_SUMMARY", &summary);
        let child = gate.stdout(to).stderr(Stdio::piped()).spawn().expect("a process");
        let output = child.wait_with_output().expect("a status");
        let summary = std::fs::read_to_string(&summary).expect("a summary");
        std::fs::remove_file(folder.at("summary.md")).expect("removed");
        (code(&output), summary, std::fs::read(folder.at(file)).expect("verdicts"))
    };
    let (expected, summary_of, _) = read(Stdio::piped(), "a.json");
    for to in [closed(), full()] {
        let (code, summary, verdicts) = read(to, "b.json");
        assert!(code == expected || code == 2, "{code}");
        assert!(summary == summary_of && !verdicts.is_empty());
        std::fs::remove_file(folder.at("b.json")).expect("removed");
    }
    // A file that cannot be written is said, whatever the verdicts.
    let device = ["gate", "affine", "--n", "2,4", "--steps", "4", "--json", "/dev/full"];
    refuses(&[&device[..], &["--out", &folder.argument("out")]].concat(), &["/dev/full"]);
}

/// One place writes to stdout, one to stderr: the macros end a program whose stderr is on a full disk.
#[test]
fn nothing_else_prints() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let found = ["src", "crates"].iter().flat_map(|folder| files_below(&root.join(folder), "rs"));
    let found: Vec<std::path::PathBuf> = found.collect();
    assert!(found.len() > 100);
    let is_source = |path: &&std::path::PathBuf| {
        let name = path.display().to_string();
        !name.ends_with("tests.rs") && !name.contains("/tests/")
    };
    for path in found.iter().filter(is_source) {
        let text = std::fs::read_to_string(path).expect("a source");
        for word in ["println!(", "print!(", "dbg!("] {
            assert!(!text.contains(word), "{}: {word}", path.display());
        }
    }
}
