//! Source: M. L. Williams (1952); src/theory/corner has the closed equations.
//! Goal: the exponent that scenes and documents name is the one computed; `check` prints it for given loads.

use studies::theory::corner::{Wedge, WedgeSide, corners};

use crate::program::{Folder, repository, stdout, sweep};
use crate::shipped::{edited, number, setup, text};

#[test]
fn scene_and_document_name_the_exponent_of_the_clamped_block() {
    let punch = setup("punch");
    let found = corners(&punch.body);
    assert_eq!(found.len(), 4);
    let orders: Vec<f64> = found.iter().map(|corner| corner.order()).collect();
    let least = orders.iter().copied().fold(1.0, f64::min);
    // Top corners are clamped and free, bottom corners free, or free and sliding where locked.
    assert_eq!(orders.iter().filter(|order| **order < 1.0).count(), 2, "{orders:?}");
    let scene = setup("corner").scene;
    assert!((scene.predicts[0].order - least).abs() < 1e-4, "{least}");
    let power = scene.source.text.lines().find_map(|line| line.strip_prefix("s = "));
    let power: f64 = power.expect("the power").parse().expect("a number");
    assert!((power - least).abs() < 1e-9, "{least}");
    let text = repository("docs/BROKEN-HYPOTHESES.md");
    assert!(text.contains(&format!("{least:.4}")), "{least}");
    let section = text.split("\n## Corners").nth(1).expect("the section");
    let section = section.split("## ").next().expect("its end");
    let rows: Vec<Vec<&str>> = section
        .lines()
        .map(|line| line.split('|').map(str::trim).collect())
        .filter(|cells: &Vec<&str>| cells.len() == 7 && cells[1].parse::<f64>().is_ok())
        .collect();
    assert_eq!(rows.len(), 9);
    let side = |word: &str| {
        let all = [WedgeSide::Clamped, WedgeSide::Free, WedgeSide::Sliding];
        all.into_iter()
            .find(|side| format!("{side:?}").to_lowercase() == word)
            .expect("a condition")
    };
    for cells in rows {
        let angle = cells[1].parse::<f64>().expect("degrees").to_radians();
        let wedge = Wedge { angle, sides: [side(cells[2]), side(cells[3])], lame_ratio: 1.0 };
        let order: f64 = cells[5].parse().expect("an order");
        assert!((wedge.order() - order).abs() < 5e-5, "{cells:?}: {}", wedge.order());
    }
}

#[test]
fn check_foresees_corners_of_given_loads() {
    let checked = stdout(&sweep(&["check", "punch"]));
    assert_eq!(checked.matches("corner ").count(), 4, "{checked}");
    assert!(
        checked.contains("left top, 90 degrees: free/clamped: r^0.7447; order in h 0.7447"),
        "{checked}"
    );
    // A manufactured solution is as smooth at corners as its formulas are.
    assert!(!stdout(&sweep(&["check", "steady"])).contains("corner "));
}

/// punch on n = 8, 16, 32 against n = 64: the order as measured is above the one without the reference's error.
#[test]
fn a_sweep_says_what_its_reference_hides() {
    let folder = Folder::new("reference");
    let small = edited(
        &edited(&text("linear-punch"), "steps = [8, 16, 32]", "steps = [4]"),
        "reference = { n = 128, steps = 64 }",
        "reference = { n = 64, steps = 4 }",
    );
    let (file, out) = (folder.file("linear-punch.toml", &small), folder.argument("out"));
    let printed = stdout(&sweep(&["run", &file, "--out", &out, "--json"]));
    let document: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    let found = &document["references"][0][1];
    let [order, measured, reference] =
        ["order", "measured_order", "reference_error"].map(|key| number(found, key));
    assert!(measured > order + 0.02 && order > 0.7 && order < 1.0, "{found}");
    // At order p the reference on half the mesh size has 2^-p of the finest whole error.
    let whole = found["finest"][1].as_f64().expect("a number");
    assert!((reference / whole - 0.5f64.powf(order)).abs() < 0.05, "{found}");
    assert!(stdout(&sweep(&["report", &out])).contains("measured only"));
}
