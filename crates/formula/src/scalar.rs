//! Evaluation of one expression at one point, operation by operation. Only hereditary integrals ask for a program; tests
//! compare the two with plain integrals.

use super::graph::{Graph, Node, Op, Variable};
use super::program::Program;
use super::vocabulary::power;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EvaluationPoint {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub t: f64,
    pub zeta: f64,
}

impl From<[f64; 3]> for EvaluationPoint {
    /// A place; t = ζ = 0.
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z, t: 0.0, zeta: 0.0 }
    }
}

impl EvaluationPoint {
    fn value(&self, v: Variable) -> f64 {
        match v {
            Variable::X => self.x,
            Variable::Y => self.y,
            Variable::Z => self.z,
            Variable::T => self.t,
            Variable::Zeta => self.zeta,
        }
    }
}

/// The values of an expression and its parts, with hereditary integrals by `integral`.
pub(super) struct Scratch<'a, F> {
    graph: &'a Graph,
    integral: F,
    order: Vec<Node>,
    values: rustc_hash::FxHashMap<Node, f64>,
}

impl Graph {
    /// The value of `f` at a point; with hereditary integrals accurate to about 1e-13 of the terms. Slow: for single
    /// values and checks.
    pub fn evaluate(&self, f: Node, at: &EvaluationPoint) -> f64 {
        let integral = |node: Node, at: &EvaluationPoint| {
            let program = Program::compile(self, &[node], at.t);
            program.values(&[[at.x, at.y, at.z]], at.t, at.zeta)[0][0]
        };
        Scratch::new(self, f, integral).value(f, at)
    }
}

impl<'a, F: Fn(Node, &EvaluationPoint) -> f64> Scratch<'a, F> {
    pub(super) fn new(graph: &'a Graph, f: Node, integral: F) -> Self {
        let order =
            graph.reachable(&[f], |n| !matches!(graph.op(n), Op::Relax(..) | Op::Convolve(..)));
        let values = order.iter().map(|&n| (n, f64::NAN)).collect();
        Self { graph, integral, order, values }
    }

    pub(super) fn value(&mut self, f: Node, at: &EvaluationPoint) -> f64 {
        for k in 0..self.order.len() {
            let node = self.order[k];
            let value = self.one_value(node, at);
            self.values.insert(node, value);
        }
        self.of(f)
    }

    fn of(&self, n: Node) -> f64 {
        self.values.get(&n).copied().unwrap_or(f64::NAN)
    }

    fn one_value(&self, node: Node, at: &EvaluationPoint) -> f64 {
        match self.graph.op(node) {
            Op::Constant(bits) => f64::from_bits(bits),
            Op::Variable(v) => at.value(v),
            Op::Neg(a) => -self.of(a),
            Op::Add(a, b) => self.of(a) + self.of(b),
            Op::Sub(a, b) => self.of(a) - self.of(b),
            Op::Mul(a, b) => self.of(a) * self.of(b),
            Op::Div(a, b) => self.of(a) / self.of(b),
            Op::Power(a, n) => power(self.of(a), n),
            Op::Pow(a, b) => self.of(a).powf(self.of(b)),
            Op::Apply(function, a) => function.value(self.of(a)),
            Op::Max(a, b) => self.of(a).max(self.of(b)),
            Op::Min(a, b) => self.of(a).min(self.of(b)),
            Op::Less([a, b, p, q]) => {
                if self.of(a) < self.of(b) {
                    self.of(p)
                } else {
                    self.of(q)
                }
            }
            Op::Relax(..) | Op::Convolve(..) => (self.integral)(node, at),
        }
    }
}
