//! Source: docs/SCENE-FILES.md.
//! Goal: the page has every part and key that the parser knows and no other, and every example on it is read.
//! Data: the parser's answer to a key that it does not know, part by part; shipped scenes, into which each example is put;
//!   a page without a key, without a part, and with a wrong example.

use crate::program::repository;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rayon::prelude::*;
use scene::{Scene, Source};

use crate::shipped::text;

/// Keys by part, such as `material.memory`.
type Parts = BTreeMap<String, BTreeSet<String>>;

const BODY: &str = "";
const ABSTRACT: &str =
    "[scene]\nname = \"a\"\nquestion = \"b\"\ndimension = 2\nkind = \"abstract\"\n";

/// The list behind "known here:" in the parser's message, if there is one.
fn known(text: &str) -> Option<BTreeSet<String>> {
    let source = Source::from_text("unknown.toml", text);
    let message = Scene::from_source(source).expect_err("a key is unknown").to_string();
    let (_, list) = message.split_once("known here: ")?;
    Some(list.lines().next()?.split(", ").map(|key| key.trim().to_owned()).collect())
}

/// Every part with its keys, as the parser names them one level after the other.
fn parsed(head: &str) -> Parts {
    let mut parts = Parts::new();
    let all = known(&format!("{head}[unheard-of]\n")).expect("the parts of a file");
    let mut open: Vec<String> = all.into_iter().filter(|part| part != "scene").collect();
    while let Some(part) = open.pop() {
        let one = format!("{head}[{part}]\nunheard-of = 1\n");
        let several = format!("{head}[[{part}]]\nunheard-of = 1\n");
        if let Some(keys) = known(&one).or_else(|| known(&several)) {
            open.extend(keys.iter().map(|key| format!("{part}.{key}")));
            parts.insert(part, keys);
        }
    }
    parts.insert("scene".into(), known("[scene]\nunheard-of = 1\n").expect("the keys of [scene]"));
    parts
}

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

fn keys_of(page: &str) -> Parts {
    let name = |key: &&str| (*key).to_owned();
    let keys = |rows: Vec<Row<'_>>| rows.iter().flat_map(|row| row.keys.iter().map(name)).collect();
    documented(page).into_iter().map(|(part, rows)| (part.to_owned(), keys(rows))).collect()
}

fn page() -> String {
    repository("docs/SCENE-FILES.md")
}

#[test]
fn the_page_has_the_keys_of_the_parser() {
    let mut all = parsed(BODY);
    for (part, keys) in parsed(ABSTRACT) {
        // Parts that both kinds of scene have: the body has more keys.
        let of_a_body = all.entry(part).or_insert_with(|| keys.clone());
        assert!(of_a_body.is_superset(&keys), "{keys:?}");
    }
    // Three kernels under other names.
    for name in ["bulk", "shear"].map(|key| format!("material.memory.{key}")) {
        assert_eq!(all.remove(&name).as_ref(), all.get("material.memory.kernel"), "{name}");
    }
    assert!(all.len() > 20 && all["time.grid"].contains("seed"), "{all:?}");
    let page = page();
    assert_eq!(keys_of(&page), all);
    let row = page.lines().find(|line| line.starts_with("| `horizon` |")).expect("a row");
    assert_ne!(keys_of(&page.replace(row, "")), all, "a key that is missing is not seen");
    let heading = "### `[time.grid]`\n";
    assert_ne!(keys_of(&page.replace(heading, "")), all, "a part that is missing is not seen");
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

/// Every table of a scene with an unknown key added to it, but those whose keys are names of the scene's own.
fn with_unknown_keys(name: &str) -> Vec<(String, String)> {
    const NAMED: [&str; 3] = ["exact.parameters", "exact.define", "loads.traction"];
    let whole: toml::Table = text(name).parse().expect("a scene");
    let (mut texts, mut open) = (Vec::new(), vec![String::new()]);
    while let Some(path) = open.pop() {
        let mut changed = toml::Value::Table(whole.clone());
        let parts = path.split('.').filter(|part| !part.is_empty());
        let found = parts.fold(&mut changed, |value, part| match part.parse::<usize>() {
            Ok(index) => &mut value[index],
            Err(_) => &mut value[part],
        });
        let inner: Vec<String> = match &*found {
            toml::Value::Table(table) => table.keys().cloned().collect(),
            toml::Value::Array(list) => (0..list.len()).map(|index| index.to_string()).collect(),
            _ => continue,
        };
        open.extend(inner.iter().map(|key| format!("{path}.{key}").trim_matches('.').to_string()));
        if let Some(table) = found.as_table_mut().filter(|_| !NAMED.contains(&path.as_str())) {
            table.insert("unheard-of".into(), 1.into());
            texts.push((path, toml::to_string(&changed).expect("TOML")));
        }
    }
    texts
}

/// No table takes a key in silence, wherever it stands: the first level is a part, all others have keys.
#[test]
fn an_unknown_key_is_refused_in_every_table() {
    let mut seen = BTreeSet::new();
    for name in ["layered", "prony", "friction-coulomb", "l-shape", "punch", "abstract-contact"] {
        for (path, text) in with_unknown_keys(name) {
            let said = Scene::from_source(Source::from_text("manufactured/unknown.toml", text));
            let said = said.expect_err(&path).to_string();
            assert!(
                said.starts_with("error: unknown") && said.contains("unheard-of"),
                "{path}: {said}"
            );
            seen.insert(path);
        }
    }
    for part in ["", "material.region.0.memory", "contact.law", "trace.0.law", "predicts.0"] {
        assert!(seen.contains(part), "{part}: {seen:?}");
    }
}
