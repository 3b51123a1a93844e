//! A rule's sums over the past of vectors, level by level.

use super::time::Weights;
use formula::{BoundProgram, Graph, Node, Program, Variable};

/// The kernel b of one term of the memory.
pub(super) enum Kernel {
    /// The pairs (a, c) of b(t) = Σ a exp(-c t).
    Exponentials(Vec<(f64, f64)>),
    /// c(t - x) of b(t) = t^{-a} c(t), 0 ≤ a < 1.
    Direct(f64, Program),
}

impl Kernel {
    pub(super) fn new(graph: &mut Graph, kernel: Node, horizon: f64) -> Self {
        match graph.exponential_sum(kernel) {
            Some(terms) => Self::Exponentials(terms),
            None => Self::Direct(0.0, of_lag(graph, kernel, horizon)),
        }
    }

    pub(super) fn singular(graph: &mut Graph, a: f64, factor: Node, horizon: f64) -> Self {
        Self::Direct(a, of_lag(graph, factor, horizon))
    }

    /// a; 0 except for singular kernels.
    pub(super) fn power(&self) -> f64 {
        if let Self::Direct(a, _) = self { *a } else { 0.0 }
    }

    /// The pairs (a, c), or empty.
    pub(super) fn exponentials(&self) -> &[(f64, f64)] {
        if let Self::Exponentials(terms) = self { terms } else { &[] }
    }

    /// b(t - s) at some times s, without the power.
    pub(super) fn at_lags(&self, t: f64, times: &[f64]) -> Vec<f64> {
        match self {
            Self::Exponentials(terms) => {
                let at = |s: f64| terms.iter().map(|(a, c)| a * (-c * (t - s)).exp()).sum();
                times.iter().map(|&s| at(s)).collect()
            }
            Self::Direct(_, program) => {
                let places: Vec<[f64; 3]> = times.iter().map(|&s| [s, 0.0, 0.0]).collect();
                let mut values = vec![Vec::new()];
                program.bind(&places).evaluate(t, 0.0, &mut values);
                values.swap_remove(0)
            }
        }
    }

    /// Whether sums are recomputed over all earlier levels.
    pub(super) fn is_direct(&self) -> bool {
        matches!(self, Self::Direct(..))
    }
}

/// A formula in t at the lag t - x.
fn of_lag(graph: &mut Graph, formula: Node, horizon: f64) -> Program {
    let (t, x) = (graph.variable(Variable::T), graph.variable(Variable::X));
    let lag = graph.sub(t, x);
    let of_lag = graph.substitute(formula, Variable::T, lag);
    Program::compile(graph, &[of_lag], horizon)
}

/// Values and errors, summed in parallel.
pub(super) type Pair<T> = [T; 2];

/// For each kernel, Σ_{j<n} w_nj b(t_n - t_j) v_j for a pair of sequences v_0, …, v_{n-1}.
///
/// For b(t) = Σ a exp(-c t) with weights of v_n that are equal in all later sums, each term P_n is updated by
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
    /// Exponentials whose weights differ from level to level.
    Anew(Vec<(f64, f64)>),
    /// The kernel bound to the times, and its values b(t_n - t_j).
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
        let places: Vec<[f64; 3]> = times.iter().map(|&s| [s, 0.0, 0.0]).collect();
        let zero = || [vec![0.0; length], vec![0.0; length]];
        let sum = |(kernel, weights): (&Kernel, &Weights)| match kernel {
            Kernel::Exponentials(terms) if !weights.are_fixed() => Sum::Anew(terms.clone()),
            Kernel::Exponentials(terms) => {
                Sum::Carried(terms.iter().map(|&(a, c)| Carried { a, c, sums: zero() }).collect())
            }
            Kernel::Direct(_, program) => {
                Sum::Direct(Box::new(program.bind(&places)), vec![Vec::new()])
            }
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

    /// The weight of the current level: w_nn b(0).
    pub(super) fn current_weight(&self, kernel: usize) -> f64 {
        let at_zero = match &self.kernels[kernel] {
            Sum::Carried(terms) => terms.iter().map(|term| term.a).sum(),
            Sum::Anew(terms) => terms.iter().map(|(a, _)| a).sum(),
            Sum::Direct(_, values) => values[0][self.level],
        };
        self.weights[kernel].at(self.times, self.level, self.level) * at_zero
    }

    /// The sums over earlier levels.
    pub(super) fn before(&self, kernel: usize) -> Pair<Vec<f64>> {
        let mut out = [vec![0.0; self.length], vec![0.0; self.length]];
        let weights = self.weights[kernel];
        match &self.kernels[kernel] {
            Sum::Carried(terms) => terms.iter().for_each(|term| add(1.0, &term.sums, &mut out)),
            Sum::Anew(terms) => {
                let t = self.times[self.level];
                for (j, past) in self.past.iter().enumerate() {
                    let lag = t - self.times[j];
                    let b: f64 = terms.iter().map(|(a, c)| a * (-c * lag).exp()).sum();
                    add(weights.at(self.times, self.level, j) * b, past, &mut out);
                }
            }
            Sum::Direct(_, values) => {
                for (j, past) in self.past.iter().enumerate() {
                    let weight = weights.at(self.times, self.level, j);
                    add(weight * values[0][j], past, &mut out);
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

/// Σ_{j<n} w_nj v_j of pairs of numbers.
pub(super) struct Numbers {
    weights: Weights,
    sums: Pair<f64>,
    /// v_0, …, v_{n-1}.
    past: Vec<Pair<f64>>,
}

impl Numbers {
    pub(super) fn new(weights: Weights) -> Self {
        Self { weights, sums: [0.0; 2], past: Vec::new() }
    }

    pub(super) fn before(&self) -> Pair<f64> {
        self.sums
    }

    /// Advances from level n < N, with its numbers.
    pub(super) fn advance(&mut self, times: &[f64], n: usize, numbers: Pair<f64>) {
        let first = if self.weights.are_fixed() { n } else { 0 };
        if first == 0 {
            self.sums = [0.0; 2];
        }
        self.past.push(numbers);
        for (j, &pair) in self.past.iter().enumerate().skip(first) {
            let w = self.weights.at(times, n + 1, j);
            self.sums.iter_mut().zip(pair).for_each(|(sum, value)| *sum += w * value);
        }
    }
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
                let kernel = Kernel::new(&mut graph, node, 1.3);
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
