//! Source: the contract of `sweep run`: an interrupted sweep loses nothing, `--resume` skips what is there.
//! Goal: killed or interrupted at several moments and resumed, the records are those of an uninterrupted run; Ctrl-C
//!   says how to go on; a torn last line is cut; records of another text of the scene or another version are refused.
//!   Faults of the machine and of a solver, other signals, and rows that are not trusted: the modules beside this one.
//! Data: pure-mild and signorini on small grids, 16 cases.

mod doubts;
mod faults;
#[cfg(unix)]
mod signals;

use std::path::Path;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Folder, code, command, refuses, stderr, stdout, sweep, timeless};
use crate::shipped::{edited, text};
use algebra::linalg::signed_unit;

fn scenes(folder: &Folder) -> [String; 2] {
    let mild = edited(&text("pure-mild"), "n = [16, 32, 64, 96]", "n = [4, 8, 16]");
    let signorini = edited(&text("signorini"), "n = [8, 16, 32, 64]", "n = [4, 8, 16, 32]");
    [folder.file("pure-mild.toml", &mild), folder.file("signorini.toml", &signorini)]
}

/// Arguments of the sweep into `out`, one case at a time.
fn arguments<'a>(scenes: &'a [String; 2], out: &'a str) -> Vec<&'a str> {
    vec!["run", &scenes[0], &scenes[1], "--out", out, "--jobs", "1"]
}

#[track_caller]
fn finish(arguments: &[&str]) -> String {
    let output = sweep(arguments);
    // Too few points for verdicts: unresolved; a failed case would be 2.
    assert_eq!(code(&output), 1, "{}{}", stdout(&output), stderr(&output));
    stderr(&output)
}

/// Runs the sweep into `out`; how to resume it.
#[track_caller]
fn finished<'a>(scenes: &'a [String; 2], out: &'a str) -> Vec<&'a str> {
    let mut resuming = arguments(scenes, out);
    finish(&resuming);
    resuming.push("--resume");
    resuming
}

fn lines(path: &Path) -> usize {
    std::fs::read(path).map_or(0, |bytes| bytes.iter().filter(|&&b| b == b'\n').count())
}

/// Cases that a resumed run found, from its first line of progress, "16 cases, 5 already recorded".
fn recorded(progress: &str) -> usize {
    let words: Vec<&str> = progress.lines().next().unwrap_or_default().split_whitespace().collect();
    match words[..] {
        [_, "cases,", done, "already", "recorded"] => done.parse().expect("a number"),
        [_, "cases"] => 0,
        _ => panic!("no first line of progress: {progress}"),
    }
}

/// A sweep that runs until `cases.csv` has at least `rows` lines, or has ended before.
fn run_until(arguments: &[&str], table: &Path, rows: usize, errors: Stdio) -> Child {
    let mut child =
        command(arguments).stdout(Stdio::null()).stderr(errors).spawn().expect("a process");
    // The limit guards against a hanging process; it decides nothing.
    let limit = Instant::now() + Duration::from_secs(300);
    while lines(table) < rows && child.try_wait().expect("a status").is_none() {
        assert!(Instant::now() < limit, "no {rows} rows in five minutes");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

/// Runs until `cases.csv` has at least `rows` lines, then sends a signal, as Ctrl-C does. Exit code and stderr.
#[cfg(unix)]
fn interrupt_after(
    arguments: &[&str],
    table: &Path,
    rows: usize,
    signal: &str,
) -> (Option<i32>, String) {
    let child = run_until(arguments, table, rows, Stdio::piped());
    let sent = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(sent.expect("kill runs").success());
    let output = child.wait_with_output().expect("a status");
    (output.status.code(), stderr(&output))
}

/// Seeded numbers: the moments are chance, and the same in each run of the test but for the machine's speed.
fn kills_at_random_moments_lose_nothing(number: u32) {
    let folder = Folder::new(&format!("killed-{number}"));
    let scenes = scenes(&folder);
    let whole = folder.argument("whole");
    let start = Instant::now();
    finish(&arguments(&scenes, &whole));
    let takes = start.elapsed();
    let expected = timeless(&folder.at("whole/cases.csv"));
    let (mut kills, mut sweeps, mut seed) = (0, 0, 20);
    while kills < number {
        // Sweeps into one directory after another; each is killed until it comes to its end.
        let out = folder.argument(&format!("sweep-{sweeps}"));
        let table = folder.at(&format!("sweep-{sweeps}/cases.csv"));
        let mut resuming = arguments(&scenes, &out);
        resuming.push("--resume");
        while kills < number {
            let mut child = command(&resuming)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .expect("a process");
            std::thread::sleep(takes.mul_f64(0.5 * (1.0 + signed_unit(&mut seed))));
            if child.try_wait().expect("a status").is_some() {
                break;
            }
            child.kill().expect("SIGKILL");
            child.wait().expect("a status");
            kills += 1;
        }
        finish(&resuming);
        assert_eq!(timeless(&table), expected, "after {kills} kills");
        sweeps += 1;
        // A sweep takes half of its time between kills: one in three, at least, comes to its end early.
        assert!(sweeps < 10 * number, "{kills} kills in {sweeps} sweeps");
    }
}

#[test]
fn ten_kills_at_random_moments_lose_nothing() {
    kills_at_random_moments_lose_nothing(10);
}

#[cfg(unix)]
#[test]
fn an_interrupted_sweep_says_how_to_go_on_and_does() {
    let folder = Folder::new("interrupted");
    let scenes = scenes(&folder);
    let whole = folder.argument("whole");
    finish(&arguments(&scenes, &whole));
    let expected = timeless(&folder.at("whole/cases.csv"));
    // The longest cases begin first: late in a sweep the rest may be over before the signal is there.
    for (moment, rows) in [2, expected.len() / 4].into_iter().enumerate() {
        // A space in the path: what is printed must still be one command.
        let name = format!("cut {moment}");
        let (out, table) = (folder.argument(&name), folder.at(&name).join("cases.csv"));
        let (code, said) = interrupt_after(&arguments(&scenes, &out), &table, rows, "-INT");
        assert_eq!(code, Some(130), "{said}");
        assert!(said.contains("interrupted") && said.contains(&out), "{said}");
        let kept = lines(&table).saturating_sub(1);
        assert!(kept + 1 >= rows && kept + 1 < expected.len(), "{kept} rows at the end");
        // The command that it prints is run as it stands.
        let told = said.lines().find_map(|line| line.strip_prefix("go on with: sweep "));
        let told = told.unwrap_or_else(|| panic!("no way on in: {said}"));
        let shell = format!("\"$SWEEP\" {told}");
        let resumed = std::process::Command::new("sh")
            .args(["-c", &shell])
            .env("SWEEP", env!("CARGO_BIN_EXE_sweep"))
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .output()
            .expect("a shell");
        // Too few points for verdicts: unresolved.
        assert_eq!(crate::program::code(&resumed), 1, "{told}\n{}", stderr(&resumed));
        assert!(recorded(&stderr(&resumed)) >= kept / 6, "{kept} rows were there");
        assert_eq!(timeless(&table), expected, "interrupted after {rows} rows");
    }
}

#[test]
fn a_torn_last_line_is_cut() {
    let folder = Folder::new("torn");
    let (scenes, out) = (scenes(&folder), folder.argument("out"));
    let resuming = finished(&scenes, &out);
    let table = folder.at("out/cases.csv");
    let bytes = std::fs::read(&table).expect("the table");
    let expected = timeless(&table);
    // In the middle of a row in the middle of a case; after the first byte of a row; without the last line break; in
    // the header.
    let starts: Vec<usize> = (1..bytes.len()).filter(|&at| bytes[at - 1] == b'\n').collect();
    for (at, most) in [(starts[20] + 40, 3), (starts[12] + 1, 2), (bytes.len() - 1, 16), (30, 0)] {
        std::fs::write(&table, &bytes[..at]).expect("a torn table");
        let progress = finish(&resuming);
        assert!(recorded(&progress) <= most, "cut at byte {at}: {progress}");
        assert_eq!(timeless(&table), expected, "cut at byte {at}");
    }
}

#[test]
fn records_of_another_text_are_refused() {
    let folder = Folder::new("changed");
    let (scenes, out) = (scenes(&folder), folder.argument("out"));
    let resuming = finished(&scenes, &out);
    let table = std::fs::read(folder.at("out/cases.csv")).expect("the table");
    // The same numbers in another text: the records cannot know.
    let original = folder.read("signorini.toml");
    folder.file("signorini.toml", &edited(&original, "L = 600", "L = 601"));
    refuses(&resuming, &["`signorini` has changed", "--resume"]);
    assert_eq!(std::fs::read(folder.at("out/cases.csv")).expect("the table"), table);
    // With the text restored the records are good again, and nothing is left to run.
    folder.file("signorini.toml", &original);
    assert_eq!(recorded(&finish(&resuming)), 16);
}

#[test]
fn records_of_another_version_are_refused() {
    let folder = Folder::new("version");
    let (scenes, out) = (scenes(&folder), folder.argument("out"));
    let resuming = finished(&scenes, &out);
    let provenance = folder.at("out/provenance.json");
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let text = std::fs::read_to_string(&provenance).expect("the provenance");
    std::fs::write(&provenance, edited(&text, &version, "\"version\": \"0.0.7\""))
        .expect("written");
    refuses(&resuming, &["version 0.0.7", "--out"]);
    // Records whose origin nobody knows.
    std::fs::remove_file(&provenance).expect("removed");
    refuses(&resuming, &["without provenance.json"]);
}
