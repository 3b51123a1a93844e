//! Whole reports: files, determinism, escaping.

use std::fs;

use super::*;
use judge::record::{Key, NormError, Status};
use judge::verdict::{Cause, Decision, Prediction, Variable, judge};

/// Three norms on a grid of 5 meshes and 6 time grids; the trace error meets its floor.
fn example(name: &str) -> Vec<CaseRecord> {
    let levels = [8u32, 16, 32, 64, 128];
    let steps = [4u32, 8, 16, 32, 64, 128];
    let pairs = levels.iter().flat_map(|n| steps.iter().map(move |s| (*n, *s)));
    pairs.map(|(n, steps)| case(name, n, steps)).collect()
}

fn case(scene: &str, n: u32, steps: u32) -> CaseRecord {
    let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
    let entry = |norm: &str, error: f64, floor: f64| NormError {
        norm: norm.into(),
        error: Some(error.max(floor)),
        floor: Some(floor),
    };
    CaseRecord {
        dofs: u64::from(n * n),
        elements: u64::from(2 * n * n),
        status: Status::Converged,
        errors: vec![
            entry("V_max", (0.3 * h * (1.0 + h)).hypot(0.4 * k * k), 1e-10),
            entry("trace_L2_max", 0.02 * h * h + 0.001 * k * k, 2e-7),
            entry("pressure_L2_max", 0.5 * h.powf(1.5) + 0.1 * k * k, 1e-9),
            entry("V_time_max", 0.4 * k * k * (1.0 - k * k), 1e-6),
        ],
        ..CaseRecord::without_work(scene, Some(n), steps, k)
    }
}

fn verdicts(name: &str, records: &[CaseRecord]) -> Vec<Verdict> {
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    [
        ("V_max", Variable::H, 1.0, None),
        ("trace_L2_max", Variable::H, 1.5, None),
        ("V_time_max", Variable::K, 2.0, None),
        ("V_max", Variable::Joint, 1.0, Some(2.0)),
    ]
    .map(|(norm, variable, order, order_k)| {
        let prediction = Prediction {
            order_k,
            at_least: norm == "trace_L2_max",
            why: "(5.26) & Thm 7".into(),
            ..Prediction::new(norm, variable, order)
        };
        judge(name, records, &keys, &prediction, Decision::Pass)
    })
    .to_vec()
}

#[test]
fn a_report_is_whole_and_the_same_twice() {
    let name = "pure <strong> & mild";
    let records = example(name);
    let verdicts = verdicts(name, &records);
    let scenes = [SceneSummary {
        name: name.into(),
        question: "All four contact states, zones that move, h < 1 & k < 1: do the orders of \
                   (5.26) hold where the body yields almost everywhere, and from which n on?"
            .into(),
        remarks: vec!["Loads <given> & *none* known.".into()],
        equations: equations(Terms { memory: true, contact: true, ..Terms::default() }),
        text: "[time]\nhorizon = \"<1.0> | `2`\"\n".into(),
        ..SceneSummary::default()
    }];
    let dir = std::env::temp_dir().join(format!("gronwall-report-{}", std::process::id()));
    let provenance = serde_json::json!({"version": "0.1.0", "threads": 2});
    let files = [
        "cases.csv",
        "verdict.json",
        "index.html",
        "report.md",
        "tables.tex",
        "report.typ",
        "report.json",
        "pure--strong----mild-h.svg",
        "pure--strong----mild-k.svg",
        "pure--strong----mild-hk.svg",
    ];
    let write = || {
        write_all(&dir, &scenes, &records, &verdicts, &provenance, None, None).unwrap();
        write_junit(&dir.join("junit.xml"), &verdicts, &provenance, None).unwrap();
        files.map(|file| fs::read_to_string(dir.join(file)).unwrap())
    };
    let once = write();
    assert_eq!(once, write());
    let junit = fs::read_to_string(dir.join("junit.xml")).unwrap();
    // Not as markup; in JSON and Markdown code it may stand.
    let is_page = |file: &str| ["html", "tex", "typ", "svg"].iter().any(|end| file.ends_with(end));
    let pages = files.iter().zip(&once).filter(|(file, _)| is_page(file)).map(|(_, text)| text);
    assert!(pages.chain([&junit]).all(|text| !text.contains("<strong>")));
    assert!(once[3].contains("### pure &lt;strong> &amp; mild\n"));
    assert!(once[3].contains(" in h:** ") && !once[3].contains(": **"));
    assert!(once[3].contains("sweep run 'pure <strong> & mild' --out"));
    assert!(once[2].contains("pure &lt;strong&gt; &amp; mild") && once[2].contains("<svg"));
    assert!(junit.contains("pure &lt;strong"));
    if std::env::var_os("GRONWALL_KEEP").is_none() {
        fs::remove_dir_all(&dir).unwrap();
    }
}

/// Why a solver is wrong stands before what is judged of it, and is read back.
#[test]
fn a_cause_is_said_first_and_kept() {
    let dir = std::env::temp_dir().join(format!("gronwall-cause-{}", std::process::id()));
    let records = example("s");
    let cause = Explanation {
        cause: Cause::Memory,
        says: "the memory is summed by the left-hand rule".into(),
        numbers: "n = 4: 4e-2 is left".into(),
        fits: false,
    };
    let run = serde_json::json!({ "run": { "options": "verify" } });
    let verdicts = verdicts("s", &records);
    write_all(&dir, &[], &records, &verdicts, &run, None, Some(&cause)).unwrap();
    let page = fs::read_to_string(dir.join("index.html")).unwrap();
    let at = |words: &str| page.find(words).expect(words);
    assert!(at("perhaps the memory is summed") < at("Predicted and observed orders"));
    assert_eq!(judge::verdict::read_earlier(&dir.join("verdict.json")).unwrap().cause, Some(cause));
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn nothing_to_draw_draws_nothing() {
    let scene = SceneSummary { name: "empty".into(), ..SceneSummary::default() };
    assert!(convergence_svg(&scene, &[], &[], Direction::Space).is_none());
    assert!(split_svg(&scene, &[]).is_none());
    let mut broken = case("empty", 8, 8);
    broken.errors[0].error = Some(f64::NAN);
    broken.errors.truncate(1);
    let records = [broken.clone(), CaseRecord { n: None, h: None, ..broken }];
    assert!(convergence_svg(&scene, &records, &[], Direction::Time).is_none());
    assert!(split_svg(&scene, &records).is_none());
}

fn picture(records: &[CaseRecord], verdicts: &[Verdict], direction: Direction) -> String {
    let scene = SceneSummary { name: "s".into(), ..SceneSummary::default() };
    convergence_svg(&scene, records, verdicts, direction).unwrap()
}

/// The distance of the locked sets, a flat line, is left to the table unless judged.
#[test]
fn the_contact_set_is_named_where_it_is_not_drawn() {
    let mut records = example("s");
    let without = picture(&records, &[], Direction::Space);
    assert!(!without.contains("locked sets"));
    for record in &mut records {
        let (norm, error, floor) = ("contact_set_max".into(), Some(1.0), Some(0.0));
        record.errors.push(NormError { norm, error, floor });
    }
    let circles = |svg: &str| svg.matches("z\"/>").count();
    let unjudged = picture(&records, &[], Direction::Space);
    assert!(unjudged.contains("locked sets") && unjudged.contains("cases.csv"));
    assert_eq!(circles(&unjudged), circles(&without), "no marker more");
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    let prediction = Prediction {
        why: "nothing".into(),
        ..Prediction::new("contact_set_max", Variable::H, 1.0)
    };
    let verdict = judge("s", &records, &keys, &prediction, Decision::Pass);
    let judged = picture(&records, &[verdict], Direction::Space);
    assert!(judged.contains("locked sets") && !judged.contains("cases.csv"));
    assert!(circles(&judged) > circles(&without));
}

/// Rounding errors are not drawn: a curve at 1e-17 would flatten all others.
#[test]
fn errors_within_their_floor_are_named_where_they_are_not_drawn() {
    let mut records = example("s");
    let before = picture(&records, &[], Direction::Space);
    assert!(before.contains("hν") && !before.contains("not drawn"));
    for entry in records.iter_mut().flat_map(|record| &mut record.errors) {
        if entry.norm == "trace_L2_max" {
            (entry.error, entry.floor) = (Some(3e-17), Some(5e-17));
        }
    }
    let after = picture(&records, &[], Direction::Space);
    assert!(after.contains("not drawn, in cases.csv:") && !after.contains("10⁻¹⁶"));
}

/// k is T/N on equal steps; a graded grid is drawn over its largest step.
#[test]
fn the_axis_names_the_step_that_is_drawn() {
    let mut records = example("s");
    assert!(!picture(&records, &[], Direction::Time).contains("largest"));
    for record in &mut records {
        record.k = 1.0 - (1.0 - record.k).powi(2);
    }
    assert!(picture(&records, &[], Direction::Time).contains("largest"));
}

/// Curves name their mesh if it differs.
#[test]
fn curves_name_their_mesh() {
    let mut records = example("s");
    let same = picture(&records, &[], Direction::Time);
    assert_eq!(same.matches("n = 128").count(), 1, "once, at the axis");
    assert_eq!(picture(&records, &[], Direction::Space).matches("N = 128").count(), 1);
    // The time error is measured on one coarse mesh only.
    for record in records.iter_mut().filter(|record| record.n != Some(32)) {
        record.errors.retain(|entry| entry.norm != "V_time_max");
    }
    let mixed = picture(&records, &[], Direction::Time);
    assert_eq!((mixed.matches("n = 32").count(), mixed.matches("n = 128").count()), (1, 1));
    assert!(mixed.contains("n = 128 where not named"));
}

#[test]
fn two_scenes_do_not_share_a_file() {
    let scene = |name: &str| SceneSummary { name: name.into(), ..SceneSummary::default() };
    let refused = stems(&[scene("a b"), scene("a/b")]);
    assert!(matches!(refused, Err(ReportError::SharedName { .. })));
}

/// Two dozen scenes with two pictures and four verdicts each, of which a page holds four, the forest plot and the chapters.
#[test]
#[cfg(feature = "pdf")]
fn the_pdf_has_few_pages_a_scene() {
    let names: Vec<String> = (0..24).map(|i| format!("scene-{i}")).collect();
    let drawn = picture(&example("s"), &[], Direction::Space);
    let scene = |name: &String| SceneSummary {
        name: name.clone(),
        question: "All four contact states, zones that move: do the orders of (5.26) hold?".into(),
        picture: Some(drawn.clone()),
        ..SceneSummary::default()
    };
    let scenes: Vec<SceneSummary> = names.iter().map(scene).collect();
    let records: Vec<CaseRecord> = names.iter().flat_map(|name| example(name)).collect();
    let verdicts: Vec<Verdict> = names.iter().flat_map(|name| verdicts(name, &records)).collect();
    let dir = std::env::temp_dir().join(format!("gronwall-pages-{}", std::process::id()));
    write_all(&dir, &scenes, &records, &verdicts, &serde_json::json!({}), None, None).unwrap();
    let pages = document::paged(&dir, None).unwrap().pages().len();
    assert!(pages <= 24 / 4 + 5, "{pages} pages");
    fs::remove_dir_all(&dir).unwrap();
}

/// A PDF of everything that a document can contain depends only on its date.
#[test]
#[cfg(feature = "pdf")]
fn the_pdf_is_the_same_twice() {
    let records = example("s");
    let verdicts = verdicts("s", &records);
    let scenes = [SceneSummary {
        name: "s".into(),
        question: "#panic(\"markup\") $x$ *bold*?".into(),
        equations: equations(Terms {
            memory: true,
            contact: true,
            gap: true,
            law: true,
            ..Terms::default()
        }),
        text: "[time]\nhorizon = 1.0\n".into(),
        ..SceneSummary::default()
    }];
    let dir = std::env::temp_dir().join(format!("gronwall-pdf-{}", std::process::id()));
    fs::create_dir_all(&dir).unwrap();
    let provenance = serde_json::json!({"version": "0.1.0"});
    write_all(&dir, &scenes, &records, &verdicts, &provenance, None, None).unwrap();
    let set = |date| pdf(&dir, date).unwrap();
    let (once, twice) = (set(Some("2026-01-31")), set(Some("2026-01-31")));
    assert!(once == twice && once.starts_with(b"%PDF-"));
    assert!(once != set(None));
    fs::remove_dir_all(&dir).unwrap();
}
