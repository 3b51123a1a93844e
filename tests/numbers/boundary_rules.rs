//! Source: (5.26) for the rules of the compliance integral; each has its scenes in the main job.
//! Goal: what Gauss points in the place of vertices do to an error is what docs/GALLERY.md says.
//! Mesh: n = 32, N = 64. Data: compliance, law-linear.

use crate::program::repository;
use crate::shipped::{on_mesh, setup};
use fem::contact::BoundaryRule;
use fem::norms::StepErrors;

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
        let [vertex, gauss] =
            [BoundaryRule::Vertex, BoundaryRule::Gauss].map(|rule| largest(name, rule, of));
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
