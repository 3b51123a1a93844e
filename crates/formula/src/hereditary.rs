//! Relaxation and convolution in time.
//!
//! Both are linear: factors independent of t come out, sums are integrated term by term, and
//!
//!   relax(a, relax(b, f)) = (relax(b, f) - relax(a, f)) / (a - b).
//!
//! The remaining integrands depend on as few space variables as possible, and points with equal abscissae share their
//! values.

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

/// Rates closer than this (relative) are not split: the difference quotient would lose as many digits.
const DISTINCT_RATES: f64 = 1e-4;

#[derive(Clone, Copy)]
enum PastKernel {
    /// exp(-c (t-s))
    Exponential(f64),
    /// b(t-s)
    General(Node),
}

impl Graph {
    /// Integral over 0 < s < t of exp(-c (t-s)) f(x,y,z,s) ds.
    pub(crate) fn relax(&mut self, c: f64, f: Node) -> Node {
        self.integrate(PastKernel::Exponential(c + 0.0), f)
    }

    /// Integral over 0 < s < t of b(t-s) f(x,y,z,s) ds for a smooth kernel b of t alone; NaN for other kernels. A sum
    /// of exponentials becomes relaxations.
    pub fn convolve(&mut self, kernel: Node, f: Node) -> Node {
        if !self.dependence(kernel).at_most_time() || self.dependence(kernel).on_history() {
            return self.constant(f64::NAN);
        }
        let Some(exponentials) = self.exponential_sum(kernel) else {
            return self.integrate(PastKernel::General(kernel), f);
        };
        let parts: Vec<(f64, Node)> =
            exponentials.into_iter().map(|(a, c)| (a, self.relax(c, f))).collect();
        self.weighted_sum(parts)
    }

    /// How many integrals over the past stand within each other.
    pub(super) fn past_depth(&self, f: Node) -> usize {
        let below = self.reachable(&[f], |_| true);
        let mut depths = vec![0; f.index() + 1];
        for &node in &below {
            let op = self.op(node);
            let inside = op.operands().map(|operand| depths[operand.index()]).max();
            let own = usize::from(op.is_integral());
            depths[node.index()] = inside.unwrap_or(0) + own;
        }
        depths[f.index()]
    }

    fn integrate(&mut self, memory: PastKernel, f: Node) -> Node {
        // Terms with the same factor in space are summed first.
        let mut groups: Vec<(Node, Node)> = Vec::new();
        for term in self.terms_in_time(f) {
            let number = self.constant(term.number);
            let integral = self.integrate_moving(memory, term.moving);
            let part = self.mul(number, integral);
            match groups.iter_mut().find(|(still, _)| *still == term.still) {
                Some((_, sum)) => *sum = self.add(*sum, part),
                None => groups.push((term.still, part)),
            }
        }
        let mut total = self.constant(0.0);
        for (still, sum) in groups {
            let part = self.mul(still, sum);
            total = self.add(total, part);
        }
        total
    }

    fn integrate_moving(&mut self, memory: PastKernel, f: Node) -> Node {
        match (memory, self.op(f)) {
            (PastKernel::Exponential(c), Op::Constant(_)) => {
                let unit = self.relaxed_unit(c);
                self.mul(f, unit)
            }
            (PastKernel::Exponential(a), Op::Relax(bits, g))
                if distinct(a, f64::from_bits(bits)) =>
            {
                let b = f64::from_bits(bits);
                let faster = self.relax(a, g);
                let nodes = [("f", f), ("faster", faster)];
                self.written("factor*(f - faster)", &nodes, &[("factor", (a - b).recip())])
            }
            (_, Op::Less([a, b, p, q])) if !self.branches_in_time(a, b) => {
                let p = self.integrate(memory, p);
                let q = self.integrate(memory, q);
                self.select_less(a, b, p, q)
            }
            (PastKernel::Exponential(c), _) => self.intern(Op::Relax(c.to_bits(), f)),
            (PastKernel::General(kernel), _) => self.intern(Op::Convolve(kernel, f)),
        }
    }

    fn branches_in_time(&self, a: Node, b: Node) -> bool {
        self.depends_on(a, Variable::T) || self.depends_on(b, Variable::T)
    }

    /// Integral over 0 < s < t of exp(-c (t-s)) ds = (1 - exp(-c t)) / c.
    fn relaxed_unit(&mut self, c: f64) -> Node {
        let t = self.variable(Variable::T);
        if c == 0.0 {
            return t;
        }
        let rate = self.constant(-c);
        let exponent = self.mul(rate, t);
        let growth = self.apply(Function::ExpMinusOne, exponent);
        self.div(growth, rate)
    }
}

fn distinct(a: f64, b: f64) -> bool {
    (a - b).abs() > DISTINCT_RATES * a.abs().max(b.abs())
}
