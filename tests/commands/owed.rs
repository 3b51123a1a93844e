//! Source: the contract of exit codes, and of the baseline on what a run owes.
//! Goal: of two verdicts one that is wrong is enough, whichever stands first and whatever command judges; a run that judges
//!   less than its scenes owe, or compares fewer constants, is not green.
//! Data: affine with two predictions, of V_max and of L2_max. Gates that forget some: docs/SABOTAGE.md.

use crate::program::{Folder, code, ends, json, stderr, stdout, sweep};
use crate::shipped::edited;

/// affine with orders in time of V_max and of L2_max; both are 2.
fn two_predictions(orders: [&str; 2]) -> String {
    let [first, second] = orders;
    let text = edited(&crate::shipped::text("affine"), "order = 2.0", &format!("order = {first}"));
    format!(
        "{text}\n[[predicts]]\nnorm = \"L2_max\"\nvariable = \"k\"\norder = {second}\nwhy = \"Theorem 7, (3.17)\"\n"
    )
}

/// Displacements of the built-in solver as the answers of another one.
#[cfg(unix)]
fn answers(scene: &str, cases: &std::path::Path) {
    let setup = crate::shipped::setup_of(scene.to_owned());
    let data = crate::shipped::on_mesh(&setup, 4);
    for steps in [4, 8, 16, 32, 64] {
        let dir = run::external::case_dir(cases, "affine", 4, steps);
        crate::external::answer(&setup, &data, steps, &dir);
    }
}

#[cfg(unix)]
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
            let output = ends(1, &[command, scenes[0], scenes[1], "--out", &out]);
            assert!(stdout(&output).contains("1 of 2 verdicts as expected"));
        }
        ends(1, &["report", &out]);
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
        ends(0, &["baseline", &scene, "--file", &file, "--out", &out]);
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
    ends(0, &["baseline", &recorded.scene, "--file", &recorded.file, "--out", &out]);
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

#[test]
fn a_scene_without_predictions_to_judge_owes_nothing() {
    let folder = Folder::new("owes-nothing");
    let text = edited(&crate::shipped::text("affine"), "[domain]", "judge = false\n[domain]");
    // The heading ends where the domain begins.
    let scene = folder.file("affine.toml", &text);
    let file = folder.argument("baseline.json");
    let out = folder.argument("out");
    ends(0, &["baseline", &scene, "--file", &file, "--out", &out]);
    let document: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&file).expect("a file")).expect("JSON");
    assert_eq!(document["scenes"]["affine"]["owes"], serde_json::json!([]));
    let output = sweep(&["run", &scene, "--json", "--out", &out]);
    assert!(json(&output).get("baseline").is_none(), "named scenes are not compared by run");
}
