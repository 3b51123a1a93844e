//! Chapters from documents of studies: each appears in every rendering, failures on the first page too.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::json;

use crate::document::{
    Block, Chapter, Document, Drawn, Group, Report, Run, StudyDocument, Table, Tone, document,
    markdown, page, tables,
};
use crate::{ReportError, SceneSummary, StepLimits};
use judge::record::{CaseRecord, Key, NormError, Status};
use judge::verdict::{Decision, Prediction, Variable, Verdict, judge};

/// Those that leave a file.
fn with_files() -> impl Iterator<Item = Chapter> {
    Chapter::ALL.into_iter().filter(|chapter| *chapter != Chapter::Diagnose)
}

/// A study of a chapter with a table, a picture and a verdict.
fn study(chapter: Chapter, holds: bool) -> StudyDocument {
    let name = chapter.name();
    let mut study = StudyDocument::new(chapter, format!("Study {name}"));
    if chapter != Chapter::Extremes {
        study = study.of_scene("s", "now");
    }
    study.verdict(holds, &format!("All of {name} holds."), vec![format!("{name}: 2 against 1")]);
    let rows = [["x", "0.5"], ["y", "y"]];
    let mut rows = rows.map(|row| row.map(Run::plain).to_vec()).to_vec();
    rows[0][1].tone = Tone::Code;
    let table = Table::new(format!("Numbers of {name}."), &["what", ">value"], rows);
    study.blocks.push(Block::Table(table));
    study.rows(format!("Other numbers of {name}."), &json!([{ "k": 0.25 }]), ">k = k");
    study.figure(&name, "what is drawn.", Some("<svg xmlns=\"\"></svg>".into()));
    study
}

/// A fresh directory.
fn directory() -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let dir =
        std::env::temp_dir().join(format!("gronwall-chapters-{}-{number}", std::process::id()));
    fs::create_dir_all(&dir).unwrap();
    dir
}

/// The studies as a report reads them from their files.
fn read(studies: &[StudyDocument]) -> Vec<StudyDocument> {
    let dir = directory();
    studies.iter().for_each(|study| study.write(&dir).unwrap());
    let found = StudyDocument::read_all(&dir).unwrap();
    fs::remove_dir_all(&dir).unwrap();
    found
}

/// The document of a scene that breaks (5.25), with these studies.
fn composed(studies: &[StudyDocument], change: impl Fn(&mut SceneSummary)) -> Document {
    let mut scene = SceneSummary {
        name: "s".into(),
        question: "What is left?".into(),
        violates: vec!["5.25".into()],
        step: Some(StepLimits {
            m0: 1.0,
            paper: 0.3,
            theorem: 0.5,
            sharpened: 4.0,
            solvable: f64::INFINITY,
        }),
        ..SceneSummary::default()
    };
    change(&mut scene);
    let records: Vec<CaseRecord> = [8, 16, 32].map(case).into();
    document(Report {
        scenes: &[Drawn {
            scene: &scene,
            group: Group::default(),
            stem: "s".into(),
            figures: Vec::new(),
            card: Vec::new(),
        }],
        studies: read(studies),
        of_cases: Vec::new(),
        forest: None,
        records: &records,
        verdicts: &[verdict(&records)],
        provenance: &json!({ "scenes": { "s": "now" } }),
        cause: None,
    })
}

fn case(n: u32) -> CaseRecord {
    let error =
        NormError { norm: "V_max".into(), error: Some(0.3 / f64::from(n)), floor: Some(0.0) };
    let errors = vec![error];
    let status = Status::Converged;
    CaseRecord { status, errors, ..CaseRecord::without_work("s", Some(n), 4, 0.25) }
}

fn verdict(records: &[CaseRecord]) -> Verdict {
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    let prediction =
        Prediction { why: "(5.26)".into(), ..Prediction::new("V_max", Variable::H, 1.0) };
    judge("s", records, &keys, &prediction, Decision::Pass)
}

#[test]
fn studies_are_chapters_of_every_rendering() {
    let mut studies: Vec<_> = with_files().map(|chapter| study(chapter, true)).collect();
    studies[0].threshold = Some("7.875".into());
    let document = composed(&studies, |_| {});
    let (page, markdown, latex) = (page(&document), markdown(&document), tables(&document));
    for words in ["Does not hold", "not everything", "not confirmed", "chapter-more"] {
        assert!(!page.contains(words) && !markdown.contains(words), "{words}");
    }
    assert!(page.contains("within (3.4)") && page.contains("(5.25)"));
    assert!(page.contains("<a href=\"#bound-s\">7.875</a>"), "the table of all scenes has it");
    for chapter in with_files() {
        let caption = format!("Other numbers of {}.", chapter.name());
        assert!([&page, &markdown, &latex].iter().all(|text| text.contains(&caption)), "{caption}");
        // Tables of code appear only on the page; LaTeX gets numbers.
        assert!(!latex.contains(&format!("Numbers of {}.", chapter.name())));
        assert!(page.contains(&format!("All of {} holds.", chapter.name())));
    }
    // Numbers of tables and pictures continue from one study to the next.
    let numbers: Vec<usize> = document.tables().map(|table| table.number).collect();
    assert_eq!(numbers, (1..=numbers.len()).collect::<Vec<_>>());
    assert!(numbers.len() > 10);
}

#[test]
fn what_is_not_there_names_its_command() {
    let page = page(&composed(&[], |scene| scene.violates.clear()));
    for command in with_files().map(Chapter::command) {
        assert!(page.contains(&format!("<code>sweep {command} --out DIR</code>")), "{command}");
    }
    assert!(page.contains("<code>sweep run broken-kernel broken-trace --out DIR</code>"));
    let names = with_files().map(Chapter::name).filter(|name| name != "bound");
    for chapter in names.chain(["broken".to_owned()]) {
        assert!(
            !page.contains(&format!("chapter-{chapter}")),
            "{chapter}: a chapter without content"
        );
    }
}

#[test]
fn what_does_not_hold_is_said_on_the_first_page_too() {
    for chapter in Chapter::ALL {
        let document = composed(&[study(chapter, false)], |_| {});
        let (page, markdown) = (page(&document), markdown(&document));
        let words = format!("{}: 2 against 1", chapter.name());
        assert!(page.contains(&words) && markdown.contains(&words), "{words}");
        assert!(page.contains("<span class=\"miss\">Does not hold: </span>"));
        let first = serde_json::to_string(&document.sections[0]).unwrap();
        assert!(first.contains("not e") && first.contains(&chapter.name()), "{first}");
    }
    // A study that compared nothing proves nothing.
    let mut silent = StudyDocument::new(Chapter::Bound, "b").of_scene("s", "now");
    silent.verdict(false, "all", Vec::new());
    assert!(page(&composed(&[silent], |_| {})).contains("nothing was compared"));
}

#[test]
fn another_text_of_the_scene_is_said() {
    let words = "a different text of the scene than the records";
    for chapter in with_files().filter(|chapter| *chapter != Chapter::Extremes) {
        let now = study(chapter, true);
        let stale = now.clone().of_scene("s", "then");
        assert!(page(&composed(&[stale], |_| {})).contains(words), "{chapter:?}");
        assert!(!page(&composed(&[now], |_| {})).contains(words), "{chapter:?}");
    }
}

#[test]
fn steps_beyond_the_bound_are_not_called_within_it() {
    let at = |change: &dyn Fn(&mut SceneSummary)| page(&composed(&[], change));
    let with = |scene: &mut SceneSummary, theorem: f64, solvable: f64| {
        let step = scene.step.as_mut().unwrap();
        (step.theorem, step.solvable) = (theorem, solvable);
    };
    assert!(at(&|_| {}).contains("within (3.4)"));
    // The largest k of the records is 1/4.
    let beyond = at(&|scene| with(scene, 0.2, f64::INFINITY));
    assert!(beyond.contains("beyond (3.4), one solution") && !beyond.contains("within (3.4)"));
    assert!(at(&|scene| with(scene, 0.25, 0.25)).contains("not guaranteed"));
    assert!(at(&|scene| with(scene, f64::NAN, f64::NAN)).contains("not guaranteed"));
    let broken = at(&|scene| scene.violates = vec!["2.9".into()]);
    assert!(
        broken.contains("without a bound: (2.9) is broken") && !broken.contains("within (3.4)")
    );
    assert!(at(&|scene| scene.step = None).contains("not computed"));
}

fn refused(file: &str, text: &str) -> String {
    let dir = directory();
    fs::write(dir.join(file), text).unwrap();
    let found = StudyDocument::read_all(&dir);
    fs::remove_dir_all(&dir).unwrap();
    let Err(error @ ReportError::Study { .. }) = found else { panic!("{file} was read") };
    error.to_string()
}

#[test]
fn a_torn_study_is_refused_with_its_line() {
    for chapter in Chapter::ALL {
        let study = study(chapter, true);
        let text = format!("{:#}", json!(study));
        let lines: Vec<&str> = text.lines().collect();
        let file = format!("{}.document.json", study.stem());
        let said = refused(&file, &lines[..lines.len() - 2].join("\n"));
        assert!(said.contains(&format!("{file}:{}: ", lines.len() - 2)), "{said}");
        assert!(said.contains("--out DIR`, or delete the file"), "{said}");
    }
    let sound = json!(study(Chapter::Bound, true));
    let changed = |key: &str, value: serde_json::Value| {
        let mut defect = sound.clone();
        defect[key] = value;
        refused("s-bound.document.json", &defect.to_string())
    };
    // A document of something else, one without the verdict, and a row that lacks a cell.
    assert!(refused("s-bound.document.json", "[1, 2]").contains("s-bound.document.json:1: "));
    assert!(changed("holds", json!(null)).contains("invalid type: null"));
    assert!(changed("chapter", json!("audit")).contains("not what its name says"));
    let mut short = sound["blocks"].clone();
    short[1]["of"]["rows"][0] = json!([]);
    assert!(changed("blocks", short).contains("rows of several lengths"));
}

#[test]
fn a_picture_is_shown_only_if_it_is_one_of_the_directory() {
    let dir = directory();
    study(Chapter::Bound, true).write(&dir).unwrap();
    let shown = || {
        let found = StudyDocument::read_all(&dir).unwrap();
        format!("{:?}", found[0].blocks).contains("<svg")
    };
    assert!(shown());
    fs::write(dir.join("s-bound.svg"), "another program's").unwrap();
    assert!(!shown());
    // A name that leads out of the directory is not followed.
    let inner = dir.join("inner");
    fs::create_dir(&inner).unwrap();
    fs::write(dir.join("s-bound.svg"), "<svg></svg>").unwrap();
    let text = fs::read_to_string(dir.join("s-bound.document.json")).unwrap();
    fs::write(inner.join("s-bound.document.json"), text.replace("s-bound.svg", "../s-bound.svg"))
        .unwrap();
    let found = StudyDocument::read_all(&inner).unwrap();
    assert!(!format!("{:?}", found[0].blocks).contains("<svg"));
    fs::remove_dir_all(&dir).unwrap();
}
