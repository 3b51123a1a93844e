//! Source: the contract of exit codes, and of the baseline on what a run owes.
//! Goal: of two verdicts one that is wrong is enough, whichever stands first and whatever command judges; an error counts
//!   from its tolerance on; a run that judges less than its scenes owe, or compares fewer constants, is not green.
//! Data: affine with two predictions, of V_max and of L2_max; verdicts of a gate that forgets some.

use crate::program::{Folder, code, json, stderr, stdout, sweep};
use crate::shipped::edited;
use judge::record::{CaseRecord, Key, NormError, Status, V_MAX};
use judge::verdict::{
    Baseline, ComparedRun, Comparison, ConstantClaim, Decision, DeviationKind, Prediction,
    Variable, Verdict, judge,
};
use scene::setup::{NewtonMarch, Scheme};

/// affine with orders in time of V_max and of L2_max; both are 2.
fn two_predictions(orders: [&str; 2]) -> String {
    let [first, second] = orders;
    let text = edited(&crate::shipped::text("affine"), "order = 2.0", &format!("order = {first}"));
    format!(
        "{text}\n[[predicts]]\nnorm = \"L2_max\"\nvariable = \"k\"\norder = {second}\nwhy = \"Theorem 7, (3.17)\"\n"
    )
}

/// Displacements of the built-in solver as the answers of another one.
fn answers(scene: &str, cases: &std::path::Path) {
    let setup = crate::shipped::setup_of(scene.to_owned());
    let data = crate::shipped::on_mesh(&setup, 4);
    let nodes = &data.space.nodes;
    for steps in [4, 8, 16, 32, 64] {
        let dir = run::external::case_dir(cases, "affine", 4, steps);
        let mut u = Vec::new();
        let mut observe = |view: &fem::contact::StepView<'_>| {
            for &node in &nodes.of_vertex {
                u.extend_from_slice(&view.u[2 * node as usize..2 * node as usize + 2]);
            }
            Ok(())
        };
        NewtonMarch.march(&setup, &data, steps, &mut observe).unwrap_or_else(|e| panic!("{e}"));
        let shape = [steps as usize + 1, nodes.of_vertex.len(), 2];
        std::fs::create_dir_all(&dir).expect("a folder");
        let bytes = run::external::encode(&shape, &u);
        std::fs::write(dir.join("displacement.npy"), bytes).expect("an answer");
    }
}

#[test]
fn one_wrong_verdict_of_two_is_enough_for_every_command() {
    for (orders, exit) in [(["2.0", "2.0"], 0), (["2.0", "3.0"], 1), (["3.0", "2.0"], 1)] {
        let folder = Folder::new("two-verdicts");
        let text = two_predictions(orders);
        let scene = folder.file("affine.toml", &text);
        answers(&text, &folder.at("cases"));
        let [run, gate, merged, verified, cases] =
            ["run", "gate", "merged", "verified", "cases"].map(|name| folder.argument(name));
        let met = if exit == 0 { "2 of 2 verdicts" } else { "1 of 2 verdicts" };
        for words in [
            &["run", &scene, "--out", &run][..],
            &["gate", &scene, "--out", &gate],
            &["merge", &run, "--out", &merged],
            &["verify", &scene, "--results", &cases, "--out", &verified],
        ] {
            let output = sweep(words);
            let said = stdout(&output) + &stderr(&output);
            assert_eq!(code(&output), exit, "{words:?} {orders:?}: {said}");
            assert!(said.contains(met), "{words:?}: {said}");
        }
        for dir in [&run, &merged, &verified] {
            let output = sweep(&["report", dir]);
            assert_eq!(code(&output), exit, "report {dir}: {}", stderr(&output));
        }
    }
}

/// Two scenes with one verdict each.
#[test]
fn one_wrong_scene_of_two_is_enough() {
    let folder = Folder::new("two-scenes");
    let good = folder.file("affine.toml", &crate::shipped::text("affine"));
    let wrong = edited(&crate::shipped::text("affine"), "name = \"affine\"", "name = \"wrong\"");
    let wrong = folder.file("wrong.toml", &edited(&wrong, "order = 2.0", "order = 3.0"));
    let out = folder.argument("out");
    for scenes in [[&good, &wrong], [&wrong, &good]] {
        for command in ["gate", "run"] {
            let output = sweep(&[command, scenes[0], scenes[1], "--out", &out]);
            assert_eq!(code(&output), 1, "{command}: {}", stderr(&output));
            assert!(stdout(&output).contains("1 of 2 verdicts as expected"));
        }
        let output = sweep(&["report", &out]);
        assert_eq!(code(&output), 1, "{}", stderr(&output));
    }
}

fn record(error: f64, floor: f64) -> CaseRecord {
    CaseRecord {
        status: Status::Converged,
        errors: vec![NormError { norm: V_MAX.into(), error: Some(error), floor: Some(floor) }],
        ..CaseRecord::without_work("block", Some(8), 4, 0.25)
    }
}

/// What deviates of an error that is `factor` times the recorded one.
fn deviating(error: f64, floor: f64, factor: f64) -> Vec<DeviationKind> {
    let baseline = Baseline::of(&[record(error, floor)], &[("block", "hash")]);
    let now = record(factor * error, floor);
    let run = ComparedRun {
        scene: "block".into(),
        hash: "hash".into(),
        planned: vec![now.key()],
        own_grids: true,
    };
    let found = baseline.compare(&[run], &[now], &[]);
    found.deviations.iter().map(|deviation| deviation.kind).collect()
}

/// 1e-6 of itself, whatever its floor; near rounding, which is 1e-12 or the floor below, 4 times that; 0.5 % at most.
#[test]
fn an_error_counts_from_its_tolerance_on() {
    for (error, floor, tolerance) in [
        (1e-3, 1e-16, 1e-6),
        (1e-3, 2e-4, 1e-6),
        (1e-8, 1e-9, 4e-4),
        (1e-8, 1e-14, 4e-6),
        (1e-10, 1e-12, 5e-3),
    ] {
        for sign in [-1.0, 1.0] {
            let (inside, outside) = (1.0 + sign * 0.9 * tolerance, 1.0 + sign * 1.1 * tolerance);
            assert_eq!(deviating(error, floor, inside), [], "{floor:e} {inside}");
            assert_eq!(
                deviating(error, floor, outside),
                [DeviationKind::Error],
                "{floor:e} {outside}"
            );
        }
    }
}

/// A baseline of affine with two predictions: its file, the arguments of a gate with it.
struct Recorded {
    folder: Folder,
    scene: String,
    file: String,
    text: String,
}

impl Recorded {
    fn new(test: &str) -> Self {
        let folder = Folder::new(test);
        let scene = folder.file("affine.toml", &two_predictions(["2.0", "2.0"]));
        let (file, out) = (folder.argument("baseline.json"), folder.argument("out"));
        let output = sweep(&["baseline", &scene, "--file", &file, "--out", &out]);
        assert_eq!(code(&output), 0, "{}{}", stdout(&output), stderr(&output));
        let text = std::fs::read_to_string(&file).expect("the baseline");
        Self { folder, scene, file, text }
    }

    fn document(&self) -> serde_json::Value {
        serde_json::from_str(&self.text).expect("JSON")
    }

    fn gate(&self, baseline: &serde_json::Value, more: &[&str]) -> (i32, String) {
        std::fs::write(&self.file, baseline.to_string()).expect("the baseline");
        let out = self.folder.argument("out");
        let words = ["gate", &self.scene, "--baseline", &self.file, "--out", &out];
        let output = sweep(&[&words[..], more].concat());
        (code(&output), stdout(&output) + &stderr(&output))
    }
}

/// The tolerance again, through the command: a repeated run has the recorded errors to the last digit.
#[test]
fn the_gate_tells_a_deviation_of_a_millionth() {
    let recorded = Recorded::new("millionth");
    for (factor, exit) in
        [(1.0 - 0.9e-6, 0), (1.0 + 0.9e-6, 0), (1.0 - 1.1e-6, 1), (1.0 + 1.1e-6, 1)]
    {
        let mut document = recorded.document();
        let error = &mut document["scenes"]["affine"]["cases"][1]["errors"]["V_max"];
        *error = (error.as_f64().expect("an error") / factor).into();
        let (found, printed) = recorded.gate(&document, &[]);
        assert_eq!(found, exit, "{factor}: {printed}");
    }
}

#[test]
fn a_gate_that_judges_less_than_is_owed_is_red() {
    let recorded = Recorded::new("owed");
    let owes = recorded.document()["scenes"]["affine"]["owes"].clone();
    let first = serde_json::json!({"norm": "V_max", "variable": "k", "constants": ["C_k"]});
    assert_eq!(owes[0], first, "{owes}");
    assert_eq!((&owes[1]["norm"], owes.as_array().map(Vec::len)), (&"L2_max".into(), Some(2)));
    let (exit, printed) = recorded.gate(&recorded.document(), &[]);
    assert!(
        exit == 0 && printed.contains("2 verdicts and 2 compared constants recorded, all judged")
    );
    assert!(printed.contains("2 of 2 verdicts as expected"), "{printed}");

    let with = |owes: serde_json::Value| {
        let mut document = recorded.document();
        document["scenes"]["affine"]["owes"] = owes;
        document
    };
    let more = |entry: serde_json::Value| {
        let mut owes = owes.as_array().expect("a list").clone();
        owes.push(entry);
        with(owes.into())
    };
    let lost = more(serde_json::json!({"norm": "stress_L2_max", "variable": "h"}));
    let mut other = owes.clone();
    other[1]["constants"] = serde_json::json!(["C_k", "C_h"]);
    let mut twice = owes.as_array().expect("a list").clone();
    twice.push(twice[0].clone());
    for (document, said) in [
        (lost, "affine: stress_L2_max in h: the verdict is recorded but was not judged"),
        (with(other), "affine: L2_max in k: the constant C_h is recorded but was not decided"),
        (with(twice.into()), "affine: V_max in k: the verdict is recorded but was not judged"),
        (
            with(serde_json::json!([first])),
            "affine: L2_max in k: the verdict was judged but is not recorded",
        ),
    ] {
        let (exit, printed) = recorded.gate(&document, &[]);
        assert!(exit == 1 && printed.contains(said), "{exit} {said}: {printed}");
        assert!(printed.contains("2 of 2 verdicts as expected"), "{printed}");
        // Other grids may judge other verdicts.
        let (exit, printed) = recorded.gate(&document, &["--steps", "8,16,32,64"]);
        assert!(exit == 0 && !printed.contains("owed"), "{printed}");
        // The merge of the same records judges as well.
        let [out, merged] = ["out", "merged"].map(|name| recorded.folder.argument(name));
        sweep(&["run", &recorded.scene, "--out", &out]);
        let words = ["merge", &out, "--out", &merged, "--baseline", &recorded.file];
        let output = sweep(&words);
        assert!(code(&output) == 1 && stdout(&output).contains(said), "{}", stdout(&output));
    }

    // A baseline of before says nothing of it; that is said, and is no deviation.
    let mut old = recorded.document();
    old["scenes"]["affine"].as_object_mut().expect("a scene").remove("owes");
    let (exit, printed) = recorded.gate(&old, &[]);
    let said = "has no verdicts and constants of 1 scene, the first is affine";
    assert!(exit == 0 && printed.contains(said), "{printed}");
    // Recording it anew says what changed.
    let out = recorded.folder.argument("out");
    let output = sweep(&["baseline", &recorded.scene, "--file", &recorded.file, "--out", &out]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    assert_eq!(std::fs::read_to_string(&recorded.file).expect("the baseline"), recorded.text);
}

#[test]
fn json_names_what_is_owed() {
    let recorded = Recorded::new("owed-json");
    let mut document = recorded.document();
    document["scenes"]["affine"]["owes"][0]["variable"] = "joint".into();
    std::fs::write(&recorded.file, document.to_string()).expect("the baseline");
    let path = recorded.folder.argument("verdict.json");
    let (exit, _) = recorded.gate(&document, &["--json", &path]);
    let text = std::fs::read_to_string(&path).expect("verdict.json");
    let found: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((exit, &found["baseline"]["owed"]["verdicts"]), (1, &2.into()));
    assert_eq!(found["baseline"]["owed"]["constants"], 2);
    let deviation = &found["baseline"]["deviations"][0];
    assert_eq!(deviation["kind"], "owed", "{deviation}");
    assert!(deviation["variable"] == "joint" && deviation["norm"] == "V_max", "{deviation}");
}

/// A verdict that passes, with a compared constant where there is one.
fn verdict(scene: &str, norm: &str, compared: bool) -> Verdict {
    let prediction = Prediction::new(norm, Variable::K, 2.0);
    let record = |steps: u32| CaseRecord {
        status: Status::Converged,
        errors: vec![NormError {
            norm: norm.into(),
            error: Some(f64::from(steps).powi(-2)),
            floor: Some(0.0),
        }],
        ..CaseRecord::without_work(scene, None, steps, 1.0 / f64::from(steps))
    };
    let records: Vec<CaseRecord> = [8, 16, 32, 64].map(record).into();
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    let mut verdict = judge(scene, &records, &keys, &prediction, Decision::Pass);
    verdict.constant = compared.then(|| ConstantClaim {
        decides: false,
        name: "C_k",
        decision: Decision::Pass,
        reason: String::new(),
        owed: false,
    });
    verdict
}

/// What a gate leaves owing of three verdicts of two scenes.
fn owing(scenes: &[&str], verdicts: &[Verdict]) -> Comparison {
    let all = [verdict("a", V_MAX, true), verdict("a", "L2_max", false), verdict("b", V_MAX, true)];
    let baseline = Baseline::of(&[], &[("a", "hash"), ("b", "hash")]).owing(&all);
    let run = |scene: &&str| ComparedRun {
        scene: (*scene).into(),
        hash: "hash".into(),
        planned: Vec::new(),
        own_grids: true,
    };
    let runs: Vec<ComparedRun> = scenes.iter().map(run).collect();
    baseline.compare(&runs, &[], verdicts)
}

#[test]
fn gates_that_forget_are_red() {
    let all = || {
        vec![verdict("a", V_MAX, true), verdict("a", "L2_max", false), verdict("b", V_MAX, true)]
    };
    let whole = owing(&["a", "b"], &all());
    assert_eq!((whole.exit_code(), whole.owed.verdicts, whole.owed.constants), (0, 3, 2));
    // Of chosen scenes only their verdicts are owed.
    let some = owing(&["b"], &all()[2..]);
    assert_eq!((some.exit_code(), some.owed.verdicts, some.owed.constants), (0, 1, 1));
    // The first prediction of each scene alone; no constant at all; a scene that is not judged.
    let first: Vec<Verdict> = all().into_iter().filter(|v| v.norm == V_MAX).collect();
    let mut without = all();
    without.iter_mut().for_each(|v| v.constant = None);
    let mut drifting = all();
    drifting.iter_mut().filter_map(|v| v.constant.as_mut()).for_each(|claim| {
        claim.decision = Decision::Unresolved;
    });
    for (verdicts, said, count) in [
        (drifting, "a: V_max in k: the constant C_k is recorded but was not decided", 2),
        (first, "a: L2_max in k: the verdict is recorded", 1),
        (without, "b: V_max in k: the constant C_k is recorded", 2),
        (all()[..2].to_vec(), "b: V_max in k: the verdict is recorded", 1),
        (Vec::new(), "a: V_max in k: the verdict is recorded", 3),
    ] {
        let found = owing(&["a", "b"], &verdicts);
        let lines = found.lines().join("\n");
        assert_eq!((found.exit_code(), found.deviations.len()), (1, count), "{lines}");
        assert!(lines.contains(said), "{lines}");
        assert!(found.deviations.iter().all(|deviation| deviation.kind == DeviationKind::Owed));
    }
}

#[test]
fn a_scene_without_predictions_to_judge_owes_nothing() {
    let folder = Folder::new("owes-nothing");
    let text = edited(&crate::shipped::text("affine"), "[domain]", "judge = false\n[domain]");
    // The heading ends where the domain begins.
    let scene = folder.file("affine.toml", &text);
    let file = folder.argument("baseline.json");
    let out = folder.argument("out");
    let output = sweep(&["baseline", &scene, "--file", &file, "--out", &out]);
    assert_eq!(code(&output), 0, "{}", stderr(&output));
    let document: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&file).expect("a file")).expect("JSON");
    assert_eq!(document["scenes"]["affine"]["owes"], serde_json::json!([]));
    let output = sweep(&["run", &scene, "--json", "--out", &out]);
    assert!(json(&output).get("baseline").is_none(), "named scenes are not compared by run");
}
