//! Source: the files under manufactured/.
//! Goal: every scene has its place in the documents, its data pass `sweep check`, and docs/SCENES.md is what
//!   `sweep list --markdown` prints. The main job runs them and judges their orders.

use rayon::prelude::*;

use crate::program::{code, stderr, stdout, sweep};

fn read(file: &str) -> String {
    let path = format!("{}/{file}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn names() -> Vec<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/manufactured");
    let registry = gronwall::scene::Registry::open(std::path::Path::new(folder)).expect("scenes");
    registry.names().map(str::to_owned).collect()
}

/// Scenes that `text` does not name in backquotes.
fn uncited(names: &[String], text: &str) -> Vec<String> {
    names.iter().filter(|name| !text.contains(&format!("`{name}`"))).cloned().collect()
}

#[test]
fn every_scene_is_cited() {
    let text = read("manufactured/REFERENCES.md") + &read("docs/BROKEN-HYPOTHESES.md");
    let names = names();
    assert_eq!(uncited(&names, &text), Vec::<String>::new());
    assert_eq!(uncited(&names, &text.replace("`steady`", "")), ["steady"]);
}

#[test]
fn the_data_of_every_scene_are_verified() {
    let failed: Vec<String> = names()
        .par_iter()
        .filter_map(|name| {
            let output = sweep(&["check", name]);
            (code(&output) != 0).then(|| format!("{name}: {}{}", stdout(&output), stderr(&output)))
        })
        .collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

#[test]
fn the_page_of_scenes_is_current() {
    let printed = stdout(&sweep(&["list", "--markdown"]));
    assert!(printed == read("docs/SCENES.md"), "docs/SCENES.md is old: make scenes");
    assert_eq!(printed.matches("../manufactured/").count(), names().len() + 1);
}
