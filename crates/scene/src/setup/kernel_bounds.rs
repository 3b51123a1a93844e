//! Proved norms of the kernels of an abstract problem, Σ_l q_l(t, s) Q_l for 0 ≤ s ≤ t ≤ T.

use crate::AbstractScene;
use formula::{Effort, Enclosing, Extreme, Graph, Interval, Node, Place, Variable, largest};
use nalgebra::{DMatrix, SymmetricEigen};

/// In place of a power, of histories of histories: their last weight is of order k² = k^{1-a}.
pub(super) const NESTED: f64 = -1.0;

pub(super) fn norm(a: &DMatrix<f64>) -> f64 {
    a.singular_values().max()
}

/// Terms with matrices of order m cost some m³ operations a box: several of them get fewer boxes, and the bound is then less
/// close to the maximum.
const OPERATIONS: usize = 1 << 27;
const FEWEST_BOXES: usize = 256;
const MOST_BOXES: usize = 4096;
const TOLERANCE: f64 = 1e-3;

/// One term (t - s)^{-a} b_l(t, s) Q_l. For a nested one b_l is ‖r_l‖ q_l(t, s), and q_l(t, t) r_l(t, t) for s = t.
struct Term {
    power: f64,
    /// b_l with s = σ t, in T and Y = σ, so that 0 ≤ s ≤ t is a box, and b_l with s = t.
    at_share: Node,
    now: Node,
    /// R Q_l between orthonormal coordinates of X and of X*: a matrix for the norm, and its symmetric part with the factor of φ.
    matrix: DMatrix<f64>,
    symmetric: DMatrix<f64>,
}

/// The terms of the history.
pub(super) struct KernelBounds {
    graph: Graph,
    terms: Vec<Term>,
    /// The first inner kernel without a bound, and a time near which there is none.
    odd: Option<(usize, f64)>,
    horizon: f64,
}

/// Bounds for the terms with one power.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KernelNorms {
    /// max ‖Σ b_l(t, s) Q_l‖.
    pub all: f64,
    /// max ‖Σ b_l(t, t) Q_l‖.
    pub now: f64,
    /// max over t of -λ_min of the symmetric part of Σ b_l(t, t) Q_l with the factors of R and φ; 0 if it is nowhere negative.
    pub destabilizing: f64,
}

/// An eigenvalue is known to a few units of rounding of the matrix.
const OF_EIGENVALUES: f64 = 1e-14;

impl KernelBounds {
    /// `matrices` are those of [`Term`], for each kernel of the problem.
    pub(super) fn new(
        graph: &Graph,
        problem: &AbstractScene,
        horizon: f64,
        matrices: impl Fn(usize) -> [DMatrix<f64>; 2],
    ) -> Self {
        let mut graph = graph.clone();
        graph.collect();
        let (t, share) = (graph.variable(Variable::T), graph.variable(Variable::Y));
        let part = graph.mul(share, t);
        let (mut terms, mut odd) = (Vec::new(), None);
        for (l, kernel) in problem.kernels.iter().enumerate() {
            let [matrix, symmetric] = matrices(l);
            let mut at_share = graph.substitute(kernel.q, Variable::X, part);
            let mut now = graph.substitute(kernel.q, Variable::X, t);
            if let Some(r) = kernel.inner {
                let (r_at_share, r_now) =
                    (graph.substitute(r, Variable::X, part), graph.substitute(r, Variable::X, t));
                let found =
                    over_triangle(&graph, horizon, &[r_at_share], Effort::FORMULA, |r| r[0].abs());
                if !found.bound.is_finite() {
                    odd = odd.or(Some((l, found.part[0].low)));
                }
                let most = graph.constant(found.bound);
                at_share = graph.mul(most, at_share);
                now = graph.mul(now, r_now);
            }
            let power = if kernel.inner.is_some() { NESTED } else { kernel.power };
            terms.push(Term { power, at_share, now, matrix, symmetric });
        }
        Self { graph, terms, odd, horizon }
    }

    /// The first kernel without a bound, its key, and a t near which there is none.
    pub(super) fn unbounded(&self) -> Option<(usize, &'static str, f64)> {
        if let Some((l, s)) = self.odd {
            return Some((l, "inner", s));
        }
        let one = |term: &Term| {
            let b = [term.at_share];
            over_triangle(&self.graph, self.horizon, &b, Effort::FORMULA, |b| b[0].abs())
        };
        let found = self.terms.iter().map(one);
        let odd = found.enumerate().find(|(_, f)| !f.bound.is_finite());
        odd.map(|(l, f)| (l, "q", f.part[0].low))
    }

    /// The norms of the terms with this power.
    pub(super) fn norms(&self, power: f64) -> KernelNorms {
        let terms: Vec<&Term> = self.terms.iter().filter(|term| term.power == power).collect();
        if terms.is_empty() {
            return KernelNorms::default();
        }
        let sizes: Vec<f64> = terms.iter().map(|term| norm(&term.matrix)).collect();
        let size = |b: &[Interval]| match b {
            [only] => only.abs() * Interval::point(sizes[0]),
            _ => around(b, &sizes, |middle| norm(&sum(middle, &terms, |term| &term.matrix))),
        };
        let least: Vec<[f64; 2]> = terms.iter().map(|term| ends(&term.symmetric)).collect();
        let bends: Vec<f64> = least.iter().map(|[a, b]| a.abs().max(b.abs())).collect();
        let negative = |b: &[Interval]| match b {
            // -λ_min of b Q is the larger of -b λ_min and -b λ_max.
            [only] => {
                let [x, y] = least[0].map(|value| *only * Interval::point(-value));
                Interval::new(x.low.max(y.low), x.high.max(y.high))
            }
            _ => around(b, &bends, |middle| -ends(&sum(middle, &terms, |term| &term.symmetric))[0]),
        };
        let factors: Vec<Node> = terms.iter().map(|term| term.at_share).collect();
        let effort = Self::effort(&terms);
        let all = over_triangle(&self.graph, self.horizon, &factors, effort, size).bound;
        let now = self.over_diagonal(&terms, size).bound;
        let negative = self.over_diagonal(&terms, negative).bound;
        let rounding = OF_EIGENVALUES * bends.iter().sum::<f64>() * now / sizes.iter().sum::<f64>();
        // Without a bound of the rounding (all matrices zero) nothing is negative.
        let destabilizing = if negative > rounding { negative } else { 0.0 };
        KernelNorms { all, now, destabilizing }
    }

    fn effort(terms: &[&Term]) -> Effort {
        let order = terms[0].matrix.nrows();
        match terms.len() {
            1 => Effort::FORMULA,
            _ => Effort {
                tolerance: TOLERANCE,
                boxes: (OPERATIONS / order.pow(3)).clamp(FEWEST_BOXES, MOST_BOXES),
            },
        }
    }

    fn over_diagonal(
        &self,
        terms: &[&Term],
        value: impl Fn(&[Interval]) -> Interval,
    ) -> Extreme<1> {
        let mut factors: Vec<Enclosing> =
            terms.iter().map(|term| self.graph.enclosing(term.now)).collect();
        largest([Interval::new(0.0, self.horizon)], Self::effort(terms), |&[t]| {
            let place = Place::origin().with(Variable::T, t);
            within(&mut factors, &place).map_or(Interval::ALL, |b| value(&b))
        })
    }
}

/// The largest value over 0 ≤ s = σt ≤ t ≤ T of a function of factors in T and Y = σ.
fn over_triangle(
    graph: &Graph,
    horizon: f64,
    factors: &[Node],
    effort: Effort,
    value: impl Fn(&[Interval]) -> Interval,
) -> Extreme<2> {
    let mut factors: Vec<Enclosing> = factors.iter().map(|&b| graph.enclosing(b)).collect();
    let whole = [Interval::new(0.0, horizon), Interval::new(0.0, 1.0)];
    largest(whole, effort, |&[t, share]| {
        let place = Place::origin().with(Variable::T, t).with(Variable::Y, share);
        within(&mut factors, &place).map_or(Interval::ALL, |b| value(&b))
    })
}

/// The ranges of the factors, if all are bounded.
fn within(factors: &mut [Enclosing<'_>], place: &Place) -> Option<Vec<Interval>> {
    let found = factors.iter_mut().map(|factor| factor.over(place));
    found.map(|one| (!one.undefined && one.range.is_finite()).then_some(one.range)).collect()
}

/// A function of Σ b_l Q_l that changes by at most Σ |δb_l| `sizes`_l, over the ranges of the b_l, from its value at their
/// middles.
fn around(b: &[Interval], sizes: &[f64], value: impl Fn(&[f64]) -> f64) -> Interval {
    let middles: Vec<f64> = b.iter().map(|range| range.middle()).collect();
    let radii = b.iter().zip(&middles).map(|(range, m)| (range.high - m).max(m - range.low));
    let radius: f64 = radii.zip(sizes).map(|(radius, size)| radius * size).sum();
    let middle = value(&middles);
    Interval::new(middle - radius, middle + radius)
}

fn sum<'a>(
    factors: &[f64],
    terms: &[&'a Term],
    of: impl Fn(&'a Term) -> &'a DMatrix<f64>,
) -> DMatrix<f64> {
    let mut sum = of(terms[0]) * factors[0];
    for (term, factor) in terms.iter().zip(factors).skip(1) {
        sum += of(term) * *factor;
    }
    sum
}

/// Smallest and largest eigenvalue of a symmetric matrix.
fn ends(matrix: &DMatrix<f64>) -> [f64; 2] {
    let eigenvalues = SymmetricEigen::new(matrix.clone()).eigenvalues;
    [eigenvalues.min(), eigenvalues.max()]
}
