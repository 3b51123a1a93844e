//! A displacement field with moving kinks in its third derivatives.

use super::plain::by_definition;
use super::{EvaluationPoint, Graph, Node, Variable, assert_close, everything, node};
use crate::Program;

const DEFINITIONS: [(&str, &str); 8] = [
    ("theta", "1.6+1.6*t-3.6*x"),
    (
        "W",
        "if(theta<0, 0.005*theta^3, if(theta<2, \
         0.04+0.525*((theta-1)^7/7-2*(theta-1)^5/5+(theta-1)^3/3), 0.08))",
    ),
    (
        "R",
        "if(W<=0, 0, if(W<=0.04, 2*W, if(W<=0.1, 0.08-0.5*(W-0.04), 0.05))) \
         + 0.15*max(theta-2,0)^3",
    ),
    ("Y", "-(1/3)*relax(0.75,R)"),
    ("e", "-R/3+Y/4"),
    ("alpha", "0.6*(t+0.3*sin(3*t))*(1+0.5*sin(pi*x))"),
    ("ux", "d(W,x)*y*(1-y)+alpha*y^2*(1-y)"),
    ("uy", "-W*(1-y^2)+e*y*(1-y)"),
];

/// u_x, u_y, the three strains, and relax(1, strain) of each.
fn field(graph: &mut Graph) -> [Node; 8] {
    let mut scope = everything();
    for (name, text) in DEFINITIONS {
        let f = node(graph, &scope, text);
        scope.define(name, f);
    }
    [
        "ux",
        "uy",
        "d(ux,x)",
        "d(uy,y)",
        "(d(ux,y)+d(uy,x))/2",
        "relax(1, d(ux,x))",
        "relax(1, d(uy,y))",
        "relax(1, (d(ux,y)+d(uy,x))/2)",
    ]
    .map(|text| node(graph, &scope, text))
}

/// Component (see [`field`]), x, y, value at t = 1.
const REFERENCE: [(usize, f64, f64, f64); 8] = [
    (0, 0.45, 0.15, -0.01783016095472),
    (1, 0.45, 0.15, -0.06400466525091),
    (2, 0.45, 0.15, -0.003204563981618),
    (3, 0.45, 0.15, 3.204849158794e-05),
    (4, 0.45, 0.15, 0.1449238734325),
    (0, 0.8, 0.15, -0.01672789178881),
    (2, 0.8, 0.15, 0.2303886859821),
    (4, 0.8, 0.15, 0.1400891913652),
];

#[test]
fn reference_values_by_both_evaluators() {
    let mut graph = Graph::new();
    let outputs = field(&mut graph);
    let program = Program::compile(&graph, &outputs, 1.0);
    let mut out = vec![Vec::new(); outputs.len()];
    for (component, x, y, expected) in REFERENCE {
        let at = EvaluationPoint { x, y, t: 1.0, ..EvaluationPoint::default() };
        let plain = by_definition(&graph, outputs[component], &at);
        assert_close(plain, expected, 2e-13, &format!("plain {component} at {x}"));
        program.bind(&[[x, y, 0.0]]).evaluate(1.0, 0.0, &mut out);
        assert_close(out[component][0], expected, 2e-13, &format!("{component} at {x}"));
        for (k, out) in out.iter().enumerate() {
            let plain = by_definition(&graph, outputs[k], &at);
            assert_close(out[0], plain, 1e-13, &format!("{k} at {x}"));
        }
    }
}

#[test]
fn no_integral_depends_on_y() {
    let mut graph = Graph::new();
    let outputs = field(&mut graph);
    let integrals: Vec<Node> = graph
        .reachable(&outputs, |_| true)
        .into_iter()
        .filter(|n| graph.op(*n).is_integral())
        .collect();
    assert!(integrals.len() >= 4);
    for n in integrals {
        assert!(!graph.depends_on(n, Variable::Y) && !graph.depends_on(n, Variable::Z));
    }
}
