//! Source: manufactured side and solver read the same numbers of a scene, so a key that is read wrongly (λ for μ)
//!   moves both, and no comparison of the two shows it.
//! Goal: every key that a scene accepts is tied once to a value from outside: a closed form of what it means, with
//!   numbers that no exchange leaves as they are. A key that is accepted and has no tie fails.
//! Data: blocks with uneven numbers; the lists of keys that the messages of the reader name.

mod contact;
mod driven;
mod finite;
mod material;
mod place;
mod walk;

use std::collections::BTreeSet;

use formula::{EvaluationPoint, Node};
use scene::Scene;

/// Keys, and the check that ties them.
pub type Tie = (&'static [&'static str], fn());

/// A block of 1 × 0.5, clamped at the top, with a load.
pub const BLOCK: &str = r#"
[scene]
name = "block"
question = "Which number is read as which?"
dimension = 2
[domain]
shape = "rectangle"
size = [1.0, 0.5]
clamped = ["top"]
traction = ["left", "right"]
contact = ["bottom"]
[time]
horizon = 1.5
[material]
lambda = 1.7
mu_L = 0.9
[contact]
[loads]
body = ["0", "-1"]
[sweep]
n = [2, 4]
steps = [3, 6]
reference = { n = 8, steps = 12 }
norms = ["V_max", "L2_max"]
[[predicts]]
norm = "V_max"
variable = "h"
order = 1.0
why = "the block"
"#;

/// A text with edits, each of which must have one place.
pub fn with(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| crate::shipped::edited(&text, from, to))
}

pub fn scene(text: &str) -> Scene {
    crate::shipped::scene_of(text.to_owned())
}

/// The block with edits, as a scene.
pub fn block(edits: &[(&str, &str)]) -> Scene {
    scene(&with(BLOCK, edits))
}

/// A formula of a scene.
pub fn value(scene: &Scene, node: Node, at: EvaluationPoint) -> f64 {
    scene.formulas.evaluate(node, &at)
}

pub const ORIGIN: EvaluationPoint = EvaluationPoint { x: 0.0, y: 0.0, z: 0.0, t: 0.0, zeta: 0.0 };

/// Equal to rounding.
#[track_caller]
pub fn near(found: f64, exact: f64) {
    assert!((found - exact).abs() <= 1e-13 * exact.abs().max(1.0), "{found} is not {exact}");
}

fn ties() -> Vec<Tie> {
    [place::TIES, material::TIES, contact::TIES, driven::TIES, finite::TIES].concat()
}

#[test]
fn every_key_is_tied_to_what_it_means() {
    for (keys, check) in ties() {
        println!("{}", keys.join(", "));
        check();
    }
}

#[test]
fn every_accepted_key_has_one_tie() {
    let accepted = walk::keys();
    let listed: Vec<&str> = ties().iter().flat_map(|(keys, _)| keys.iter().copied()).collect();
    let tied: BTreeSet<String> = listed.iter().map(|key| (*key).to_owned()).collect();
    assert_eq!(listed.len(), tied.len(), "a key is tied twice");
    let open: Vec<&String> = accepted.difference(&tied).collect();
    assert!(open.is_empty(), "accepted without a tie to a value from outside: {open:?}");
    let gone: Vec<&String> = tied.difference(&accepted).collect();
    assert!(gone.is_empty(), "tied and not accepted: {gone:?}");
    assert!(accepted.len() > 100, "{}", accepted.len());
}
