//! Sums of exponentials, and guards.

use super::plain::by_definition;
use super::{EvaluationPoint, Graph, assert_close, everything, node};

#[test]
fn sums_of_exponentials() {
    let e = std::f64::consts::E;
    let cases: [(&str, &[(f64, f64)]); 10] = [
        ("3", &[(3.0, 0.0)]),
        ("0", &[]),
        ("exp(-t/4)", &[(1.0, 0.25)]),
        ("-exp(-t)", &[(-1.0, 1.0)]),
        ("2*exp(1-3*t)", &[(2.0 * e, 3.0)]),
        ("1 + exp(-t)/2 - 3*exp(-2*t)", &[(1.0, 0.0), (0.5, 1.0), (-3.0, 2.0)]),
        ("exp(-t)*(1 - 2*exp(-t))/4", &[(0.25, 1.0), (-0.5, 2.0)]),
        ("exp(-2*t) - exp(-(t + t))", &[]),
        ("exp(-t)*exp(t)", &[(1.0, 0.0)]),
        ("1/exp(2*t)", &[(1.0, 2.0)]),
    ];
    for (text, expected) in cases {
        let mut graph = Graph::new();
        let f = node(&mut graph, &everything(), text);
        let sum = graph.exponential_sum(f).unwrap_or_else(|| panic!("{text} is one"));
        assert_eq!(sum.len(), expected.len(), "{text}: {sum:?}");
        for ((a, c), (b, d)) in sum.iter().zip(expected) {
            assert_close(*a, *b, 1e-14, text);
            assert_close(*c, *d, 1e-14, text);
        }
    }
    for text in [
        "t",
        "t*exp(-t)",
        "exp(-t) + t",
        "exp(-t)/(1 + t)",
        "exp(exp(-t))",
        "exp(-t^2)",
        "sin(t)",
        "x",
        "exp(-x*t)",
        "1/(1+t)",
        "relax(1, sin(t))",
        // Sums that are written in another way.
        "(1-exp(-t))^2",
        "2^(-t)",
    ] {
        let mut graph = Graph::new();
        let f = node(&mut graph, &everything(), text);
        assert_eq!(graph.exponential_sum(f), None, "{text}");
    }
}

#[test]
fn guards_are_found() {
    let mut graph = Graph::new();
    let scope = everything();
    let text = "max(x, t) + abs(y) + if(x<=y, 1, 2)*relax(1, sign(t-x)*t) + max(2, 3)";
    let f = node(&mut graph, &scope, text);
    let found = graph.guards(&[f]);
    let at = EvaluationPoint { x: 0.25, y: 2.0, z: 0.0, t: 1.0, zeta: 0.0 };
    let mut sizes: Vec<f64> = found.iter().map(|g| by_definition(&graph, *g, &at).abs()).collect();
    sizes.sort_by(f64::total_cmp);
    assert_eq!(sizes, [0.75, 0.75, 1.75, 2.0]);
    let smooth = node(&mut graph, &scope, "sin(x)*relax(1, t*x)");
    assert!(graph.guards(&[smooth]).is_empty());
}
