//! Valid scenes: other grids and laws, numbers as formulas, violations on purpose.

use super::good::{EXACT, LOADED};
use crate::{
    Data, Direction, Expectation, Hypothesis, LoadForm, MeshFamily, Scene, Side, Source, TimeGrid,
};
use vhi::law::FourthOrder;

fn accepted(good: &str, from: &str, to: &str) -> Scene {
    assert_eq!(good.matches(from).count(), 1, "`{from}` is not unique");
    let source = Source::from_text("block.toml", good.replace(from, to));
    Scene::from_source(source).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn grids_and_meshes() {
    let graded = accepted(LOADED, "\"uniform\"", "\"graded\", exponent = 2");
    assert_eq!(graded.time.grid, TimeGrid::Graded { exponent: 2.0 });
    let random = accepted(LOADED, "\"uniform\"", "\"random\", seed = 7");
    assert_eq!(random.time.grid, TimeGrid::Random { seed: 7 });
    // A reference run needs meshes that nest; an exact solution does not.
    let meshed = |kind: &str| {
        let sides = "contact = [\"bottom\"]";
        accepted(EXACT, sides, &format!("{sides}\nmesh = {{ kind = {kind} }}"))
    };
    let mesh = "\"perturbed\", amplitude = 0.2, seed = 1";
    let perturbed = meshed(mesh);
    assert_eq!(
        perturbed.as_contact().unwrap().domain.mesh,
        MeshFamily::Perturbed { amplitude: 0.2, seed: 1, axes: [true; 3] }
    );
    let columns = meshed(&format!("{mesh}, axes = [\"y\"]"));
    assert_eq!(
        columns.as_contact().unwrap().domain.mesh,
        MeshFamily::Perturbed { amplitude: 0.2, seed: 1, axes: [false, true, false] }
    );
}

#[test]
fn young_and_poisson_give_lame() {
    let scene = accepted(EXACT, "nu = 0.25", "nu = 0.25");
    let FourthOrder::Isotropic(law) = &scene.as_contact().unwrap().material.elastic else {
        panic!()
    };
    assert!((law.lambda - 1.0).abs() < 1e-15 && (law.mu - 1.0).abs() < 1e-15);
    let Data::Exact { form, interpolated, multiplier, .. } = &scene.as_contact().unwrap().data
    else {
        panic!()
    };
    assert_eq!((*form, *interpolated, multiplier.len()), (LoadForm::Strong, false, 1));
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
fn laws_with_a_jump_and_linear() {
    let jump = accepted(LOADED, "[0.04, 0.08]", "[0.0, 0.08]").as_contact().unwrap().contact[0]
        .clone()
        .law
        .unwrap();
    assert!(jump.is_set_valued() && (jump.alpha() - 0.3).abs() < 1e-12);
    let start = LOADED.find("law = {").unwrap();
    let end = start + LOADED[start..].find('\n').unwrap();
    let law = |text: &str| {
        accepted(LOADED, &LOADED[start..end], text).as_contact().unwrap().contact[0].clone().law
    };
    let linear = law("law = { kind = \"linear\", stiffness = 3 }").unwrap();
    assert_eq!((linear.slope_before, linear.slope_after, linear.alpha()), (3.0, 3.0, 0.0));
    assert!(law("law = { kind = \"none\" }").is_none());
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

#[test]
fn loads_predictions_and_no_sweep() {
    let scene = accepted(LOADED, "variable = \"h\"", "variable = \"joint\"\norder_k = 2.0");
    assert_eq!(scene.predicts[0].variable, Direction::Joint);
    assert_eq!(scene.predicts[0].order_k, Some(2.0));
    let Data::Loads { traction, .. } = &scene.as_contact().unwrap().data else { panic!() };
    assert_eq!(traction.len(), 1);
    assert_eq!(traction[0].0, Side(0));
    let start = LOADED.find("[sweep]").unwrap();
    let end = LOADED.find("[[predicts]]").unwrap();
    let unjudged = LOADED.replace("judge = true", "judge = false");
    assert!(accepted(&unjudged, &LOADED[start..end], "").sweep.is_none());
}
