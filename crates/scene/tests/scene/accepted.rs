//! Valid scenes: numbers as formulas, violations on purpose. What each key means: tests/numbers/keys.

use super::good::LOADED;
use scene::{Expectation, Hypothesis, Scene, Source};

fn accepted(good: &str, from: &str, to: &str) -> Scene {
    assert_eq!(good.matches(from).count(), 1, "`{from}` is not unique");
    let source = Source::from_text("block.toml", good.replace(from, to));
    Scene::from_source(source).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn gaps_as_numbers_and_without_bound() {
    let number = accepted(LOADED, "gap = \"0.10\"", "gap = 0.25");
    let gap = number.as_contact().unwrap().contact[0].clone().gap.unwrap();
    assert_eq!(number.formulas.value_of_constant(gap), Some(0.25));
    for free in ["gap = \"inf\"", "gap = inf", ""] {
        assert!(
            accepted(LOADED, "gap = \"0.10\"", free).as_contact().unwrap().contact[0]
                .clone()
                .gap
                .is_none()
        );
    }
    accepted(LOADED, "gap = \"0.10\"", "gap = \"0.08 + 0.1*x*(1 - x)\"");
}

#[test]
fn hypotheses_violated_on_purpose() {
    let bent = LOADED.replace("gap = \"0.10\"", "gap = \"0.1 + 0.2*x^2\"");
    let scene = accepted(&bent, "judge = true", "violates = [\"concave_gap\", \"2.9\"]");
    assert_eq!(scene.violates, [Hypothesis::ConcaveGap, Hypothesis::Smallness]);
    let root = LOADED.replace("0.05*zeta", "sqrt(zeta)");
    let scene = accepted(&root, "judge = true", "violates = [\"5.1\"]\nexpect = \"fail\"");
    assert_eq!(
        scene.as_contact().unwrap().material.projection.clone().unwrap().lipschitz,
        f64::INFINITY
    );
    assert_eq!(scene.expect, Expectation::Fail);
}
