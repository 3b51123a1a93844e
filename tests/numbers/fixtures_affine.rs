//! Source: values of an independent implementation (fixtures/affine.json), exact ζ from elementary integrals.
//! Goal: errors of the P1-exact scenes, histories, traces and multipliers agree for every (n, N) of the fixture.
//!   What breaks the agreement: docs/SABOTAGE.md.
//! Mesh: 4 × 4 squares cut from lower left to upper right; vertex rule on Γ3.
//! Data: affine (gap not reached, fixture "compliance") and affine-locked (λ = t, fixture "locked"); ζ also of affine-kink.

use crate::shipped::{errors, fixture, number, on_mesh, relative, run, setup};
use exact::InterpolatedOnMesh;
use fem::norms::is_locked;
use scene::setup::{MeshData, Setup};
use serde_json::{Value, json};

/// The errors of the fixture carry 12 digits, but are differences of displacements 1e3 to 1e5 times their size,
/// which rounds the last four: 1e-8 is what remains for the smallest of them.
const ERRORS: f64 = 1e-8;
/// Other values carry 12 digits as printed; the last one rounds.
const VALUES: f64 = 1e-11;

const SCENES: [(&str, &str); 2] = [("affine", "compliance"), ("affine-locked", "locked")];

/// The quantities of the fixture, computed.
fn computed(setup: &Setup, data: &MeshData, steps: u32) -> Value {
    let v: Vec<f64> = errors(setup, &setup.model, data, steps).iter().map(|e| e.v).collect();
    let trace = &data.space.trace;
    let at = |x: f64| {
        let on = |p: &fem::contact::TracePoint| data.space.mesh.vertex(p.vertex)[0] == x;
        trace.points.iter().position(on).expect("a vertex of Γ3")
    };
    let mut last = Value::Null;
    run(setup, &setup.model, data, steps, |view| {
        let gap = 0.10;
        let normal = |i: usize| trace.normal(i, view.u);
        let cells = 0..data.space.mesh.cell_count();
        last = json!({
            "V_T": v[view.n],
            "V": v.iter().copied().fold(0.0, f64::max),
            "zeta_h_T": view.zeta,
            "norm_eps_h_T": view.strain_norm,
            "unu_T_left": normal(at(0.0)),
            "unu_T_right": normal(at(1.0)),
            "lam_T_left": view.multiplier[at(0.0)],
            "lam_T_mid": view.multiplier[at(0.5)],
            "locked": (0..trace.points.len()).filter(|&i| is_locked(normal(i), gap)).count(),
            "yields_at_T": cells.clone().any(|c| view.yields::<3>(&data.space, &setup.model, c)),
        });
    })
    .unwrap_or_else(|error| panic!("{error}"));
    assert!(v.iter().all(|v| v.is_finite()), "{v:?}");
    last
}

/// The first quantity that does not agree.
fn disagreement(found: &Value, row: &Value) -> Option<String> {
    let differs = |key: &str, allowed: f64| {
        let off = relative(number(found, key), number(row, key));
        (off.is_nan() || off > allowed).then(|| format!("{key} is off by {off:e}"))
    };
    let mut all = ["V", "V_T"].iter().map(|key| differs(key, ERRORS)).collect::<Vec<_>>();
    let values =
        ["zeta_h_T", "norm_eps_h_T", "unu_T_left", "unu_T_right", "lam_T_left", "lam_T_mid"];
    all.extend(values.iter().map(|key| differs(key, VALUES)));
    let exactly = |key: &str| (found[key] != row[key]).then(|| format!("{key} = {}", found[key]));
    all.extend([exactly("locked"), exactly("yields_at_T")]);
    all.into_iter().flatten().next()
}

fn rows(part: &str) -> Vec<Value> {
    let rows = fixture("affine")[part].as_array().expect("rows").clone();
    assert!(rows.len() >= 3, "{part}: {} rows", rows.len());
    rows
}

#[test]
fn all_rows_agree() {
    for (scene, part) in SCENES {
        let setup = setup(scene);
        for row in rows(part) {
            let data = on_mesh(&setup, number(&row, "n") as u32);
            let steps = number(&row, "N") as u32;
            let wrong = disagreement(&computed(&setup, &data, steps), &row);
            assert_eq!(wrong, None, "{scene}, N = {steps}");
        }
    }
}

/// ζ(T) of the manufactured side; 12 digits in the fixture.
#[test]
fn the_exact_accumulated_strain_agrees() {
    for (scene, part) in SCENES {
        let exact = setup(scene).exact.expect("an exact solution");
        let off = relative(exact.zeta.at(1.0), number(&rows(part)[0], "zeta_exact_T"));
        assert!(off <= VALUES, "{scene}: {off:e}");
    }
}

/// ζ of the scene with a kink in time, by formulas over the body and by nodal values, against ∫ √(a² + b²/2) by Simpson's
/// rule on both sides of the kink. Panels that are halved without a cut there miss it by 7e-10.
#[test]
fn a_kink_in_time_is_cut_out_of_the_accumulated_strain() {
    let setup = setup("affine-kink");
    let norm = |t: f64| {
        let late = (t - 1.0 / 3.0).max(0.0);
        let (a, b) = (0.06 * t * (2.0 - t) + 0.02 * late, 0.3 * (2.0 * t).sin() - 0.2 * late);
        (a * a + 0.5 * b * b).sqrt()
    };
    let simpson = |from: f64, to: f64| -> f64 {
        let width = (to - from) / 1000.0;
        let part = |k: i32| {
            let [low, middle, high] = [0.0, 0.5, 1.0].map(|u| from + width * (f64::from(k) + u));
            width / 6.0 * (norm(low) + 4.0 * norm(middle) + norm(high))
        };
        (0..1000).map(part).sum()
    };
    let expected = simpson(0.0, 1.0 / 3.0) + simpson(1.0 / 3.0, 1.0);
    let exact = setup.exact.clone().expect("an exact solution");
    let space = setup.space(2).expect("a mesh");
    let rule = setup.compliance_rule();
    let nodal = InterpolatedOnMesh::new(exact.clone(), space, rule).zeta(1.0).expect("a number");
    for found in [exact.zeta.at(1.0), nodal] {
        // Sums of a few hundred terms, rounded.
        assert!(relative(found, expected) <= 1e-14, "{found} is not {expected}");
    }
}
