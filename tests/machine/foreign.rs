//! Text of scenes, tables and solvers stands in messages and files as text: it steers no terminal and commands no log.

use files::{harmless, harmless_json, shortened};

use crate::program::{Folder, ends, json, stderr, stdout, sweep};
use crate::shipped::{edited, text};

/// What a hostile text is made of, as TOML and shell write it: colours by either form of the escape, a command of
/// GitHub Actions on a whole line and in its older form, and a mark that turns the direction of writing.
const TOML: &str = r"a\u001b[31mb\u009b2J\n::error::from outside\n  ::set-output name=a::b\n##[error]old \u202e end";

/// Nothing in the text acts: no control but ends of lines, no line is a command but those that are this program's.
#[track_caller]
fn acts_not(what: &str, text: &str, allowed: &[&str]) {
    let steering = |c: char| (c.is_control() && c != '\n' && c != '\t') || c == '\u{202e}';
    assert!(!text.chars().any(steering), "{what}: {}", text.escape_debug());
    assert!(!text.contains("##["), "{what}: {text}");
    for line in text.lines().filter(|line| line.trim_start().starts_with("::")) {
        assert!(allowed.iter().any(|command| line.starts_with(command)), "{what}: {line}");
    }
}

#[test]
fn nothing_steers_a_terminal_or_commands_a_log() {
    let plain = "a: b::c, h = 1/8\n\tγ ≤ 1 # 2 [3]";
    assert_eq!(harmless(plain), plain);
    assert_eq!(harmless("\u{1b}[31mred\u{7}\r"), "\\u{1b}[31mred\\u{7}\\u{d}");
    assert_eq!(harmless("\u{9b}2J \u{202e}x"), "\\u{9b}2J \\u{202e}x");
    assert_eq!(harmless("x\n  ::error::y\n::a::"), "x\n  \\::error::y\n\\::a::");
    assert_eq!(harmless("a ##[error]b"), "a #\\#[error]b");
    let value = serde_json::json!({ "why": "\u{1b}[1m ##[error] \u{9b} \u{202e} ::x" });
    let text = harmless_json(&value.to_string());
    acts_not("JSON", &text, &[]);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&text).expect("JSON"), value);
    assert_eq!(shortened("abc", 3), "abc");
    assert_eq!(shortened("aγc", 2), "aγ … (1 bytes more)");
}

#[test]
fn texts_of_a_scene_do_nothing() {
    let folder = Folder::new("foreign");
    std::fs::create_dir(folder.at("scenes")).expect("a folder");
    let written = text("affine");
    let line = |key: &str| {
        let found = written.lines().find(|line| line.starts_with(&format!("{key} = ")));
        found.unwrap_or_else(|| panic!("no {key}")).to_owned()
    };
    // A prediction that cannot be met, so that it is shown wherever a verdict is.
    let scene = edited(&written, &line("question"), &format!("question = \"{TOML}\""));
    let scene = edited(&scene, &line("why"), &format!("why = \"{TOML}\""));
    let scene = scene.replace(&line("order"), "order = 7.0");
    let path = folder.file("scenes/affine.toml", &scene);
    let (out, junit, scenes) =
        (folder.argument("out"), folder.argument("junit.xml"), folder.argument("scenes"));
    let summary = folder.at("summary.md");
    let gate = ["gate", &path, "--n", "2,4,8", "--steps", "4", "--out", &out];
    for (arguments, allowed) in [
        (&["list", "--scenes", &scenes][..], &[][..]),
        (&["list", "--markdown", "--scenes", &scenes], &[]),
        (&["list", "--json", "--scenes", &scenes], &[]),
        (&["check", &path], &[]),
        (&[&gate[..], &["--junit", &junit]].concat(), &[]),
        (
            &[&gate[..], &["--github"]].concat(),
            &["::error file=", "::warning file=", "::notice title="],
        ),
        (&["report", &out], &[]),
    ] {
        let mut program = crate::program::command(arguments);
        let output = program.env("GITHUB_STEP_SUMMARY", &summary).output().expect("the binary");
        acts_not(&format!("{arguments:?}"), &stdout(&output), allowed);
        acts_not(&format!("{arguments:?}"), &stderr(&output), &[]);
    }
    // It is said, not left out; within a line it is no command.
    let listed = stdout(&sweep(&["list", "--scenes", &scenes]));
    assert!(
        listed.contains("a\\u{1b}[31mb") && listed.contains("::error::from outside"),
        "{listed}"
    );
    let same = json(&sweep(&["list", "--json", "--scenes", &scenes]));
    assert!(same[0]["question"].as_str().is_some_and(|text| text.contains("\u{1b}[31m")));
    for file in ["out/index.html", "junit.xml", "summary.md"] {
        let written = std::fs::read_to_string(folder.at(file)).expect(file);
        acts_not(file, &written, &[]);
    }
    for name in folder.names().iter().filter(|name| name.ends_with(".md")) {
        acts_not(name, &folder.read(name), &[]);
    }
}

#[cfg(unix)]
#[test]
fn what_a_solver_prints_does_nothing() {
    let folder = Folder::new("foreign-solver");
    let script = "printf '\\033[31mred\\033]0;title\\007\\n::error::from outside\\n::set-output name=a::b\\n##[error]old\\r\\n' >&2\nexit 3\n";
    let solver = format!("sh {}", folder.file("solver.sh", script));
    let out = folder.argument("out");
    let arguments =
        ["verify", "signorini", "--n", "4", "--steps", "2", "--out", &out, "--solver", &solver];
    for more in [&[][..], &["--github"], &["--json"], &["--verbose"]] {
        let output = ends(2, &[&arguments[..], more].concat());
        acts_not(
            "stdout",
            &stdout(&output),
            &["::error file=", "::error title=", "::notice title="],
        );
        acts_not("stderr", &stderr(&output), &[]);
        let said = stdout(&output) + &stderr(&output);
        // A reason has the last line; all of what was printed is shown beside verdicts, not in JSON.
        let all = said.contains("red") && said.contains("from outside");
        assert!(all || (more == ["--json"] && said.contains("old")), "{said}");
    }
    let page = folder.read("out/index.html");
    acts_not("index.html", &page, &[]);
}

#[test]
fn cells_of_a_table_do_nothing() {
    let folder = Folder::new("foreign-table");
    let rows: String =
        [0.5, 0.25, 0.125].map(|h| format!("\"\u{1b}[31m\n::error::x\u{9b}\",{h},{h}\n")).concat();
    let table = folder.file("table.csv", &format!("scene,h,error\n{rows}"));
    let nonsense = folder.file("nonsense.csv", "h,error\n0.5,\u{1b}[31m\n::error::x,1\n");
    for arguments in
        [&["fit", &table, "--p", "1"][..], &["fit", &table, "--json"], &["fit", &nonsense]]
    {
        let output = sweep(arguments);
        acts_not("stdout", &stdout(&output), &[]);
        acts_not("stderr", &stderr(&output), &[]);
    }
}
