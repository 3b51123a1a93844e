//! A rule's sums over the past of vectors: the times of a scene's grid, and weights that are independent of the solver's.

use super::NoConstant;
use algebra::linalg::axpy;
use formula::{Graph, Node, Program, Variable};
use scene::{Time, TimeGrid, TimeRule};
use vhi::history::TimeGrid as Steps;

/// The kernel (t-s)^{-a} q(t,s), 0 ≤ a < 1, of a term of the memory with the weights of its sums.
pub(super) struct Kernel {
    /// q(t, x).
    factor: Program,
    weights: Weights,
}

/// Values and errors, summed in parallel.
pub(super) type Pair<T> = [T; 2];

impl Kernel {
    /// Of the formula q in t and x, the place of s.
    ///
    /// # Errors
    /// [`NoConstant::Rule`].
    pub(super) fn new(
        graph: &Graph,
        (rule, power): (TimeRule, f64),
        q: Node,
        horizon: f64,
    ) -> Result<Self, NoConstant> {
        let factor = Program::compile(graph, &[q], horizon);
        Ok(Self { factor, weights: Weights::of_kernel(rule, power)? })
    }

    /// Of the formula c with q(t,s) = c(t-s).
    ///
    /// # Errors
    /// [`NoConstant::Rule`].
    pub(super) fn of_lag(
        graph: &mut Graph,
        rule: (TimeRule, f64),
        c: Node,
        horizon: f64,
    ) -> Result<Self, NoConstant> {
        let (t, x) = (graph.variable(Variable::T), graph.variable(Variable::X));
        let lag = graph.sub(t, x);
        let q = graph.substitute(c, Variable::T, lag);
        Self::new(graph, rule, q, horizon)
    }

    /// q = 1 with the weights of plain integrals.
    ///
    /// # Errors
    /// [`NoConstant::Rule`].
    pub(super) fn one(graph: &mut Graph, rule: TimeRule, horizon: f64) -> Result<Self, NoConstant> {
        let one = graph.constant(1.0);
        let factor = Program::compile(graph, &[one], horizon);
        let weights = match rule {
            TimeRule::ProductIntegration => Weights::Trapezoid,
            _ => Weights::of(rule)?,
        };
        Ok(Self { factor, weights })
    }

    /// Σ_{j<n} w_nj q(t_n, t_j) v_j of the levels v_0, …, v_{n-1}, pairs of vectors of some length, and the weight w_nn
    /// q(t_n, t_n) of the level itself.
    pub(super) fn sums(
        &self,
        times: &[f64],
        levels: &[Pair<Vec<f64>>],
        length: usize,
    ) -> (Pair<Vec<f64>>, f64) {
        let n = levels.len();
        let places: Vec<[f64; 3]> = times[..=n].iter().map(|&s| [s, 0.0, 0.0]).collect();
        let q = self.factor.values(&places, times[n], 0.0).swap_remove(0);
        // A kernel may be infinite where it has no weight.
        let weight = |j: usize| match self.weights.at(times, n, j) {
            0.0 => 0.0,
            weight => weight * q[j],
        };
        let mut sums = [vec![0.0; length], vec![0.0; length]];
        for (j, level) in levels.iter().enumerate() {
            let weight = weight(j);
            level.iter().zip(&mut sums).for_each(|(vector, sum)| axpy(weight, vector, sum));
        }
        (sums, weight(n))
    }
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

#[cfg(test)]
mod tests {
    use super::*;

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
                let sum: f64 = (0..=n).map(|j| rule.at(&times, n, j) * times[j].powi(degree)).sum();
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

    /// Of a kernel that is a root at s = t, against the definition, on a grid of very different steps.
    #[test]
    fn sums_are_those_of_the_definition() {
        let times = [0.0, 0.02, 0.5, 0.6, 0.61, 1.3];
        let mut graph = Graph::new();
        let c = graph.parse("sqrt(t) - exp(-t)", &formula::Scope::new(&[Variable::T])).unwrap();
        let of = |lag: f64| lag.sqrt() - (-lag).exp();
        let levels = |t: f64| [vec![1.0 - t, (3.0 * t).sin()], vec![t * t, 2.0]];
        for rule in [TimeRule::Trapezoid, TimeRule::Left, TimeRule::Gregory { order: 4 }] {
            let kernel = Kernel::of_lag(&mut graph, (rule, 0.0), c, 1.3).unwrap();
            for n in 0..times.len() {
                let past: Vec<_> = times[..n].iter().map(|&t| levels(t)).collect();
                let (sums, last) = kernel.sums(&times, &past, 2);
                let weight = |j: usize| kernel.weights.at(&times, n, j) * of(times[n] - times[j]);
                assert!((last - weight(n)).abs() < 1e-15, "{last}");
                for (which, part) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let plain: f64 = (0..n).map(|j| weight(j) * past[j][which][part]).sum();
                    // Sums of size one.
                    assert!((sums[which][part] - plain).abs() < 1e-14, "{plain}");
                }
            }
        }
    }
}
