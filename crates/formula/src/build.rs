//! Construction of expressions, with local simplification.
//!
//! Constants are folded, and x+0, 1*x, 0*x, x-x, x/x and nested powers simplified. Constants of a product are merged
//! unless the result leaves the range of doubles: 1e-300*(x/1e150) is not 0. 0*x = 0 drops the NaN of a singular x, and
//! x/x = 1 the one at x = 0: accepted, since exact solutions have neither.

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;
use super::vocabulary::power;

impl Graph {
    /// Both zeros are one node.
    pub fn constant(&mut self, v: f64) -> Node {
        let v = if v.is_nan() { f64::NAN } else { v + 0.0 };
        self.intern(Op::Constant(v.to_bits()))
    }

    /// The variable `v`.
    pub fn variable(&mut self, v: Variable) -> Node {
        self.intern(Op::Variable(v))
    }

    /// -a.
    pub fn neg(&mut self, a: Node) -> Node {
        match self.op(a) {
            Op::Constant(bits) => self.constant(-f64::from_bits(bits)),
            Op::Neg(b) => b,
            Op::Sub(b, c) => self.sub(c, b),
            Op::Mul(b, c) if self.value_of_constant(b).is_some() => {
                let b = self.neg(b);
                self.mul(b, c)
            }
            _ => self.intern(Op::Neg(a)),
        }
    }

    /// a + b.
    pub fn add(&mut self, a: Node, b: Node) -> Node {
        match (self.value_of_constant(a), self.value_of_constant(b)) {
            (Some(u), Some(v)) => return self.constant(u + v),
            (Some(0.0), _) => return b,
            (_, Some(0.0)) => return a,
            _ => {}
        }
        if a == b {
            let two = self.constant(2.0);
            return self.mul(two, a);
        }
        match (self.op(a), self.op(b)) {
            (_, Op::Neg(c)) => self.sub(a, c),
            (Op::Neg(c), _) => self.sub(b, c),
            _ => {
                let (a, b) = self.ordered(a, b);
                self.intern(Op::Add(a, b))
            }
        }
    }

    /// Σ w a of numbers w.
    pub fn weighted_sum(&mut self, terms: impl IntoIterator<Item = (f64, Node)>) -> Node {
        let zero = self.constant(0.0);
        terms.into_iter().fold(zero, |sum, (weight, a)| {
            let weight = self.constant(weight);
            let term = self.mul(weight, a);
            self.add(sum, term)
        })
    }

    /// a - b.
    pub fn sub(&mut self, a: Node, b: Node) -> Node {
        if a == b {
            return self.constant(0.0);
        }
        if self.value_of_constant(b).is_some() {
            let b = self.neg(b);
            return self.add(a, b);
        }
        if self.value_of_constant(a) == Some(0.0) {
            return self.neg(b);
        }
        if let Op::Neg(c) = self.op(b) {
            return self.add(a, c);
        }
        if let Some(product) = self.factored(a, b) {
            return product;
        }
        self.intern(Op::Sub(a, b))
    }

    /// a - c a as (1 - c) a, and c b - b as (c - 1) b.
    fn factored(&mut self, a: Node, b: Node) -> Option<Node> {
        let one = self.collects.then(|| self.constant(1.0))?;
        let (factor, common) = match (self.op(a), self.op(b)) {
            (_, Op::Mul(c, d)) if d == a => (self.sub(one, c), a),
            (_, Op::Mul(c, d)) if c == a => (self.sub(one, d), a),
            (Op::Mul(c, d), _) if d == b => (self.sub(c, one), b),
            (Op::Mul(c, d), _) if c == b => (self.sub(d, one), b),
            _ => return None,
        };
        Some(self.mul(factor, common))
    }

    /// a * b.
    pub fn mul(&mut self, a: Node, b: Node) -> Node {
        let (a, b) = self.ordered(a, b);
        match (self.value_of_constant(a), self.value_of_constant(b)) {
            (Some(u), Some(v)) => return self.constant(u * v),
            (Some(0.0), _) => return a,
            (Some(1.0), _) => return b,
            (Some(-1.0), _) => return self.neg(b),
            _ => {}
        }
        match (self.op(a), self.op(b)) {
            (Op::Constant(_), Op::Neg(c)) => {
                let a = self.neg(a);
                self.mul(a, c)
            }
            (Op::Constant(u), Op::Mul(c, d))
                if self
                    .value_of_constant(c)
                    .is_some_and(|v| (f64::from_bits(u) * v).is_normal()) =>
            {
                let v = self.value_of_constant(c).unwrap_or(1.0);
                let product = self.constant(f64::from_bits(u) * v);
                self.mul(product, d)
            }
            (Op::Neg(c), _) => {
                let product = self.mul(c, b);
                self.neg(product)
            }
            (_, Op::Neg(c)) => {
                let product = self.mul(a, c);
                self.neg(product)
            }
            _ if a == b => self.powi(a, 2),
            (Op::Power(c, n), _) if c == b && (1..i32::MAX).contains(&n) => self.powi(b, n + 1),
            (_, Op::Power(c, n)) if c == a && (1..i32::MAX).contains(&n) => self.powi(a, n + 1),
            _ => self.intern(Op::Mul(a, b)),
        }
    }

    /// a / b.
    pub fn div(&mut self, a: Node, b: Node) -> Node {
        match (self.value_of_constant(a), self.value_of_constant(b)) {
            (Some(u), Some(v)) => return self.constant(u / v),
            (Some(0.0), _) => return a,
            (_, Some(1.0)) => return a,
            (_, Some(v)) => {
                if let Op::Mul(c, d) = self.op(a)
                    && let Some(u) = self.value_of_constant(c)
                    && (u / v).is_normal()
                {
                    let quotient = self.constant(u / v);
                    return self.mul(quotient, d);
                }
            }
            _ => {}
        }
        if a == b {
            return self.constant(1.0);
        }
        match (self.op(a), self.op(b)) {
            (Op::Neg(c), _) => {
                let quotient = self.div(c, b);
                self.neg(quotient)
            }
            (_, Op::Neg(c)) => {
                let quotient = self.div(a, c);
                self.neg(quotient)
            }
            _ => self.intern(Op::Div(a, b)),
        }
    }

    /// a^n by repeated multiplication, also for negative a.
    pub fn powi(&mut self, a: Node, n: i32) -> Node {
        match (n, self.op(a)) {
            (0, _) => self.constant(1.0),
            (1, _) => a,
            (_, Op::Constant(bits)) => self.constant(power(f64::from_bits(bits), n)),
            (_, Op::Neg(b)) => {
                let even = self.powi(b, n);
                if n % 2 == 0 { even } else { self.neg(even) }
            }
            (_, Op::Power(b, m)) if m.checked_mul(n).is_some() => self.powi(b, m * n),
            _ => self.intern(Op::Power(a, n)),
        }
    }

    /// a^b; an integer power if b is a whole number.
    pub fn pow(&mut self, a: Node, b: Node) -> Node {
        match (self.value_of_constant(a), self.value_of_constant(b)) {
            (_, Some(n)) if n.fract() == 0.0 && n.abs() <= f64::from(i32::MAX) => {
                self.powi(a, n as i32)
            }
            (Some(u), Some(v)) => self.constant(u.powf(v)),
            (_, Some(0.5)) => self.apply(Function::Sqrt, a),
            (Some(1.0), _) => a,
            _ => self.intern(Op::Pow(a, b)),
        }
    }

    /// The larger of a and b.
    pub fn max(&mut self, a: Node, b: Node) -> Node {
        self.extremum(a, b, f64::max, Op::Max)
    }

    /// The smaller of a and b.
    pub fn min(&mut self, a: Node, b: Node) -> Node {
        self.extremum(a, b, f64::min, Op::Min)
    }

    fn extremum(
        &mut self,
        a: Node,
        b: Node,
        fold: fn(f64, f64) -> f64,
        op: fn(Node, Node) -> Op,
    ) -> Node {
        if a == b {
            return a;
        }
        if let (Some(u), Some(v)) = (self.value_of_constant(a), self.value_of_constant(b)) {
            return self.constant(fold(u, v));
        }
        let (a, b) = self.ordered(a, b);
        let decider = self.sub(a, b);
        let node = self.intern(op(a, b));
        self.deciders.insert(node, decider);
        node
    }

    /// `then` where a < b, else `otherwise`.
    pub fn select_less(&mut self, a: Node, b: Node, then: Node, otherwise: Node) -> Node {
        if then == otherwise {
            return then;
        }
        if a == b {
            return otherwise;
        }
        if let (Some(u), Some(v)) = (self.value_of_constant(a), self.value_of_constant(b)) {
            return if u < v { then } else { otherwise };
        }
        let decider = self.sub(a, b);
        let node = self.intern(Op::Less([a, b, then, otherwise]));
        self.deciders.insert(node, decider);
        node
    }

    /// A function of a.
    pub fn apply(&mut self, function: Function, a: Node) -> Node {
        match (function, self.op(a)) {
            (_, Op::Constant(bits)) => self.constant(function.value(f64::from_bits(bits))),
            (Function::Abs, Op::Neg(b)) => self.apply(function, b),
            _ => {
                let node = self.intern(Op::Apply(function, a));
                if matches!(function, Function::Abs | Function::Sign) {
                    self.deciders.insert(node, a);
                }
                node
            }
        }
    }

    /// Canonical order of commutative operands: numbers first.
    fn ordered(&self, a: Node, b: Node) -> (Node, Node) {
        let key = |n: Node| (self.value_of_constant(n).is_none(), n.0);
        if key(b) < key(a) { (b, a) } else { (a, b) }
    }
}
