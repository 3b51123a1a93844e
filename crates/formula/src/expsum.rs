//! Recognition of sums of exponentials in time.

use std::collections::HashMap;

use super::graph::{Graph, Node, Op, Variable};
use super::vocabulary::Function;

/// Longer sums are not treated term by term.
const MOST_TERMS: usize = 64;

/// Σ a exp(-c t) + q t: a formula, or an exponent within it.
struct Form {
    /// The pairs (a, c) of different rates, which ascend.
    exponentials: Vec<(f64, f64)>,
    slope: f64,
}

impl Graph {
    /// The pairs (a, c) with f(t) = Σ a exp(-c t), if `f` is written as a sum of constants times exponentials of linear
    /// expressions in t. Equal rates are merged, rates ascend; zero is the empty sum.
    pub fn exponential_sum(&self, f: Node) -> Option<Vec<(f64, f64)>> {
        if !self.dependence(f).at_most_time() || self.dependence(f).on_history() {
            return None;
        }
        let mut known: HashMap<Node, Option<Form>> = HashMap::new();
        for node in self.reachable(&[f], |_| true) {
            let form = self.form(node, |part| known.get(&part)?.as_ref());
            known.insert(node, form);
        }
        let form = known.remove(&f).flatten()?;
        (form.slope == 0.0).then_some(form.exponentials)
    }

    fn form<'a>(&self, f: Node, of: impl Fn(Node) -> Option<&'a Form>) -> Option<Form> {
        match self.op(f) {
            Op::Constant(bits) => Form::new(vec![(f64::from_bits(bits), 0.0)], 0.0),
            Op::Variable(Variable::T) => Form::new(Vec::new(), 1.0),
            Op::Neg(a) => of(a)?.scaled(|v| -v, 0.0),
            Op::Add(a, b) => of(a)?.plus(of(b)?),
            Op::Sub(a, b) => of(a)?.plus(&of(b)?.scaled(|v| -v, 0.0)?),
            Op::Mul(a, b) => match (&of(a)?.exponentials[..], &of(b)?.exponentials[..]) {
                (&[(d, c)], _) if of(a)?.slope == 0.0 => of(b)?.scaled(|v| d * v, c),
                (_, &[(d, c)]) if of(b)?.slope == 0.0 => of(a)?.scaled(|v| v * d, c),
                _ => None,
            },
            Op::Div(a, b) => match of(b)? {
                Form { exponentials, slope: 0.0 } => {
                    let &[(d, c)] = &exponentials[..] else { return None };
                    of(a)?.scaled(|v| v / d, -c)
                }
                _ => None,
            },
            Op::Apply(Function::Exp, a) => {
                let p = match of(a)?.exponentials[..] {
                    [] => 0.0,
                    [(p, 0.0)] => p,
                    _ => return None,
                };
                Form::new(vec![(p.exp(), -of(a)?.slope)], 0.0)
            }
            _ => None,
        }
    }
}

impl Form {
    /// Equal rates merged, ascending; none if the sum is too long or not finite.
    fn new(mut exponentials: Vec<(f64, f64)>, slope: f64) -> Option<Self> {
        if !slope.is_finite() || exponentials.iter().any(|(a, c)| !a.is_finite() || !c.is_finite())
        {
            return None;
        }
        // Turns -0 into +0.
        exponentials.iter_mut().for_each(|(_, c)| *c += 0.0);
        exponentials.sort_by(|(_, c), (_, d)| c.total_cmp(d));
        exponentials.dedup_by(|next, kept| {
            let equal = next.1 == kept.1;
            if equal {
                kept.0 += next.0;
            }
            equal
        });
        exponentials.retain(|(a, _)| *a != 0.0);
        (exponentials.len() <= MOST_TERMS).then_some(Self { exponentials, slope })
    }

    fn plus(&self, other: &Self) -> Option<Self> {
        let exponentials = [&self.exponentials[..], &other.exponentials].concat();
        Self::new(exponentials, self.slope + other.slope)
    }

    /// All coefficients changed, and multiplied by exp(-c t).
    fn scaled(&self, by: impl Fn(f64) -> f64, c: f64) -> Option<Self> {
        if c != 0.0 && self.slope != 0.0 {
            return None;
        }
        let exponentials = self.exponentials.iter().map(|&(a, e)| (by(a), e + c)).collect();
        Self::new(exponentials, by(self.slope))
    }
}
