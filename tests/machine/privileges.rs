//! The program reads scenes, writes under --out alone, runs no other program and asks no network.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::program::{Folder, code, stderr};
use crate::shipped::text;

/// All files below a folder, with their bytes.
fn files(folder: &Path, found: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.insert(path.clone(), Vec::new());
            files(&path, found);
        } else {
            let bytes = std::fs::read(&path).expect("a file");
            found.insert(path, bytes);
        }
    }
}

fn below(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    files(folder, &mut found);
    found
}

/// What differs, but for the folder `out`.
fn touched(
    before: &BTreeMap<PathBuf, Vec<u8>>,
    after: &BTreeMap<PathBuf, Vec<u8>>,
    out: &Path,
) -> Vec<PathBuf> {
    let new = after.iter().filter(|(path, bytes)| before.get(*path) != Some(*bytes));
    let gone = before.keys().filter(|path| !after.contains_key(*path));
    let all = new.map(|(path, _)| path).chain(gone);
    all.filter(|path| !path.starts_with(out)).cloned().collect()
}

/// Home, temporary files, configuration and working directory are all in one folder: what is written there shows.
#[test]
fn nothing_is_written_but_under_out() {
    let folder = Folder::new("privileges");
    std::fs::create_dir_all(folder.at("manufactured")).expect("a folder");
    std::fs::create_dir_all(folder.at("home/.config")).expect("a folder");
    std::fs::create_dir_all(folder.at("tmp")).expect("a folder");
    folder.file("manufactured/affine.toml", &text("affine"));
    let here = folder.at("");
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sweep"));
        command.args(arguments).current_dir(&here).env_clear();
        command.env("HOME", folder.at("home")).env("TMPDIR", folder.at("tmp"));
        let output = command.output().expect("the binary runs");
        assert!(code(&output) < 2, "{arguments:?}: {}", stderr(&output));
    };
    let grid = ["--n", "4", "--steps", "4,8"];
    let before = below(&here);
    let out = folder.at("out");
    run(&[&["run", "affine", "--out", "out/run"], &grid[..]].concat());
    run(&[&["run", "affine", "--out", "out/run", "--resume"], &grid[..]].concat());
    run(&["report", "out/run"]);
    run(&["solve", "affine", "--n", "4", "--steps", "4", "--vtu", "out/vtu"]);
    run(&["check", "affine"]);
    run(&["check", "affine", "--floors", "--n", "4", "--steps", "4"]);
    run(&["list"]);
    run(&["fit", "out/run/cases.csv"]);
    let only = ["--out", "out/part", "--only", "affine:n4:N4", "affine:n4:N8"];
    run(&[&["run", "affine"], &grid[..], &only].concat());
    let cases = folder.file("out/cases.txt", "affine:n4:N4\naffine:n4:N8\n");
    run(&["merge", "out/part", "--cases", &cases, "--out", "out/merged"]);
    let after = below(&here);
    assert!(after.len() > before.len() + 5, "nothing was written at all");
    assert_eq!(touched(&before, &after, &out), Vec::<PathBuf>::new());
    // A file beside it would be seen, and a scene that was changed.
    folder.file("stray", "");
    folder.file("manufactured/affine.toml", "");
    assert_eq!(touched(&before, &below(&here), &out).len(), 2);
}

/// What a source names of other programs and of the network.
fn reaches_out(source: &str) -> Vec<&'static str> {
    let code: Vec<&str> =
        source.lines().map(|line| line.split("//").next().unwrap_or("")).collect();
    let code = code.join("\n");
    let words = ["Command::new", "std::net", "TcpStream", "UdpSocket", "process::Command"];
    words.into_iter().filter(|word| code.contains(word)).collect()
}

/// Sources that may run a program: one that the user names, and the typesetter beside this one for `report --pdf`.
const ASKED_FOR: [&str; 2] = ["crates/run/src/external/process.rs", "src/cli/report.rs"];

#[test]
fn no_other_program_is_run_and_no_network_is_asked() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources: Vec<_> =
        ["src", "crates"].iter().flat_map(|folder| below(&root.join(folder))).collect();
    assert!(sources.len() > 100);
    for (path, bytes) in &sources {
        let name = path.strip_prefix(root).expect("below the root").display().to_string();
        let found = reaches_out(&String::from_utf8_lossy(bytes));
        assert!(found.is_empty() || ASKED_FOR.contains(&&*name), "{name}: {found:?}");
    }
    assert_eq!(reaches_out("use std::process::Command;").len(), 1);
    assert_eq!(reaches_out("let s = TcpStream::connect(a); // std::net").len(), 1);
}
