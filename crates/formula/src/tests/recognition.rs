//! Sums of exponentials, separation and guards.

use super::plain::by_definition;
use super::{EvaluationPoint, Graph, Node, Variable, assert_close, everything, node};

#[test]
fn sums_of_exponentials() {
    let e = std::f64::consts::E;
    let cases: [(&str, &[(f64, f64)]); 9] = [
        ("3", &[(3.0, 0.0)]),
        ("0", &[]),
        ("exp(-t/4)", &[(1.0, 0.25)]),
        ("-exp(-t)", &[(-1.0, 1.0)]),
        ("2*exp(1-3*t)", &[(2.0 * e, 3.0)]),
        ("1 + exp(-t)/2 - 3*exp(-2*t)", &[(1.0, 0.0), (0.5, 1.0), (-3.0, 2.0)]),
        ("(1-exp(-t))^2", &[(1.0, 0.0), (-2.0, 1.0), (1.0, 2.0)]),
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
    for text in ["t", "exp(-t^2)", "sin(t)", "x", "exp(-x*t)", "1/(1+t)", "relax(1, sin(t))"] {
        let mut graph = Graph::new();
        let f = node(&mut graph, &everything(), text);
        assert_eq!(graph.exponential_sum(f), None, "{text}");
    }
}

#[test]
fn separation() {
    let cases = [
        ("x*y", 1),
        ("sin(t)", 1),
        ("0", 0),
        ("t*(x+t)*(1-y)", 2),
        ("(t+x)^2", 3),
        ("exp(x-2*t)*y/(1+t)", 1),
        ("-sin(t)*x/3 + 2*x*cos(t)", 1),
        ("if(x<0.5, t, t^2*y)", 2),
        ("relax(1, x*t^2) + (x*t)^3", 2),
        ("relax(1, (1+x*sin(t))^2)", 3),
    ];
    for (text, most) in cases {
        let mut graph = Graph::new();
        let f = node(&mut graph, &everything(), text);
        let sum = graph.separate(f).unwrap_or_else(|| panic!("{text} separates"));
        assert!(sum.len() <= most, "{text}: {} terms", sum.len());
        let at = EvaluationPoint { x: 0.3, y: 0.8, z: 0.1, t: 0.7, zeta: 0.0 };
        let mut total = 0.0;
        for (a, g) in sum {
            assert!(!graph.depends_on(g, Variable::T), "{text}");
            assert!(!graph.depends_on(a, Variable::X) && !graph.depends_on(a, Variable::Y));
            total += by_definition(&graph, a, &at) * by_definition(&graph, g, &at);
        }
        assert_close(total, by_definition(&graph, f, &at), 1e-13, text);
    }
    for text in ["sin(x*t)", "1/(x+t)", "max(x, t)", "if(x<t, 1, 2)", "relax(1, sin(x*t))"] {
        let mut graph = Graph::new();
        let f = node(&mut graph, &everything(), text);
        assert!(graph.separate(f).is_none(), "{text}");
    }
}

/// 2t sin x, -3t y + x cos t and t/7 have two factors in time.
#[test]
fn several_formulas_share_their_factors_in_time() {
    let mut graph = Graph::new();
    let texts = ["2*t*sin(x)", "x*cos(t) - 3*t*y", "t/7", "4", "0"];
    let formulas = texts.map(|text| node(&mut graph, &everything(), text));
    let together = graph.separate_together(&formulas).expect("sums of products");
    assert_eq!(together.factors.len(), 3, "t, cos t and 1");
    let at = EvaluationPoint { x: 0.3, y: 0.8, z: 0.1, t: 0.7, zeta: 0.0 };
    for ((text, f), shapes) in texts.iter().zip(formulas).zip(&together.shapes) {
        let terms = shapes.iter().map(|&(m, shape)| {
            assert!(!graph.depends_on(shape, Variable::T), "{text}");
            by_definition(&graph, together.factors[m], &at) * by_definition(&graph, shape, &at)
        });
        assert_close(terms.sum(), by_definition(&graph, f, &at), 1e-15, text);
    }
    let moving = node(&mut graph, &everything(), "sin(x*t)");
    assert!(graph.separate_together(&[formulas[0], moving]).is_none());
}

/// t, t + sin t and 2t - sin t need two factors; t + sin t and y need only the sum.
#[test]
fn sums_of_factors_of_others_are_none_of_their_own() {
    let at = EvaluationPoint { x: 0.3, y: 0.8, z: 0.1, t: 0.7, zeta: 0.0 };
    for (texts, factors) in [
        (["t*x", "(t + sin(t))*y", "(2*t - sin(t))/3*z"], 2),
        (["(t + 1)*x", "(t - 1)*y", "(sin(t) + 2)*z + t"], 3),
        (["(t + sin(t))*x", "(t + sin(t))*y", "z*(t + sin(t))"], 1),
    ] {
        let mut graph = Graph::new();
        let formulas = texts.map(|text| node(&mut graph, &everything(), text));
        let together = graph.separate_together(&formulas).expect("sums of products");
        assert_eq!(together.factors.len(), factors, "{texts:?}");
        for ((text, f), shapes) in texts.iter().zip(formulas).zip(&together.shapes) {
            let term = |&(m, shape): &(usize, Node)| {
                by_definition(&graph, together.factors[m], &at) * by_definition(&graph, shape, &at)
            };
            let sum: f64 = shapes.iter().map(term).sum();
            assert_close(sum, by_definition(&graph, f, &at), 1e-14, text);
            let alone = |(m, _): &(usize, Node)| shapes.iter().filter(|(n, _)| n == m).count() == 1;
            assert!(shapes.iter().all(alone), "{text}: a factor comes once");
        }
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
