//! Source: point values of an independent implementation (fixtures/pure-strong.json).
//! Goal: the manufactured side alone: u, ε, σ, f0 and ζ(t) of the solution with all terms and moving zones, in
//!   both of its evaluations.
//! Data: pure-strong at t = 1, three points at y = 0.15; ζ at t = 1/4, 1/2, 1. No mesh.

use crate::shipped::{fixture, number, setup};
use exact::Exact;
use exact::constitutive::{self, Tensor};
use formula::EvaluationPoint;
use serde_json::Value;

/// The fixture carries 13 digits; its σ and f0 come from histories by quadrature good to about 1e-12, and f0 from
/// derivatives of them. Relative to the largest of its kind at the three points.
const FIELDS: f64 = 1e-9;
/// ζ carries 13 digits and is below 0.35.
const ZETA: f64 = 1e-11;

fn exact() -> std::sync::Arc<Exact> {
    setup("pure-strong").exact.expect("an exact solution")
}

/// [u, ε_xx, ε_yy, ε_xy, σ_xx, σ_yy, σ_xy, f0] by kind at one point at t = 1.
fn fields(exact: &Exact, x: f64, y: f64) -> [Vec<f64>; 4] {
    let at =
        EvaluationPoint { x, y, t: 1.0, zeta: exact.zeta.at(1.0), ..EvaluationPoint::default() };
    let values = |nodes: &[formula::Node]| -> Vec<f64> {
        nodes.iter().map(|&node| exact.data.graph.evaluate(node, &at)).collect()
    };
    // Components come as xx, xy, yy.
    let order = |list: Vec<f64>| vec![list[0], list[2], list[1]];
    [
        values(&exact.data.u),
        order(values(&exact.strain)),
        order(values(&exact.stress)),
        values(&exact.body_force),
    ]
}

fn list(value: &Value, key: &str) -> Vec<f64> {
    let numbers = value[key].as_array().unwrap_or_else(|| panic!("no list `{key}`")).iter();
    numbers.map(|number| number.as_f64().expect("a number")).collect()
}

const KINDS: [&str; 4] = ["u", "eps_xx_yy_xy", "sigma_xx_yy_xy", "f0"];

/// Largest distance of each kind, relative to its largest value at the points.
fn distances(exact: &Exact) -> [f64; 4] {
    let fixture = fixture("pure-strong");
    let points = fixture["interior"].as_array().expect("points");
    assert_eq!(points.len(), 3);
    let (mut off, mut size) = ([0f64; 4], [0f64; 4]);
    for point in points {
        let found = fields(exact, number(point, "x"), number(point, "y"));
        for (kind, key) in KINDS.iter().enumerate() {
            let expected = list(point, key);
            assert_eq!(expected.len(), found[kind].len());
            for (a, b) in found[kind].iter().zip(expected) {
                let here = (a - b).abs();
                off[kind] = if here.is_nan() { f64::NAN } else { off[kind].max(here) };
                size[kind] = size[kind].max(b.abs());
            }
        }
    }
    std::array::from_fn(|kind| off[kind] / size[kind])
}

#[test]
fn fields_agree() {
    // u and ε have no history.
    let most = [1e-11, 4e-11, FIELDS, FIELDS];
    for ((kind, off), most) in KINDS.iter().zip(distances(&exact())).zip(most) {
        assert!(off <= most, "{kind} is off by {off:e}");
    }
}

#[test]
fn accumulated_strain_and_yield_limit_agree() {
    let (exact, fixture) = (exact(), fixture("pure-strong"));
    let times = fixture["zeta"].as_object().expect("ζ by time");
    assert_eq!(times.len(), 3);
    for (t, zeta) in times {
        let t: f64 = t.parse().expect("a time");
        let off = (exact.zeta.at(t) - zeta.as_f64().expect("a number")).abs();
        assert!(off <= ZETA, "ζ({t}) is off by {off:e}");
    }
    let off = (exact.kappa(1.0) - number(&fixture, "kappa_T")).abs();
    assert!(off <= ZETA, "κ is off by {off:e}");
}

/// The pointwise law on full tensors, fed with ε and H of the compiled formulas, gives the same σ.
#[test]
fn the_two_evaluations_of_the_stress_agree() {
    let exact = exact();
    for point in fixture("pure-strong")["interior"].as_array().expect("points") {
        let mut out = vec![Vec::new(); 8];
        let at = [[number(point, "x"), number(point, "y"), 0.0]];
        exact.interior.bind(&at).evaluate(1.0, 0.0, &mut out);
        let tensor = |first: usize| -> Tensor<2> {
            [[out[first][0], out[first + 1][0]], [out[first + 1][0], out[first + 2][0]]]
        };
        let stress =
            constitutive::stress(&exact.data.material, &tensor(2), &[tensor(5)], exact.kappa(1.0));
        let found = [stress[0][0], stress[1][1], stress[0][1]];
        for (a, b) in found.iter().zip(list(point, "sigma_xx_yy_xy")) {
            // 0.72 is the largest stress at the three points.
            assert!((a - b).abs() <= FIELDS * 0.72, "{a} {b}");
        }
    }
}
