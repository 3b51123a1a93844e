//! Chapters from studies with one seeded defect each: what does not hold is said in words, on the first page too.

use serde_json::{Value, json};

use crate::document::{Document, Report, document, markdown, page, tables};
use crate::studies::Studies;
use crate::{ReportError, SceneSummary, StepLimits};
use judge::record::{CaseRecord, Key, NormError, Status};
use judge::verdict::{Expect, Prediction, Variable, Verdict, judge};

fn bound() -> Value {
    json!({
        "scene": "s", "fingerprint": "now", "n": 8, "steps": 4,
        "constants": [{ "name": "m_A", "value": 2.0, "uncertainty": null, "how": "proved", "safe": true, "note": "" }],
        "samples": [{ "what": "alpha_j", "declared": 1.0, "needed": 0.9, "holds": true }],
        "thresholds": {
            "paper_norm": 0.375, "theorem": 0.75, "sharpened": 2.857, "solvable": null,
            "norm_one": [7.9, null], "radius_one": [7.9, 8.0], "loss": [7.9, 8.0], "loss_reason": "Newton fails",
        },
        "ratio": 21.0, "worst": { "level": 3, "t": 0.75 },
        "rungs": [{
            "k": 0.5, "norm": 0.1, "radius": 0.09, "sharpened": 0.2, "theorem": 0.6, "paper_norm": 1.2,
            "newton": 3, "fixed_point": "no convergence",
        }],
        "violations": [],
    })
}

fn gronwall() -> Value {
    let ratio = json!({ "at_end": 2.5 });
    json!({
        "scene": "s", "fingerprint": "now", "n": 4, "truth": "exact u(t) in V^h", "constants": { "C1": 0.5 },
        "grids": [{
            "steps": 8, "C2_k": 0.1, "error_end": 1e-5, "truncation_end": 1e-6,
            "effectivity": {
                "weighted": ratio, "primed": ratio, "closed": ratio, "limit": ratio, "printed": null, "printed_closed": null,
            },
        }],
        "horizons": {
            "k": 0.125,
            "rows": [{ "horizon": 4.0, "error": 1e-5, "weighted": 1e-4, "primed": 1e-3, "closed": 1e-2, "c2": 1.0, "growth": null }],
        },
        "perturbations": [{
            "shape": "random", "size": 0.1, "load": 0.2, "difference": 0.05, "growth": 0.6, "least_effectivity": 1.2,
        }],
        "violations": [],
    })
}

fn audit() -> Value {
    json!({
        "scene": "s", "fingerprint": "now", "theorem": "Theorem 10", "rule": "exact", "holds": true,
        "lines": [{
            "line": "(4.7)", "says": "m_A e^2 <= E_A", "relation": "<=", "left": 1e-3, "right": 2e-3, "ratio": 0.5,
            "power_h": [2.0, 1.9], "power_k": [null, null], "holds": true,
        }],
        "cases": [{ "n": 8, "steps": 4 }, { "n": 16, "steps": 4 }],
        "violations": [],
    })
}

fn ledger() -> Value {
    json!([{
        "claim": "E_n is of order h^2", "hypotheses": "(5.25)", "quantity": "power of h", "proved": 2.0, "observed": 2.01,
        "claimed": "sharp", "confirmed": true, "command": "sweep audit s --n 8,16 --steps 4",
    }])
}

fn trade() -> Value {
    json!({
        "scene": "s", "fingerprint": "now", "norm": "V_max",
        "trials": [{
            "knob": "as written", "n": 8, "steps": 4, "front": true, "status": "converged", "error": 0.01,
            "cpu_seconds": 0.02, "predicted_bytes": 2e7,
        }],
        "error_model": { "model": "sum", "space": { "constant": 0.3, "order": 1.0 }, "time": null },
        "cost_model": { "reason": "too few runs" },
        "coupling": null,
        "prices": [{ "words": "loads by degree 2: 1.2 times as fast" }],
        "answer": { "target": 0.01, "n": 8, "steps": 4, "knob": "as written", "error": 0.01, "cpu_seconds": 0.02 },
    })
}

fn extremes() -> Value {
    json!({
        "ladders": [{ "name": "length", "parameter": "unit", "quantity": "difference", "why": "scaling" }],
        "rungs": [{
            "ladder": "length", "at": "1e100", "expected": "<= 1e-12", "measured": 1e-15, "digits_lost": 1.0,
            "standing": "as-expected", "note": "",
        }],
    })
}

/// The studies of a directory with these files.
fn read(files: &[(&str, String)]) -> Result<Studies, ReportError> {
    static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let own = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let dir = std::env::temp_dir().join(format!("gronwall-chapters-{}-{own}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    for (name, text) in files {
        std::fs::write(dir.join(name), text).unwrap();
    }
    let studies = Studies::read(&dir);
    std::fs::remove_dir_all(&dir).unwrap();
    studies
}

/// The document of a scene that breaks (5.25), with these studies beside it.
fn composed(files: &[(&str, &Value)], change: impl Fn(&mut SceneSummary)) -> Document {
    let files: Vec<(&str, String)> =
        files.iter().map(|(name, value)| (*name, value.to_string())).collect();
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
    let scenes = [scene];
    document(Report {
        scenes: &scenes,
        stems: &["s".to_owned()],
        pictures: vec![Vec::new()],
        studies: read(&files).unwrap(),
        records: &records,
        verdicts: &[verdict(&records)],
        provenance: &json!({ "scenes": { "s": "now" } }),
    })
}

fn case(n: u32) -> CaseRecord {
    let error = NormError { norm: "V_max".into(), error: Some(0.3 / f64::from(n)), floor: None };
    let errors = vec![error];
    let status = Status::Converged;
    CaseRecord { status, errors, ..CaseRecord::without_work("s", Some(n), 4, 0.25) }
}

fn verdict(records: &[CaseRecord]) -> Verdict {
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    let prediction =
        Prediction { why: "(5.26)".into(), ..Prediction::new("V_max", Variable::H, 1.0) };
    judge("s", records, &keys, &prediction, Expect::Pass)
}

/// All studies, each with what is said of it if it is sound.
fn sound() -> [(&'static str, Value); 6] {
    [
        ("s-bound.json", bound()),
        ("s-gronwall.json", gronwall()),
        ("s-audit.json", audit()),
        ("ledger.json", ledger()),
        ("s-trade.json", trade()),
        ("extremes.json", extremes()),
    ]
}

#[test]
fn sound_studies_are_chapters_of_every_rendering() {
    let sound = sound();
    let files: Vec<(&str, &Value)> = sound.iter().map(|(name, value)| (*name, value)).collect();
    let document = composed(&files, |_| {});
    let (page, markdown, latex) = (page(&document), markdown(&document), tables(&document));
    for words in
        ["Does not hold", "does not hold", "not everything", "not confirmed", "DIR adds one"]
    {
        assert!(!page.contains(words) && !markdown.contains(words), "{words}");
    }
    for words in
        ["within (3.4)", "(5.25)", "Theorem 10", "1 rung, every one", "every k", "as written"]
    {
        assert!(page.contains(words), "{words}");
    }
    for caption in [
        "contraction factor",
        "bound over error",
        "lines of the proof",
        "Claims",
        "CPU seconds",
        "Rungs:",
    ] {
        assert!([&page, &markdown, &latex].iter().all(|text| text.contains(caption)), "{caption}");
    }
}

#[test]
fn what_is_not_there_names_its_command() {
    let page = page(&composed(&[], |scene| scene.violates.clear()));
    for command in [
        "bound SCENE",
        "gronwall SCENE",
        "audit SCENE",
        "audit --ledger",
        "trade SCENE",
        "extremes",
    ] {
        assert!(page.contains(&format!("<code>sweep {command} --out DIR</code>")), "{command}");
    }
    assert!(page.contains("no scene that breaks one"));
}

/// The word that a defect of a study must leave on the page, and whether it belongs on the first one.
#[track_caller]
fn shows(name: &str, study: &Value, words: &str, first: bool) {
    let document = composed(&[(name, study)], |_| {});
    let (page, markdown) = (page(&document), markdown(&document));
    assert!(page.contains(words), "{words}: {page}");
    let link = page.contains("<span class=\"miss\">") && page.contains("class=\"miss\"");
    assert!(link && markdown.contains("**"), "{words} stands out");
    let summary = &document.sections[0];
    let said = serde_json::to_string(summary).unwrap();
    assert_eq!(said.contains("not e") && said.contains("#"), first, "{words}: {said}");
}

#[test]
fn what_does_not_hold_is_said() {
    let mut defect = bound();
    defect["violations"] =
        json!([{ "k": 0.5, "what": "|DLambda| <= (3.15)", "left": 2.0, "right": 0.6 }]);
    shows(
        "s-bound.json",
        &defect,
        "|DLambda| &lt;= (3.15): 2.000000000e0 against 6.000000000e-1",
        true,
    );
    let mut defect = bound();
    defect["rungs"] = json!([]);
    shows("s-bound.json", &defect, "nothing was compared", true);
    let mut defect = bound();
    defect["samples"][0]["holds"] = json!(false);
    shows("s-bound.json", &defect, "alpha_j, declared and needed by a sample", true);

    let mut defect = gronwall();
    defect["violations"] = json!([{ "part": "N = 8", "link": "e <= weighted envelope", "n": 3, "t": 0.3, "left": 1.0, "right": null }]);
    shows("s-gronwall.json", &defect, "e &lt;= weighted envelope at n = 3", true);
    shows("s-gronwall.json", &defect, "against no number", true);
    let mut defect = gronwall();
    defect["grids"] = json!([]);
    shows("s-gronwall.json", &defect, "nothing was compared", true);

    let mut defect = audit();
    defect["violations"] = json!(["(4.7) at level 2 of n = 8: it exceeds"]);
    shows("s-audit.json", &defect, "(4.7) at level 2 of n = 8: it exceeds", true);
    // A line that fails is believed, whatever the head of the file says.
    let mut defect = audit();
    defect["lines"][0]["holds"] = json!(false);
    shows("s-audit.json", &defect, "0 of 1 lines hold", true);

    let mut defect = ledger();
    defect[0]["confirmed"] = json!(false);
    shows("ledger.json", &defect, "sharp: not confirmed", true);

    let mut defect = extremes();
    defect["rungs"][0]["standing"] = json!("not-as-expected");
    shows("extremes.json", &defect, "length at 1e100: not as expected", true);
    let mut defect = extremes();
    defect["rungs"] = json!([]);
    shows("extremes.json", &defect, "nothing was compared", true);

    let mut defect = trade();
    defect["trials"][0] = json!({ "knob": "loads", "n": 8, "steps": 4, "front": false, "status": "failed", "reason": "KKT residual" });
    shows("s-trade.json", &defect, "failed: KKT residual", false);
}

#[test]
fn another_text_of_the_scene_is_said() {
    let files = sound();
    for (name, study) in files.iter().filter(|(name, _)| name.starts_with("s-")) {
        let mut stale = study.clone();
        stale["fingerprint"] = json!("then");
        let words = "another text of the scene than the records";
        assert!(page(&composed(&[(name, &stale)], |_| {})).contains(words), "{name}");
        assert!(!page(&composed(&[(name, study)], |_| {})).contains(words), "{name}");
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

#[test]
fn a_torn_study_is_refused_with_its_line() {
    for (name, study) in sound() {
        let text = serde_json::to_string_pretty(&study).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let torn = lines[..lines.len() - 2].join("\n");
        let Err(error) = read(&[(name, torn)]).map(|_| ()) else { panic!("{name} was read") };
        let said = error.to_string();
        assert!(said.contains(&format!("{name}:{}: ", lines.len() - 2)), "{said}");
        assert!(said.contains("--out DIR`, or delete the file"), "{said}");
    }
    // A document of something else, and one that lacks what decides.
    assert!(read(&[("s-bound.json", "[1, 2]".into())]).is_err());
    let mut silent = bound();
    silent.as_object_mut().unwrap().remove("violations");
    let error = read(&[("s-bound.json", silent.to_string())]).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("missing field `violations`"), "{error}");
}
