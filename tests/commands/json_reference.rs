//! Source: docs/JSON.md.
//! Goal: the page has every key that a command prints with --json, with its type, and none that no command prints.
//! Data: one or more runs of each command. `JSON_WRITE=1` writes keys and types into the page and keeps what it says of them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use run::external::encode;
use serde_json::Value;

use crate::program::{Folder, json, repository, stderr, sweep};

/// A section of the page, by its heading, and what is run for it; `DIR` is a folder of the test.
const RUNS: &[(&str, &[&str])] = &[
    (
        "run, gate, merge",
        &[
            "run affine --n 4 --steps 4,8,16 --out DIR/one",
            "run broken-kernel --n 4 --steps 4,8 --out DIR/two",
            "run linear-punch --n 4,8,16 --steps 4 --out DIR/three",
            "run affine --out DIR/four --baseline DIR/base.json",
        ],
    ),
    ("run --list-cases", &["run affine --list-cases"]),
    ("verify", &["verify state-instant --beside --results DIR/wrong --out DIR/seen"]),
    (
        "fit",
        &[
            "fit DIR/line.csv --p 1 --window 0.01,1",
            "fit DIR/short.csv --p 1",
            "fit DIR/grid.csv --p 1 --q 2",
            "fit DIR/path.csv --p 1 --q 2",
            "fit DIR/values.csv --p 1",
        ],
    ),
    ("list", &["list affine"]),
    ("check", &["check affine --floors --n 4 --steps 4", "check punch", "check layered"]),
    (
        "solve",
        &["solve punch --n 4 --steps 2", "solve punch --n 4 --steps 2 --solver decomposition"],
    ),
    (
        "solve --estimate",
        &[
            "solve viscoelastic --n 8 --steps 4 --estimate --target 0.01",
            "solve punch --n 8 --steps 4 --estimate",
        ],
    ),
    ("bound", &["bound memory-minus-identity --n 4 --steps 4"]),
    ("gronwall", &["gronwall affine --steps 8,16", "gronwall abstract-smooth --steps 8,16"]),
    ("audit", &["audit compliance --n 4 --steps 2"]),
    ("estimators", &["estimators law-linear --n 8,16,32", "estimators friction-jump --n 8,16,32"]),
    ("trade", &["trade compliance --n 4,8,16 --steps 2,4,8 --target 0.03 --confirm"]),
    ("diagnose", &["diagnose affine --always"]),
    ("extremes", &["extremes one-vertex"]),
];

/// Objects that several commands print, by the path to them.
const SHARED: [(&str, &str); 10] = [
    ("verdicts[]", "A verdict"),
    ("claims[]", "A claim"),
    ("trials[].claim", "A claim"),
    ("bound.largest", "A guaranteed bound"),
    ("bound.levels[]", "A guaranteed bound"),
    ("answer", "A run that is recommended"),
    ("candidates[]", "A run that is recommended"),
    ("recommendation.choice", "A run that is recommended"),
    ("recommendation.cautious", "A run that is recommended"),
    ("state", "solve"),
];
/// Commands whose output has these keys, which stand in a section of their own.
const TOP: [(&[&str], &[&str], &str); 2] = [
    (&["verify"], &["failures", "provenance", "verdicts"], "run, gate, merge"),
    (
        &["bound", "gronwall", "audit", "estimators", "trade", "diagnose", "extremes"],
        &["claims", "fingerprint", "holds", "scene"],
        "A study",
    ),
];
/// Objects whose keys are names.
const MAPS: [&str; 3] = ["provenance.scenes", "constants", "grids[].effectivity"];
/// Printed where measured seconds grow with n and N, which those of so small runs need not do.
const BY_THE_CLOCK: (&str, &str) = ("trade", "coupling.");
const PAGE: &str = "docs/JSON.md";

/// Types by key, in a section.
type Keys = BTreeMap<String, BTreeSet<String>>;

/// What follows `## ` in the page, with its keys.
type Sections = BTreeMap<String, Keys>;

/// Adds the keys below a value, under the section that has its path.
fn collect(value: &Value, section: &str, path: &str, into: &mut Sections) {
    for (prefix, shared) in SHARED {
        if path == prefix && section != shared {
            return collect(value, shared, "", into);
        }
    }
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Object(map) => {
            let named =
                MAPS.contains(&path) && map.values().all(|v| v.is_object() || v.is_string());
            for (key, value) in map {
                let path = below(if named { "*" } else { key });
                let types = into.entry(section.to_owned()).or_default().entry(path.clone());
                types.or_default().insert(kind(value));
                collect(value, section, &path, into);
            }
        }
        Value::Array(list) => {
            let path = format!("{path}[]");
            list.iter().for_each(|value| collect(value, section, &path, into));
        }
        _ => {}
    }
}

fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(_) => "boolean".into(),
        Value::Number(_) => "number".into(),
        Value::String(_) => "text".into(),
        Value::Object(_) => "object".into(),
        Value::Array(_) => "list".into(),
    }
}

/// What the program prints.
fn printed() -> Sections {
    let folder = Folder::new("json-reference");
    prepare(&folder);
    let mut found = Sections::new();
    for &(section, runs) in RUNS {
        for run in runs {
            let run = format!("{run} --json").replace("DIR", &folder.argument(""));
            let output = sweep(&run.split_whitespace().collect::<Vec<_>>());
            assert!(!output.stdout.is_empty(), "{run}: {}", stderr(&output));
            let mut document = json(&output);
            for (_, keys, elsewhere) in TOP.iter().filter(|(of, ..)| of.contains(&section)) {
                for key in keys.iter() {
                    let value = document.as_object_mut().and_then(|document| document.remove(*key));
                    if let Some(value) = value {
                        collect(&serde_json::json!({ *key: value }), elsewhere, "", &mut found);
                    }
                }
            }
            collect(&document, section, "", &mut found);
        }
    }
    found
}

/// Tables, and answers that are zero.
fn prepare(folder: &Folder) {
    let h = [0.25, 0.125, 0.0625, 0.03125];
    let table = |head: &str, row: &dyn Fn(f64) -> String| {
        let rows: Vec<String> = h.iter().map(|h| row(*h)).collect();
        format!("{head}\n{}\n", rows.join("\n"))
    };
    folder.file("line.csv", &table("h,k,error", &|h| format!("{h},0.5,{}", h + 0.2 * h * h)));
    folder.file("short.csv", "h,error\n0.5,0.1\n0.25,0.05\n");
    folder.file("path.csv", &table("h,k,error", &|h| format!("{h},{},{}", h.sqrt(), 1.1 * h)));
    folder.file("values.csv", &table("h,value", &|h| format!("{h},{}", 1.0 + h)));
    let cell = |h: f64, k: f64| format!("{h},{k},{}", h + 0.5 * k * k);
    let row = |h: f64| h_by_k(h, &cell);
    folder.file("grid.csv", &table("h,k,error", &row));
    // A baseline from which every error deviates.
    let shipped = repository("reports/baseline.json");
    let mut recorded: Value = serde_json::from_str(&shipped).expect("JSON");
    doubled(&mut recorded);
    folder.file("base.json", &recorded.to_string());
    let wrong = folder.argument("wrong");
    sweep(&["verify", "state-instant", "--export", &wrong]);
    let cases = std::fs::read_dir(Path::new(&wrong).join("state-instant")).expect("cases");
    for case in cases.map(|case| case.expect("a case").path()) {
        let lines = |name: &str| {
            std::fs::read_to_string(case.join(name)).expect("a table").lines().count() - 1
        };
        let text = std::fs::read_to_string(case.join("case.json")).expect("case.json");
        let steps = serde_json::from_str::<Value>(&text).expect("JSON")["steps"].as_u64();
        let shape = [steps.expect("steps") as usize + 1, lines("vertices.csv"), 2];
        let zeros = vec![0.0; shape.iter().product()];
        std::fs::write(case.join("displacement.npy"), encode(&shape, &zeros)).expect("an answer");
    }
}

/// Every number that is not whole, doubled.
fn doubled(value: &mut Value) {
    match value {
        Value::Number(number) if !number.is_u64() => {
            *value = (2.0 * number.as_f64().expect("a number")).into();
        }
        Value::Array(list) => list.iter_mut().for_each(doubled),
        Value::Object(map) => map.values_mut().for_each(doubled),
        _ => {}
    }
}

fn h_by_k(h: f64, cell: &dyn Fn(f64, f64) -> String) -> String {
    [0.4, 0.2, 0.1, 0.05].map(|k| cell(h, k)).join("\n")
}

/// The rows of the page: key, types and meaning, by heading.
fn written(page: &str) -> BTreeMap<String, Vec<[String; 3]>> {
    let mut sections: BTreeMap<String, Vec<[String; 3]>> = BTreeMap::new();
    for section in page.split("\n## ").skip(1) {
        let (heading, body) = section.split_once('\n').unwrap_or((section, ""));
        let rows = body.lines().filter_map(|line| {
            let cells: Vec<&str> = line.strip_prefix("| `")?.splitn(3, " | ").collect();
            let [key, kinds, meaning] = cells[..] else { return None };
            let key = key.trim_end_matches('`');
            Some([key, kinds, meaning.trim_end_matches('|').trim()].map(str::to_owned))
        });
        sections.insert(heading.replace('`', ""), rows.collect());
    }
    sections
}

/// Commands that take --json and are never run here.
fn unseen(runs: &[(&str, &[&str])]) -> Vec<String> {
    let help = |words: &[&str]| String::from_utf8_lossy(&sweep(words).stdout).into_owned();
    let program = help(&["--help"]);
    let listed = program.lines().filter_map(|line| line.strip_prefix("  ")?.split_once(' '));
    // The first letter tells a command from an example or an option.
    let commands = listed.map(|(name, _)| name).filter(|name| {
        *name != "sweep" && name.starts_with(|first: char| first.is_ascii_lowercase())
    });
    let takes = commands.filter(|name| help(&[name, "--help"]).contains("--json"));
    let ran = |name: &&str| {
        runs.iter().any(|(_, runs)| runs.iter().any(|run| run.split(' ').next() == Some(name)))
    };
    takes.filter(|name| !ran(name)).map(str::to_owned).collect()
}

fn by_the_clock(section: &str, key: &str) -> bool {
    section == BY_THE_CLOCK.0 && key.starts_with(BY_THE_CLOCK.1)
}

fn differences(page: &str, printed: &Sections) -> Vec<String> {
    let written = written(page);
    let mut wrong = Vec::new();
    let nothing = Vec::new();
    for (section, keys) in printed {
        let rows = written.get(section).unwrap_or(&nothing);
        for (key, kinds) in keys {
            match rows.iter().find(|row| row[0] == *key) {
                None => wrong.push(format!("{section}: no `{key}`")),
                Some([_, said, _]) => {
                    let said: Vec<&str> = said.split(" or ").collect();
                    let other = kinds.iter().filter(|kind| !said.contains(&kind.as_str()));
                    wrong.extend(other.map(|kind| format!("{section}: `{key}` may be {kind}")));
                }
            }
        }
    }
    for (section, rows) in &written {
        for [key, _, meaning] in rows {
            let known = printed.get(section).is_some_and(|keys| keys.contains_key(key));
            if !known && !by_the_clock(section, key) {
                wrong.push(format!("{section}: `{key}` is never printed"));
            }
            if meaning.len() < 2 {
                wrong.push(format!("{section}: `{key}` without a meaning"));
            }
        }
    }
    wrong
}

/// The page with these keys; what it says of keys that stay is kept.
fn rewritten(page: &str, printed: &Sections) -> String {
    let old = written(page);
    let nothing = Vec::new();
    let mut text = page.split("\n## ").next().unwrap_or_default().to_owned();
    let shared =
        ["A verdict", "A claim", "A study", "A guaranteed bound", "A run that is recommended"];
    let order = shared.into_iter().chain(RUNS.iter().map(|(section, _)| *section));
    for section in order {
        let rows = old.get(section).unwrap_or(&nothing);
        let _ = write!(text, "\n## {section}\n\n| key | type | what |\n|---|---|---|\n");
        let mut keys = printed[section].clone();
        let kept = rows.iter().filter(|row| by_the_clock(section, &row[0]));
        kept.for_each(|row| _ = keys.entry(row[0].clone()).or_default());
        for (key, kinds) in &keys {
            let row = rows.iter().find(|row| row[0] == *key);
            let mut kinds = kinds.clone();
            kinds.extend(row.iter().flat_map(|row| row[1].split(" or ")).map(str::to_owned));
            let absent = kinds.remove("null").then_some("null".to_owned());
            let kinds: Vec<String> = kinds.into_iter().chain(absent).collect();
            let meaning = row.map_or("?", |row| &row[2]);
            let _ = writeln!(text, "| `{key}` | {} | {meaning} |", kinds.join(" or "));
        }
    }
    text
}

#[test]
fn every_key_of_json_is_in_the_reference() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(PAGE);
    let page = std::fs::read_to_string(&path).expect("the page");
    let printed = printed();
    if std::env::var_os("JSON_WRITE").is_some() {
        std::fs::write(&path, rewritten(&page, &printed)).expect("the page is written");
        return;
    }
    assert_eq!(differences(&page, &printed), Vec::<String>::new());
    // gate and merge print what run prints.
    assert_eq!(unseen(RUNS), ["gate", "merge"]);
    assert!(unseen(&RUNS[1..RUNS.len() - 1]).contains(&"extremes".to_owned()));
    // A key that is renamed, one of another type, and one that the page lacks are seen.
    let seeded = |from: &str, to: &str| differences(&page.replacen(from, to, 1), &printed);
    assert_eq!(seeded("| `probability` |", "| `chance` |").len(), 2);
    assert_eq!(
        seeded("| `newton_iterations` | number |", "| `newton_iterations` | text |").len(),
        1
    );
    assert!(!seeded("| `dofs` |", "dofs").is_empty());
}
