//! Source: the program as it stands in repositories of others.
//! Goal: scenes and their baseline are inside the program, the same as those of its folder; a folder here or one that is
//!   named goes before them, and `list` says which; the lines of docs/EXTERNAL.md do what they say in an empty folder.
//! Data: all shipped scenes; viscoelastic on its grid with the answers of the built-in solver.
#![cfg(unix)]

use std::path::Path;
use std::process::Output;

use gronwall::shipped::{baseline, scenes};
use judge::verdict::Baseline;

use crate::external::answer;
use crate::program::{Folder, code, command, json, refused, repository, stderr, stdout};
use crate::shipped::{edited, on_mesh, registry, setup, text};

/// The program as it runs in a folder that knows nothing of it.
fn there(folder: &Folder, arguments: &[&str]) -> Output {
    command(arguments).current_dir(folder.at("")).output().expect("the binary runs")
}

#[test]
fn the_scenes_inside_are_those_of_the_folder() {
    let (inside, outside) = (scenes(), registry());
    let names: Vec<&str> = inside.names().collect();
    assert_eq!(names, outside.names().collect::<Vec<_>>());
    for name in names {
        let [inside, outside] =
            [&inside, &outside].map(|registry| registry.load(name).expect("a scene"));
        // Hashes are of text and mesh.
        assert_eq!(inside.source.hash, outside.source.hash, "{name}");
    }
    let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/baseline.json");
    let recorded = Baseline::read(&recorded).expect("a baseline").expect("a file");
    assert_eq!(baseline().expect("a baseline"), recorded);
}

/// What `--text` prints is a scene file: that of the repository, byte for byte (as all are, by the hashes above), and one that runs
/// under another name.
#[test]
fn the_text_of_a_scene_is_its_file() {
    let folder = Folder::new("inside-text");
    let printed = |name: &str| there(&folder, &["list", name, "--text"]);
    for name in ["affine", "frustum"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("manufactured/{name}.toml"));
        let output = printed(name);
        assert_eq!(code(&output), 0, "{name}");
        assert!(output.stdout == std::fs::read(file).expect("a scene"), "{name}");
    }
    let mine = folder.file("mine.toml", &stdout(&printed("affine")));
    assert_eq!(code(&there(&folder, &["check", &mine])), 0);
    let listed = stdout(&there(&folder, &["list", "affine", "steady"]));
    assert!(listed.ends_with("2 scenes inside this program\n"), "{listed}");
    for (arguments, says) in [
        (&["list", "affine", "steady", "--text"][..], "--text prints one scene"),
        (&["list", "afine", "--text"], "affine"),
        (&["list", "--text"], "SCENE"),
    ] {
        refused(&there(&folder, arguments), &[says]);
    }
}

#[test]
fn a_folder_goes_before_the_scenes_inside() {
    let folder = Folder::new("inside");
    let listed = |more: &[&str]| stdout(&there(&folder, &[&["list"][..], more].concat()));
    let count = scenes().names().count();
    assert!(listed(&[]).ends_with(&format!("{count} scenes inside this program\n")));
    let file = |line: &serde_json::Value| line["file"].clone();
    let rows = json(&there(&folder, &["list", "--json"]));
    assert!(rows.as_array().expect("a list").iter().all(|row| file(row).is_null()));
    for name in ["manufactured", "mine"] {
        std::fs::create_dir(folder.at(name)).expect("a folder");
        folder.file(&format!("{name}/affine.toml"), &text("affine"));
    }
    let mine = folder.argument("mine");
    assert!(listed(&[]).ends_with("1 scene in manufactured\n"));
    assert!(listed(&["--scenes", &mine]).ends_with(&format!("1 scene in {mine}\n")));
    let rows = json(&there(&folder, &["list", "--json"]));
    assert_eq!(file(&rows[0]), "manufactured/affine.toml");
    // An unknown name is looked for there alone.
    refused(&there(&folder, &["check", "steady"]), &["under manufactured"]);
}

/// The baseline goes with the scenes: one that was recorded here comes first, a wrong one is seen.
#[test]
fn scenes_inside_are_compared_with_the_baseline_inside() {
    let folder = Folder::new("inside-baseline");
    let gate = |more: &[&str]| {
        there(&folder, &[&["gate", "affine", "--json", "gate.json"][..], more].concat())
    };
    let output = gate(&[]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let read = || {
        let text = folder.read("gate.json");
        serde_json::from_str::<serde_json::Value>(&text).expect("JSON")["baseline"].clone()
    };
    assert_eq!(read()["scenes"], serde_json::json!(["affine"]), "{}", read());
    // A folder of scenes that is named has none.
    let mine = folder.at("mine");
    std::fs::create_dir(&mine).expect("a folder");
    std::fs::write(mine.join("affine.toml"), text("affine")).expect("a scene");
    assert_eq!(code(&gate(&["--scenes", "mine"])), 0);
    assert!(read().is_null(), "{}", read());
    let mut wrong = baseline().expect("a baseline");
    let recorded = wrong.scenes.get_mut("affine").expect("recorded");
    recorded.cases.iter_mut().flat_map(|case| case.errors.values_mut()).for_each(|e| *e *= 1.1);
    std::fs::create_dir(folder.at("reports")).ok();
    wrong.write(&folder.at("reports/baseline.json")).expect("a file");
    assert_eq!(code(&gate(&[])), 1);
}

/// The commands of the first block of docs/EXTERNAL.md, but for its installation.
fn three_lines() -> Vec<Vec<String>> {
    let page = repository("docs/EXTERNAL.md");
    let block = page.split("```sh\n").nth(1).and_then(|rest| rest.split("```").next());
    let lines: Vec<&str> = block.expect("a block").lines().collect();
    assert_eq!(lines.len(), 3, "{lines:?}");
    assert_eq!(lines[0], "pip install ./gronwall/python");
    lines[1..].iter().map(|line| shlex::split(line).expect("words")).collect()
}

#[test]
fn the_three_lines_of_the_page_run_in_an_empty_folder() {
    let (folder, setup) = (Folder::new("inside-lines"), setup("viscoelastic"));
    for n in [8, 16, 32, 64] {
        let dir = folder.at(&format!("answers/n{n}-N16"));
        answer(&setup, &on_mesh(&setup, n), 16, &dir);
    }
    folder.file("solve.sh", "cp answers/$(basename $1)/displacement.npy $1\n");
    folder.file(
        "errors.csv",
        "h,error\n0.125,0.125\n0.0625,0.0625\n0.03125,0.03125\n0.015625,0.015625\n",
    );
    let [verify, fit] = &three_lines()[..] else { panic!("two commands") };
    assert_eq!((&*verify[0], &*fit[0]), ("sweep", "sweep"));
    let verify = verify.join(" ");
    let words = edited(&verify, "python3 solve_case.py", "'sh solve.sh'");
    let words = shlex::split(&words).expect("words");
    let words: Vec<&str> = words[1..].iter().map(String::as_str).collect();
    let sound = there(&folder, &words);
    assert_eq!(code(&sound), 0, "{}{}", stdout(&sound), stderr(&sound));
    assert!(folder.at("report/junit.xml").exists() && folder.at("report/cases.csv").exists());
    let fit: Vec<&str> = fit[1..].iter().map(String::as_str).collect();
    assert_eq!(code(&there(&folder, &fit)), 0);
    // A solver of a fault is caught there as here.
    folder.file("solve.sh", "cp answers/n8-N16/displacement.npy $1\n");
    assert_eq!(code(&there(&folder, &words)), 2);
}
