//! Separation of time from the other variables.

use std::collections::HashMap;

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

/// Longer sums count as not separable.
const MOST_TERMS: usize = 128;

/// Range of numbers moved between factors: beyond, one factor might overflow and the other vanish, as in 1e-300 t
/// (x/1e150).
const MOVED: std::ops::RangeInclusive<f64> = 1e-80..=1e80;

/// The pairs (a, f) of sum a(t) f, f of the other variables.
type Separated = Vec<(Node, Node)>;

/// Several formulas separated with common factors in time.
#[derive(Clone, Debug, Default)]
pub struct Together {
    /// The a_m(t).
    pub factors: Vec<Node>,
    /// For each formula its terms (m, g), each m at most once.
    pub shapes: Vec<Vec<(usize, Node)>>,
}

impl Graph {
    /// The pairs (a, g) with f = sum a(t) g(x,y,z,zeta), found by expanding sums and small powers, and splitting
    /// products, exponentials of sums and branches decided by space or time alone. None if the form of `f` does not
    /// show one; zero is the empty sum.
    pub fn separate(&mut self, f: Node) -> Option<Vec<(Node, Node)>> {
        let mut known: HashMap<Node, Option<Separated>> = HashMap::new();
        for node in self.reachable(&[f], |n| !self.is_pure(n)) {
            let sum = if self.is_pure(node) {
                Some(self.pure(node))
            } else {
                self.separate_one(node, &known)
            };
            let sum = sum.and_then(|sum| self.collected(sum));
            known.insert(node, sum);
        }
        known.remove(&f).flatten()
    }

    /// Factors a_m(t) and, for each formula, the pairs (m, g) with f = sum a_m(t) g(x,y,z,zeta). Proportional factors
    /// are merged, and a sum is replaced by its addends if that takes fewer factors in all. None if a formula does not
    /// separate.
    pub fn separate_together(&mut self, formulas: &[Node]) -> Option<Together> {
        let sums: Option<Vec<Separated>> = formulas.iter().map(|&f| self.separate(f)).collect();
        let sums = sums?;
        let addends: Vec<Separated> = sums.iter().map(|sum| self.in_addends(sum)).collect();
        let [whole, split] = [sums, addends].map(|sums| self.with_common_factors(&sums));
        Some(if split.factors.len() < whole.factors.len() { split } else { whole })
    }

    /// Splits each factor into its addends.
    fn in_addends(&mut self, sum: &Separated) -> Separated {
        let one = self.constant(1.0);
        let mut all = Vec::with_capacity(sum.len());
        for &(a, g) in sum {
            for (number, addend) in self.addends(a) {
                let (number, addend) = match self.value_of_constant(addend) {
                    Some(value) => (number * value, one),
                    None => (number, addend),
                };
                let number = self.constant(number);
                all.push((addend, self.mul(number, g)));
            }
        }
        all
    }

    fn with_common_factors(&mut self, sums: &[Separated]) -> Together {
        let mut together = Together::default();
        for sum in sums {
            let mut shapes: Vec<(usize, Node)> = Vec::new();
            for &(a, g) in sum {
                let (number, a) = self.number_out(a);
                let number = self.constant(number);
                let g = self.mul(number, g);
                let known = together.factors.iter().position(|&known| known == a);
                let m = known.unwrap_or(together.factors.len());
                if known.is_none() {
                    together.factors.push(a);
                }
                match shapes.iter_mut().find(|(factor, _)| *factor == m) {
                    Some((_, shape)) => *shape = self.add(*shape, g),
                    None => shapes.push((m, g)),
                }
            }
            together.shapes.push(shapes);
        }
        together
    }

    /// f = number * rest, with the numbers of a product taken out.
    fn number_out(&self, f: Node) -> (f64, Node) {
        match self.addends(f)[..] {
            [(number, rest)] if MOVED.contains(&number.abs()) => (number, rest),
            _ => (1.0, f),
        }
    }

    fn is_pure(&self, f: Node) -> bool {
        self.dependence(f).at_most_time() || !self.depends_on(f, Variable::T)
    }

    fn pure(&mut self, f: Node) -> Separated {
        let one = self.constant(1.0);
        if self.value_of_constant(f) == Some(0.0) {
            Vec::new()
        } else if self.depends_on(f, Variable::T) {
            vec![(f, one)]
        } else {
            vec![(one, f)]
        }
    }

    fn separate_one(
        &mut self,
        f: Node,
        known: &HashMap<Node, Option<Separated>>,
    ) -> Option<Separated> {
        let of = |n: Node| known.get(&n).cloned().flatten();
        match self.op(f) {
            Op::Neg(a) => Some(self.negated(of(a)?)),
            Op::Add(a, b) => Some([of(a)?, of(b)?].concat()),
            Op::Sub(a, b) => {
                let minus = self.negated(of(b)?);
                Some([of(a)?, minus].concat())
            }
            Op::Mul(a, b) => self.multiplied(&of(a)?, &of(b)?),
            Op::Div(a, b) => {
                let [(first, second)] = of(b)?[..] else {
                    return None;
                };
                let divide = |(a, g): (Node, Node)| (self.div(a, first), self.div(g, second));
                Some(of(a)?.into_iter().map(divide).collect())
            }
            Op::Power(a, n) => {
                let base = of(a)?;
                if let [(first, second)] = base[..] {
                    return Some(vec![(self.powi(first, n), self.powi(second, n))]);
                }
                (2..=16).contains(&n).then_some(())?;
                (1..n).try_fold(base.clone(), |sum, _| {
                    let sum = self.multiplied(&sum, &base)?;
                    self.collected(sum)
                })
            }
            Op::Apply(Function::Exp, a) => {
                let (mut first, mut second) = (self.constant(1.0), self.constant(1.0));
                for (a, g) in of(a)? {
                    let exponent = self.mul(a, g);
                    if !self.is_pure(exponent) {
                        return None;
                    }
                    let factor = self.apply(Function::Exp, exponent);
                    if self.dependence(exponent).at_most_time() {
                        first = self.mul(first, factor);
                    } else {
                        second = self.mul(second, factor);
                    }
                }
                Some(vec![(first, second)])
            }
            Op::Less([a, b, p, q]) => self.separate_branches([a, b], of(p)?, of(q)?),
            Op::Relax(c, a) => {
                let relax = |(a, g): (Node, Node)| (self.relax(f64::from_bits(c), a), g);
                Some(of(a)?.into_iter().map(relax).collect())
            }
            Op::Convolve(kernel, a) => {
                let convolve = |(a, g): (Node, Node)| (self.convolve(kernel, a), g);
                Some(of(a)?.into_iter().map(convolve).collect())
            }
            _ => None,
        }
    }

    /// Moves a branch into the factor that decides it.
    fn separate_branches(
        &mut self,
        [a, b]: [Node; 2],
        then: Separated,
        otherwise: Separated,
    ) -> Option<Separated> {
        let in_first = self.dependence(a).at_most_time() && self.dependence(b).at_most_time();
        if !in_first && [a, b].iter().any(|&n| self.depends_on(n, Variable::T)) {
            return None;
        }
        let zero = self.constant(0.0);
        let mut sum = Vec::with_capacity(then.len() + otherwise.len());
        for (list, taken) in [(then, true), (otherwise, false)] {
            for (first, second) in list {
                let factor = if in_first { first } else { second };
                let (p, q) = if taken { (factor, zero) } else { (zero, factor) };
                let factor = self.select_less(a, b, p, q);
                sum.push(if in_first { (factor, second) } else { (first, factor) });
            }
        }
        Some(sum)
    }

    fn negated(&mut self, sum: Separated) -> Separated {
        sum.into_iter().map(|(a, g)| (a, self.neg(g))).collect()
    }

    fn multiplied(&mut self, f: &Separated, g: &Separated) -> Option<Separated> {
        if f.len() * g.len() > MOST_TERMS {
            return None;
        }
        let mut sum = Vec::with_capacity(f.len() * g.len());
        for &(a, p) in f {
            for &(b, q) in g {
                sum.push((self.mul(a, b), self.mul(p, q)));
            }
        }
        Some(sum)
    }

    /// Moves numbers to the first factor if that varies, else to the second.
    fn normalised(&mut self, a: Node, g: Node) -> (Node, Node) {
        let one = self.constant(1.0);
        if self.value_of_constant(a).is_some() {
            return (one, self.mul(a, g));
        }
        match self.addends(g)[..] {
            [(number, g)] if MOVED.contains(&number.abs()) => {
                let (number, g) = match self.value_of_constant(g) {
                    Some(v) => (number * v, one),
                    None => (number, g),
                };
                let number = self.constant(number);
                (self.mul(number, a), g)
            }
            _ => (a, g),
        }
    }

    fn collected(&mut self, sum: Separated) -> Option<Separated> {
        let mut kept: Separated = Vec::new();
        for (a, g) in sum {
            let (a, g) = self.normalised(a, g);
            if let Some((_, second)) = kept.iter_mut().find(|(b, _)| *b == a) {
                *second = self.add(*second, g);
            } else if let Some((first, _)) = kept.iter_mut().find(|(_, h)| *h == g) {
                *first = self.add(*first, a);
            } else {
                kept.push((a, g));
            }
        }
        kept.retain(|(a, g)| {
            self.value_of_constant(*a) != Some(0.0) && self.value_of_constant(*g) != Some(0.0)
        });
        (kept.len() <= MOST_TERMS).then_some(kept)
    }
}
