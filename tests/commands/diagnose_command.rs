//! Source: the contract of `sweep diagnose`: 0 nothing to diagnose, 1 something is wrong, 2 it could not be done.
//! Goal: exit codes, the sentence and the JSON keys, from outside.
//! Data: affine; affine with an order that no theorem gives; scenes without exact solution.

use crate::program::{Folder, ends, json, stderr, stdout};
use crate::shipped::{edited, text};

#[test]
fn a_sound_scene_has_nothing_to_diagnose() {
    let output = ends(0, &["diagnose", "affine"]);
    let printed = stdout(&output);
    assert!(printed.contains("nothing to diagnose"), "{printed}");
    assert!(!printed.contains("memory alone"), "{printed}");
}

#[test]
fn always_runs_the_trials() {
    let output = ends(0, &["diagnose", "affine", "--always"]);
    let printed = stdout(&output);
    println!("{printed}");
    for words in
        ["without memory", "zeta alone", "1.0000e-9", "nothing is wrong, because every variant"]
    {
        assert!(printed.contains(words), "{words}: {printed}");
    }
}

#[test]
fn json_has_its_keys() {
    let output = ends(0, &["diagnose", "affine", "--always", "--json"]);
    let document = json(&output);
    let trials = document["trials"].as_array().expect("trials");
    assert!(trials.len() >= 12);
    for trial in trials {
        assert_eq!(trial["verdict"], "pass", "{trial}");
        let claim = &trial["claim"];
        let is_order = claim["relation"] == "order";
        assert!(claim["left"].is_number() && claim["holds"] == true, "{trial}");
        assert_eq!(claim["right"], if is_order { 2.0 } else { 1e-9 }, "{trial}");
        assert!(trial["suspects"].as_array().is_some_and(|list| !list.is_empty()));
    }
    let culprits = document["culprits"].as_array().expect("culprits");
    assert!(culprits.is_empty() && document["sentence"].is_string());
    assert!(document["verdicts"][0]["norm"] == "V_max" && document["scene"] == "affine");
    // Verdicts and trials are claims alike.
    let claims = document["claims"].as_array().expect("claims").len();
    let verdicts = document["verdicts"].as_array().expect("verdicts").len();
    assert_eq!(claims, verdicts + trials.len());
}

/// A prediction that is wrong is no defect of the solver: the scene fails, and no term is named.
#[test]
fn a_wrong_prediction_is_not_among_the_terms() {
    let folder = Folder::new("diagnose");
    let wrong = edited(&text("affine"), "order = 2.0", "order = 3.0");
    let output = ends(1, &["diagnose", &folder.file("affine.toml", &wrong)]);
    let printed = stdout(&output);
    assert!(printed.contains("not among the terms") && !printed.contains("culprit"), "{printed}");
    // The constant of order 2 agrees: the prediction is named, and no trial is needed.
    assert!(printed.contains("[[predicts]] says 3"), "{printed}");
    assert!(!printed.contains("memory alone"), "{printed}");
}

#[test]
fn what_has_no_variants_is_refused() {
    for (name, words) in [
        ("punch", "no exact solution"),
        ("abstract-smooth", "no terms to remove"),
        ("no-such-scene", "no-such-scene"),
    ] {
        let output = ends(2, &["diagnose", name]);
        assert!(stderr(&output).contains(words) && stdout(&output).is_empty(), "{name}");
    }
}
