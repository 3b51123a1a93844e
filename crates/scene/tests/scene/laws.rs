//! The kinds of law: their keys, and the messages for wrong ones.

use super::good::{LOADED, refused};
use scene::{Curve, Law, Scene, Source};

/// The valid text with another law, on line 28.
fn with_law(law: &str) -> String {
    let start = LOADED.find("law = {").expect("a law");
    let end = start + LOADED[start..].find('\n').expect("an end");
    format!("{}law = {law}{}", &LOADED[..start], &LOADED[end..])
}

fn accepted(text: &str) -> Law {
    let scene = Scene::from_source(Source::from_text("block.toml", text.to_string()));
    let scene = scene.unwrap_or_else(|error| panic!("{error}"));
    scene.as_contact().unwrap().contact[0].clone().law.unwrap()
}

#[track_caller]
fn says(text: &str, line: usize, phrase: &str) {
    let diagnosis = refused(text);
    let shown = diagnosis.to_string();
    assert!(shown.contains(phrase), "`{phrase}` is not said:\n{shown}");
    assert_eq!(diagnosis.line(), line, "{shown}");
    assert!(!diagnosis.hint.is_empty());
}

#[test]
fn every_kind_is_read() {
    let law = accepted(&with_law("{ kind = \"rational\", stiffness = 2.0, length = 0.04 }"));
    assert_eq!(law.curve, Some(Curve::Rational { stiffness: 2.0, length: 0.04 }));
    assert!(!law.is_set_valued() && law.alpha() == 0.25);
    let law = "{ kind = \"exponential\", stiffness = 2.0, length = 0.04, jump = 0.1 }";
    let law = accepted(&with_law(law));
    assert!(law.is_set_valued() && law.points == [[0.0, 0.0], [0.0, 0.1]]);
    assert!((law.alpha() - 2.0 * (-2.0f64).exp()).abs() < 1e-15);
    let law =
        "{ kind = \"power\", coefficient = 3.0, exponent = 1.5, until = 0.1, scale = \"2 - x\" }";
    let law = accepted(&with_law(law));
    let scale = law.scale.expect("a factor");
    // An affine factor has no bend: its bound is its value at x = 0, where α_ν = 0 stays 0.
    assert!((scale.largest - 2.0).abs() < 1e-15 && law.alpha() == 0.0);
}

#[test]
fn wrong_numbers_and_keys_are_refused_at_their_place() {
    for (law, phrase) in [
        ("{ kind = \"rational\", stiffness = 2.0 }", "needs the key `length`"),
        (
            "{ kind = \"rational\", stiffness = -2.0, length = 0.1 }",
            "`stiffness` = -2 is not positive",
        ),
        (
            "{ kind = \"exponential\", stiffness = 2.0, length = 0.0 }",
            "`length` = 0 is not positive",
        ),
        (
            "{ kind = \"exponential\", stiffness = 2.0, length = 0.1, until = 1.0 }",
            "takes no `until`",
        ),
        (
            "{ kind = \"power\", coefficient = 2.0, exponent = 0.5, until = 1.0 }",
            "slope of the law is infinite at r = 0",
        ),
        ("{ kind = \"power\", coefficient = 2.0, exponent = 900.0, until = 9.0 }", "linear growth"),
        (
            "{ kind = \"power\", coefficient = 2.0, exponent = 1.5, until = 1.0, length = 1.0 }",
            "takes no `length`",
        ),
        ("{ kind = \"linear\", stiffness = 2.0, jump = 1.0 }", "takes no `jump`"),
        (
            "{ kind = \"rational\", stiffness = 2.0, length = 0.1, jump = -1.0 }",
            "`jump` = -1 is not positive",
        ),
        ("{ kind = \"none\", scale = \"1 + x\" }", "takes no `scale`"),
        ("{ kind = \"linear\", stiffness = 2.0, scale = \"1 - 2*x\" }", "`scale` is -1 at x = 1"),
        ("{ kind = \"linear\", stiffness = 2.0, scale = \"1/x\" }", "`scale` is inf at x = 0"),
        ("{ kind = \"linear\", stiffness = 2.0, scale = \"1 + t\" }", "`t` is not allowed here"),
        ("{ kind = \"exponental\", stiffness = 2.0, length = 0.1 }", "did you mean `exponential`?"),
    ] {
        says(&with_law(law), 28, phrase);
    }
}

#[test]
fn rules_that_a_law_does_not_have_are_refused() {
    let exact =
        |law: &str| with_law(law).replace("quadrature = \"vertex\"", "quadrature = \"exact\"");
    let power = "{ kind = \"power\", coefficient = 2.0, exponent = 1.5, until = 1.0 }";
    says(&exact(power), 29, "a whole exponent");
    accepted(&exact("{ kind = \"power\", coefficient = 2.0, exponent = 2.0, until = 1.0 }"));
    let jump = "{ kind = \"rational\", stiffness = 2.0, length = 0.1, jump = 0.1 }";
    says(&exact(jump), 29, "a law with a jump");
}
