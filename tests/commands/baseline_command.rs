//! Source: the contract of `sweep baseline` and of its comparison by `sweep gate`.
//! Goal: a repeated run is green; a deviating error, a lost case and a changed scene are not, in every output.
//! Data: affine and affine-locked; the shipped baseline is read, complete and of the shipped scenes.

use crate::program::{Folder, code, ends, stderr, stdout, sweep};
use crate::shipped::{edited, registry};

use judge::verdict::Baseline;

/// A recorded baseline of two scenes, as text.
fn recorded(folder: &Folder) -> (String, String) {
    let (file, out) = (folder.argument("baseline.json"), folder.argument("out"));
    let output = ends(0, &["baseline", "affine", "affine-locked", "--file", &file, "--out", &out]);
    let printed = stdout(&output);
    assert!(
        printed.contains("affine: new, 5 cases") && printed.contains("2 scenes, 2 changes"),
        "{printed}"
    );
    let text = std::fs::read_to_string(&file).expect("the file");
    (file, text)
}

fn gate(folder: &Folder, file: &str, more: &[&str]) -> (i32, String) {
    let out = folder.argument("out");
    let (junit, document) = (folder.argument("junit.xml"), folder.argument("verdict.json"));
    let mut words = vec!["gate", "affine", "affine-locked", "--baseline", file, "--out", &out];
    words.extend(["--junit", &junit, "--json", &document]);
    words.extend(more);
    let output = sweep(&words);
    (code(&output), stdout(&output) + &stderr(&output))
}

#[test]
fn deviations_turn_the_gate_red() {
    let folder = Folder::new("baseline");
    let (file, text) = recorded(&folder);
    let read = |name: &str| folder.read(name);
    let (exit, printed) = gate(&folder, &file, &[]);
    assert!(exit == 0 && printed.contains("no deviation"), "{printed}");
    assert!(
        read("junit.xml").contains("testsuite name=\"baseline\"")
            && !read("junit.xml").contains("<failure")
    );
    // Other grids are compared where they meet.
    let (exit, printed) = gate(&folder, &file, &["--steps", "1,4,8,16,32,64"]);
    assert!(exit == 0 && printed.contains("no deviation"), "{printed}");

    let against = |document: &serde_json::Value| {
        std::fs::write(&file, document.to_string()).expect("the file");
        gate(&folder, &file, &[])
    };
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let recorded =
        document["scenes"]["affine"]["cases"][2]["errors"]["V_max"].as_f64().expect("an error");
    document["scenes"]["affine"]["cases"][2]["errors"]["V_max"] = (recorded / 1.01).into();
    let (exit, printed) = against(&document);
    assert_eq!(exit, 1, "{printed}");
    assert!(
        printed.contains("affine, n = 4, steps = 16: V_max") && printed.contains("+1.0 %"),
        "{printed}"
    );
    assert!(printed.contains("1 deviation") && printed.contains("sweep baseline"), "{printed}");
    assert!(read("junit.xml").contains("<failure") && read("junit.xml").contains("+1.0 %"));
    for name in ["verdict.json", "out/verdict.json"] {
        let document: serde_json::Value = serde_json::from_str(&read(name)).expect("JSON");
        let deviation = &document["baseline"]["deviations"][0];
        assert!(deviation["kind"] == "error" && deviation["verdict"] == "fail", "{document}");
        assert!(deviation["steps"] == 16 && deviation["found"].is_number(), "{deviation}");
    }

    // A case that the scene no longer runs.
    document["scenes"]["affine"]["cases"][2]["errors"]["V_max"] = recorded.into();
    document["scenes"]["affine"]["cases"][2]["steps"] = 17.into();
    let (exit, printed) = against(&document);
    assert!(exit == 1 && printed.contains("steps = 17 was not run"), "{printed}");

    // A scene file that changed.
    document["scenes"]["affine"]["hash"] = "0000000000000000".into();
    let (exit, printed) = against(&document);
    assert!(
        exit == 1 && printed.contains("unresolved: affine: the scene file changed"),
        "{printed}"
    );
    assert!(read("junit.xml").contains("unresolved"));

    // Recording one scene anew keeps the other, says what changed, and heals.
    let output = sweep(&["baseline", "affine", "--file", &file, "--out", &folder.argument("out")]);
    assert!(code(&output) == 0 && stdout(&output).contains("affine: the scene file changed"));
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), text);
}

#[test]
fn files_that_are_no_baseline_are_refused() {
    let folder = Folder::new("no-baseline");
    let (exit, printed) = gate(&folder, &folder.argument("missing.json"), &[]);
    assert!(exit == 2 && printed.contains("missing.json"), "{printed}");
    let broken = folder.file("broken.json", "{\"scenes\": [");
    let (exit, printed) = gate(&folder, &broken, &[]);
    assert!(exit == 2 && printed.contains("sweep baseline"), "{printed}");
}

/// A run that is not as expected is never recorded.
#[test]
fn a_wrong_run_is_not_recorded() {
    let folder = Folder::new("wrong-baseline");
    let wrong = edited(&crate::shipped::text("affine"), "order = 2.0", "order = 3.0");
    let scene = folder.file("affine.toml", &wrong);
    let (file, out) = (folder.argument("baseline.json"), folder.argument("out"));
    let output = sweep(&["baseline", &scene, "--file", &file, "--out", &out]);
    assert!(code(&output) == 1 && stdout(&output).contains("nothing was recorded"));
    assert!(!folder.at("baseline.json").exists());
}

/// The shipped file knows every scene of the main job as it stands: `make baseline` after a change of a scene.
#[test]
fn the_shipped_baseline_is_of_the_shipped_scenes() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let shipped = Baseline::read(&root.join("reports/baseline.json"));
    let shipped = shipped.unwrap_or_else(|error| panic!("{error}")).expect("reports/baseline.json");
    let registry = registry();
    let mut scenes = 0;
    for name in registry.names() {
        let scene = registry.load(name).unwrap_or_else(|error| panic!("{error}"));
        if scene.long || scene.sweep.is_none() {
            continue;
        }
        let recorded = shipped.scenes.get(name).unwrap_or_else(|| panic!("{name}: make baseline"));
        assert_eq!(recorded.hash, scene.source.hash, "{name} changed: make baseline");
        // Reference runs may be too near to tell; what is judged has errors to compare.
        // A judged scene owes a verdict for each of its predictions.
        let owes = recorded.owes.as_ref();
        let owes =
            owes.unwrap_or_else(|| panic!("{name} does not say what it owes: make baseline"));
        let predicted = if scene.judge { scene.predicts.len() } else { 0 };
        assert_eq!(owes.len(), predicted, "{name}: make baseline");
        let compared = recorded.cases.iter().any(|case| !case.errors.is_empty());
        assert!(compared || !scene.judge, "{name}");
        scenes += 1;
    }
    assert_eq!(shipped.scenes.len(), scenes, "entries of scenes that are no more: make baseline");
}
