//! Source: the contracts of `solve --estimate`, `bound` and `audit`.
//! Goal: they take quadratic elements; what an audit cannot have with these is refused at its key, exit code 2.
//! Data: quadratic-elastic, quadratic-front, quadratic-memory.

use crate::program::{ends, json, refuses};

#[test]
fn quadratic_elements_go_through_every_study() {
    let output = ends(
        0,
        &[
            "solve",
            "quadratic-elastic",
            "--n",
            "8",
            "--steps",
            "4",
            "--estimate",
            "--target",
            "0.5%",
            "--json",
        ],
    );
    let document = json(&output);
    let space = &document["norms"][0]["space"]["order"];
    let order = space.as_f64().expect("an order");
    // docs/JUDGING.md: a local order of three meshes.
    assert!((order - 2.0).abs() < 0.3, "{order}");
    let level = &document["bound"]["largest"];
    let number = |key: &str| level[key].as_f64().expect("a number");
    assert!(number("bound") >= number("error"), "{level}");
    assert!(document["recommendation"]["choice"]["n"].is_u64());
    for arguments in [
        &["audit", "quadratic-elastic", "--n", "4,8", "--steps", "2", "--json"][..],
        &["bound", "quadratic-elastic", "--n", "4", "--json"],
    ] {
        ends(0, arguments);
    }
}

#[test]
fn what_is_left_out_is_refused_with_its_reason() {
    refuses(&["audit", "quadratic-memory"], &["trapezoidal rule alone"]);
}
