//! Replacement of a variable by an expression.

use std::collections::HashMap;

use super::graph::{Graph, Node, Op, Variable};

impl Graph {
    /// `f` with `v` replaced by `by`.
    ///
    /// A hereditary integral keeps its time of integration, so not everything that depends on t can be expressed: t = 0
    /// gives zero, and a replacement of another variable must not depend on t. The rest becomes NaN.
    pub fn substitute(&mut self, f: Node, v: Variable, by: Node) -> Node {
        if self.op(by) == Op::Variable(v) {
            return f;
        }
        let order = self.reachable(&[f], |n| {
            // A new present leaves the past of an integral unchanged.
            self.depends_on(n, v) && !(v == Variable::T && self.op(n).is_integral())
        });
        let mut new: HashMap<Node, Node> = HashMap::with_capacity(order.len());
        for node in order {
            let image =
                if self.depends_on(node, v) { self.rebuilt(node, v, by, &new) } else { node };
            new.insert(node, image);
        }
        new.get(&f).copied().unwrap_or(f)
    }

    /// `f` at the time t without its past: hereditary integrals in it become zero.
    pub fn instant(&mut self, f: Node, t: f64) -> Node {
        let is_past = |op: Op| op.is_integral();
        let order = self.reachable(&[f], |n| !is_past(self.op(n)));
        let mut new: HashMap<Node, Node> = HashMap::with_capacity(order.len());
        for node in order {
            let image = match self.op(node) {
                Op::Variable(Variable::T) => self.constant(t),
                op if is_past(op) => self.constant(0.0),
                op => self.with_operands(op, |n| new.get(&n).copied().unwrap_or(n)),
            };
            new.insert(node, image);
        }
        new.get(&f).copied().unwrap_or(f)
    }

    fn rebuilt(&mut self, f: Node, v: Variable, by: Node, new: &HashMap<Node, Node>) -> Node {
        let to = |n: Node| new.get(&n).copied().unwrap_or(n);
        match self.op(f) {
            Op::Variable(_) => by,
            Op::Relax(..) | Op::Convolve(..) if v == Variable::T => {
                let at_start = self.value_of_constant(by) == Some(0.0);
                self.constant(if at_start { 0.0 } else { f64::NAN })
            }
            Op::Relax(..) | Op::Convolve(..) if self.depends_on(by, Variable::T) => {
                self.constant(f64::NAN)
            }
            op => self.with_operands(op, to),
        }
    }

    /// `op` on other operands, simplified again.
    pub(super) fn with_operands(&mut self, op: Op, to: impl Fn(Node) -> Node) -> Node {
        match op {
            Op::Constant(_) | Op::Variable(_) => self.intern(op),
            Op::Neg(a) => self.neg(to(a)),
            Op::Add(a, b) => self.add(to(a), to(b)),
            Op::Sub(a, b) => self.sub(to(a), to(b)),
            Op::Mul(a, b) => self.mul(to(a), to(b)),
            Op::Div(a, b) => self.div(to(a), to(b)),
            Op::Power(a, n) => self.powi(to(a), n),
            Op::Pow(a, b) => self.pow(to(a), to(b)),
            Op::Apply(function, a) => self.apply(function, to(a)),
            Op::Max(a, b) => self.max(to(a), to(b)),
            Op::Min(a, b) => self.min(to(a), to(b)),
            Op::Less([a, b, p, q]) => self.select_less(to(a), to(b), to(p), to(q)),
            Op::Relax(c, a) => self.relax(f64::from_bits(c), to(a)),
            Op::Convolve(kernel, a) => self.convolve(kernel, to(a)),
        }
    }
}
