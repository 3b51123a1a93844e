//! Source: (5.26) for the three rules of the compliance integral: `vertex`, `gauss`, and `exact`, (5.14) of the paper.
//! Goal: on the same data all three have order 1 in the V norm, and the same error to a percent; `exact` gives a
//!   different solution than either (it is no alias).
//! Mesh: n = 8, 16, 32, N = 4. Data: compliance (both branches of the law, no constraint), pure-strong (all states).

use crate::program::repository;
use crate::shipped::{on_mesh, setup};
use fem::contact::BoundaryRule;
use fem::norms::StepErrors;

const RULES: [BoundaryRule; 3] = [BoundaryRule::Vertex, BoundaryRule::Gauss, BoundaryRule::Exact];
const MESHES: [u32; 3] = [8, 16, 32];

/// max over n of ‖ε(u_n - u_n^{kh})‖ by mesh.
fn v_errors(name: &str, rule: BoundaryRule) -> Vec<f64> {
    let mut setup = setup(name);
    setup.model.boundary.first_mut().expect("contact").rule = rule;
    let largest = |n: u32| {
        let found = crate::shipped::errors(&setup, &setup.model, &on_mesh(&setup, n), 4);
        found.iter().fold(0.0f64, |worst, e| if e.v.is_nan() { e.v } else { worst.max(e.v) })
    };
    MESHES.map(largest).to_vec()
}

#[test]
fn the_three_rules_have_the_same_order() {
    for name in ["compliance", "pure-strong"] {
        let table = RULES.map(|rule| v_errors(name, rule));
        for (rule, errors) in RULES.iter().zip(&table) {
            println!("{name} {rule:?} {errors:.6?}");
            let order = (errors[1] / errors[2]).log2();
            // The steep front of pure-strong is pre-asymptotic on these meshes: 0.83 to 1.
            let allowed = if name == "compliance" { 0.95..1.05 } else { 0.75..1.1 };
            assert!(allowed.contains(&order), "{name} {rule:?}: {order}");
        }
        for (n, &exact) in table[2].iter().enumerate() {
            for other in &table[..2] {
                let apart = (other[n] - exact).abs() / exact;
                assert!(apart < 1e-2, "{name}, mesh {n}: {apart:e}");
                assert!(apart > 1e-12, "{name}, mesh {n}: the rules are one");
            }
        }
    }
}

/// Vertex or integral contact: the answer of docs/GALLERY.md.
#[test]
fn the_rules_differ_as_the_gallery_says() {
    let largest = |name: &str, rule: BoundaryRule, of: fn(&StepErrors) -> f64| {
        let mut setup = setup(name);
        setup.model.boundary.first_mut().expect("contact").rule = rule;
        let found = crate::shipped::errors(&setup, &setup.model, &on_mesh(&setup, 32), 64);
        found.iter().map(of).fold(0.0f64, |worst, e| if e.is_nan() { e } else { worst.max(e) })
    };
    let ratio = |name: &str, of: fn(&StepErrors) -> f64| {
        let [vertex, gauss, _] = RULES.map(|rule| largest(name, rule, of));
        gauss / vertex
    };
    let text = repository("docs/GALLERY.md");
    for name in ["compliance", "law-linear"] {
        let (strain, trace) = (ratio(name, |e| e.v), ratio(name, |e| e.trace));
        println!("{name} {strain} {trace}");
        assert!((strain - 1.0).abs() < 1e-3, "{name}: {strain}");
        let said = format!("{trace:.2} times on `{name}`");
        assert!(text.replace('\n', " ").contains(&said), "docs/GALLERY.md does not say {said}");
    }
}
