//! A rule's sums over the past of vectors, level by level.

use super::adaptive::{cuts, integral_against};
use super::time::Weights;
use formula::{BoundProgram, Graph, Node, Program, Variable};

/// The kernel of one term of the memory, (t-s)^{-a} q(t,s), 0 ≤ a < 1.
pub(super) struct Kernel {
    /// a; 0 except for singular kernels.
    pub(super) power: f64,
    /// q(t, x).
    factor: Program,
    /// The pairs (a, c) of q(t,s) = Σ a exp(-c (t-s)), if it has that form.
    exponentials: Option<Vec<(f64, f64)>>,
}

impl Kernel {
    /// Of the formula c with q(t,s) = c(t-s).
    pub(super) fn of_lag(graph: &mut Graph, power: f64, factor: Node, horizon: f64) -> Self {
        let exponentials = graph.exponential_sum(factor).filter(|_| power == 0.0);
        let (t, x) = (graph.variable(Variable::T), graph.variable(Variable::X));
        let lag = graph.sub(t, x);
        let q = graph.substitute(factor, Variable::T, lag);
        Self { exponentials, ..Self::new(graph, power, q, horizon) }
    }

    /// Of the formula q in t and x, the place of s.
    pub(super) fn new(graph: &mut Graph, power: f64, q: Node, horizon: f64) -> Self {
        Self { power, factor: Program::compile(graph, &[q], horizon), exponentials: None }
    }

    /// b = 1.
    pub(super) fn one(graph: &mut Graph, horizon: f64) -> Self {
        let one = graph.constant(1.0);
        Self::of_lag(graph, 0.0, one, horizon)
    }

    /// The pairs (a, c), or empty.
    pub(super) fn exponentials(&self) -> &[(f64, f64)] {
        self.exponentials.as_deref().unwrap_or_default()
    }

    /// q(t, s) for t and some times s.
    fn at_times(&self, times: &[f64]) -> BoundProgram {
        self.factor.bind(&times.iter().map(|&s| [s, 0.0, 0.0]).collect::<Vec<_>>())
    }

    /// ∫_0^t (t-s)^{-a} q(t,s) v(s) ds, where v, given for a list of times, has kinks
    /// at some; `discrete` is the sum that it is compared with.
    pub(super) fn integral(
        &self,
        t: f64,
        kinks: &[f64],
        discrete: &[f64],
        mut v: impl FnMut(&[f64]) -> Vec<Vec<f64>>,
    ) -> Vec<f64> {
        if t == 0.0 {
            return vec![0.0; discrete.len()];
        }
        integral_against(self.power, &cuts(t, kinks), discrete, |times| {
            let mut factors = [Vec::new()];
            self.at_times(times).evaluate(t, 0.0, &mut factors);
            let mut values = v(times);
            for (values, q) in values.iter_mut().zip(&factors[0]) {
                values.iter_mut().for_each(|value| *value *= q);
            }
            values
        })
    }

    /// Whether sums are recomputed over all earlier levels.
    pub(super) fn is_direct(&self) -> bool {
        self.exponentials.is_none()
    }
}

/// Values and errors, summed in parallel.
pub(super) type Pair<T> = [T; 2];

/// For each kernel, Σ_{j<n} w_nj q(t_n, t_j) v_j for a pair of sequences v_0, …, v_{n-1}.
///
/// For q(t,s) = Σ a exp(-c (t-s)) with weights of v_n that are equal in all later sums, each term P_n is updated by
///
/// ```text
/// P_{n+1} = exp(-c k_{n+1}) (P_n + a w_{n+1,n} v_n)
/// ```
///
/// Other sums are recomputed.
pub(super) struct Sums<'a> {
    weights: Vec<Weights>,
    times: &'a [f64],
    level: usize,
    kernels: Vec<Sum>,
    /// v_0, …, v_{n-1}, if a kernel needs them.
    past: Vec<Pair<Vec<f64>>>,
    length: usize,
}

enum Sum {
    Carried(Vec<Carried>),
    /// The kernel bound to the times, and its values q(t_n, t_j).
    Direct(Box<BoundProgram>, Vec<Vec<f64>>),
}

struct Carried {
    a: f64,
    c: f64,
    sums: Pair<Vec<f64>>,
}

impl<'a> Sums<'a> {
    /// Empty sums at t_0, of vectors of the given length, with the weights of each kernel.
    pub(super) fn new(
        weights: Vec<Weights>,
        kernels: &[Kernel],
        times: &'a [f64],
        length: usize,
    ) -> Self {
        let zero = || [vec![0.0; length], vec![0.0; length]];
        let sum = |(kernel, weights): (&Kernel, &Weights)| match &kernel.exponentials {
            Some(terms) if weights.are_fixed() => {
                Sum::Carried(terms.iter().map(|&(a, c)| Carried { a, c, sums: zero() }).collect())
            }
            _ => Sum::Direct(Box::new(kernel.at_times(times)), vec![Vec::new()]),
        };
        let mut sums = Self {
            times,
            level: 0,
            kernels: kernels.iter().zip(&weights).map(sum).collect(),
            weights,
            past: Vec::new(),
            length,
        };
        sums.evaluate();
        sums
    }

    /// The weight of the current level: w_nn q(t_n, t_n).
    pub(super) fn current_weight(&self, kernel: usize) -> f64 {
        let at_zero = match &self.kernels[kernel] {
            Sum::Carried(terms) => terms.iter().map(|term| term.a).sum(),
            Sum::Direct(_, values) => values[0][self.level],
        };
        weighted(self.weights[kernel].at(self.times, self.level, self.level), at_zero)
    }

    /// The sums over earlier levels.
    pub(super) fn before(&self, kernel: usize) -> Pair<Vec<f64>> {
        let mut out = [vec![0.0; self.length], vec![0.0; self.length]];
        let weights = self.weights[kernel];
        match &self.kernels[kernel] {
            Sum::Carried(terms) => terms.iter().for_each(|term| add(1.0, &term.sums, &mut out)),
            Sum::Direct(_, values) => {
                for (j, past) in self.past.iter().enumerate() {
                    let weight = weights.at(self.times, self.level, j);
                    add(weighted(weight, values[0][j]), past, &mut out);
                }
            }
        }
        out
    }

    /// Advances to the next level, with the vectors of this one.
    pub(super) fn advance(&mut self, vectors: Pair<Vec<f64>>) {
        let n = self.level;
        let Some(next) = self.times.get(n + 1) else { return };
        let step = next - self.times[n];
        for (kernel, weights) in self.kernels.iter_mut().zip(&self.weights) {
            let Sum::Carried(terms) = kernel else { continue };
            let weight = weights.at(self.times, n + 1, n);
            for Carried { a, c, sums } in terms {
                add(*a * weight, &vectors, sums);
                let decay = (-*c * step).exp();
                sums.iter_mut().flatten().for_each(|value| *value *= decay);
            }
        }
        if self.kernels.iter().any(|kernel| !matches!(kernel, Sum::Carried(_))) {
            self.past.push(vectors);
        }
        self.level = n + 1;
        self.evaluate();
    }

    /// Evaluates kernels at the lags of this level.
    fn evaluate(&mut self) {
        for kernel in &mut self.kernels {
            if let Sum::Direct(bound, values) = kernel {
                bound.evaluate(self.times[self.level], 0.0, values);
            }
        }
    }
}

/// A kernel may be infinite where it has no weight.
fn weighted(weight: f64, kernel: f64) -> f64 {
    if weight == 0.0 { 0.0 } else { weight * kernel }
}

fn add(factor: f64, vectors: &Pair<Vec<f64>>, sums: &mut Pair<Vec<f64>>) {
    for (vector, sum) in vectors.iter().zip(sums) {
        algebra::linalg::axpy(factor, vector, sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use formula::Scope;
    use scene::TimeRule;

    const FOUR: TimeRule = TimeRule::Gregory { order: 4 };

    /// Sums of all kinds against the definition, on a grid of very different steps.
    #[test]
    fn sums_are_those_of_the_definition() {
        let times = [0.0, 0.02, 0.5, 0.6, 0.61, 1.3];
        type Plain = fn(f64) -> f64;
        let kernels: [(&str, Plain, bool); 4] = [
            ("-exp(-t)", |t| -(-t).exp(), false),
            (
                "0.3 + 2*exp(-3*t) - exp(0.5*t)",
                |t| 0.3 + 2.0 * (-3.0 * t).exp() - (0.5 * t).exp(),
                false,
            ),
            ("1/(1 + t)^1.5", |t| (1.0 + t).powf(-1.5), true),
            ("sqrt(t)", f64::sqrt, true),
        ];
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::T]);
        let prepared: Vec<Kernel> = kernels
            .iter()
            .map(|(text, _, direct)| {
                let node = graph.parse(text, &scope).unwrap();
                let kernel = Kernel::of_lag(&mut graph, 0.0, node, 1.3);
                assert_eq!(kernel.is_direct(), *direct, "{text}");
                kernel
            })
            .collect();
        let vectors = |t: f64| [vec![1.0 - t, (3.0 * t).sin()], vec![t * t, 2.0]];
        for rule in [Weights::Trapezoid, Weights::Left, Weights::of(FOUR).unwrap()] {
            let mut sums = Sums::new(vec![rule; 4], &prepared, &times, 2);
            for n in 0..times.len() {
                for (i, (text, b, _)) in kernels.iter().enumerate() {
                    let current = rule.at(&times, n, n) * b(0.0);
                    assert!((sums.current_weight(i) - current).abs() < 1e-15, "{text}: {current}");
                    let before = sums.before(i);
                    for (which, part) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let term = |j: usize| {
                            let w = rule.at(&times, n, j) * b(times[n] - times[j]);
                            w * vectors(times[j])[which][part]
                        };
                        let plain: f64 = (0..n).map(term).sum();
                        // Sums of size one.
                        assert!((before[which][part] - plain).abs() < 1e-14, "{text}: {plain}");
                    }
                }
                sums.advance(vectors(times[n]));
            }
        }
    }
}
