//! Values of independent implementations (tests/fixtures), as tests/fixtures_*.rs compare them.

use exact::Exact;
use fem::norms::step_errors;
use scene::setup::{MeshData, Setup};
use serde_json::Value;
use studies::solution::FinalState;

use crate::shipped::{fixture, number, relative};

/// The accuracies of tests/numbers/fixtures_punch.rs, tests/numbers/fixtures_affine.rs and tests/numbers/fixtures_pure_strong.rs, with their
/// reasons there.
const PUNCH: f64 = 1e-9;
const ERRORS: f64 = 1e-8;
const FIELDS: f64 = 1e-9;

/// Scenes with their parts of the fixture.
pub const AFFINE: [(&str, &str); 2] = [("affine", "compliance"), ("affine-locked", "locked")];

/// Rows of a part of the affine fixture.
pub fn rows(part: &str) -> Vec<Value> {
    fixture("affine")[part].as_array().expect("rows").clone()
}

/// The quantities of a punch scene at n = N = `level`.
pub fn punch(scene: &str, level: u32) -> Value {
    let value = fixture("punch")[scene][format!("n={level} N={level}")].clone();
    assert!(value.is_object(), "{scene}, {level}");
    value
}

fn off(key: &str, found: f64, expected: f64, allowed: f64) -> Option<String> {
    let off = relative(found, expected);
    (off.is_nan() || off > allowed).then(|| format!("{key} off by {off:.1e}"))
}

/// The first quantity of a final state that disagrees.
pub fn punch_disagrees(state: &FinalState, expected: &Value) -> Option<String> {
    let quantities = [
        ("norm_eps", state.strain_norm),
        ("zeta", state.zeta),
        ("energy", state.elastic_energy),
        ("contact_force", state.contact_force),
        ("compliance_force", state.compliance_force),
        ("multiplier_force", state.multiplier_force),
        ("min_uy", state.min_uy),
        ("locked_vertices", state.locked_vertices as f64),
    ];
    quantities.iter().find_map(|(key, found)| off(key, *found, number(expected, key), PUNCH))
}

/// The first error of a row of the affine fixture that disagrees.
pub fn affine_disagrees(
    sound: &Setup,
    program: &Setup,
    data: &MeshData,
    row: &Value,
) -> Option<String> {
    let (mut largest, mut last) = (0f64, f64::NAN);
    let steps = number(row, "N") as u32;
    let run = program.scheme.march(program, data, steps, &mut |view| {
        let moments = data.truth.moments(view.t)?;
        last = step_errors(&data.space, &sound.model, view, &moments).v;
        largest = if last.is_nan() { f64::NAN } else { largest.max(last) };
        Ok(())
    });
    if let Err(error) = run {
        return Some(format!("no result: {error}"));
    }
    off("V", largest, number(row, "V"), ERRORS)
        .or_else(|| off("V_T", last, number(row, "V_T"), ERRORS))
}

/// The first f0 of pure-strong that disagrees.
pub fn fields_disagree(exact: &Exact) -> Option<String> {
    let fixture = fixture("pure-strong");
    let points = fixture["interior"].as_array().expect("points");
    points.iter().find_map(|point| {
        let at = [[number(point, "x"), number(point, "y"), 0.0]];
        let mut found = vec![Vec::new(); 2];
        exact.forces.bind(&at).evaluate(1.0, exact.zeta.at(1.0), &mut found);
        let expected = point["f0"].as_array().expect("f0");
        found.iter().zip(expected).find_map(|(found, expected)| {
            // Relative to the largest force at the three points, 30.
            let off = (found[0] - expected.as_f64().expect("a number")).abs() / 30.0;
            (off.is_nan() || off > FIELDS).then(|| format!("f0 off by {off:.1e}"))
        })
    })
}
