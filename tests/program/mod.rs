//! The binary as a user runs it, in a folder that vanishes.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A fresh folder for one test, removed at its end.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new(test: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("gronwall-{test}-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    pub fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file; its path as an argument.
    pub fn file(&self, name: &str, text: &str) -> String {
        std::fs::write(self.at(name), text).expect("a file");
        self.argument(name)
    }

    /// A path in the folder as an argument.
    pub fn argument(&self, name: &str) -> String {
        self.at(name).display().to_string()
    }

    /// A file of the folder.
    #[track_caller]
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// A document of the folder.
    #[track_caller]
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.read(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Names in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("the folder");
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.expect("an entry").file_name().to_string_lossy().into_owned()
        };
        let mut names: Vec<String> = entries.map(name).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The binary with its arguments, run from the root of the repository.
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweep"));
    command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).env_remove("RUST_BACKTRACE");
    // Tests run in CI as well.
    command.env_remove("GITHUB_ACTIONS").env_remove("GITHUB_STEP_SUMMARY");
    command
}

/// Runs it to its end. What it writes without a folder of its own would replace the report of whoever runs the tests.
pub fn sweep(arguments: &[&str]) -> Output {
    let lock = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/latest/.lock");
    let taken = || lock.metadata().and_then(|lock| lock.modified()).ok();
    let before = taken();
    let output = command(arguments).output().expect("the binary runs");
    assert_eq!(
        taken(),
        before,
        "this or a command beside it wrote into reports/latest: {arguments:?}"
    );
    output
}

/// Runs it to its end, which must be this exit code.
#[track_caller]
pub fn ends(exit: i32, arguments: &[&str]) -> Output {
    let output = sweep(arguments);
    let said = || stdout(&output) + &stderr(&output);
    assert_eq!(code(&output), exit, "{arguments:?}: {}", said());
    output
}

/// Bad input: exit code 2, nothing printed, and a message with these words.
#[track_caller]
pub fn refused(output: &Output, words: &[&str]) {
    let said = stderr(output);
    assert_eq!((code(output), stdout(output).as_str()), (2, ""), "{said}");
    for part in words {
        assert!(said.contains(part) || unwrapped(&said).contains(part), "{part}: {said}");
    }
}

/// What is refused as it is given.
#[track_caller]
pub fn refuses(arguments: &[&str], words: &[&str]) {
    refused(&sweep(arguments), words);
}

/// Words with a blank between them, wherever lines end.
pub fn unwrapped(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A file of the repository.
#[track_caller]
pub fn repository(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Files below a folder whose names have this ending, sorted.
pub fn files_below(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files_below(&path, ending));
        } else if path.extension().is_some_and(|found| found == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Its exit code; a signal is a failure of the test.
pub fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or_else(|| panic!("no exit code: {output:?}"))
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8 on stdout")
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8 on stderr")
}

/// What is printed with --json.
#[track_caller]
pub fn json(output: &Output) -> serde_json::Value {
    let text = stdout(output);
    serde_json::from_str(&text)
        .unwrap_or_else(|error| panic!("{error}:\n{text}\n{}", stderr(output)))
}

/// verdict.json or provenance.json without what may differ between runs of equal records.
#[track_caller]
pub fn lasting(path: &Path) -> serde_json::Value {
    let text = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut document: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    let provenance = match document.get("provenance") {
        Some(_) => &mut document["provenance"],
        None => &mut document,
    };
    let run = provenance.as_object_mut().expect("an object").remove("run").expect("a run");
    assert!(run["threads"].is_u64() && run["commit"].is_string(), "{run}");
    document
}

/// A table of cases, every column but `seconds_*` as text, the header first.
#[track_caller]
pub fn timeless(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    let kept: Vec<usize> =
        (0..header.len()).filter(|&c| !header[c].starts_with("seconds_")).collect();
    assert_eq!(header.len() - kept.len(), 5, "{header:?}");
    let mut rows = vec![kept.iter().map(|&c| header[c].to_string()).collect::<Vec<_>>()];
    for line in lines {
        assert_eq!(line.len(), header.len(), "a torn line: {line:?}");
        rows.push(kept.iter().map(|&c| line[c].to_string()).collect());
    }
    rows
}
