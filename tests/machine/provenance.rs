//! What made a report, and that nothing in the records depends on it.

use serde_json::Value;

use crate::build;
use crate::program::{Folder, code, stderr, sweep};

fn document(folder: &Folder, name: &str) -> Value {
    let text = std::fs::read(folder.at(name)).expect("a file");
    serde_json::from_slice(&text).expect("JSON")
}

/// A hash, or one of the two reasons why there is none.
fn is_commit(text: &str) -> bool {
    let hash = text.len() >= 40 && text.chars().all(|c| c.is_ascii_hexdigit());
    hash || ["unknown", "development build"].contains(&text)
}

/// What is missing in the provenance of a report, or has no place there.
fn faults(provenance: &Value, threads: u64, options: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let run = &provenance["run"];
    for key in ["commit", "compiler", "target", "optimisation", "processor", "options"] {
        match run[key].as_str() {
            Some(text) if !text.starts_with('/') => {}
            other => faults.push(format!("{key}: {other:?}")),
        }
    }
    let said = [
        (provenance["version"] == env!("CARGO_PKG_VERSION"), "version"),
        (provenance["scenes"]["affine"].as_str().is_some_and(|hash| hash.len() == 16), "hash"),
        (run["threads"] == threads, "threads"),
        (run["options"] == options, "options"),
        (run["compiler"].as_str().is_some_and(|text| text.starts_with("rustc 1.")), "rustc"),
        (run["commit"].as_str().is_some_and(is_commit), "commit"),
    ];
    faults.extend(said.iter().filter(|(holds, _)| !holds).map(|(_, what)| (*what).to_owned()));
    faults
}

#[test]
fn a_report_says_what_made_it_and_where_is_nobodys_business() {
    let folder = Folder::new("made");
    let scene = folder.file("affine.toml", &crate::shipped::text("affine"));
    let out = folder.argument("out");
    let output =
        sweep(&["run", &scene, "--n", "4", "--steps", "4,8", "--jobs", "2", "--out", &out]);
    assert!(code(&output) < 2, "{}", stderr(&output));
    let verdict = document(&folder, "out/verdict.json");
    let options = "--n 4 --steps 4,8 --jobs 2";
    assert_eq!(faults(&verdict["provenance"], 2, options), Vec::<String>::new());
    // Another number of threads, other options, no commit, a path: each is seen.
    assert_eq!(faults(&verdict["provenance"], 3, options).len(), 1);
    assert_eq!(faults(&verdict["provenance"], 2, "").len(), 1);
    let mut without = verdict["provenance"].clone();
    without["run"]["commit"] = "/home/me".into();
    assert!(!faults(&without, 2, options).is_empty());
    let page = folder.read("out/index.html");
    for key in ["compiler", "processor", "options"] {
        let value = verdict["provenance"]["run"][key].as_str().expect("a text");
        let escaped = value.replace('&', "&amp;").replace('<', "&lt;");
        assert!(page.contains(&escaped), "no {key} in the page");
    }
    let junit = folder.argument("junit.xml");
    let beside = folder.argument("gate");
    let gate = ["gate", &scene, "--n", "4", "--steps", "4,8", "--out", &beside, "--junit", &junit];
    assert!(code(&sweep(&gate)) < 2);
    let junit = std::fs::read_to_string(&junit).expect("JUnit");
    let commit = verdict["provenance"]["run"]["commit"].as_str().expect("a commit");
    assert!(junit.contains(&format!("<property name=\"commit\" value=\"{commit}\"")), "{junit}");
    // No path of this machine in anything that is handed on.
    let here = [folder.argument(""), env!("CARGO_MANIFEST_DIR").to_owned()];
    for file in ["verdict.json", "provenance.json", "index.html", "cases.csv"] {
        let text = std::fs::read_to_string(folder.at("out").join(file)).expect("a file");
        assert!(here.iter().all(|path| !text.contains(path.trim_end_matches('/'))), "{file}");
    }
}

/// A clone of files alone: HEAD on a branch, loose or packed, a commit checked out, a work tree, and none.
#[test]
fn the_commit_is_read_from_the_files_of_a_clone() {
    let folder = Folder::new("commit");
    let [first, second] =
        ["0123456789abcdef0123456789abcdef01234567", "f".repeat(40).as_str()].map(str::to_owned);
    let write = |name: &str, text: &str| {
        let path = folder.at(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        std::fs::write(path, text).expect("a file");
    };
    let read = |name: &str| build::commit(&folder.at(name));
    assert_eq!(read(".git"), None);
    write(".git/HEAD", "ref: refs/heads/main\n");
    assert_eq!(read(".git"), None);
    let packed = format!("# pack-refs\n{second} refs/heads/other\n{first} refs/heads/main\n");
    write(".git/packed-refs", &packed);
    assert_eq!(read(".git"), Some(first.clone()));
    write(".git/refs/heads/main", &format!("{second}\n"));
    assert_eq!(read(".git"), Some(second.clone()));
    // A work tree has a HEAD; branches are in the common folder.
    write(".git/worktrees/tree/HEAD", "ref: refs/heads/main\n");
    write(".git/worktrees/tree/commondir", "../..\n");
    write("tree/.git", "gitdir: ../.git/worktrees/tree\n");
    assert_eq!(read("tree/.git"), Some(second));
    write(".git/HEAD", &format!("{first}\n"));
    assert_eq!(read(".git"), Some(first));
    write(".git/HEAD", "no commit\n");
    assert_eq!(read(".git"), None);
}

/// A published crate holds its commit in a file of cargo's.
#[test]
fn the_commit_of_a_published_crate_is_read_unless_its_sources_were_ahead() {
    let (folder, commit) = (Folder::new("packaged"), "0123456789abcdef0123456789abcdef01234567");
    let kept = |git: &str| {
        let text = format!("{{\n  \"git\": {{{git}}},\n  \"path_in_vcs\": \"\"\n}}");
        folder.file(".cargo_vcs_info.json", &text);
        build::packaged(&folder.at(".cargo_vcs_info.json"))
    };
    assert_eq!(build::packaged(&folder.at(".cargo_vcs_info.json")), None);
    assert_eq!(kept(&format!("\n    \"sha1\": \"{commit}\"\n  ")), Some(commit.to_owned()));
    assert_eq!(kept(&format!("\n    \"sha1\": \"{commit}\",\n    \"dirty\": true\n  ")), None);
    assert_eq!(kept("\n    \"sha1\": \"main\"\n  "), None);
}
