//! Source: docs/SCENE-FILES.md, and the keys of the scene crate.
//! Goal: the page shows every key as it is registered and no other, every example on it is read. What
//!   is done with a key that nobody knows: tests/numbers/keys.
//! Data: shipped scenes, into which each example is put; a page without a key, without a part, and with a wrong example.
//!   `SCENE_KEYS_WRITE=1 cargo test --release --test commands scene_keys` writes the tables of the page anew.

use crate::program::repository;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rayon::prelude::*;
use scene::{Scene, Source};

use crate::shipped::text;

/// A row of a table: what stands between backquotes in its first and in its last cell.
struct Row<'t> {
    keys: Vec<&'t str>,
    example: Vec<&'t str>,
}

fn quoted(cell: &str) -> Vec<&str> {
    cell.split('`').skip(1).step_by(2).collect()
}

/// The rows below the heading of each part.
fn documented(page: &str) -> BTreeMap<&str, Vec<Row<'_>>> {
    let mut parts = BTreeMap::new();
    for section in page.split("\n### `[").skip(1) {
        let (name, body) = section.split_once("]`\n").expect("a heading");
        let body = body.split("\n#").next().unwrap_or_default();
        let rows = body.lines().filter(|line| line.starts_with("| `")).map(|line| {
            let cells: Vec<&str> = line.trim_matches(['|', ' ']).split(" | ").collect();
            Row { keys: quoted(cells[0]), example: quoted(cells[cells.len() - 1]) }
        });
        parts.insert(name.trim_matches(['[', ']']), rows.collect());
    }
    parts
}

fn page() -> String {
    repository("docs/SCENE-FILES.md")
}

/// What the parser takes its keys from: by heading, `[time.grid]` or `[[predicts]]`, the rows key, type, default, meaning,
/// example of a Markdown table.
fn of_the_parser() -> BTreeMap<String, Vec<String>> {
    let file: toml::Table = repository("crates/scene/src/keys.toml").parse().expect("TOML");
    let texts = |list: &toml::Value| -> Vec<String> {
        list.as_array()
            .expect("a list")
            .iter()
            .map(|v| v.as_str().expect("a text").into())
            .collect()
    };
    let quoted = |words: &mut dyn Iterator<Item = &str>, between: &str| {
        words.map(|word| format!("`{word}`")).collect::<Vec<_>>().join(between)
    };
    let row = |row: &toml::Value| {
        let row = texts(row);
        let example = match &row[4..] {
            [above] if above == "↑" => above.clone(),
            lines => quoted(&mut lines.iter().map(String::as_str), " "),
        };
        let cells = [&[quoted(&mut row[0].split(' '), ", ")], &row[1..4], &[example]].concat();
        let cells = cells.iter().map(|cell| match cell.is_empty() {
            true => " |".to_owned(),
            false => format!(" {cell} |"),
        });
        format!("|{}", cells.collect::<String>())
    };
    let part = |part: &toml::Value| {
        let heading = match &texts(&part["tables"])[0] {
            list if list.ends_with(".*") => format!("[[{}]]", list.trim_end_matches(".*")),
            table => format!("[{table}]"),
        };
        (heading, part["rows"].as_array().expect("rows").iter().map(row).collect())
    };
    file["part"].as_array().expect("parts").iter().map(part).collect()
}

/// The page with the rows that each part has; headings that no part has, and parts without a heading.
fn rewritten(page: &str) -> (String, BTreeSet<String>) {
    let part_of = |line: &str| line.strip_prefix("### `")?.strip_suffix('`').map(str::to_owned);
    let mut rows = of_the_parser();
    let (mut lines, mut strange) = (Vec::new(), BTreeSet::new());
    let (mut inside, mut next) = (false, Vec::new());
    for line in page.lines() {
        if line.starts_with('#') {
            let part = part_of(line);
            inside = part.is_some();
            next = part.as_ref().and_then(|part| rows.remove(part)).unwrap_or_default();
            strange.extend(part.filter(|_| next.is_empty()));
        }
        if !(inside && line.starts_with("| `")) {
            lines.push(line.to_owned());
        }
        if line.starts_with("|---") {
            lines.append(&mut next);
        }
    }
    strange.extend(rows.into_keys());
    (lines.join("\n") + "\n", strange)
}

#[test]
fn the_page_has_the_keys_of_the_parser() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/SCENE-FILES.md");
    let (written, strange) = rewritten(&page());
    assert_eq!(strange, BTreeSet::new());
    if std::env::var_os("SCENE_KEYS_WRITE").is_some() {
        std::fs::write(path, &written).expect("a written page");
    }
    let page = page();
    assert!(page == written, "docs/SCENE-FILES.md is stale: SCENE_KEYS_WRITE=1 writes it anew");
    let row = page.lines().find(|line| line.starts_with("| `horizon` |")).expect("a row");
    let fewer = page.replace(row, "");
    assert_ne!(rewritten(&fewer).0, fewer, "a key that is missing is not seen");
    let heading = "### `[time.grid]`\n";
    assert_eq!(rewritten(&page.replace(heading, "")).1, BTreeSet::from(["[time.grid]".into()]));
}

fn key_of(line: &str) -> &str {
    line.split(" = ").next().unwrap_or_default()
}

/// A scene with an example in the place of its keys. An example of `[contact.law]` that begins with `law =` is the
/// whole table.
fn with(scene: &str, part: &str, example: &[&str]) -> String {
    let (parent, last) = part.rsplit_once('.').unwrap_or(("", part));
    let part = if example.iter().any(|line| key_of(line) == last) { parent } else { part };
    let lines: Vec<&str> = scene.lines().collect();
    let is_head = |line: &&str| {
        [format!("[{part}]"), format!("[[{part}]]")].iter().any(|h| line.starts_with(h))
    };
    let Some(head) = lines.iter().position(is_head) else {
        return format!("{scene}\n[{part}]\n{}\n", example.join("\n"));
    };
    let rest = &lines[head + 1..];
    let length = rest.iter().position(|line| line.starts_with('[')).unwrap_or(rest.len());
    let replaced = |line: &&&str| example.iter().any(|new| key_of(new) == key_of(line));
    let kept = rest[..length].iter().filter(|line| !replaced(line));
    let all = lines[..=head].iter().chain(example).chain(kept).chain(&rest[length..]);
    all.flat_map(|line| [*line, "\n"]).collect()
}

/// Shipped scenes, one whose region is a physical group of its mesh file, and one without a grid.
fn scenes() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manufactured");
    let entries = std::fs::read_dir(folder).expect("scenes").map(|entry| entry.expect("an entry"));
    let files = entries.map(|entry| entry.path());
    let mut files: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    files.sort();
    let region =
        "\n[[material.region]]\nname = \"a\"\nphysical = \"lower\"\nlambda = 1.0\nmu_L = 1.0\n";
    let steady = text("steady");
    let no_grid = steady
        .split("\n[sweep]")
        .next()
        .expect("a scene")
        .replace("[scene]", "[scene]\njudge = false");
    let texts = files.iter().map(|path| std::fs::read_to_string(path).expect("a scene"));
    texts.chain([text("frustum") + region, no_grid]).collect()
}

/// Whether some scene is read with the example in it.
fn is_read(scenes: &[String], part: &str, example: &[&str]) -> bool {
    let read = |text| Scene::from_source(Source::from_text("manufactured/example.toml", text));
    scenes.par_iter().any(|scene| read(with(scene, part, example)).is_ok())
}

/// Examples that no scene takes, and keys that no example of their part has.
fn faults(page: &str) -> Vec<String> {
    let scenes = scenes();
    let mut faults = Vec::new();
    for (part, rows) in documented(page) {
        let examples = rows.iter().map(|row| &row.example).filter(|example| !example.is_empty());
        let refused = examples.clone().filter(|example| !is_read(&scenes, part, example));
        faults.extend(refused.map(|example| format!("[{part}]: {}", example.join(", "))));
        let has = |line: &str, key: &str| line.contains(&format!("{key} = "));
        let shown = |key: &str| examples.clone().flatten().any(|line| has(line, key));
        let keys = rows.iter().flat_map(|row| &row.keys).filter(|key| !shown(key));
        faults.extend(keys.map(|key| format!("[{part}]: {key} has none")));
    }
    faults
}

#[test]
fn every_example_is_read() {
    let page = page();
    assert_eq!(faults(&page), Vec::<String>::new());
}

#[test]
fn a_wrong_example_and_a_missing_one_are_seen() {
    let page = "\n### `[time]`\n\n| `horizon` | time | needed | T | `horizon = 2.0` |\n\
        | `grid` | table | uniform | steps | `grid = { kind = \"uniform\" }` |\n";
    assert_eq!(faults(page), Vec::<String>::new());
    let edited = |from: &str, to: &str| faults(&crate::shipped::edited(page, from, to));
    assert_eq!(edited("2.0", "-2.0"), ["[time]: horizon = -2.0"]);
    assert_eq!(edited("\"uniform\"", "\"even\""), ["[time]: grid = { kind = \"even\" }"]);
    assert_eq!(edited("`horizon = 2.0`", ""), ["[time]: horizon has none"]);
}
