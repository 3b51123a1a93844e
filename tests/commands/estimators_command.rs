//! Source: the contract of `sweep estimators`: JSON, files, exit codes; the tables of docs/estimates.
//! Goal: the command prints what its page shows, fails where an estimator does, and refuses what it cannot compare; the errors
//!   of the page of static contact are those of the baseline.
//! Data: the cheap scenes of the pages.

use crate::program::{Folder, code, ends, json, refuses, repository, stderr, sweep};

fn page(name: &str) -> String {
    repository(&format!("docs/estimates/{name}.md"))
}

/// The cells of the row of a scene.
fn row(page: &str, scene: &str) -> Vec<String> {
    let head = format!("| `{scene}` |");
    let line = page.lines().find(|line| line.starts_with(&head)).expect("a row");
    line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// Numbers with three digits behind the point.
fn shown(runs: &serde_json::Value, key: &str) -> String {
    let runs = runs.as_array().expect("runs").iter();
    let numbers: Vec<String> =
        runs.filter_map(|run| Some(format!("{:.3}", run[key].as_f64()?))).collect();
    if numbers.is_empty() { "none".to_owned() } else { numbers.join(", ") }
}

#[test]
fn the_page_shows_what_the_command_prints() {
    let text = page("ESTIMATORS");
    for (scene, holds) in
        [("law-linear", true), ("friction-jump", false), ("locking-linear", false)]
    {
        let output = sweep(&["estimators", scene, "--json"]);
        assert_eq!(code(&output), i32::from(!holds), "{scene}: {}", stderr(&output));
        let found = json(&output);
        assert_eq!(found["holds"], holds);
        let runs = &found["runs"];
        let [_, estimate, bound, claims] = row(&text, scene).try_into().expect("four cells");
        assert_eq!(estimate, shown(runs, "estimate_over_error"), "{scene}");
        assert_eq!(bound, shown(runs, "bound_over_error"), "{scene}");
        assert_eq!(claims, if holds { "hold" } else { "fail" });
    }
}

#[test]
fn files_and_refusals() {
    let folder = Folder::new("estimators");
    let out = folder.argument("out");
    let arguments = ["estimators", "static-bilateral", "--n", "8,16,32", "--out", &out];
    ends(0, &arguments);
    let claims = std::fs::read_to_string(folder.at("out/static-bilateral-estimators-claims.csv"));
    let claims = claims.expect("the claims");
    for (line, count) in [
        ("\"estimate, interval\"", 3),
        ("\"estimate, efficient\"", 1),
        ("\"estimate, reliable\"", 1),
    ] {
        assert_eq!(claims.matches(line).count(), count, "{line}: {claims}");
    }
    assert!(folder.at("out/static-bilateral-estimators.svg").exists());
    for (arguments, words) in [
        (&["punch"][..], "no exact solution"),
        (&["abstract-smooth"], "an abstract problem has no body"),
        (&["static-bilateral", "--n", "8,16"], "an order needs 3"),
    ] {
        refuses(&[&["estimators"], arguments].concat(), &[words]);
    }
}

#[test]
fn the_errors_of_the_page_of_static_contact_are_those_of_the_baseline() {
    let baseline = repository("reports/baseline.json");
    let baseline: serde_json::Value = serde_json::from_str(&baseline).expect("JSON");
    let text = page("STATIC");
    for scene in ["static-bilateral", "static-oblique", "static-rough"] {
        let [_, n, errors, _] = row(&text, scene).try_into().expect("four cells");
        let cases = baseline["scenes"][scene]["cases"].as_array().expect("cases");
        let known: Vec<(String, String)> = cases
            .iter()
            .map(|case| {
                let error = case["errors"]["V_max"].as_f64().expect("an error");
                (case["n"].to_string(), format!("{error:.3e}"))
            })
            .collect();
        let pairs: Vec<(String, String)> = n
            .split(", ")
            .zip(errors.split(", "))
            .map(|(n, error)| (n.to_owned(), error.to_owned()))
            .collect();
        assert_eq!(pairs, known, "{scene}");
    }
}
