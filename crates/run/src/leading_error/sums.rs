//! A rule's sums over the past of vectors, level by level.

use super::NoConstant;
use super::cells::{Mandel, inner, strains};
use exact::Exact;
use fem::contact::Discretization;
use fem::mesh::Mesh;
use fem::space::quadrature::{Rule, gauss_legendre};
use formula::{BoundProgram, Graph, Node, Program, Variable};
use scene::{Time, TimeGrid, TimeRule};
use vhi::history::TimeGrid as Steps;

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

    /// start + ∫_0^s q(s,τ) u(τ) dτ of a kernel without a power, by Gauss points between uniform cuts and kinks.
    pub(super) fn history(
        &self,
        s: f64,
        kinks: &[f64],
        start: &[f64],
        u: impl Fn(&[f64]) -> Vec<Vec<f64>>,
    ) -> Vec<f64> {
        let mut v = start.to_vec();
        if s > 0.0 {
            let (mut times, mut weights) = (Vec::new(), Vec::new());
            for ends in cuts(s, kinks).windows(2) {
                let half = 0.5 * (ends[1] - ends[0]);
                for (x, weight) in gauss_legendre(POINTS[0]) {
                    times.push(0.5 * (ends[0] + ends[1]) + half * x);
                    weights.push(half * weight);
                }
            }
            let mut factors = [Vec::new()];
            self.at_times(&times).evaluate(s, 0.0, &mut factors);
            for ((u, q), weight) in u(&times).iter().zip(&factors[0]).zip(weights) {
                algebra::linalg::axpy(q * weight, u, &mut v);
            }
        }
        v
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

// Reference integrals for discrete sums, by Gauss rules of two orders on bisected pieces: as accurate as the
// comparison requires, and independent of the quadratures of the exact solution.

/// Points of the rule, and of the weaker one for its error.
const POINTS: [usize; 2] = [10, 6];
/// Allowed error as a share of the difference from the discrete sum: predictions are compared at 1e-2 and 1e-3.
const SHARE: f64 = 1e-5;
/// Rounding of a hundred terms.
const ROUNDING: f64 = 1e-14;
/// Rounds of halving, and the limit of pieces halved.
const ROUNDS: usize = 60;
const MOST: usize = 256;
/// Approximate limit of numbers held at once.
const HELD: usize = 1 << 17;

/// Initial pieces of [0, t].
const PIECES: usize = 8;

/// Cuts of [0, t]: uniform ones, and the `places` where f has a kink, since a kink near the end of a piece is beyond
/// the last points of both rules.
pub(super) fn cuts(t: f64, places: &[f64]) -> Vec<f64> {
    let mut cuts: Vec<f64> = (0..=PIECES).map(|i| t * i as f64 / PIECES as f64).collect();
    cuts.extend(places.iter().copied().filter(|&place| place > 0.0 && place < t));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    cuts
}

/// ∫_0^t (t-s)^{-a} f(s) ds, 0 ≤ a < 1, of vectors, with cuts of [0, t]: in r = (t-s)^{1-a}, where the kernel is
/// constant.
pub(super) fn integral_against(
    a: f64,
    cuts: &[f64],
    discrete: &[f64],
    mut f: impl FnMut(&[f64]) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let t = cuts.last().copied().unwrap_or(0.0);
    if a == 0.0 {
        return integral(cuts, discrete, f);
    }
    let in_r: Vec<f64> = cuts.iter().rev().map(|s| (t - s).powf(1.0 - a)).collect();
    integral(&in_r, discrete, |places| {
        let stretch = 1.0 / (1.0 - a);
        let times: Vec<f64> = places.iter().map(|r| (t - r.powf(stretch)).max(0.0)).collect();
        let mut values = f(&times);
        values.iter_mut().flatten().for_each(|value| *value *= stretch);
        values
    })
}

/// ∫ f between the first and the last cut, as vectors; `f` gives one for each time of a list. `discrete` is the sum
/// that the integral is compared with.
pub(super) fn integral(
    cuts: &[f64],
    discrete: &[f64],
    mut f: impl FnMut(&[f64]) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let rules = POINTS.map(gauss_legendre);
    let count = POINTS[0] + POINTS[1];
    let mut pending: Vec<[f64; 2]> = cuts.windows(2).map(|ends| [ends[0], ends[1]]).collect();
    let mut done = vec![0.0; discrete.len()];
    for round in 0.. {
        let (mut total, mut size) = (done.clone(), 0.0_f64);
        let mut found = Vec::with_capacity(pending.len());
        for pieces in pending.chunks((HELD / (count * discrete.len().max(1))).max(1)) {
            let all = || rules.iter().copied().flatten();
            let place = |[from, to]: &[f64; 2], x: f64| 0.5 * (from + to) + 0.5 * (to - from) * x;
            let times: Vec<f64> =
                pieces.iter().flat_map(|ends| all().map(move |(x, _)| place(ends, *x))).collect();
            for (ends, values) in pieces.iter().zip(f(&times).chunks(count)) {
                let (strong, weak) = values.split_at(POINTS[0]);
                let half = 0.5 * (ends[1] - ends[0]);
                let [strong_sum, weak_sum] =
                    [(strong, &rules[0]), (weak, &rules[1])].map(|(values, rule)| {
                        let mut sum = vec![0.0; discrete.len()];
                        for (value, (_, weight)) in values.iter().zip(*rule) {
                            algebra::linalg::axpy(half * weight, value, &mut sum);
                        }
                        sum
                    });
                let largest = strong.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
                size += half * largest;
                algebra::linalg::axpy(1.0, &strong_sum, &mut total);
                let error = apart(&strong_sum, &weak_sum);
                found.push((*ends, strong_sum, error));
            }
        }
        let allowed = SHARE * apart(&total, discrete) + ROUNDING * size;
        let mut next = Vec::new();
        for (ends, strong_sum, error) in found {
            let middle = 0.5 * (ends[0] + ends[1]);
            // Bisection does not help where values are not finite.
            if error > allowed && middle > ends[0] && middle < ends[1] {
                next.extend([[ends[0], middle], [middle, ends[1]]]);
            } else {
                algebra::linalg::axpy(1.0, &strong_sum, &mut done);
            }
        }
        if next.is_empty() {
            break;
        }
        if round == ROUNDS || next.len() > MOST {
            return total;
        }
        pending = next;
    }
    done
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

// Times of a scene's grid, and weights of its rule, independent of those of the solver.

/// t_0, …, t_N. A random grid is defined by its generator, which is shared.
pub(super) fn times(time: &Time, steps: u32) -> Vec<f64> {
    let share = |j: u32| f64::from(j) / f64::from(steps);
    match time.grid {
        TimeGrid::Uniform => (0..=steps).map(|j| time.horizon * share(j)).collect(),
        TimeGrid::Graded { exponent } => {
            (0..=steps).map(|j| time.horizon * share(j).powf(exponent)).collect()
        }
        TimeGrid::Random { seed } => Steps::random(time.horizon, steps, seed).times().to_vec(),
    }
}

pub(super) fn largest_step(times: &[f64]) -> f64 {
    times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max)
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Weights {
    /// Half of each adjacent step.
    Trapezoid,
    /// The step after t_j.
    Left,
    /// The step before t_j.
    Right,
    /// Gregory's rule of this order, on equal steps.
    Gregory(&'static Table),
    /// The weights of v interpolated linearly and integrated against (t - s)^{-a}.
    Power(f64),
}

/// Weights in units of the step.
#[derive(Debug)]
pub(super) struct Table {
    /// Of sums over 1, 2, … steps, as (numerator, denominator).
    first: &'static [&'static [(i8, i8)]],
    /// Of longer sums, from either end; 1 between.
    end: &'static [(i8, i8)],
}

const THREE: Table =
    Table { first: &[&[(1, 2), (1, 2)], &[(5, 12), (7, 6), (5, 12)]], end: &[(5, 12), (13, 12)] };
const FOUR: Table = Table {
    first: &[
        &[(1, 2), (1, 2)],
        &[(1, 3), (4, 3), (1, 3)],
        &[(3, 8), (9, 8), (9, 8), (3, 8)],
        &[(3, 8), (7, 6), (11, 12), (7, 6), (3, 8)],
    ],
    end: &[(3, 8), (7, 6), (23, 24)],
};

impl Table {
    /// The weight of t_j in a sum over n unit steps.
    fn at(&self, n: usize, j: usize) -> f64 {
        if n == 0 {
            return 0.0;
        }
        let from_end = j.min(n - j);
        let found = match self.first.get(n - 1) {
            Some(row) => row.get(j),
            None => self.end.get(from_end),
        };
        found.map_or(1.0, |&(over, under)| f64::from(over) / f64::from(under))
    }
}

impl Weights {
    /// The weights of a rule, if independent of the kernel.
    ///
    /// # Errors
    /// [`NoConstant::Rule`].
    pub(super) fn of(rule: TimeRule) -> Result<Self, NoConstant> {
        match rule {
            TimeRule::Trapezoid => Ok(Self::Trapezoid),
            TimeRule::Left => Ok(Self::Left),
            TimeRule::Right => Ok(Self::Right),
            TimeRule::Gregory { order: 3 } => Ok(Self::Gregory(&THREE)),
            TimeRule::Gregory { .. } => Ok(Self::Gregory(&FOUR)),
            _ => Err(NoConstant::Rule),
        }
    }

    /// The weights for the values of b v under a kernel (t - s)^{-a} b(t, s).
    ///
    /// # Errors
    /// [`NoConstant::Rule`] if they depend on b.
    pub(super) fn of_kernel(rule: TimeRule, a: f64) -> Result<Self, NoConstant> {
        match rule {
            TimeRule::ProductIntegration if a > 0.0 => Ok(Self::Power(a)),
            _ => Self::of(rule),
        }
    }

    pub(super) fn of_plain(rule: TimeRule) -> Result<Self, NoConstant> {
        match rule {
            TimeRule::ProductIntegration => Ok(Self::Trapezoid),
            _ => Self::of(rule),
        }
    }

    /// The weight of t_j in the sum up to t_n.
    pub(super) fn at(self, times: &[f64], n: usize, j: usize) -> f64 {
        let before = if j > 0 { times[j] - times[j - 1] } else { 0.0 };
        let after = if j < n { times[j + 1] - times[j] } else { 0.0 };
        match self {
            Self::Trapezoid => 0.5 * (before + after),
            Self::Left => after,
            Self::Right => before,
            Self::Gregory(table) => {
                table.at(n, j) * times[times.len() - 1] / (times.len() - 1) as f64
            }
            Self::Power(a) => by_power(a, times, n, j),
        }
    }

    /// Whether the weight of t_j, j < n, is equal in the sums up to all t_n.
    pub(super) fn are_fixed(self) -> bool {
        !matches!(self, Self::Gregory(_) | Self::Power(_))
    }
}

/// ∫ (t_n - s)^{-a} φ_j(s) ds as the second difference of Φ(λ) = λ^{2-a}/((1-a)(2-a)): 8 digits on the grids of scenes,
/// where a prediction needs 4.
fn by_power(a: f64, times: &[f64], n: usize, j: usize) -> f64 {
    let lag = |i: usize| times[n] - times[i];
    let bend = |i: usize| lag(i).powf(2.0 - a) / ((1.0 - a) * (2.0 - a));
    let slope = |i: usize| (bend(i + 1) - bend(i)) / (times[i + 1] - times[i]);
    if n == 0 {
        return 0.0;
    }
    // φ_0 has no rising side, φ_n no falling one: there Φ' = λ^{1-a}/(1-a) and 0 replace the slope.
    let after = if j < n { slope(j) } else { 0.0 };
    let before = if j > 0 { slope(j - 1) } else { -lag(0).powf(1.0 - a) / (1.0 - a) };
    after - before
}

// Exact histories of I_h u for the prediction, integrated independently, so that errors in the histories of the
// exact solution show.

/// ∫_0^t b_i(t-s) u(s) ds at the nodes, and ζ(t) = ∫_0^t ‖ε(I_h u(s))‖ ds, advanced from one time to the next.
pub(super) struct OwnHistory<'a, const S: usize> {
    space: &'a Discretization,
    u: BoundProgram,
    kernels: &'a [Kernel],
    t: f64,
    /// ∫_0^t exp(-c (t-s)) u(s) ds of all exponentials in turn, then ζ if needed.
    carried: Vec<f64>,
    rates: Vec<f64>,
    with_zeta: bool,
    /// For kernels without recursion: guards of u at the nodes, and their values at t.
    guards: Option<(BoundProgram, Vec<Vec<f64>>)>,
    /// The ends of steps in which one of these changes sign.
    kinked: Vec<f64>,
}

impl<'a, const S: usize> OwnHistory<'a, S> {
    /// The history of `exact` at t = 0.
    pub(super) fn new(
        exact: &Exact,
        space: &'a Discretization,
        kernels: &'a [Kernel],
        with_zeta: bool,
    ) -> Self {
        let graph = exact.data.graph.clone();
        let program = Program::compile(&graph, &exact.data.u, exact.data.horizon);
        let points = points_of_nodes(space);
        let terms = kernels.iter().flat_map(Kernel::exponentials);
        let rates: Vec<f64> = terms.map(|&(_, rate)| rate).collect();
        let carried = vec![0.0; rates.len() * space.nodes.len() + usize::from(with_zeta)];
        let guards = graph.guards(&exact.data.u);
        let guards = kernels.iter().any(Kernel::is_direct).then(|| {
            let mut values = vec![Vec::new(); guards.len()];
            let program = Program::compile(&graph, &guards, exact.data.horizon);
            let mut bound = program.bind(&points);
            bound.evaluate(0.0, 0.0, &mut values);
            (bound, values)
        });
        let (u, kinked) = (program.bind(&points), Vec::new());
        Self { space, u, kernels, t: 0.0, carried, rates, with_zeta, guards, kinked }
    }

    pub(super) fn displacement(&mut self, t: f64) -> Vec<f64> {
        nodal(&mut self.u, self.space, t)
    }

    pub(super) fn advance(&mut self, to: f64) {
        let Self { space, u, rates, carried, with_zeta, t: from, guards, kinked, .. } = self;
        if let Some((bound, before)) = guards {
            let mut values = vec![Vec::new(); before.len()];
            bound.evaluate(to, 0.0, &mut values);
            let pairs = before.iter().flatten().zip(values.iter().flatten());
            if pairs.into_iter().any(|(a, b)| (*a > 0.0) != (*b > 0.0)) {
                kinked.extend([*from, to]);
            }
            *before = values;
        }
        if carried.is_empty() {
            *from = to;
            return;
        }
        let mut f = |times: &[f64]| -> Vec<Vec<f64>> {
            let at = |&s: &f64| {
                let u = nodal(u, space, s);
                let faded = |rate: &f64| (-rate * (to - s)).exp();
                let mut all: Vec<f64> =
                    rates.iter().flat_map(|rate| u.iter().map(|u| faded(rate) * u)).collect();
                if *with_zeta {
                    let strain: Vec<Mandel<S>> = strains(space, &u);
                    all.push(inner(space, &strain, &strain).sqrt());
                }
                all
            };
            times.iter().map(at).collect()
        };
        let step = to - *from;
        let ends = f(&[*from, to]);
        let trapezoid: Vec<f64> =
            ends[0].iter().zip(&ends[1]).map(|(a, b)| 0.5 * step * (a + b)).collect();
        let added = integral(&[*from, to], &trapezoid, f);
        for (values, rate) in carried.chunks_mut(space.nodes.len()).zip(&*rates) {
            values.iter_mut().for_each(|value| *value *= (-rate * step).exp());
        }
        algebra::linalg::axpy(1.0, &added, carried);
        *from = to;
    }

    /// ∫_0^t b(t-s) u(s) ds of one kernel; `discrete` is the corresponding sum.
    pub(super) fn remembered(&mut self, term: usize, discrete: &[f64]) -> Vec<f64> {
        let (kernel, length) = (&self.kernels[term], self.space.nodes.len());
        if kernel.is_direct() {
            let (u, space) = (&mut self.u, self.space);
            let mut at = |&s: &f64| nodal(u, space, s);
            let v = |times: &[f64]| times.iter().map(&mut at).collect();
            return kernel.integral(self.t, &self.kinked, discrete, v);
        }
        let before: usize = self.kernels[..term].iter().map(|k| k.exponentials().len()).sum();
        let mut sum = vec![0.0; length];
        for ((a, _), values) in
            kernel.exponentials().iter().zip(self.carried.chunks(length).skip(before))
        {
            algebra::linalg::axpy(*a, values, &mut sum);
        }
        sum
    }

    /// ζ(t); 0 if not needed.
    pub(super) fn zeta(&self) -> f64 {
        self.carried.last().copied().filter(|_| self.with_zeta).unwrap_or(0.0)
    }
}

/// The points of a rule, cell by cell.
pub(super) fn points_of_cells(mesh: &Mesh, rule: &Rule) -> Vec<[f64; 3]> {
    (0..mesh.cell_count())
        .flat_map(|c| rule.points.iter().map(move |b| mesh.point(mesh.cell(c), b)))
        .collect()
}

pub(super) fn points_of_nodes(space: &Discretization) -> Vec<[f64; 3]> {
    space.nodes.vertex.iter().map(|&vertex| space.mesh.point(&[vertex], &[1.0])).collect()
}

/// A field at the nodes as a nodal vector.
pub(super) fn nodal(bound: &mut BoundProgram, space: &Discretization, t: f64) -> Vec<f64> {
    let d = space.mesh.dimension;
    let mut fields = vec![Vec::new(); d];
    bound.evaluate(t, 0.0, &mut fields);
    let mut all = vec![0.0; space.nodes.len()];
    for (i, field) in fields.iter().enumerate() {
        all[i..].iter_mut().step_by(d).zip(field).for_each(|(at, value)| *at = *value);
    }
    all
}

#[cfg(test)]
mod tests {
    mod sums {
        use super::super::*;
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
                        assert!(
                            (sums.current_weight(i) - current).abs() < 1e-15,
                            "{text}: {current}"
                        );
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

    mod adaptive {
        use super::super::{cuts, integral, integral_against};

        /// Powers and kinks to the allowed share; smooth functions to rounding at once.
        #[test]
        fn integrals_are_as_good_as_the_comparison_asks_for() {
            let one = |f: &dyn Fn(f64) -> f64, discrete: f64| {
                integral(&[0.0, 1.0], &[discrete], |times| {
                    times.iter().map(|&s| vec![f(s)]).collect()
                })[0]
            };
            for power in [0.1, 0.3, 0.6, 0.9] {
                let (exact, found) = (1.0 / (1.0 + power), one(&|s| s.powf(power), 0.5));
                assert!((found - exact).abs() < 1e-4 * (exact - 0.5), "{power}: {found}");
            }
            let kink = one(&|s| (s - 0.3_f64).abs(), 0.5);
            assert!((kink - 0.29).abs() < 1e-4 * 0.21, "{kink}");
            assert!((one(&f64::exp, 1.859) - 1f64.exp_m1()).abs() < 1e-14);
            assert!(one(&|_| f64::NAN, 1.0).is_nan());
        }

        /// ∫_0^t (t-s)^{-a} s^a ds = t πa/sin πa: infinite at one end, a root at the other.
        #[test]
        fn powers_at_both_ends_are_integrated() {
            let t = 0.7;
            for a in [0.3f64, 0.5, 0.9] {
                let exact = t * std::f64::consts::PI * a / (std::f64::consts::PI * a).sin();
                let f = |times: &[f64]| times.iter().map(|s| vec![s.powf(a)]).collect();
                let found = integral_against(a, &cuts(t, &[]), &[exact + 1e-3], f)[0];
                assert!((found - exact).abs() < 1e-7, "{a}: {found} {exact}");
            }
        }

        /// A kink just inside the end of a piece, where neither rule has a point, must be a cut. Kernels with a root at the
        /// other end need none.
        #[test]
        fn kinks_near_the_end_of_a_piece_are_cut_off() {
            let (steps, place) = (256, 0.361_803);
            let [mut plain, mut cut] = [0.0_f64; 2];
            for n in 8..=steps {
                let t = f64::from(n) / f64::from(steps);
                let f = |s: f64| (t - s).max(0.0).sqrt() + (s - place).abs();
                let k = 1.0 / f64::from(steps);
                let inner: f64 = (1..n).map(|j| f(f64::from(j) * k)).sum();
                let discrete = k * (inner + 0.5 * (f(0.0) + f(t)));
                let rest = (t - place) * (t - place).abs();
                let exact = t.powf(1.5) / 1.5 + 0.5 * (place * place + rest);
                let off = |places: &[f64]| {
                    let values = |times: &[f64]| times.iter().map(|&s| vec![f(s)]).collect();
                    let found = integral(&cuts(t, places), &[discrete], values)[0];
                    (found - exact).abs() / (discrete - exact).abs()
                };
                plain = plain.max(off(&[]));
                cut = cut.max(off(&[place]));
            }
            assert!(cut < 1e-3 && plain > 1e-2, "{cut:e} {plain:e}");
        }
    }

    mod time {
        use super::super::*;

        #[test]
        fn weights_integrate_what_the_rules_are_made_for_on_any_grid() {
            let times = [0.0, 0.1, 0.35, 0.5, 0.9];
            for n in 0..times.len() {
                let sum = |rule: Weights, slope: f64| -> f64 {
                    (0..=n).map(|j| rule.at(&times, n, j) * (1.0 + slope * times[j])).sum()
                };
                let line = times[n] + 0.5 * times[n] * times[n];
                assert!((sum(Weights::Trapezoid, 1.0) - line).abs() < 1e-15);
                assert!((sum(Weights::Left, 0.0) - times[n]).abs() < 1e-15);
                let missed: f64 = times[..=n].windows(2).map(|k| 0.5 * (k[1] - k[0]).powi(2)).sum();
                assert!((sum(Weights::Left, 1.0) + missed - line).abs() < 1e-15);
                assert!((sum(Weights::Right, 0.0) - times[n]).abs() < 1e-15);
                assert!((sum(Weights::Right, 1.0) - missed - line).abs() < 1e-15);
            }
            let times: Vec<f64> = (0..12).map(|j| 0.25 * f64::from(j)).collect();
            for (rule, degree) in [(Weights::Gregory(&THREE), 1), (Weights::Gregory(&FOUR), 3)] {
                for n in 0..12 {
                    let degree = if n == 1 { 1 } else { degree };
                    let sum: f64 =
                        (0..=n).map(|j| rule.at(&times, n, j) * times[j].powi(degree)).sum();
                    let full = times[n].powi(degree + 1) / f64::from(degree + 1);
                    assert!((sum - full).abs() < 1e-13, "{n}: {sum} {full}");
                }
            }
            for n in 0..12 {
                let sum = |v: fn(f64) -> f64| -> f64 {
                    (0..=n).map(|j| Weights::Power(0.6).at(&times, n, j) * v(times[j])).sum()
                };
                let (one, line) = (times[n].powf(0.4) / 0.4, times[n].powf(1.4) / 0.56);
                assert!((sum(|_| 1.0) - one).abs() < 1e-13 && (sum(|s| s) - line).abs() < 1e-13);
            }
            let times = [0.0, 0.1, 0.35, 0.5, 0.9];
            assert!((largest_step(&times) - 0.4).abs() < 1e-15);
        }
    }
}
