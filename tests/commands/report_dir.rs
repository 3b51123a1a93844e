//! Source: the contract of a directory of records: `report` rebuilds what `run` wrote, from the directory alone, and a
//!   directory that is used again holds nothing of the run before.
//! Goal: the same bytes although the scene's file is gone; another text of the scene is refused; pictures of earlier
//!   scenes go, files of others stay.
//! Data: steady and affine on small grids, given by name and by path.

use std::process::Output;

use crate::program::{Folder, code, ends, refuses, stderr, stdout, sweep};
use crate::shipped::{edited, text};

const STEADY: [&str; 2] = ["--n", "8,16,32"];
const AFFINE: [&str; 4] = ["--n", "4", "--steps", "4,8,16"];

/// Runs scenes into `out` of the folder; the exit code.
#[track_caller]
fn run(folder: &Folder, command: &str, scenes: &[&str], grid: &[&str]) -> i32 {
    let out = folder.argument("out");
    let output = sweep(&[&[command], scenes, &["--out", &out], grid].concat());
    assert_ne!(code(&output), 2, "{}", stderr(&output));
    code(&output)
}

/// `report` on the folder gives the same bytes again, also where the files are gone.
#[track_caller]
fn rebuilds(folder: &Folder, exit: i32) {
    let files = [
        "verdict.json",
        "cases.csv",
        "index.html",
        "report.md",
        "tables.tex",
        "report.json",
        "steady-h.svg",
    ];
    let read = |file: &str| std::fs::read(folder.at("out").join(file)).expect("a file");
    let before = files.map(read);
    for file in ["verdict.json", "index.html", "steady-h.svg"] {
        std::fs::remove_file(folder.at("out").join(file)).expect("removed");
    }
    let output = sweep(&["report", &folder.argument("out")]);
    assert_eq!(code(&output), exit, "{}", stderr(&output));
    for (file, before) in files.iter().zip(before) {
        assert!(read(file) == before, "{file} differs");
    }
}

/// Names in the directory of records, sorted.
fn names(folder: &Folder) -> Vec<String> {
    let entries = std::fs::read_dir(folder.at("out")).expect("a directory");
    let mut names: Vec<String> = entries
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    // Of no interest to a reader.
    names.retain(|name| name != ".lock");
    names.sort();
    names
}

#[test]
fn records_of_another_version_are_not_judged() {
    let folder = Folder::new("other-version");
    run(&folder, "run", &["steady"], &STEADY);
    let path = folder.at("out/provenance.json");
    let provenance = std::fs::read_to_string(&path).expect("provenance");
    let this = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    std::fs::write(&path, edited(&provenance, &this, "\"version\": \"0.0.0\"")).expect("written");
    let output = sweep(&["report", &folder.argument("out")]);
    let said = stderr(&output);
    assert_eq!(code(&output), 2, "{said}");
    assert!(said.contains("version 0.0.0, this is") && said.contains("by that version"), "{said}");
}

/// The text is kept with the records: neither the file nor the shipped scene of that name counts.
#[test]
fn report_needs_no_file_of_the_scene() {
    let folder = Folder::new("by-path");
    let second = edited(&text("steady"), "order = 1.0", "order = 2.0");
    let path = folder.file("mine.toml", &second);
    assert_eq!(run(&folder, "run", &[&path], &STEADY), 1, "order 2 fails");
    std::fs::remove_file(&path).expect("removed");
    rebuilds(&folder, 1);
    for file in names(&folder) {
        let bytes = std::fs::read(folder.at("out").join(&file)).expect("a file");
        let text = String::from_utf8(bytes).expect("text");
        assert!(!text.contains(&path), "{file} holds a path of this machine");
    }
}

/// The text of the mesh file is kept as well.
#[test]
fn report_needs_no_mesh_file() {
    let folder = Folder::new("mesh");
    let mesh = std::fs::read_to_string(crate::shipped::path("frustum").with_extension("msh"));
    let mesh = folder.file("frustum.msh", &mesh.expect("the mesh of a shipped scene"));
    let path = folder.file("mine.toml", &text("frustum"));
    assert_eq!(run(&folder, "run", &[&path], &["--n", "2,3"]), 1, "two meshes leave it open");
    std::fs::remove_file(&path).and_then(|()| std::fs::remove_file(&mesh)).expect("removed");
    let verdict = folder.at("out/verdict.json");
    let before = std::fs::read(&verdict).expect("a file");
    std::fs::remove_file(&verdict).expect("removed");
    ends(1, &["report", &folder.argument("out")]);
    assert!(std::fs::read(&verdict).expect("a file") == before, "verdict.json differs");
}

/// Records are judged by the text they were made with, or not at all.
#[test]
fn report_refuses_records_of_another_text() {
    let folder = Folder::new("other-text");
    let second = edited(&text("steady"), "order = 1.0", "order = 2.0");
    let path = folder.file("steady.toml", &second);
    run(&folder, "run", &[&path], &STEADY);
    let out = folder.argument("out");
    refuses(&["report", &out, "--scenes", "manufactured"], &["another text"]);
    ends(1, &["report", &out, "--scenes", &folder.argument("")]);
    // A kept text that was edited is not the one of the records.
    let kept = folder.at("out/provenance.json");
    let provenance = std::fs::read_to_string(&kept).expect("provenance");
    let torn = edited(&provenance, "order = 2.0", "order = 1.0");
    std::fs::write(&kept, &torn).expect("written");
    refuses(&["report", &out], &["differs from the one that the records"]);
}

#[test]
fn pictures_of_scenes_that_left_go_and_foreign_files_stay() {
    let folder = Folder::new("stale");
    run(&folder, "run", &["affine", "steady"], &["--n", "4,8", "--steps", "4,8"]);
    assert!(names(&folder).contains(&"steady-h.svg".to_owned()), "{:?}", names(&folder));
    // A file of somebody else that is called like a picture of a scene of the first run.
    folder.file("out/steady-mine.svg", "mine");
    folder.file("out/affine-h.svg.bak", "mine");
    run(&folder, "run", &["affine"], &AFFINE);
    let expected = [
        "affine-errors.svg",
        "affine-h.svg.bak",
        "affine-k.svg",
        "affine-scene.svg",
        "cases.csv",
        "files.json",
        "forest.svg",
        "index.html",
        "provenance.json",
        "report.json",
        "report.md",
        "report.typ",
        "steady-mine.svg",
        "tables.tex",
        "verdict.json",
    ];
    assert_eq!(names(&folder), expected);
    // `gate` writes no page: that of the run before would show other records.
    run(&folder, "gate", &["affine"], &AFFINE);
    let left =
        ["affine-h.svg.bak", "cases.csv", "provenance.json", "steady-mine.svg", "verdict.json"];
    assert_eq!(names(&folder), left);
}

/// The program alone in a folder, whatever stands beside it where it was built. What was just written cannot be run while a
/// program that another thread begins still has the file open.
fn alone(folder: &Folder, arguments: &[&str]) -> Output {
    let program = folder.at("sweep");
    std::fs::copy(env!("CARGO_BIN_EXE_sweep"), &program).expect("a copy");
    for _ in 0..1000 {
        let mut command = std::process::Command::new(&program);
        command.args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
        let begun = command.output();
        let busy = match &begun {
            Ok(output) => stderr(output).contains("Text file busy"),
            Err(error) => error.kind() == std::io::ErrorKind::ExecutableFileBusy,
        };
        if !busy {
            return begun.expect("a run");
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    panic!("{} is busy", program.display())
}

/// Without the typesetter there is no PDF, and no half of a report either.
#[test]
fn without_a_typesetter_the_way_to_one_is_named() {
    let folder = Folder::new("pdf");
    let file = folder.argument("report.pdf");
    let output = alone(&folder, &["report", &folder.argument("out"), "--pdf", &file]);
    assert_eq!((code(&output), stdout(&output).as_str()), (2, ""));
    assert!(stderr(&output).contains("make pdf"), "{}", stderr(&output));
    assert!(!folder.at("report.pdf").exists());
}

/// What the program beside it prints is the PDF; where it fails its words are the error, and there is no file.
#[test]
#[cfg(unix)]
fn a_typesetter_gets_directory_and_date_and_its_failure_is_one() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new("typeset");
    run(&folder, "gate", &["affine"], &AFFINE);
    let (out, file) = (folder.argument("out"), folder.argument("report.pdf"));
    let by = |script: &str| {
        folder.file("typeset", &format!("#!/bin/sh\n{script}\n"));
        let mode = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(folder.at("typeset"), mode).expect("a mode");
        alone(&folder, &["report", &out, "--pdf", &file, "--date", "2026-01-31"])
    };
    let failed = by("echo no such font >&2; exit 2");
    assert_eq!(code(&failed), 2);
    assert!(stderr(&failed).contains("no such font"), "{}", stderr(&failed));
    assert!(!folder.at("report.pdf").exists());
    let output = by("test -f $1/report.typ && printf '%s' $2");
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(folder.read("report.pdf"), "2026-01-31");
}

/// Studies that the commands wrote into the directory are chapters of it, without a solve; one that is torn is refused.
#[test]
fn studies_of_the_directory_are_chapters() {
    let folder = Folder::new("chapters");
    assert_eq!(run(&folder, "run", &["affine"], &AFFINE), 0);
    let out = folder.argument("out");
    let read = |file: &str| std::fs::read_to_string(folder.at("out").join(file)).expect("a file");
    assert!(read("index.html").contains("sweep bound SCENE --out DIR"));
    for study in [
        &["bound", "affine", "--n", "4", "--steps", "2"][..],
        &["gronwall", "affine", "--steps", "8,16"],
        &["audit", "compliance", "--n", "4,8", "--steps", "2"],
        &["estimators", "law-linear", "--n", "8,16,32"],
        &["trade", "compliance", "--n", "4,8,16", "--steps", "4,8,16"],
        &["extremes", "one-vertex"],
    ] {
        ends(0, &[study, &["--out", &out]].concat());
    }
    let report = || sweep(&["report", &out]);
    assert_eq!(code(&report()), 0);
    let pages = ["index.html", "report.md", "tables.tex", "report.json"].map(read);
    for (words, times) in [
        ("Contraction factor of Λ for a last step", 3),
        ("Bound over error at t = T", 3),
        ("The claims, the tightest first", 3),
        ("Error, CPU seconds of one run", 3),
        ("Step sizes: bounds on k", 3),
        ("Ladders: the parameter", 3),
    ] {
        let holding = pages.iter().filter(|page| page.contains(words)).count();
        assert!(holding >= times, "{words} is in {holding} renderings");
    }
    assert!(!pages[0].contains("sweep bound SCENE --out DIR"), "the study is there");
    assert!(!pages[0].contains("oes not hold") && !pages[0].contains("not everything holds"));
    assert_eq!(code(&report()), 0);
    assert!(
        ["index.html", "report.md", "tables.tex", "report.json"].map(read) == pages,
        "the same twice"
    );
}

/// What the page links to is there: sections, files, and the evidence of each verdict.
#[test]
fn every_link_of_the_page_leads_somewhere() {
    let folder = Folder::new("links");
    run(&folder, "run", &["steady", "affine"], &["--n", "4,8", "--steps", "4,8,16"]);
    let read = |file: &str| std::fs::read_to_string(folder.at("out").join(file)).expect("a file");
    let page = read("index.html");
    let targets: Vec<&str> = page
        .split("href=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .filter(|target| !target.starts_with("data:"))
        .collect();
    assert!(targets.contains(&"#steady") && targets.contains(&"cases.csv"), "{targets:?}");
    for target in targets {
        match target.strip_prefix('#') {
            Some(id) => assert!(page.contains(&format!(" id=\"{id}\"")), "{target}"),
            None => assert!(folder.at("out").join(target).exists(), "{target}"),
        }
    }
    // Neither a script nor a style sheet nor a picture of another place.
    assert!(!page.contains("src=") && !page.contains("@import") && !page.contains("https://"));
    for words in ["used", "(5.26)", "σ = 𝒜ε(u)", "The scene file"] {
        assert!(page.contains(words), "{words}");
    }
    let (markdown, latex) = (read("report.md"), read("tables.tex"));
    assert!(markdown.contains("![") && markdown.contains("| scene | norm |"), "{markdown}");
    let count = |what: &str| latex.matches(what).count();
    assert!(count("\\begin{longtable}") > 3);
    assert_eq!(count("\\begin{longtable}"), count("\\end{longtable}"));
    assert_eq!(count("\\toprule"), count("\\bottomrule"));
}
