//! Source: the contract of `sweep bound`: constants, samples, factors and thresholds as text, JSON and a picture.
//! Goal: the command prints numbers that are known, writes what it says, and refuses what it cannot study.
//! Data: memory-minus-identity: m0 = 2, |B(0)| = 1, Q-norm 4, so 0.4, 1, 4 and 4, and a factor of k/4.

use crate::program::{
    Folder, code, ends, json, refused, refuses, stderr, stdout, sweep, unwrapped,
};
use crate::shipped::{edited, text};

fn near(value: &serde_json::Value, exact: f64) -> bool {
    value.as_f64().is_some_and(|value| (value - exact).abs() < 2e-6 * exact)
}

#[test]
fn json_and_files_hold_the_known_numbers() {
    let folder = Folder::new("bound");
    let out = folder.argument("out");
    let output = ends(
        0,
        &["bound", "memory-minus-identity", "--n", "4", "--steps", "4", "--json", "--out", &out],
    );
    let document = json(&output);
    let thresholds = &document["thresholds"];
    for (key, exact) in
        [("paper_norm", 0.4), ("theorem", 1.0), ("sharpened", 4.0), ("solvable", 4.0)]
    {
        assert!(near(&thresholds[key], exact), "{key}: {}", thresholds[key]);
    }
    for key in ["norm_one", "radius_one", "loss"] {
        for end in 0..2 {
            assert!(near(&thresholds[key][end], 4.0), "{key}: {}", thresholds[key]);
        }
    }
    assert!(near(&document["ratio"], 10.0));
    let claims = document["claims"].as_array().expect("claims");
    assert!(document["holds"] == true && claims.iter().all(|claim| claim["holds"] == true));
    for (line, least) in [("sharpened", 10), ("threshold", 5), ("c_j^2", 2)] {
        assert!(claims.iter().filter(|claim| claim["line"] == line).count() >= least, "{line}");
    }
    let rungs = document["rungs"].as_array().expect("rungs");
    assert!(rungs.len() >= 10);
    for rung in rungs {
        let k = rung["k"].as_f64().expect("k");
        assert!(near(&rung["norm"], 0.25 * k) && near(&rung["sharpened"], 0.25 * k), "{rung}");
        assert_eq!(rung["newton"].is_number(), k < 4.0, "{rung}");
    }
    let constants = document["constants"].as_array().expect("constants");
    let named = |name: &str| constants.iter().find(|c| c["name"] == name).expect("a constant");
    for (name, exact, how) in [
        ("m_A", 2.0, "proved"),
        ("c_j^2, limit", 1.0, "extrapolated"),
        ("c_j^2, bound", 1.0, "proved"),
        ("|B|_Q", 4.0, "proved"),
    ] {
        let constant = named(name);
        assert!(near(&constant["value"], exact) && constant["how"] == how, "{constant}");
    }
    let written = std::fs::read_to_string(folder.at("out/memory-minus-identity-bound.json"));
    assert_eq!(written.expect("a file").trim(), stdout(&output).trim());
    let svg = std::fs::read_to_string(folder.at("out/memory-minus-identity-bound.svg"));
    assert!(svg.expect("a picture").contains("sharpened"));
}

#[test]
fn text_names_every_threshold() {
    let output = ends(0, &["bound", "memory-minus-identity", "--n", "4"]);
    let text = stdout(&output);
    for phrase in ["m_A ", "energy constant, limit", "and every one holds."] {
        assert!(text.contains(phrase), "no `{phrase}` in\n{text}");
    }
    for (name, value) in [("1: (3.4), the paper's norm", "0.4"), ("2: sharpened", "4")] {
        let line = text.lines().find(|line| line.contains(name)).expect(name);
        assert!(line.trim_end().ends_with(&format!(" {value}")), "{line}");
    }
    // Deterministic: nothing in it depends on time or threads.
    assert_eq!(text, stdout(&sweep(&["bound", "memory-minus-identity", "--n", "4"])));
}

#[test]
fn what_cannot_be_studied_is_refused() {
    for arguments in [&["bound", "nothing"][..], &["bound", "punch", "--n", "0"], &["bound"]] {
        let output = ends(2, arguments);
        assert!(stdout(&output).is_empty() && !stderr(&output).contains("panicked"));
    }
}

/// Where m0 <= 0 no k is below (3.4): what is defined is printed, the rest says why not, and (2.9) is a violation.
#[test]
fn without_monotonicity_the_rest_is_still_said() {
    for (name, m0) in [("broken-m0-beyond", -0.1), ("broken-m0-at", 0.0)] {
        let output = sweep(&["bound", name]);
        let text = stdout(&output);
        assert_eq!(code(&output), 1, "{}", stderr(&output));
        for phrase in ["m_A ", "random starts", "no k: m0 = ", "Does not hold: (2.9)"] {
            assert!(text.contains(phrase), "no `{phrase}` in\n{text}");
        }
        let unwrapped = unwrapped(&text);
        let reason =
            format!("Nothing is measured: the least m0 = {m0} is not positive, (2.9) is violated");
        assert!(unwrapped.contains(&reason), "{text}");
        assert!(
            !text.contains("NaN") && !text.contains(" inf ") && !text.contains("every k"),
            "{text}"
        );
        let folder = Folder::new("bound-m0");
        let output = ends(1, &["bound", name, "--json", "--out", &folder.argument("out")]);
        let document = json(&output);
        let thresholds = &document["thresholds"];
        assert!(thresholds["norm_one"].is_null() && thresholds["loss"].is_null(), "{thresholds}");
        let reason = thresholds["not_followed"].as_str().expect("a reason");
        assert!(reason.contains("(2.9) is violated"), "{reason}");
        for key in ["paper_norm", "theorem", "sharpened", "solvable"] {
            assert_eq!(thresholds[key], 0.0, "{key}");
        }
        assert_eq!(document["rungs"], serde_json::json!([]));
        let levels = document["levels"].as_array().expect("levels");
        assert!(
            levels.iter().all(|level| level["norm"].is_number() && level["sharpened"].is_null())
        );
        let constants = document["constants"].as_array().expect("constants");
        let found = constants.iter().find(|c| c["name"] == "m0").expect("m0");
        assert!((found["value"].as_f64().expect("m0") - m0).abs() < 1e-12, "{found}");
        assert!(folder.names().contains(&"out".to_owned()));
        // Gronwall's lemma divides by m0 as well.
        refuses(&["gronwall", name], &["is not positive"]);
    }
}

/// The fixed-point iteration is a solver one can choose; it agrees with Newton's method, and says when it cannot.
#[test]
fn solve_takes_either_solver() {
    let at = |solver: &str, steps: &str| {
        sweep(&["solve", "punch", "--n", "4", "--steps", steps, "--solver", solver, "--json"])
    };
    let (newton, lambda) = (json(&at("newton", "4")), json(&at("fixed-point", "4")));
    let both = ["strain_norm", "zeta", "contact_force"];
    for key in both {
        let (a, b) = (newton[key].as_f64().expect(key), lambda[key].as_f64().expect(key));
        assert!((a - b).abs() < 1e-10 * a.abs(), "{key}: {a} {b}");
    }
    assert_eq!(newton["fixed_point_iterations"], 0);
    assert!(lambda["fixed_point_iterations"].as_u64().expect("a count") > 8);
    let folder = Folder::new("solver");
    let scene = edited(&text("memory-plus-identity"), "horizon = 1.0", "horizon = 20.0");
    let path = folder.file("memory-plus-identity.toml", &scene);
    let long =
        |solver: &str| sweep(&["solve", &path, "--n", "4", "--steps", "4", "--solver", solver]);
    assert_eq!(code(&long("newton")), 0);
    refused(&long("fixed-point"), &["does not contract"]);
}
