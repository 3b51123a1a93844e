//! Source: docs/NEW-SCENE.md, docs/FAQ.md.
//! Goal: every command of a page, run in its order on the file that its blocks build, prints what the page shows; every
//!   message that a page quotes is one of the program; files that pages name are there.
//! Data: `toml` blocks are appended, `diff` blocks replace a line's part, `console` blocks are commands with their output,
//!   `text` blocks are messages with … for what varies.

use std::path::Path;
use std::process::Command;

use crate::program::{Folder, files_below, repository};

/// A numbers' rounding on another machine: nothing printed has more than five digits, and what is below this is rounding.
const DIGITS: f64 = 1e-3;
const ROUNDING: f64 = 1e-9;

/// Fenced blocks: language and text.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    let mut rest = page;
    while let Some((_, after)) = rest.split_once("```") {
        let (language, body) = after.split_once('\n').expect("a block");
        let (text, next) = body.split_once("```").expect("an end of the block");
        found.push((language, text));
        rest = next;
    }
    found
}

/// Words equal, or numbers equal to rounding.
fn same(word: &str, other: &str) -> bool {
    let number =
        |word: &str| word.trim_matches(|c: char| "[](),;:%".contains(c)).parse::<f64>().ok();
    match (number(word), number(other)) {
        _ if word == other => true,
        (Some(a), Some(b)) => (a - b).abs() <= DIGITS * a.abs().max(b.abs()) + ROUNDING,
        _ => false,
    }
}

/// Where two texts differ; costs are predictions of time and left out. A line of … on the page stands for any lines.
fn difference(shown: &str, printed: &str) -> Option<String> {
    let lines = |text: &str| -> Vec<String> {
        let words = |line: &str| line.split("about").next().unwrap_or("").trim_end().to_owned();
        text.lines().map(words).collect()
    };
    let (mut shown, printed) = (lines(shown), lines(printed));
    if let Some(at) = shown.iter().position(|line| line == "…")
        && shown.len() <= printed.len()
    {
        let tail = printed.len() + at + 1 - shown.len();
        shown.splice(at..=at, printed[at..tail].iter().cloned());
    }
    let differ = |(a, b): &(&String, &String)| {
        let (a, b): (Vec<_>, Vec<_>) =
            (a.split_whitespace().collect(), b.split_whitespace().collect());
        a.len() != b.len() || !a.iter().zip(&b).all(|(a, b)| same(a, b))
    };
    if let Some((a, b)) = shown.iter().zip(&printed).find(differ) {
        return Some(format!("the page says\n  {a}\nthe program\n  {b}"));
    }
    (shown.len() != printed.len()).then(|| format!("{} lines, not {}", printed.len(), shown.len()))
}

/// What a command prints in the folder: results, errors without progress, exit code.
fn printed(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sweep"));
    command.args(arguments).current_dir(folder).env_remove("RUST_BACKTRACE");
    command.env_remove("GITHUB_ACTIONS").env_remove("GITHUB_STEP_SUMMARY");
    let output = command.output().expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    let (results, errors) = (text(&output.stdout), text(&output.stderr));
    let progress =
        |line: &&str| line.starts_with('[') && line.contains(']') || line.ends_with(" cases");
    let errors: Vec<&str> = errors.lines().filter(|line| !progress(line)).collect();
    let code = output.status.code().expect("an exit code");
    let all = format!("{}\n{}", results.trim_end(), errors.join("\n"));
    format!("{}\n(exit code {code})\n", all.trim_matches('\n'))
}

/// The sources with the strings that go on in the next line put together.
fn sources() -> &'static str {
    static TEXT: std::sync::OnceLock<String> = std::sync::OnceLock::new();
    TEXT.get_or_init(|| {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let files =
            ["src", "crates"].iter().flat_map(|folder| files_below(&root.join(folder), "rs"));
        files.map(|path| std::fs::read_to_string(path).expect("a source")).collect()
    })
}

/// Words of a message between what varies that stand in no string of the program.
fn unsaid(message: &str) -> Option<&str> {
    let parts = message.trim().split('…').map(|part| part.trim_matches(['`', ' ']));
    let (said, mut rest) = (sources(), parts.filter(|part| !part.is_empty()));
    rest.find(|part| !said.contains(*part))
}

/// Runs a page; the first difference.
fn followed(page: &str) -> Option<String> {
    let folder = Folder::new("new-scene");
    let file = folder.at("my-layer.toml");
    std::fs::write(&file, "").expect("a file");
    let read = || std::fs::read_to_string(&file).expect("the scene");
    for (language, text) in blocks(page) {
        match language {
            "toml" => {
                let before = read();
                let gap = if before.is_empty() { "" } else { "\n" };
                std::fs::write(&file, format!("{before}{gap}{text}")).expect("a file");
            }
            "diff" => {
                let part = |sign: &str| {
                    text.lines().find_map(|line| line.strip_prefix(sign)).expect("a part")
                };
                std::fs::write(&file, crate::shipped::edited(&read(), part("- "), part("+ ")))
                    .expect("a file");
            }
            "console" => {
                let (command, shown) = text.split_once('\n').expect("a command");
                let arguments = command.strip_prefix("$ sweep ").expect("a command of sweep");
                let arguments: Vec<&str> = arguments.split(' ').collect();
                let found = difference(shown, &printed(&folder.at(""), &arguments));
                if let Some(what) = found {
                    return Some(format!("{command}: {what}"));
                }
            }
            "text" => {
                if let Some(words) = unsaid(text) {
                    return Some(format!("no message has the words: {words}"));
                }
            }
            other => return Some(format!("a block in {other}")),
        }
    }
    None
}

#[test]
fn the_page_prints_what_it_shows() {
    let page = repository("docs/NEW-SCENE.md");
    assert!(page.matches("$ sweep ").count() >= 10 && page.contains("(exit code 0)"));
    if let Some(what) = followed(&page) {
        panic!("{what}");
    }
    // A message that is no longer printed, and a verdict that is another one, are seen.
    let head = page.split("## 2.").next().expect("a first section");
    assert_eq!(followed(head), None);
    let other = crate::shipped::edited(head, "my-layer.toml is empty", "my-layer.toml is blank");
    assert!(followed(&other).is_some_and(|what| what.contains("is blank")));
}

fn document(name: &str) -> String {
    repository(&format!("docs/{name}"))
}

#[test]
fn every_message_of_the_questions_is_one_of_the_program() {
    let page = document("FAQ.md");
    assert!(page.matches("```text").count() >= 20);
    if let Some(what) = followed(&page) {
        panic!("{what}");
    }
    let other =
        crate::shipped::edited(&page, "no condition on the side", "no conditions on the side");
    assert_eq!(
        followed(&other).as_deref(),
        Some("no message has the words: no conditions on the side")
    );
    let other =
        crate::shipped::edited(&page, "error: nothing/cases.csv", "error: nothing/cases.tsv");
    assert!(followed(&other).is_some_and(|what| what.contains("cases.tsv")));
}

/// Paths in code, `src/…` and the like, as far as they are paths of this repository.
fn lost(page: &str) -> Vec<&str> {
    let code = page.split('`').skip(1).step_by(2);
    let named = code.filter(|code| {
        ["src/", "crates/", "tests/", "docs/", "manufactured/"]
            .iter()
            .any(|folder| code.starts_with(folder))
            && !code.contains(|c: char| "…*{ ".contains(c))
    });
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    named.filter(|path| !root.join(path).exists()).collect()
}

#[test]
fn files_that_the_guide_names_are_there() {
    for name in ["EXTENDING.md", "FAQ.md", "CONTACT-LAWS.md", "NEW-SCENE.md"] {
        assert_eq!(lost(&document(name)), Vec::<&str>::new(), "{name}");
    }
    assert_eq!(lost("see `src/lib.rs` and `src/no.rs`"), ["src/no.rs"]);
}

#[test]
fn differences_are_seen() {
    assert_eq!(difference("a 5.1e-15 [0.90, 1.06]\n", "a 7.3e-15 [0.90, 1.06]\n"), None);
    assert!(difference("a [0.90, 1.06]\n", "a [0.91, 1.06]\n").is_some());
    assert!(difference("a\n", "a\nb\n").is_some());
    assert_eq!(difference("a\n…\nd\n", "a\nb\nc\nd\n"), None);
    assert!(difference("a\n…\nd\n", "a\nb\nc\ne\n").is_some());
    assert_eq!(difference("n = 8: about 2 ms\n", "n = 8: about 3 ms\n"), None);
}
