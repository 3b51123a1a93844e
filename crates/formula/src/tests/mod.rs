//! Tests of formulas as a whole.

mod acid;
mod calculus;
mod extremes;
mod hereditary;
mod language;
mod plain;
mod recognition;
mod tapes;

use plain::by_definition;

use super::{EvaluationPoint, Graph, Node, Scope, Variable};

fn everything() -> Scope {
    use Variable::{T, X, Y, Z, Zeta};
    Scope::new(&[X, Y, Z, T, Zeta])
}

fn node(graph: &mut Graph, scope: &Scope, text: &str) -> Node {
    match graph.parse(text, scope) {
        Ok(node) => node,
        Err(error) => panic!("{text}: {error}"),
    }
}

fn value(text: &str, [x, y, z, t]: [f64; 4]) -> f64 {
    let mut graph = Graph::new();
    let f = node(&mut graph, &everything(), text);
    by_definition(&graph, f, &EvaluationPoint { x, y, z, t, zeta: 0.0 })
}

fn assert_close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance, "{what}: {a} and {b} differ by {:e}", a - b);
}
