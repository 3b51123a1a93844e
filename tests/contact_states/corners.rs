//! Source: M. L. Williams (1952); src/theory/corner has the closed equations.
//! Goal: the exponent that scenes and documents name is the one computed; `explain` and `check` print it for given loads.

use gronwall::theory::corner::corners;

use crate::program::{stdout, sweep};
use crate::shipped::setup;

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
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/CONTACT-STATES.md");
    let text = std::fs::read_to_string(path).expect("the document");
    assert!(text.contains(&format!("{least:.4}")), "{least}");
}

#[test]
fn explain_and_check_foresee_corners_of_given_loads() {
    let explained = stdout(&sweep(&["explain", "punch"]));
    assert_eq!(explained.matches("corner ").count(), 4, "{explained}");
    assert!(explained.contains("order in h at least 0.7447"), "{explained}");
    let checked = stdout(&sweep(&["check", "punch"]));
    assert!(checked.contains("clamped/free: r^0.7447; order in h 0.7447"), "{checked}");
    // A manufactured solution is as smooth at corners as its formulas are.
    assert!(!stdout(&sweep(&["explain", "steady"])).contains("corner "));
}
