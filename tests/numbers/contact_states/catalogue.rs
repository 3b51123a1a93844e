//! Source: the files under manufactured/.
//! Goal: every scene has its place in the documents, its data pass `sweep check`, and docs/SCENES.md is what
//!   `sweep list --markdown` prints, with the pictures of `--pictures`. The main job runs them and judges their orders.

use crate::shipped::registry;
use rayon::prelude::*;

use crate::program::{Folder, code, ends, repository, stderr, stdout, sweep};

fn names() -> Vec<String> {
    registry().names().map(str::to_owned).collect()
}

/// Scenes that `text` does not name in backquotes.
fn uncited(names: &[String], text: &str) -> Vec<String> {
    names.iter().filter(|name| !text.contains(&format!("`{name}`"))).cloned().collect()
}

#[test]
fn every_scene_is_cited() {
    let text = repository("manufactured/REFERENCES.md") + &repository("docs/BROKEN-HYPOTHESES.md");
    let names = names();
    assert_eq!(uncited(&names, &text), Vec::<String>::new());
    assert_eq!(uncited(&names, &text.replace("`steady`", "")), ["steady"]);
}

#[test]
#[ignore = "seconds for each scene: make test-long"]
fn long_the_data_of_every_scene_are_verified() {
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
    assert!(printed == repository("docs/SCENES.md"), "docs/SCENES.md is old: make scenes");
    assert_eq!(printed.matches("../manufactured/").count(), names().len() + 1);
}

/// Every scene has its picture, and each is the one that is drawn now.
#[test]
fn the_pictures_of_scenes_are_current() {
    let folder = Folder::new("pictures");
    ends(0, &["list", "--pictures", &folder.argument("")]);
    let expected: Vec<String> = names().iter().map(|name| format!("{name}.svg")).collect();
    let mut sorted = expected.clone();
    sorted.sort();
    assert_eq!(folder.names(), sorted);
    let kept = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/scenes");
    let mut there: Vec<String> = std::fs::read_dir(kept)
        .expect("docs/scenes")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    there.sort();
    assert_eq!(there, sorted, "docs/scenes is old: make scenes");
    for name in &sorted {
        let drawn = folder.read(name);
        assert!(drawn == repository(&format!("docs/scenes/{name}")), "{name} is old: make scenes");
        assert!(!drawn.contains("NaN") && drawn.len() < 24_000, "{name}: {}", drawn.len());
    }
}
