//! Fields of known regularity: polynomials in t and x, powers of t, kinks.

use super::*;
use crate::{ContactFormulas, ExactData, MaterialNumbers, Status};
use formula::{Graph, Scope, Variable};

/// u on a rectangle or a box, contact below. T is not a power of two: t_n rounds.
fn of(u: &[&str], size: Vec<f64>) -> Exact {
    let mut graph = Graph::new();
    let scope = Scope::new(&[Variable::X, Variable::Y, Variable::Z, Variable::T]);
    let u = u.iter().map(|text| graph.parse(text, &scope).expect("a formula")).collect();
    let (full, memory, projection) = (None, Vec::new(), None);
    let material = MaterialNumbers { lambda: 1.0, mu_l: 1.0, full, memory, projection };
    Exact::new(ExactData {
        graph,
        u,
        material,
        regions: Vec::new(),
        inner: Vec::new(),
        kernels: Vec::new(),
        kappa: None,
        contact: vec![ContactFormulas { side: 2, ..ContactFormulas::default() }],
        horizon: 0.7,
        size,
        polytope: None,
    })
}

/// u = (0, a(t) p(x) (1 - y)) on (0,1)².
fn exact(amplitude: &str, profile: &str) -> Exact {
    of(&["0", &format!("({amplitude})*({profile})*(1 - y)")], vec![1.0, 1.0])
}

/// The side y = 0, in contact.
fn bottom(size: &[f64]) -> BodyFace {
    BodyFace { side: 2, face: Face::of_box(size, 2), clamped: false, contact: true }
}

/// Findings, by the first words of their subjects.
fn statuses(amplitude: &str, profile: &str) -> [Status; 3] {
    let findings = regularity(&exact(amplitude, profile), &[bottom(&[1.0, 1.0])]);
    ["u in W2,inf", "eps(u')", "u_nu in H2"].map(|subject| {
        let found = findings.iter().find(|finding| finding.subject.starts_with(subject));
        found.unwrap_or_else(|| panic!("no finding on {subject}")).status
    })
}

const YES: Status = Status::Verified;
const NO: Status = Status::Weak;

#[test]
fn fields_linear_in_time_are_bounded_in_any_unit() {
    for amplitude in ["0.3", "0.1*t", "0.3 - 0.1*t", "1e9*t", "1e-9*(1 + t)", "100 + t/3"] {
        assert_eq!(statuses(amplitude, "1 + x/3"), [YES; 3], "{amplitude}");
    }
}

#[test]
fn growth_is_seen_also_beside_a_large_linear_part() {
    // u'' of t^(3/2) is unbounded and integrable, of t^(1/2) neither.
    assert_eq!(statuses("t^1.5", "1"), [NO, YES, YES]);
    assert_eq!(statuses("1e6*t + t^1.5", "1"), [NO, YES, YES]);
    assert_eq!(statuses("t^0.5", "1"), [NO, NO, YES]);
    assert_eq!(statuses("1e3*t + t^0.5", "1"), [NO, NO, YES]);
    assert_eq!(statuses("max(t - 0.3, 0)", "1"), [NO, YES, YES]);
    assert_eq!(statuses("t^2", "1"), [YES; 3]);
    // A kink of u_ν along Γ3.
    assert_eq!(statuses("t^2", "abs(x - 0.4)"), [YES, YES, NO]);
}

/// The second differences of 0.1 t are rounding and grow: without the floor they would be judged unbounded.
#[test]
fn it_is_the_floor_that_tells_rounding_from_growth() {
    let found = &time_derivatives(&exact("0.1*t", "1"))[0];
    assert!(found.value > 0.0, "this field must show rounding");
    let growing = [found.value / 64.0, found.value / 16.0, found.value / 4.0, found.value];
    let floor = rounding(0.07, 1.0, (0.7f64 / 256.0).powi(2));
    assert_eq!(judge("", "", &growing, floor).status, YES);
    assert_eq!(judge("", "", &growing, 0.0).status, NO);
    assert!(found.value > floor / 1e3, "the floor is not orders above what it covers");
}

/// u = (0, t² p(x) q(z) (1 - y), 0) on a box: a kink is detected along either direction of Γ3, and in the gradient.
#[test]
fn both_directions_of_a_face_are_looked_at() {
    let found = |profile: &str| {
        let size = [1.0, 1.0, 0.5];
        let exact = of(&["0", &format!("t^2*({profile})*(1 - y)"), "0"], size.to_vec());
        let findings = regularity(&exact, &[bottom(&size)]);
        ["u in H2", "u_nu in H2"].map(|subject| {
            let found = findings.iter().find(|finding| finding.subject.starts_with(subject));
            found.expect("a finding").status
        })
    };
    assert_eq!(found("1 + x^2*z^2"), [YES; 2]);
    assert_eq!(found("abs(x - 0.4)"), [NO; 2]);
    assert_eq!(found("abs(z - 0.2)"), [NO; 2]);
}

#[test]
fn what_is_no_number_is_not_bounded() {
    for quotients in [[1.0, f64::NAN], [f64::NAN, 1.0], [1.0, f64::INFINITY], [0.0, 1.0]] {
        assert_eq!(judge("", "", &quotients, 1e-9).status, NO, "{quotients:?}");
    }
    assert_eq!(worst(1.0, f64::NAN), f64::INFINITY);
}
