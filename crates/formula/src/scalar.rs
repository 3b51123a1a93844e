//! Evaluation of one expression at one point: the plain definition, independent of the tapes so that the two check each
//! other.

use super::graph::{Graph, Node, Op, Variable};
use super::quadrature::GAUSS;

const PANELS: usize = 32;
const WATCHES: usize = 6;

/// Breaks closer than this, relative to t, are merged.
const APART: f64 = 1e-14;

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

#[inline]
pub(super) fn power(x: f64, n: i32) -> f64 {
    let (mut base, mut rest, mut product) = (x, n.unsigned_abs(), 1.0);
    while rest > 0 {
        if rest & 1 == 1 {
            product *= base;
        }
        rest >>= 1;
        if rest > 0 {
            base *= base;
        }
    }
    if n < 0 { 1.0 / product } else { product }
}

struct Scratch<'a> {
    graph: &'a Graph,
    order: Vec<Node>,
    values: rustc_hash::FxHashMap<Node, f64>,
}

impl Graph {
    /// The value of `f` at a point; with hereditary integrals accurate to about 1e-13 of the terms. Slow: for single
    /// values and checks.
    pub fn evaluate(&self, f: Node, at: &EvaluationPoint) -> f64 {
        Scratch::new(self, &[f]).value(f, at)
    }
}

impl<'a> Scratch<'a> {
    fn new(graph: &'a Graph, roots: &[Node]) -> Self {
        let order =
            graph.reachable(roots, |n| !matches!(graph.op(n), Op::Relax(..) | Op::Convolve(..)));
        let values = order.iter().map(|&n| (n, f64::NAN)).collect();
        Self { graph, order, values }
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
            Op::Relax(c, f) => {
                let c = f64::from_bits(c);
                integral(self.graph, f, at, |lag| (-c * lag).exp())
            }
            Op::Convolve(kernel, f) => {
                let mut b = Scratch::new(self.graph, &[kernel]);
                integral(self.graph, f, at, |lag| {
                    b.value(kernel, &EvaluationPoint { t: lag, ..*at })
                })
            }
        }
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
    let guards: Vec<Node> = graph.guards(&[f]);
    let mut integrand = Scratch::new(graph, &[f]);
    let mut guards: Vec<(Node, Scratch)> = guards
        .into_iter()
        .filter(|g| graph.depends_on(*g, Variable::T))
        .map(|g| (g, Scratch::new(graph, &[g])))
        .collect();
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

/// The sign as a number: equal classes mean the same branch.
pub(super) fn class(guard: f64) -> i8 {
    i8::from(guard > 0.0) - i8::from(guard < 0.0)
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
