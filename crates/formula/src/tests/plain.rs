//! The plain definition of an expression, independent of tapes and their integrals so that the two check each other.

use crate::graph::{Graph, Node, Op, Variable};
use crate::program::EvaluationPoint;
use crate::quadrature::GAUSS;
use crate::vocabulary::power;

const PANELS: usize = 32;
const WATCHES: usize = 6;

/// Breaks closer than this, relative to t, are merged.
const APART: f64 = 1e-14;

/// The value of `f` at a point; with hereditary integrals accurate to about 1e-13 of the terms.
pub(super) fn by_definition(graph: &Graph, f: Node, at: &EvaluationPoint) -> f64 {
    match graph.op(f) {
        Op::Relax(c, g) => integral(graph, g, at, |lag| (-f64::from_bits(c) * lag).exp()),
        Op::Convolve(kernel, g) => {
            let mut b = Scratch::new(graph, kernel, |_, _| f64::NAN);
            integral(graph, g, at, |lag| b.value(kernel, &EvaluationPoint { t: lag, ..*at }))
        }
        _ => Scratch::new(graph, f, |node, at: &EvaluationPoint| by_definition(graph, node, at))
            .value(f, at),
    }
}

/// Integral over 0 < s < t of kernel(t-s) f(s): composite Gauss quadrature, panels broken where a guard of f changes
/// sign.
fn integral(
    graph: &Graph,
    f: Node,
    at: &EvaluationPoint,
    mut kernel: impl FnMut(f64) -> f64,
) -> f64 {
    let past = |node: Node, at: &EvaluationPoint| by_definition(graph, node, at);
    let mut integrand = Scratch::new(graph, f, past);
    let guards = graph.guards(&[f]).into_iter().filter(|g| graph.depends_on(*g, Variable::T));
    let mut guards: Vec<_> = guards.map(|g| (g, Scratch::new(graph, g, past))).collect();
    let edge = |k: usize| at.t * k as f64 / (PANELS * WATCHES) as f64;
    let mut total = 0.0;
    for panel in 0..PANELS {
        let mut cuts = vec![edge(panel * WATCHES), edge((panel + 1) * WATCHES)];
        for (guard, scratch) in &mut guards {
            let mut sign = |s: f64| class(scratch.value(*guard, &EvaluationPoint { t: s, ..*at }));
            for k in panel * WATCHES..(panel + 1) * WATCHES {
                cuts.extend(change(&mut sign, edge(k), edge(k + 1)));
            }
        }
        cuts.sort_by(f64::total_cmp);
        if at.t < 0.0 {
            cuts.reverse();
        }
        // A break next to an edge or another break would leave no room for quadrature points.
        cuts.dedup_by(|next, kept| (*next - *kept).abs() <= APART * at.t.abs());
        if let Some(last) = cuts.last_mut() {
            *last = edge((panel + 1) * WATCHES);
        }
        for piece in cuts.windows(2) {
            let width = piece[1] - piece[0];
            for (u, w) in GAUSS.abscissae.iter().zip(&GAUSS.weights) {
                let s = piece[0] + width * u;
                let value = integrand.value(f, &EvaluationPoint { t: s, ..*at });
                total += width * w * value * kernel(at.t - s);
            }
        }
    }
    total
}

/// The place between `low` and `high` where the sign changes, by bisection.
fn change(sign: &mut impl FnMut(f64) -> i8, mut low: f64, mut high: f64) -> Option<f64> {
    let first = sign(low);
    if sign(high) == first {
        return None;
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low.min(high) || middle >= low.max(high) {
            return Some(high);
        }
        if sign(middle) == first {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// The sign as a number: equal classes mean the same branch.
fn class(guard: f64) -> i8 {
    i8::from(guard > 0.0) - i8::from(guard < 0.0)
}

/// The values of an expression and its parts, with hereditary integrals by `integral`.
struct Scratch<'a, F> {
    graph: &'a Graph,
    integral: F,
    order: Vec<Node>,
    values: rustc_hash::FxHashMap<Node, f64>,
}

impl<'a, F: Fn(Node, &EvaluationPoint) -> f64> Scratch<'a, F> {
    fn new(graph: &'a Graph, f: Node, integral: F) -> Self {
        let order = graph.reachable(&[f], |n| !graph.op(n).is_integral());
        let values = order.iter().map(|&n| (n, f64::NAN)).collect();
        Self { graph, integral, order, values }
    }

    fn value(&mut self, f: Node, at: &EvaluationPoint) -> f64 {
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
            Op::Variable(v) => [at.x, at.y, at.z, at.t, at.zeta][v as usize],
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
