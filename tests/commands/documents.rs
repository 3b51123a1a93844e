//! Source: README.md, the pages under docs/.
//! Goal: what a page prints is what the program prints, no link is broken, each page names its reader and is in the book, and
//!   the pages stay short. Keys of scene files: scene_keys.
//! Data: the pages; a page with a seeded mistake for each check.

use std::path::{Path, PathBuf};

use scene::{Registry, Scene};

use crate::program::{Folder, code, ends, json, repository as read, stdout, sweep};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Pages written by a command or a test: their length is that of what they list.
const GENERATED: [&str; 5] = ["EQUATIONS.md", "JSON.md", "LADDERS.md", "SABOTAGE.md", "SCENES.md"];

/// Names of the pages under docs/, without the book's table of contents.
fn pages() -> Vec<String> {
    let folder = std::fs::read_dir(root().join("docs")).expect("docs");
    let names =
        folder.map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"));
    let mut names: Vec<String> =
        names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md").collect();
    names.sort();
    assert!(names.len() > 15, "{names:?}");
    names
}

/// Words: what stands between blanks and has a letter or a digit, so that the bars of a table are none.
fn words(text: &str) -> usize {
    let is_word = |word: &&str| word.chars().any(char::is_alphanumeric);
    text.split_whitespace().filter(is_word).count()
}

/// The first block of a page that opens with `fence`.
fn block(page: &str, fence: &str) -> String {
    let start = page.find(fence).unwrap_or_else(|| panic!("no {fence}")) + fence.len();
    let length = page[start..].find("```").expect("an end");
    page[start..start + length].trim().to_owned()
}

/// Words of a line, so that the width of a table does not count.
fn cells(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

#[test]
fn the_readme_is_short() {
    let readme = read("README.md");
    assert!(words(&readme) <= 900, "{} words", words(&readme));
    // Bars of tables count here, as `wc -w` counts.
    assert!(read("benches/README.md").split_whitespace().count() <= 800);
    assert_eq!(words("| two | words |\n"), 2);
}

/// Rows of the README's first table that are not among the printed ones.
fn unprinted(readme: &str, printed: &str) -> Vec<String> {
    let shown = block(readme, "orders, such as\n\n```text\n");
    let rows: Vec<Vec<&str>> = printed.lines().map(cells).collect();
    let verdict = |line: &&str| line.contains('[');
    assert_eq!(shown.lines().filter(verdict).count(), 3);
    let missing = |line: &&str| !rows.contains(&cells(line));
    shown.lines().filter(verdict).filter(missing).map(str::to_owned).collect()
}

#[test]
#[ignore = "a third of the main job: make test-long"]
fn long_the_readme_shows_what_the_main_job_prints() {
    let readme = read("README.md");
    let folder = Folder::new("readme-rows");
    let out = folder.argument("out");
    let printed = stdout(&sweep(&[
        "gate",
        "affine",
        "pure-mild",
        "steady",
        "symmetry-box",
        "--quiet",
        "--out",
        &out,
    ]));
    assert_eq!(unprinted(&readme, &printed), Vec::<String>::new());
    assert_eq!(unprinted(&readme.replacen("0.99 [0.9", "0.98 [0.9", 1), &printed).len(), 1);
    let baseline: serde_json::Value =
        serde_json::from_str(&read("reports/baseline.json")).expect("JSON");
    let recorded: Vec<&serde_json::Value> =
        baseline["scenes"].as_object().expect("scenes").values().collect();
    let sum = |count: &dyn Fn(&serde_json::Value) -> usize| -> usize {
        recorded.iter().map(|scene| count(scene)).sum()
    };
    let of = |scene: &serde_json::Value, key: &str| scene[key].as_array().map_or(0, Vec::len);
    let cases = sum(&|scene| of(scene, "cases"));
    let verdicts = sum(&|scene| of(scene, "owes"));
    let constants = sum(&|scene| {
        let owed = scene["owes"].as_array().into_iter().flatten();
        owed.map(|verdict| of(verdict, "constants")).sum()
    });
    // The claim that readers know by name stands in the reason of a prediction.
    let registry = Registry::open(&root().join("manufactured")).expect("the scenes");
    let scenes: Vec<Scene> =
        registry.names().map(|name| registry.load(name).expect("a scene")).collect();
    let judged = scenes.iter().filter(|scene| scene.judge && !scene.long);
    let reasons: Vec<&String> = judged.flat_map(|scene| &scene.predicts).map(|p| &p.why).collect();
    let held = ["(5.26)", "Theorem 7", "(5.24)"].map(|claim| {
        let count = reasons.iter().filter(|why| why.contains(claim)).count();
        format!("{claim}: {count} of {count}; ")
    });
    let written: serde_json::Value =
        serde_json::from_str(&folder.read("out/verdict.json")).expect("JSON");
    // The least certain of all scenes is one of those that run here.
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let least = written["verdicts"]
        .as_array()
        .expect("verdicts")
        .iter()
        .min_by(|a, b| number(&a["probability"]).total_cmp(&number(&b["probability"])))
        .expect("a verdict");
    let least = format!(
        "{}, {} in {}: {:.2} [{:.2}, {:.2}] for {} holds with probability {:.2}, pass.",
        least["scene"].as_str().expect("a name"),
        least["norm"].as_str().expect("a norm"),
        least["variable"].as_str().expect("a variable"),
        number(&least["observed"]),
        number(&least["interval"][0]),
        number(&least["interval"][1]),
        number(&least["predicted"]),
        number(&least["probability"])
    );
    for line in [
        held.concat(),
        least,
        format!("{cases} cases, 0 failed; {verdicts} of {verdicts} verdicts as expected"),
        format!("baseline: {verdicts} verdicts and {constants} compared constants recorded"),
    ] {
        assert!(readme.contains(&line), "{line}");
    }
}

#[test]
fn the_table_of_the_readme_is_judged_as_it_says() {
    let readme = read("README.md");
    let folder = Folder::new("readme");
    let table = folder.file("table.csv", &block(&readme, "```csv\n"));
    let shown = block(&readme, "```console\n$ sweep fit table.csv --p 1\n");
    let printed = sweep(&["fit", &table, "--p", "1"]);
    let printed = format!("{}\n(exit code {})", stdout(&printed).trim(), code(&printed));
    assert_eq!(printed, shown);
}

#[test]
fn the_estimate_of_the_readme_is_the_one_printed() {
    let readme = read("README.md");
    let line = readme.lines().find(|line| line.starts_with("sweep solve ")).expect("a command");
    let printed = stdout(&sweep(&cells(line)[1..]));
    let shown = block(
        &readme,
        "upper end of the interval, and the run that checks the first:\n\n```text\n",
    );
    assert_eq!(shown.lines().count(), 3);
    for line in shown.lines() {
        assert!(printed.contains(line.trim()), "{line}\n{printed}");
    }
}

/// The commands that need scikit-fem run in `make verify-examples`.
#[test]
fn the_solvers_of_the_readme_run_in_the_examples() {
    let (readme, script) = (read("README.md"), read("tests/verify_examples.sh"));
    let verified: Vec<&str> =
        readme.lines().filter(|line| line.starts_with("sweep verify ")).collect();
    assert_eq!(verified.len(), 2);
    for line in verified {
        let scene = cells(line)[2];
        let wrong = line.contains("--rule rectangle");
        let run = if wrong {
            format!("verify {scene} --solver \"$solver --rule rectangle\"")
        } else {
            format!("\"$solver\" {scene}\n")
        };
        assert!(script.contains(&run), "{run}");
    }
}

#[test]
#[ignore = "ten scenes: make test-long"]
fn long_the_gallery_shows_what_its_commands_find() {
    let page = read("docs/GALLERY.md");
    let scenes: Vec<&str> =
        page.lines().filter_map(|line| line.trim().strip_prefix("sweep run ")).collect();
    assert_eq!(scenes.len(), 10);
    let folder = Folder::new("gallery");
    let file = folder.argument("verdict.json");
    ends(
        0,
        &[&["gate", "--quiet", "--out", &folder.argument("out"), "--json", &file], &scenes[..]]
            .concat(),
    );
    let judged: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&file).expect("a file")).expect("JSON");
    let questions = json(&sweep(&["list", "--json"]));
    let mut missing = Vec::new();
    for scene in scenes {
        let of = |list: &serde_json::Value, key: &str| {
            let found = list.as_array().expect("a list").iter().find(|one| one[key] == scene);
            found.unwrap_or_else(|| panic!("{scene}")).clone()
        };
        let verdict = of(&judged["verdicts"], "scene");
        let number = |value: &serde_json::Value| value.as_f64().expect("a number");
        let [lo, hi] = [0, 1].map(|end| number(&verdict["interval"][end]));
        let line = format!(
            "order {:.2} in [{lo:.2}, {hi:.2}], predicted {}: {}.",
            number(&verdict["observed"]),
            number(&verdict["predicted"]),
            verdict["verdict"].as_str().expect("a word"),
        );
        let question = of(&questions, "name")["question"].as_str().expect("a text").to_owned();
        let section = page.split(&format!("## `{scene}`")).nth(1).expect("a section");
        let section = section.split("\n## ").next().expect("its end");
        let absent = [line, question].into_iter().filter(|text| !section.contains(text));
        missing.extend(absent.map(|text| format!("{scene}: {text}")));
    }
    assert_eq!(missing, Vec::<String>::new());
}

/// Files that the links of a page name and that are not there.
fn broken(page: &str, text: &str) -> Vec<String> {
    let folder: PathBuf = root().join(page).parent().expect("a folder").into();
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let files = targets.filter(|target| !target.contains("://") && !target.starts_with('#'));
    let path = |target: &str| target.split('#').next().unwrap_or(target).to_owned();
    let files = files.filter(|target| !target.contains(' ')).map(path);
    files.filter(|target| !folder.join(target).exists()).map(|t| format!("{page}: {t}")).collect()
}

#[test]
fn no_link_is_broken() {
    let docs = pages().into_iter().map(|name| format!("docs/{name}"));
    let others = [
        "README.md",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "benches/README.md",
        "docs/SUMMARY.md",
        "reports/README.md",
        "manufactured/REFERENCES.md",
        "examples/python/README.md",
    ];
    let all = docs.chain(others.map(str::to_owned));
    let lost: Vec<String> = all.flat_map(|page| broken(&page, &read(&page))).collect();
    assert!(lost.is_empty(), "{}", lost.join("\n"));
    assert_eq!(broken("docs/FAQ.md", "[a](NOWHERE.md#b)"), ["docs/FAQ.md: NOWHERE.md"]);
}

/// Package registries show these pages, and no other file of the repository.
#[test]
fn published_pages_have_no_relative_links() {
    let manifest = read("Cargo.toml");
    assert!(manifest.contains("\nreadme = \"src/README.md\"\n"));
    let relative = |text: &str| text.split("](").skip(1).any(|rest| !rest.starts_with("https://"));
    for page in ["src/README.md", "crates/judge/README.md", "python/README.md"] {
        assert!(!relative(&read(page)), "{page}");
    }
    assert!(relative(&read("README.md")));
}

/// What is wrong with the first lines of a page.
fn names_no_reader(text: &str) -> bool {
    let mut lines = text.lines().filter(|line| !line.is_empty());
    !(lines.next().is_some_and(|title| title.starts_with("# "))
        && lines.next().is_some_and(|line| line.starts_with("For ")))
}

#[test]
fn every_page_names_its_reader_and_is_in_the_book() {
    let book = read("docs/SUMMARY.md");
    for name in pages() {
        assert!(!names_no_reader(&read(&format!("docs/{name}"))), "{name} names no reader");
        assert!(book.contains(&format!("({name})")), "{name} is not in docs/SUMMARY.md");
    }
    for page in [
        "README.md",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "benches/README.md",
        "examples/python/README.md",
        "manufactured/REFERENCES.md",
        "python/README.md",
        "reports/README.md",
        "src/README.md",
    ] {
        assert!(!names_no_reader(&read(page)), "{page} names no reader");
    }
    assert!(names_no_reader("# Title\n\nWhat it is.\n"));
}

#[test]
fn the_pages_stay_short() {
    let written = pages().into_iter().filter(|name| !GENERATED.contains(&name.as_str()));
    let counts: Vec<(String, usize)> = written
        .map(|name| (name.clone(), words(&by_hand(&read(&format!("docs/{name}"))))))
        .collect();
    let all: usize = counts.iter().map(|(_, words)| words).sum();
    assert!(all <= LONGEST, "{all} words: {counts:?}");
}

/// Each page of a further estimate.
const OF_ESTIMATE: usize = 500;

#[test]
fn pages_of_estimates_are_short_and_in_the_book() {
    let (book, folder) = (read("docs/SUMMARY.md"), root().join("docs/estimates"));
    for entry in std::fs::read_dir(folder).expect("docs/estimates") {
        let name = entry.expect("an entry").file_name().into_string().expect("UTF-8");
        let (page, text) =
            (format!("docs/estimates/{name}"), read(&format!("docs/estimates/{name}")));
        assert!(words(&text) <= OF_ESTIMATE, "{page}: {} words", words(&text));
        assert!(!names_no_reader(&text), "{page} names no reader");
        assert!(book.contains(&format!("(estimates/{name})")), "{page} is not in docs/SUMMARY.md");
        assert_eq!(broken(&page, &text), Vec::<String>::new());
    }
}

/// A page without the tables that tests write (tests/sabotage/protocol.rs).
fn by_hand(page: &str) -> String {
    ["| mistake |", "| penalty |"].iter().fold(page.to_owned(), |page, head| {
        let table = page.find(head).map_or("", |from| {
            let rest = &page[from..];
            &rest[..rest.find("\n\n").unwrap_or(rest.len())]
        });
        page.replace(table, "")
    })
}

/// Words of all pages that are written by hand.
const LONGEST: usize = 18_000;
