//! The exact side against closed forms: histories of a(t) = 0.2 t(2 - t) and b(t) = 0.3 sin 2t (`prony`: 0.1 more), and 𝒜
//! in the axes of the material.

use exact::constitutive::{Tensor, stress};
use formula::Graph;

use crate::shipped::{on_mesh, setup};

/// ε = [[0, -b/2], [-b/2, a]] of u = (b(1-y), -a(1-y)); σ of the memory from histories (a_i, b_i).
fn strain(a: f64, b: f64) -> [[f64; 2]; 2] {
    [[0.0, -0.5 * b], [-0.5 * b, a]]
}

fn a(t: f64) -> f64 {
    0.2 * t * (2.0 - t)
}

fn b(t: f64) -> f64 {
    0.3 * (2.0 * t).sin()
}

/// ∫_0^t e^{-c(t-s)} a(s) ds: the solution of I' = -cI + a with I(0) = 0, a quadratic plus an exponential.
fn fading_a(c: f64, t: f64) -> f64 {
    // p t² + q t + r with 2pt + q + c(pt² + qt + r) = 0.4 t - 0.2 t².
    let p = -0.2 / c;
    let q = (0.4 - 2.0 * p) / c;
    let r = -q / c;
    p * t * t + q * t + r - r * (-c * t).exp()
}

/// ∫_0^t e^{-c(t-s)} b(s) ds.
fn fading_b(c: f64, t: f64) -> f64 {
    let (sin, cos) = (2.0 * t).sin_cos();
    0.3 * (c * sin - 2.0 * cos + 2.0 * (-c * t).exp()) / (c * c + 4.0)
}

/// ∫_0^t (1 + r/τ)^{-3/2} a(t-r) dr with w = 1 + r/τ: powers of w.
fn power_a(tau: f64, t: f64) -> f64 {
    let end = 1.0 + t / tau;
    // ∫_1^end w^{m - 3/2} τ dw.
    let moment = |m: i32| {
        let e = f64::from(m) - 0.5;
        tau * (end.powf(e) - 1.0) / e
    };
    // a(t - r) = 0.2 (2t - t² + (2t - 2) r - r²), r = τ(w - 1).
    let r1 = tau * (moment(1) - moment(0));
    let r2 = tau * tau * (moment(2) - 2.0 * moment(1) + moment(0));
    0.2 * ((2.0 * t - t * t) * moment(0) + (2.0 * t - 2.0) * r1 - r2)
}

/// 2 μ τ + λ tr τ I.
fn isotropic(lambda: f64, mu: f64, tensor: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let trace = tensor[0][0] + tensor[1][1];
    let entry =
        |i: usize, j: usize| 2.0 * mu * tensor[i][j] + if i == j { lambda * trace } else { 0.0 };
    [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
}

/// σ_yy and √2 σ_xy of the truth on a cell at time t.
fn of_truth(name: &str, t: f64) -> [f64; 2] {
    let setup = setup(name);
    let data = on_mesh(&setup, 2);
    let moments = data.truth.moments(t).unwrap_or_else(|error| panic!("{error}"));
    let mean = &moments.stress.at;
    [mean[1], mean[2] / std::f64::consts::SQRT_2]
}

/// Histories by adaptive quadrature are good to 1e-12.
const HISTORIES: f64 = 1e-11;

#[test]
fn prony_histories_are_the_closed_forms() {
    for t in [0.3, 1.0] {
        let both = |f: fn(f64, f64) -> f64| -f(5.0, t) - 0.3 * f(0.5, t);
        let raised = |c: f64, t: f64| fading_b(c, t) + 0.1 * (1.0 - (-c * t).exp()) / c;
        let elastic = isotropic(1.5, 0.5, strain(a(t), 0.1 + b(t)));
        let memory = isotropic(0.6, 0.25, strain(both(fading_a), both(raised)));
        let [yy, xy] = of_truth("prony", t);
        assert!((yy - elastic[1][1] - memory[1][1]).abs() < HISTORIES, "{yy}");
        assert!((xy - elastic[0][1] - memory[0][1]).abs() < HISTORIES, "{xy}");
    }
}

#[test]
fn power_law_histories_are_the_closed_forms() {
    for t in [0.3, 1.0] {
        // σ_yy holds a alone.
        let history = -power_a(0.25, t);
        let expected = (1.5 + 1.0) * a(t) + (0.6 + 0.5) * history;
        let [yy, _] = of_truth("power-law", t);
        assert!((yy - expected).abs() < HISTORIES, "{yy} {expected}");
    }
}

/// bulk tr(ε) I + 2 shear dev(ε): the trace remembers a by one kernel, the deviator a and b by the other.
#[test]
fn bulk_and_shear_histories_are_the_closed_forms() {
    for t in [0.3, 1.0] {
        let bulk = -0.6 * fading_a(0.5, t);
        let shear = |f: fn(f64, f64) -> f64| -0.5 * f(4.0, t) + 0.1 * f(1.0, t);
        let elastic = isotropic(1.5, 0.5, strain(a(t), b(t)));
        let [yy, xy] = of_truth("bulk-shear", t);
        // tr ε = a, dev ε = [[-a/2, -b/2], [-b/2, a/2]].
        assert!((yy - elastic[1][1] - bulk - shear(fading_a)).abs() < HISTORIES, "{yy}");
        assert!((xy - elastic[0][1] + shear(fading_b)).abs() < HISTORIES, "{xy}");
    }
}

/// Turned by 30° into the axes of the material, through the moduli there, and back.
#[test]
fn the_full_contraction_is_that_of_the_axes_of_the_material() {
    let setup = setup("orthotropic");
    let material = &setup.exact.as_ref().expect("exact").data.material;
    let (c, s) = (0.75f64.sqrt(), 0.5);
    let turn = [[c, -s], [s, c]];
    let product = |a: Tensor<2>, b: Tensor<2>| -> Tensor<2> {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
    };
    let back = [[c, s], [-s, c]];
    let strain = [[0.11, -0.07], [-0.07, 0.04]];
    let along_axes = product(product(back, strain), turn);
    let (xx, yy) = (
        4.0 * along_axes[0][0] + 0.8 * along_axes[1][1],
        0.8 * along_axes[0][0] + 1.5 * along_axes[1][1],
    );
    let shear = 2.0 * 0.6 * along_axes[0][1];
    let expected = product(product(turn, [[xx, shear], [shear, yy]]), back);
    let found = stress(material, &strain, &[], f64::INFINITY);
    for i in 0..2 {
        for j in 0..2 {
            // The scene has 12 digits.
            assert!((found[i][j] - expected[i][j]).abs() < 1e-12, "{found:?} {expected:?}");
        }
    }
}

/// In space: one entry of Mandel's matrix at a time, for a strain with one component.
#[test]
fn mandel_entries_in_space_stand_for_the_right_components() {
    let mut material = setup("orthotropic").exact.as_ref().expect("exact").data.material.clone();
    // σ_xx from 2 ε_xz, and σ_yz from ε_zz: entries (1, 5) and (4, 3).
    let mut matrix = [[0.0; 6]; 6];
    (matrix[0][4], matrix[3][2]) = (std::f64::consts::SQRT_2, std::f64::consts::SQRT_2);
    material.full = Some(matrix);
    let mut strain = [[0.0; 3]; 3];
    (strain[0][2], strain[2][0], strain[2][2]) = (0.5, 0.5, 3.0);
    let found = stress(&material, &strain, &[], f64::INFINITY);
    // √2·√2 ε_xz, and √2 σ_yz = √2 ε_zz.
    assert!((found[0][0] - 1.0).abs() < 1e-14 && (found[1][2] - 3.0).abs() < 1e-14, "{found:?}");
    assert!((found[2][1] - 3.0).abs() < 1e-14 && found[1][1].abs() < 1e-14, "{found:?}");
}

/// Kernels by name are the formulas they stand for, and sums of exponentials are recognised as such.
#[test]
fn kernels_by_name_are_their_formulas() {
    let kernel = |name: &str, term: usize| {
        let setup = setup(name);
        setup.body.material.memory[term].clone()
    };
    let rates = |terms: Option<Vec<(f64, f64)>>| {
        let mut terms = terms.expect("a sum of exponentials");
        terms.sort_by(|a, b| a.1.total_cmp(&b.1));
        terms
    };
    assert_eq!(rates(kernel("prony", 0).exponentials), [(-0.3, 0.5), (-1.0, 5.0)]);
    assert_eq!(rates(kernel("bulk-shear", 1).exponentials), [(0.1, 1.0), (-0.5, 4.0)]);
    assert!(kernel("power-law", 0).exponentials.is_none());
    let scene = setup("power-law").scene;
    let at = formula::EvaluationPoint { t: 0.75, ..Default::default() };
    let graph: &Graph = &scene.formulas;
    // -(1 + 3)^{-3/2}.
    assert!((graph.evaluate(kernel("power-law", 0).kernel, &at) + 0.125).abs() < 1e-15);
}
