//! Decomposition into sums of products of time-dependent and constant factors.

use super::graph::{Graph, Node, Op};

/// Limit of terms when products of sums are expanded.
const MOST_TERMS: usize = 256;

/// number * still * moving: `still` does not depend on t, `moving` is a product of factors that do, or 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term {
    pub(super) number: f64,
    pub(super) still: Node,
    pub(super) moving: Node,
}

struct Product {
    number: f64,
    still: Node,
    moving: Vec<Node>,
}

impl Graph {
    /// `f` as a sum of terms. Sums are expanded where that separates space from time or frees a hereditary integral; a
    /// sum whose parts all move stays one factor.
    pub(super) fn terms_in_time(&mut self, f: Node) -> Vec<Term> {
        let one = self.constant(1.0);
        let mut terms = Vec::new();
        let mut stack = vec![(1.0, one, f)];
        while let Some((number, still, sum)) = stack.pop() {
            for (sign, addend) in self.addends(sum) {
                let product = self.factors(addend);
                let number = number * sign * product.number;
                let still = self.mul(still, product.still);
                let room = terms.len() + stack.len() < MOST_TERMS;
                match self.factor_to_expand(&product.moving) {
                    Some(k) if room => {
                        let rest = self.product_without(&product.moving, k);
                        for (sign, part) in self.addends(product.moving[k]) {
                            let part = self.mul(part, rest);
                            stack.push((number * sign, still, part));
                        }
                    }
                    _ => {
                        let moving = self.product_without(&product.moving, usize::MAX);
                        terms.push(Term { number, still, moving });
                    }
                }
            }
        }
        terms
    }

    /// `f` as a sum of numbers times expressions that are not sums.
    pub(super) fn addends(&self, f: Node) -> Vec<(f64, Node)> {
        let mut found = Vec::new();
        let mut stack = vec![(1.0, f)];
        while let Some((number, node)) = stack.pop() {
            match self.op(node) {
                Op::Add(a, b) => stack.extend([(number, b), (number, a)]),
                Op::Sub(a, b) => stack.extend([(-number, b), (number, a)]),
                Op::Neg(a) => stack.push((-number, a)),
                Op::Mul(a, b) => match self.value_of_constant(a) {
                    Some(v) => stack.push((number * v, b)),
                    None => found.push((number, node)),
                },
                Op::Div(a, b) => match self.value_of_constant(b) {
                    Some(v) => stack.push((number / v, a)),
                    None => found.push((number, node)),
                },
                _ => found.push((number, node)),
            }
        }
        found
    }

    /// The factors of `f`, including those in quotients and powers.
    fn factors(&mut self, f: Node) -> Product {
        let one = self.constant(1.0);
        let mut product = Product { number: 1.0, still: one, moving: Vec::new() };
        let mut stack = vec![(f, false)];
        while let Some((node, below)) = stack.pop() {
            match self.op(node) {
                Op::Mul(a, b) => stack.extend([(b, below), (a, below)]),
                Op::Div(a, b) => stack.extend([(b, !below), (a, below)]),
                Op::Neg(a) => {
                    product.number = -product.number;
                    stack.push((a, below));
                }
                Op::Constant(bits) => {
                    let v = f64::from_bits(bits);
                    product.number *= if below { v.recip() } else { v };
                }
                Op::Power(base, n) if self.is_product(base) => {
                    let (Op::Mul(a, b) | Op::Div(a, b)) = self.op(base) else {
                        continue;
                    };
                    let inverted = matches!(self.op(base), Op::Div(..));
                    let (a, b) = (self.powi(a, n), self.powi(b, n));
                    stack.extend([(b, below != inverted), (a, below)]);
                }
                _ if !self.dependence(node).on_time() => {
                    product.still = if below {
                        self.div(product.still, node)
                    } else {
                        self.mul(product.still, node)
                    };
                }
                _ => {
                    let factor = if below { self.div(one, node) } else { node };
                    product.moving.push(factor);
                }
            }
        }
        product
    }

    fn is_product(&self, f: Node) -> bool {
        matches!(self.op(f), Op::Mul(..) | Op::Div(..))
    }

    fn is_sum(&self, f: Node) -> bool {
        matches!(self.op(f), Op::Add(..) | Op::Sub(..))
    }

    /// The factor that is a sum to be expanded, if any. A lone sum always is, since integration is linear.
    fn factor_to_expand(&mut self, factors: &[Node]) -> Option<usize> {
        match factors {
            [] => None,
            [single] => self.is_sum(*single).then_some(0),
            _ => (0..factors.len()).find(|&k| self.is_sum(factors[k]) && self.is_mixed(factors[k])),
        }
    }

    /// Whether parts of a sum differ in space dependence, have constant factors, or are hereditary.
    fn is_mixed(&mut self, sum: Node) -> bool {
        let addends = self.addends(sum);
        let space = self.dependence(addends[0].1).space();
        addends.into_iter().any(|(_, addend)| {
            let still = self.factors(addend).still;
            self.dependence(addend).space() != space
                || self.value_of_constant(still).is_none()
                || self.dependence(addend).on_history()
        })
    }

    fn product_without(&mut self, factors: &[Node], omitted: usize) -> Node {
        let mut product = self.constant(1.0);
        for (k, &factor) in factors.iter().enumerate() {
            if k != omitted {
                product = self.mul(product, factor);
            }
        }
        product
    }
}
