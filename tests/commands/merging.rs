//! Source: the contract of `run --list-cases`, `run --only` and `merge`: a sweep in many processes is the sweep of one.
//! Goal: records and verdicts are the same bit for bit; a part that is altered, torn, cut, doubled, foreign or missing is
//!   seen and named; a killed part goes on.
//! Data: signorini, punch with its reference run, an abstract scene, and a scene on which the solver gives up.

use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::{
    Folder, code, command, ends, json, lasting, refused, stderr, stdout, sweep, timeless,
};
use crate::shipped::{edited, text};

/// Names of the files of four scenes; 4 + 4 + 2 + 5 cases.
fn scenes(folder: &Folder) -> Vec<String> {
    let signorini = edited(&text("signorini"), "n = [8, 16, 32, 64]", "n = [4, 8, 16, 32]");
    let punch = edited(&text("punch"), "n = [8, 16, 32]", "n = [4, 8]");
    let punch = edited(&punch, "steps = [8, 16, 32]", "steps = [4, 8]");
    let punch = edited(&punch, "{ n = 128, steps = 64 }", "{ n = 16, steps = 16 }");
    // No step of it has a positive definite tangent, as in tests/commands/cli.rs.
    let strong = edited(&text("viscoelastic"), "-exp(-t)", "-50*exp(-t)");
    let strong = edited(&strong, "dimension = 2", "dimension = 2\nviolates = [\"3.4\"]");
    let strong = edited(&strong, "n = [8, 16, 32, 64]", "n = [2, 4]");
    let strong = edited(&strong, "steps = [16]", "steps = [1]");
    let steps = "steps = [64, 128, 256, 512, 1024, 2048, 4096]";
    let without_mesh = edited(&text("abstract-smooth"), steps, "steps = [16, 32, 64, 128, 256]");
    let named = [
        ("signorini", signorini),
        ("punch", punch),
        ("viscoelastic", strong),
        ("abstract-smooth", without_mesh),
    ];
    named.map(|(name, text)| folder.file(&format!("{name}.toml"), &text)).into()
}

/// The cases of `scenes`, three at a time in `parts`.
struct Many {
    folder: Folder,
    scenes: Vec<String>,
    keys: Vec<String>,
}

const EACH: usize = 3;

impl Many {
    /// All of them run.
    fn new(test: &str) -> Self {
        let folder = Folder::new(test);
        let scenes = scenes(&folder);
        let mut many = Self { keys: Vec::new(), folder, scenes };
        let listed = ends(0, &many.run(&["--list-cases"]));
        many.folder.file("cases.txt", &stdout(&listed));
        many.keys = stdout(&listed).lines().map(str::to_owned).collect();
        assert_eq!(many.keys.len(), 15, "{:?}", many.keys);
        for (number, keys) in many.keys.chunks(EACH).enumerate() {
            let output = many.only(keys, &format!("parts/{number}"), &[]);
            assert_eq!(code(&output), 0, "{}", stderr(&output));
        }
        many
    }

    fn run<'a>(&'a self, more: &[&'a str]) -> Vec<&'a str> {
        let mut arguments = vec!["run"];
        arguments.extend(self.scenes.iter().map(String::as_str));
        arguments.extend(more);
        arguments
    }

    fn only(&self, keys: &[String], out: &str, more: &[&str]) -> Output {
        let out = self.folder.argument(out);
        let mut arguments = self.run(&["--out", &out]);
        arguments.extend(more);
        arguments.push("--only");
        arguments.extend(keys.iter().map(String::as_str));
        sweep(&arguments)
    }

    fn merge(&self, more: &[&str]) -> Output {
        let [parts, cases, out] =
            ["parts", "cases.txt", "merged"].map(|name| self.folder.argument(name));
        sweep(&[&["merge", &parts, "--cases", &cases, "--out", &out][..], more].concat())
    }

    /// The part of a case.
    fn part(&self, key: &str) -> PathBuf {
        let at = self.keys.iter().position(|known| known == key).expect("a case");
        self.folder.at(&format!("parts/{}", at / EACH))
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).expect("a folder");
    for entry in std::fs::read_dir(from).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_file() {
            std::fs::copy(&path, to.join(path.file_name().expect("a name"))).expect("a copy");
        }
    }
}

/// A table as of a program that writes no checksums: what is changed in it is not seen by itself.
fn without_checksums(table: &Path) -> String {
    let text = std::fs::read_to_string(table).expect("a table");
    text.lines().map(|row| row.rsplit_once(',').expect("fields").0.to_owned() + "\n").collect()
}

/// The first row of a case in a table, with another error.
fn altered(table: &Path, begin: &str) -> String {
    let text = without_checksums(table);
    let row = text.lines().find(|row| row.starts_with(begin)).expect("a row");
    let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
    let error: f64 = fields[9].parse().expect("an error");
    fields[9] = format!("{:?}", error * (1.0 + 2.0 * f64::EPSILON));
    text.replacen(row, &fields.join(","), 1)
}

#[test]
fn many_processes_and_one_are_the_same_bit_for_bit() {
    let sweeping = Many::new("many");
    let folder = &sweeping.folder;
    let whole = folder.argument("whole");
    let run = sweep(&sweeping.run(&["--out", &whole]));
    // One scene fails.
    assert_eq!(code(&run), 2, "{}", stderr(&run));
    let same = || {
        assert_eq!(code(&sweeping.merge(&[])), 2);
        let [table, verdict] = ["cases.csv", "verdict.json"]
            .map(|file| [folder.at("whole").join(file), folder.at("merged").join(file)]);
        timeless(&table[0]) == timeless(&table[1]) && lasting(&verdict[0]) == lasting(&verdict[1])
    };
    assert!(same());
    let provenance =
        ["whole", "merged"].map(|dir| lasting(&folder.at(dir).join("provenance.json")));
    assert_eq!(provenance[0], provenance[1]);
    // The reasons of failures came along.
    let failures = lasting(&folder.at("merged/verdict.json"))["failures"].clone();
    assert_eq!(failures.as_array().map(Vec::len), Some(2));
    assert!(failures[0]["reason"].as_str().is_some_and(|r| r.contains("not positive definite")));
    // Pages come from the merged records as from any.
    ends(2, &["report", &folder.argument("merged")]);
    assert!(folder.at("merged/index.html").is_file());
    assert!(same());
    assert!(!folder.at("merged/index.html").exists(), "the page of other records");
    // One bit in one error of one part.
    let table = sweeping.part("signorini:n16:N16").join("cases.csv");
    let sound = std::fs::read(&table).expect("a table");
    std::fs::write(&table, altered(&table, "signorini,2,16,16,")).expect("written");
    assert!(!same(), "an altered part is not seen");
    std::fs::write(&table, sound).expect("written");
    assert!(same());
}

#[test]
fn a_missing_case_is_never_silent() {
    let sweeping = Many::new("missing");
    let part = sweeping.part("signorini:n32:N16");
    // A part that never ran.
    std::fs::rename(&part, sweeping.folder.at("away")).expect("renamed");
    refused(
        &sweeping.merge(&[]),
        &["3 cases missing", "signorini:n32:N16", "--incomplete", "sweep run --only"],
    );
    assert!(!sweeping.folder.at("merged/cases.csv").exists());
    let output = sweeping.merge(&["--incomplete"]);
    assert_eq!(code(&output), 2, "{}", stderr(&output));
    assert!(stderr(&output).contains("signorini:n32:N16"), "{}", stderr(&output));
    let table = std::fs::read_to_string(sweeping.folder.at("merged/cases.csv")).expect("a table");
    let rows: Vec<&str> = table.lines().filter(|r| r.starts_with("signorini,2,32,16,")).collect();
    assert!(!rows.is_empty() && rows.iter().all(|row| row.contains(",,,skipped,")), "{rows:?}");
    let verdicts = lasting(&sweeping.folder.at("merged/verdict.json"))["verdicts"].clone();
    let of_scene = |verdict: &&serde_json::Value| verdict["scene"] == "signorini";
    let found: Vec<_> = verdicts.as_array().expect("a list").iter().filter(of_scene).collect();
    assert!(!found.is_empty() && found.iter().all(|verdict| verdict["verdict"] == "fail"));
    // A part that lost rows at a line break: nothing in the table says so.
    std::fs::rename(sweeping.folder.at("away"), &part).expect("renamed");
    let file = part.join("cases.csv");
    let sound = std::fs::read_to_string(&file).expect("a table");
    let mut lines: Vec<&str> = sound.lines().collect();
    let last = lines.pop().expect("a row");
    std::fs::write(&file, lines.join("\n") + "\n").expect("written");
    let key = last.split(',').collect::<Vec<_>>();
    refused(
        &sweeping.merge(&[]),
        &["1 case missing", &format!("{}:n{}:N{}", key[0], key[2], key[3])],
    );
    // Within a line.
    std::fs::write(&file, &sound[..sound.len() - 7]).expect("written");
    refused(&sweeping.merge(&[]), &[&file.display().to_string(), "cut off"]);
    // A line in the middle that is none.
    std::fs::write(&file, sound.replacen("converged", "convurged", 1)).expect("written");
    refused(&sweeping.merge(&[]), &[":2:", "changed after it was written"]);
    let bare = without_checksums(&file).replacen("converged", "convurged", 1);
    std::fs::write(&file, bare).expect("written");
    refused(&sweeping.merge(&[]), &[":2:", "convurged"]);
    std::fs::write(&file, sound).expect("written");
    assert!(stdout(&sweeping.merge(&[])).contains("0 missing"));
    // Without a list the grids of the files are what is expected.
    let [parts, alone] = ["parts", "alone"].map(|name| sweeping.folder.argument(name));
    let output = sweep(&["merge", &parts, "--out", &alone]);
    assert!(stdout(&output).contains("0 missing"), "{}", stderr(&output));
    let tables = ["alone", "merged"].map(|dir| sweeping.folder.at(dir).join("cases.csv"));
    assert_eq!(timeless(&tables[0]), timeless(&tables[1]));
    let output = sweep(&["merge", &part.display().to_string(), "--out", &alone]);
    refused(&output, &["missing", "grids of the scenes' files", "--cases"]);
}

#[test]
fn records_of_one_case_agree_or_are_refused() {
    let sweeping = Many::new("twice");
    let merged = || timeless(&sweeping.folder.at("merged/cases.csv"));
    assert!(stdout(&sweeping.merge(&[])).contains("0 missing"));
    let once = merged();
    let (part, again) = (sweeping.part("signorini:n16:N16"), sweeping.folder.at("parts/again"));
    copy(&part, &again);
    // The records once more, with other seconds.
    let table = again.join("cases.csv");
    let text = without_checksums(&table);
    assert!(stdout(&sweeping.merge(&[])).contains("0 missing"));
    assert_eq!(merged(), once);
    // Another error, then another count of iterations.
    std::fs::write(&table, altered(&table, "signorini,2,16,16,")).expect("written");
    let both = [part.display().to_string(), again.display().to_string()];
    refused(&sweeping.merge(&[]), &["signorini:n16:N16", &both[0], &both[1]]);
    assert_eq!(merged(), once, "an earlier merge stays until another is complete");
    // Not one of the records, but not to be told from one.
    std::fs::write(&table, text.replace(",converged,", ",failed,")).expect("written");
    refused(&sweeping.merge(&[]), &["differ in more", &both[0], &both[1]]);
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let sweeping = Many::new("foreign");
    // Not the first part of its scene, with which it is compared.
    let part = sweeping.part("signorini:n32:N16");
    let file = part.join("provenance.json");
    let sound = std::fs::read_to_string(&file).expect("a file");
    let hash = json_hash(&sound, "signorini");
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    let name = part.display().to_string();
    for (from, to, said) in [
        (version.as_str(), "\"version\": \"0.0.7\"", "version 0.0.7"),
        (hash.as_str(), "0123456789abcdef", "`signorini` is another one (0123456789abcdef)"),
        ("\"signorini\": \"", "\"stranger\": \"", "which its provenance.json does not name"),
        ("\"platform\": \"", "\"platform\": \"other-", "made on other-"),
    ] {
        std::fs::write(&file, sound.replace(from, to)).expect("written");
        refused(&sweeping.merge(&[]), &[said, &name]);
    }
    std::fs::remove_file(&file).expect("removed");
    refused(&sweeping.merge(&[]), &["without provenance.json", &name]);
    std::fs::write(&file, &sound).expect("written");
    // A case that is not in the list, of a scene that is.
    let more = sweeping.folder.argument("parts/more");
    ends(1, &["run", &sweeping.scenes[0], "--n", "12", "--out", &more, "--quiet"]);
    refused(&sweeping.merge(&[]), &["signorini:n12:N16 is no case of the list", &more]);
    std::fs::remove_dir_all(&more).expect("removed");
    // Into one of the parts, from nothing, from a directory of something else.
    let [parts, empty] = ["parts", "empty"].map(|name| sweeping.folder.argument(name));
    std::fs::create_dir(&empty).expect("a folder");
    refused(&sweep(&["merge", &parts, "--out", &name]), &[&name, "--out"]);
    refused(&sweep(&["merge", &empty, "--out", "nowhere"]), &[&empty, "no cases.csv"]);
    refused(&sweep(&["merge", "no-such", "--out", "nowhere"]), &["no-such"]);
    assert!(stdout(&sweeping.merge(&[])).contains("0 missing"));
}

fn json_hash(text: &str, scene: &str) -> String {
    let document: serde_json::Value = serde_json::from_str(text).expect("JSON");
    document["scenes"][scene].as_str().expect("a hash").to_owned()
}

#[test]
fn keys_are_those_of_the_scenes_and_grids() {
    let folder = Folder::new("keys");
    let out = folder.argument("out");
    let only = |arguments: &[&str]| sweep(&[&["run", "--out", &out], arguments].concat());
    // Scenes by the keys alone, also one that has to be named.
    let output = only(&["--only", "affine:n4:N8", "abstract-smooth:N64"]);
    assert_eq!(stdout(&output), format!("2 cases in {out}, 0 failed\n"), "{}", stderr(&output));
    refused(&only(&["--only", "affine:n3:N8"]), &["affine:n3:N8", "no such case", "--n"]);
    refused(&only(&["affine", "--only", "steady:n8:N1"]), &["steady:n8:N1", "no such case"]);
    refused(&only(&["--only", "stranger:n3:N8"]), &["stranger"]);
    let output = only(&["--n", "3", "affine", "--only", "affine:n3:N8"]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    for wrong in ["affine", "affine:n2", "affine:2:8", ":n2:N8", "affine:N"] {
        refused(&only(&["--only", wrong]), &[&format!("`{wrong}` is no case"), "pure-mild:n16:N4"]);
    }
    // Into a directory of its own, and not that of the main job.
    refused(&sweep(&["run", "--only", "affine:n4:N8"]), &["--out"]);
    // The list, with what each case takes.
    let listed = sweep(&["run", "affine", "--list-cases", "--json"]);
    let cases = json(&listed)["cases"].as_array().expect("a list").clone();
    let keys: Vec<&str> = cases.iter().filter_map(|case| case["key"].as_str()).collect();
    assert_eq!(keys.join("\n") + "\n", stdout(&sweep(&["run", "affine", "--list-cases"])));
    assert!(cases.iter().all(|case| case["memory_bytes"].as_u64().is_some_and(|b| b > 1_000_000)));
    let [list, parts] = [folder.file("cases.txt", "affine:n3:N8\n\naffine\n"), out.clone()];
    let merge = |list: &str| sweep(&["merge", &parts, "--cases", list, "--out", "nowhere"]);
    refused(&merge(&list), &["cases.txt", "line 3", "`affine` is no case"]);
    refused(&merge(&folder.file("empty.txt", "\n")), &["no case in it", "--list-cases"]);
}

#[cfg(unix)]
#[test]
fn a_killed_part_goes_on() {
    let folder = Folder::new("killed");
    let scene = crate::shipped::path("pure-mild").display().to_string();
    let grid = ["run", &scene, "--n", "8,16,24,32", "--steps", "4,8,16"];
    let listed = sweep(&[&grid[..], &["--list-cases"]].concat());
    let (list, part) = (folder.file("cases.txt", &stdout(&listed)), folder.argument("parts/0"));
    let keys = stdout(&listed);
    let keys: Vec<&str> = keys.lines().collect();
    let job = [&grid[..], &["--out", &part, "--resume", "--only"], &keys[..]].concat();
    let table = folder.at("parts/0/cases.csv");
    let lines = || std::fs::read_to_string(&table).map_or(0, |text| text.lines().count());
    let mut child =
        command(&job).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("runs");
    // The limit guards against a hanging process; it decides nothing.
    let limit = Instant::now() + Duration::from_secs(300);
    while lines() < 8 && child.try_wait().expect("a status").is_none() {
        assert!(Instant::now() < limit, "no rows in five minutes");
        std::thread::sleep(Duration::from_millis(1));
    }
    // Two processes do not run one part.
    let second = sweep(&job);
    let running = child.try_wait().expect("a status").is_none();
    child.kill().expect("SIGKILL");
    child.wait().expect("a status");
    assert!(running, "the part ended too early for this test");
    refused(&second, &["is writing here"]);
    let parts = folder.argument("parts");
    let merge = ["merge", &parts, "--cases", &list, "--out", &folder.argument("merged")];
    // What is there is no sweep yet: cases are missing, or a line is cut off.
    ends(2, &merge);
    let again = ends(0, &job);
    assert!(stderr(&again).contains("already recorded"), "nothing was kept: {}", stderr(&again));
    let merged = sweep(&merge);
    let whole = folder.argument("whole");
    let run = sweep(&[&grid[..], &["--out", &whole, "--quiet"]].concat());
    assert_eq!(code(&merged), code(&run), "{}", stderr(&merged));
    assert_eq!(timeless(&folder.at("merged/cases.csv")), timeless(&folder.at("whole/cases.csv")));
}
