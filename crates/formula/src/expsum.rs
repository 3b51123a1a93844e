//! Recognition of sums of exponentials in time.

use std::collections::HashMap;

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;
use super::vocabulary::power;

/// Longer sums are not treated term by term.
const MOST_TERMS: usize = 64;

/// Pairs (a, c) of f(t) = sum a exp(-c t).
type Exponentials = Vec<(f64, f64)>;

impl Graph {
    /// The pairs (a, c) with f(t) = sum a exp(-c t), if `f` has that form: constants, exponentials of linear
    /// expressions in t, and sums, products and powers of those. Equal rates are merged, rates ascend; zero is the
    /// empty sum.
    pub fn exponential_sum(&self, f: Node) -> Option<Vec<(f64, f64)>> {
        if !self.dependence(f).at_most_time() || self.dependence(f).on_history() {
            return None;
        }
        let mut known: HashMap<Node, Option<Exponentials>> = HashMap::new();
        for node in self.reachable(&[f], |_| true) {
            let sum = self.one_sum(node, &known);
            known.insert(node, sum.and_then(merged));
        }
        known.remove(&f).flatten()
    }

    fn one_sum(
        &self,
        f: Node,
        known: &HashMap<Node, Option<Exponentials>>,
    ) -> Option<Exponentials> {
        let of = |n: Node| known.get(&n).and_then(Option::as_ref);
        let negated =
            |sum: &Exponentials| -> Exponentials { sum.iter().map(|&(a, c)| (-a, c)).collect() };
        match self.op(f) {
            Op::Constant(bits) => Some(vec![(f64::from_bits(bits), 0.0)]),
            Op::Neg(a) => Some(negated(of(a)?)),
            Op::Add(a, b) => Some([of(a)?.as_slice(), of(b)?].concat()),
            Op::Sub(a, b) => Some([of(a)?.as_slice(), &negated(of(b)?)].concat()),
            Op::Mul(a, b) => Some(product(of(a)?, of(b)?)),
            Op::Div(a, b) => {
                // A single exponential can be divided by.
                let [(d, c)] = of(b)?.as_slice() else {
                    return None;
                };
                Some(of(a)?.iter().map(|(a, e)| (a / d, e - c)).collect())
            }
            Op::Power(a, n) if n > 0 && n <= 16 => {
                let base = of(a)?;
                (1..n).try_fold(base.clone(), |sum, _| merged(product(&sum, base)))
            }
            Op::Power(a, n) => {
                let [(d, c)] = of(a)?.as_slice() else {
                    return None;
                };
                Some(vec![(power(*d, n), c * f64::from(n))])
            }
            Op::Pow(a, b) => {
                let base = self.value_of_constant(a).filter(|base| *base > 0.0)?.ln();
                let (p, q) = self.linear_in_time(b)?;
                Some(vec![((base * p).exp(), -base * q)])
            }
            Op::Apply(Function::Exp, a) => {
                let (p, q) = self.linear_in_time(a)?;
                Some(vec![(p.exp(), -q)])
            }
            Op::Apply(Function::ExpMinusOne, a) => {
                let (p, q) = self.linear_in_time(a)?;
                Some(vec![(p.exp(), -q), (-1.0, 0.0)])
            }
            _ => None,
        }
    }

    /// (p, q) with f = p + q t, if `f` has that form.
    fn linear_in_time(&self, f: Node) -> Option<(f64, f64)> {
        let mut known: HashMap<Node, Option<(f64, f64)>> = HashMap::new();
        for node in self.reachable(&[f], |_| true) {
            let of = |n: Node| known.get(&n).copied().flatten();
            let pair = |a, b| of(a).zip(of(b));
            let line = match self.op(node) {
                Op::Constant(bits) => Some((f64::from_bits(bits), 0.0)),
                Op::Variable(Variable::T) => Some((0.0, 1.0)),
                Op::Neg(a) => of(a).map(|(p, q)| (-p, -q)),
                Op::Add(a, b) => pair(a, b).map(|((p, q), (r, s))| (p + r, q + s)),
                Op::Sub(a, b) => pair(a, b).map(|((p, q), (r, s))| (p - r, q - s)),
                Op::Mul(a, b) => match pair(a, b) {
                    Some(((p, 0.0), (r, s))) | Some(((r, s), (p, 0.0))) => Some((p * r, p * s)),
                    _ => None,
                },
                Op::Div(a, b) => match pair(a, b) {
                    Some(((p, q), (d, 0.0))) => Some((p / d, q / d)),
                    _ => None,
                },
                _ => None,
            };
            known.insert(node, line);
        }
        known.remove(&f).flatten()
    }
}

fn product(f: &Exponentials, g: &Exponentials) -> Exponentials {
    f.iter().flat_map(|(a, c)| g.iter().map(move |(b, d)| (a * b, c + d))).collect()
}

/// Equal rates merged, ascending; none if the sum is too long or not finite.
fn merged(mut sum: Exponentials) -> Option<Exponentials> {
    if sum.iter().any(|(a, c)| !a.is_finite() || !c.is_finite()) {
        return None;
    }
    for (_, c) in &mut sum {
        // Turns -0 into +0.
        *c += 0.0;
    }
    sum.sort_by(|(_, c), (_, d)| c.total_cmp(d));
    sum.dedup_by(|next, kept| {
        let equal = next.1 == kept.1;
        if equal {
            kept.0 += next.0;
        }
        equal
    });
    sum.retain(|(a, _)| *a != 0.0);
    (sum.len() <= MOST_TERMS).then_some(sum)
}
