//! Bound programs against plain evaluation, and their repeatability.

use super::plain::by_definition;
use super::{EvaluationPoint, Graph, Node, Scope, assert_close, everything, node};
use crate::{BoundProgram, Program};

const FORMULAS: [&str; 12] = [
    "3",
    "x",
    "t",
    "zeta*x",
    "sin(x)*cos(y)*exp(-t)+z^3",
    "max(x-t, y)*if(x+y<1, z, t^2)*tanh(x)",
    "x^y + y^-3 + 2/(1+x) - (1-z)/7 + min(x, 0.3)",
    "relax(1, max(t-x*y, 0)^2*sin(z*t)) + relax(2, abs(sin(5*t)-x))",
    "relax(1, relax(1, if(t<x, t, y))*t)",
    "relax(0.5, sin(zeta*t+x))",
    "d(relax(0.5, sin(y*t)*exp(x*t)), y)",
    "asin(x/2)+acos(y/2)+atan(z)+sinh(x)+cosh(t)+tan(y)+log(1+x)+abs(x-y)+sign(y-0.4)",
];

fn setup() -> (Graph, Vec<Node>, Vec<[f64; 3]>) {
    let mut graph = Graph::new();
    let scope: Scope = everything();
    let mut outputs: Vec<Node> = FORMULAS.map(|f| node(&mut graph, &scope, f)).to_vec();
    let kernel = node(&mut graph, &scope, "1/(1+t)^2");
    let f = node(&mut graph, &scope, "max(sin(3*t)-x, 0)");
    outputs.push(graph.convolve(kernel, f));
    // Two distinct z, seven x, nineteen y: more than one block.
    let points = (0..266).map(|k| {
        let (i, j, l) = (k % 7, k / 7 % 19, k / 133);
        [0.05 + f64::from(i) * 0.13, 0.07 + f64::from(j) * 0.05, 0.2 + f64::from(l) * 0.4]
    });
    (graph, outputs, points.collect())
}

fn run(bound: &mut BoundProgram, count: usize, t: f64, zeta: f64) -> Vec<Vec<f64>> {
    let mut out = vec![Vec::new(); count];
    bound.evaluate(t, zeta, &mut out);
    out
}

fn bits(values: &[Vec<f64>]) -> Vec<Vec<u64>> {
    let row = |v: &Vec<f64>| v.iter().map(|v| v.to_bits()).collect();
    values.iter().map(row).collect()
}

#[test]
fn tapes_agree_with_plain_evaluation() {
    let (graph, outputs, points) = setup();
    let mut bound = Program::compile(&graph, &outputs, 1.0).bind(&points);
    for (t, zeta) in [(0.83, 0.3), (0.0, 0.3), (0.4, -1.0), (1.3, 0.3)] {
        let out = run(&mut bound, outputs.len(), t, zeta);
        for p in (0..points.len()).step_by(61) {
            let [x, y, z] = points[p];
            for (k, f) in outputs.iter().enumerate() {
                let plain = by_definition(&graph, *f, &EvaluationPoint { x, y, z, t, zeta });
                let tolerance = 1e-13 * (1.0 + plain.abs());
                assert_close(out[k][p], plain, tolerance, &format!("output {k} at {t}"));
            }
        }
    }
}

#[test]
fn values_do_not_depend_on_what_was_evaluated_before() {
    let (graph, outputs, points) = setup();
    let program = Program::compile(&graph, &outputs, 1.0);
    let times = [(0.9, 0.1), (0.1, 0.1), (0.5, 0.7), (0.484375, 0.1), (2.2, 0.7), (0.1, 0.7)];
    let mut bound = program.bind(&points);
    let first: Vec<_> =
        times.map(|(t, zeta)| bits(&run(&mut bound, outputs.len(), t, zeta))).to_vec();
    let mut again = program.bind(&points);
    for k in [3, 0, 5, 2, 4, 1, 0, 3] {
        let (t, zeta) = times[k];
        assert_eq!(first[k], bits(&run(&mut again, outputs.len(), t, zeta)), "t = {t}");
    }
    // Nor on the other points.
    for p in [0, 100, 265] {
        let mut alone = program.bind(&points[p..=p]);
        let values = bits(&run(&mut alone, outputs.len(), 0.9, 0.1));
        for (all, one) in first[0].iter().zip(&values) {
            assert_eq!(all[p], one[0], "point {p}");
        }
    }
}

#[test]
fn extreme_times_and_empty_sets() {
    let (mut graph, outputs, points) = setup();
    let program = Program::compile(&graph, &outputs, 1.0);
    assert!(run(&mut program.bind(&[]), outputs.len(), 0.5, 0.0).iter().all(Vec::is_empty));
    let start = run(&mut program.bind(&points), outputs.len(), 0.0, 0.2);
    for k in [7, 8, 9, 12] {
        assert!(start[k].iter().all(|v| *v == 0.0), "output {k} at the start");
    }
    let out = run(&mut program.bind(&points[..3]), outputs.len(), f64::NAN, 0.2);
    assert!(out[7].iter().all(|v| v.is_nan()));
    // Far beyond the horizon: relax(1, sin(t)) tends to (sin - cos)/2.
    let f = node(&mut graph, &everything(), "relax(1, sin(t))");
    let mut bound = Program::compile(&graph, &[f], 0.5).bind(&points[..1]);
    for t in [40.0f64, 100.0] {
        let value = run(&mut bound, 1, t, 0.0)[0][0];
        assert_close(value, 0.5 * (t.sin() - t.cos()), 1e-13, "late");
    }
}

#[test]
fn programs_can_be_shared() {
    fn shared<T: Send + Sync>() {}
    fn sent<T: Send>() {}
    shared::<Program>();
    sent::<BoundProgram>();
}
