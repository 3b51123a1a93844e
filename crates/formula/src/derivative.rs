//! Exact derivatives.

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

impl Graph {
    /// The derivative of `f` with respect to `v`.
    ///
    /// max, min and `if` differentiate the branch taken, |a|' = sign(a) a' and sign' = 0: valid off the kinks. For
    /// hereditary integrals d/dx goes inside, and d/dt relax(c,f) = f - c relax(c,f), d/dt (b * f) = b(0) f + b' * f.
    pub fn derivative(&mut self, f: Node, v: Variable) -> Node {
        // Nodes without v have derivative zero; those below a finished node are not needed.
        let order = self
            .reachable(&[f], |n| self.depends_on(n, v) && !self.derivatives.contains_key(&(n, v)));
        for node in order {
            if !self.derivatives.contains_key(&(node, v)) {
                let slope = self.one_derivative(node, v);
                self.derivatives.insert((node, v), slope);
            }
        }
        self.slope(f, v)
    }

    fn slope(&mut self, f: Node, v: Variable) -> Node {
        match self.derivatives.get(&(f, v)) {
            Some(&slope) => slope,
            None => self.constant(0.0),
        }
    }

    fn one_derivative(&mut self, f: Node, v: Variable) -> Node {
        if !self.depends_on(f, v) {
            return self.constant(0.0);
        }
        match self.op(f) {
            Op::Constant(_) => self.constant(0.0),
            Op::Variable(_) => self.constant(1.0),
            Op::Neg(a) => {
                let da = self.slope(a, v);
                self.neg(da)
            }
            Op::Add(a, b) => {
                let (da, db) = (self.slope(a, v), self.slope(b, v));
                self.add(da, db)
            }
            Op::Sub(a, b) => {
                let (da, db) = (self.slope(a, v), self.slope(b, v));
                self.sub(da, db)
            }
            Op::Mul(a, b) => {
                let (da, db) = (self.slope(a, v), self.slope(b, v));
                let (left, right) = (self.mul(da, b), self.mul(a, db));
                self.add(left, right)
            }
            Op::Div(a, b) => self.quotient_derivative(f, a, b, v),
            Op::Power(a, n) => self.power_derivative(f, a, n, v),
            Op::Pow(a, b) => self.pow_derivative(f, a, b, v),
            Op::Apply(function, a) => {
                let da = self.slope(a, v);
                let outer = self.outer_derivative(function, a, f);
                self.mul(outer, da)
            }
            Op::Max(a, b) => {
                let (da, db) = (self.slope(a, v), self.slope(b, v));
                self.select_less(a, b, db, da)
            }
            Op::Min(a, b) => {
                let (da, db) = (self.slope(a, v), self.slope(b, v));
                self.select_less(a, b, da, db)
            }
            Op::Less([a, b, p, q]) => {
                let (dp, dq) = (self.slope(p, v), self.slope(q, v));
                self.select_less(a, b, dp, dq)
            }
            Op::Relax(c, a) if v == Variable::T => {
                let rate = self.constant(f64::from_bits(c));
                let decay = self.mul(rate, f);
                self.sub(a, decay)
            }
            Op::Relax(c, a) => {
                let da = self.slope(a, v);
                self.relax(f64::from_bits(c), da)
            }
            Op::Convolve(kernel, a) => self.convolution_derivative(kernel, a, v),
        }
    }

    /// (∫₀ᵗ b(t − s) a(s) ds)' = b(0) a + ∫₀ᵗ b'(t − s) a(s) ds in time; b is independent of space.
    fn convolution_derivative(&mut self, kernel: Node, a: Node, v: Variable) -> Node {
        if v != Variable::T {
            let da = self.slope(a, v);
            return self.convolve(kernel, da);
        }
        let zero = self.constant(0.0);
        let initial = self.substitute(kernel, Variable::T, zero);
        let change = self.slope(kernel, v);
        let now = self.mul(initial, a);
        let past = self.convolve(change, a);
        self.add(now, past)
    }

    fn quotient_derivative(&mut self, f: Node, a: Node, b: Node, v: Variable) -> Node {
        let (da, db) = (self.slope(a, v), self.slope(b, v));
        let carried = self.mul(f, db);
        let numerator = self.sub(da, carried);
        self.div(numerator, b)
    }

    fn power_derivative(&mut self, f: Node, a: Node, n: i32, v: Variable) -> Node {
        let da = self.slope(a, v);
        let factor = self.constant(f64::from(n));
        let lower = match n.checked_sub(1) {
            Some(m) => self.powi(a, m),
            None => self.div(f, a),
        };
        let outer = self.mul(factor, lower);
        self.mul(outer, da)
    }

    /// (a^b)' = b a^(b-1) a' + a^b log(a) b', each part only if needed.
    fn pow_derivative(&mut self, f: Node, a: Node, b: Node, v: Variable) -> Node {
        let (da, db) = (self.slope(a, v), self.slope(b, v));
        let minus_one = self.constant(-1.0);
        let exponent = self.add(b, minus_one);
        let lower = self.pow(a, exponent);
        let outer = self.mul(b, lower);
        let base = self.mul(outer, da);
        if self.value_of_constant(db) == Some(0.0) {
            return base;
        }
        let logarithm = self.apply(Function::Log, a);
        let growth = self.mul(f, logarithm);
        let growth = self.mul(growth, db);
        self.add(base, growth)
    }

    fn outer_derivative(&mut self, function: Function, a: Node, f: Node) -> Node {
        let one = self.constant(1.0);
        match function {
            Function::Sin => self.apply(Function::Cos, a),
            Function::Cos => {
                let s = self.apply(Function::Sin, a);
                self.neg(s)
            }
            Function::Tan => {
                let square = self.powi(f, 2);
                self.add(one, square)
            }
            Function::Asin | Function::Acos => {
                let square = self.powi(a, 2);
                let rest = self.sub(one, square);
                let root = self.apply(Function::Sqrt, rest);
                let slope = self.div(one, root);
                if function == Function::Asin { slope } else { self.neg(slope) }
            }
            Function::Atan => {
                let square = self.powi(a, 2);
                let sum = self.add(one, square);
                self.div(one, sum)
            }
            Function::Sinh => self.apply(Function::Cosh, a),
            Function::Cosh => self.apply(Function::Sinh, a),
            Function::Tanh => {
                let square = self.powi(f, 2);
                self.sub(one, square)
            }
            Function::Exp => f,
            Function::ExpMinusOne => self.apply(Function::Exp, a),
            Function::Log => self.div(one, a),
            Function::Sqrt => {
                let half = self.constant(0.5);
                self.div(half, f)
            }
            Function::Abs => self.apply(Function::Sign, a),
            Function::Sign => self.constant(0.0),
        }
    }
}
