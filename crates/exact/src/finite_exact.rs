//! The exact solution of Problem 1 in ℝ^m and its load
//!
//! ```text
//! f(t) = M u + g(u) + N(S u, u) + Σ_i w_i (ξ_i + λ_i) a_i,   S u = R(Σ_l Q_l ∫_0^t q_l(t,s) u(s) ds + a_S)
//! ```
//!
//! where a nested term has v(s) = start + ∫_0^s r(s,τ) u(τ) dτ in place of u(s),
//!
//! with histories by double exponential quadrature between the kinks of the integrands.

use super::double_exponential::against_power;
use super::exact::{LawNumbers, law_formula, normal_component};
use super::sign_changes::Guards;
use formula::{EvaluationPoint, Graph, Node, Program, Variable};

/// Defining data; matrices by rows.
pub struct FiniteData {
    pub graph: Graph,
    /// M.
    pub matrix: Vec<Vec<f64>>,
    /// g_i in r, the first space coordinate; empty for linear A.
    pub nonlinear: Vec<Node>,
    pub kernels: Vec<KernelFormulas>,
    /// R.
    pub r: Vec<Vec<f64>>,
    /// a_S.
    pub a_s: Vec<f64>,
    /// v(0) of all nested terms.
    pub start: Vec<f64>,
    /// N_i in y (second space coordinate) and r (first); empty for N(y, u) = y.
    pub force: Vec<Node>,
    pub traces: Vec<FiniteTrace>,
    pub u: Vec<Node>,
    /// T.
    pub horizon: f64,
}

/// (t - s)^{-a} q(t, s) Q.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelFormulas {
    /// q in t and, for s, the first space coordinate.
    pub q: Node,
    /// a, 0 ≤ a < 1.
    pub power: f64,
    /// r in s, kept as t, and τ, kept as the first space coordinate; q is then applied to that history.
    pub inner: Option<Node>,
    /// Q.
    pub matrix: Vec<Vec<f64>>,
}

/// One functional with its multiplier and selection.
pub struct FiniteTrace {
    /// a_i.
    pub functional: Vec<f64>,
    /// w_i.
    pub weight: f64,
    /// ∂j_i.
    pub law: Option<LawNumbers>,
    /// λ_i(t).
    pub multiplier: Option<Node>,
    /// ξ_i(t).
    pub selection: Option<Node>,
}

/// The solution at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteState {
    pub u: Vec<f64>,
    /// (S u)(t).
    pub history: Vec<f64>,
    /// a_i·u per functional.
    pub traces: Vec<f64>,
    /// ξ_i.
    pub selection: Vec<f64>,
    /// λ_i.
    pub multiplier: Vec<f64>,
    /// f(t).
    pub load: Vec<f64>,
}

/// A history that quadrature does not resolve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "the history at t = {t} changes by {change:.1e} when its panels are halved, {panels} of them: the kernel or u varies too fast, or is not finite on [0, t]"
)]
pub struct Unresolved {
    pub t: f64,
    /// Change of the integrals.
    pub change: f64,
    /// Panels of [0, t].
    pub panels: usize,
}

/// The exact solution with its compiled formulas.
pub struct FiniteExact {
    data: FiniteData,
    /// [u, a_i·u, ξ_i, λ_i] in t.
    present: Program,
    /// q_l(t, s) u_j(s), by l, then j, without the power; q_l(t, s) alone if the term is nested.
    integrands: Program,
    /// r_l(t, s) u_j(s), by j, of each nested term.
    inner: Vec<Option<Program>>,
    /// u_j(s).
    past: Program,
    /// Their signs decide the branches of the integrands.
    guards: Guards,
    panels: usize,
}

/// Allowed relative change of a history by halving all panels; the rule itself is exact to 1e-14 on resolved panels.
const RESOLVED: f64 = 1e-12;
/// Limit of halvings.
const HALVINGS: u32 = 9;
/// Intervals of [0, t] in which kinks are sought.
const WATCHES: usize = 64;

impl FiniteExact {
    /// Compiles the formulas and finds how many panels resolve the histories on [0, T].
    pub fn new(mut data: FiniteData) -> Result<Self, Unresolved> {
        let graph = &mut data.graph;
        let s = graph.variable(Variable::X);
        let past: Vec<Node> = data.u.iter().map(|&u| graph.substitute(u, Variable::T, s)).collect();
        let (mut integrands, mut guarded, mut inner) = (Vec::new(), Vec::new(), Vec::new());
        for kernel in &data.kernels {
            let mut times = |q| past.iter().map(|&u| graph.mul(q, u)).collect::<Vec<Node>>();
            let of_q = times(kernel.q);
            let within = kernel.inner.map(times);
            // Kinks of u are kinks of the slope of v.
            guarded.extend(of_q.iter().chain(within.iter().flatten()).copied());
            integrands.extend(if within.is_some() { vec![kernel.q; of_q.len()] } else { of_q });
            inner.push(within);
        }
        let guards = graph.guards(&guarded);
        let mut present = data.u.clone();
        let zero = graph.constant(0.0);
        for trace in &data.traces {
            present.push(normal_component(graph, &data.u, &trace.functional));
        }
        for (i, trace) in data.traces.iter().enumerate() {
            let value = present[data.u.len() + i];
            present.push(match (trace.selection, &trace.law) {
                (Some(selection), _) => selection,
                (None, Some(law)) => law_formula(graph, law, value),
                (None, None) => zero,
            });
        }
        present.extend(data.traces.iter().map(|trace| trace.multiplier.unwrap_or(zero)));
        let horizon = data.horizon;
        let mut exact = Self {
            present: Program::compile(graph, &present, horizon),
            integrands: Program::compile(graph, &integrands, horizon),
            inner: inner
                .into_iter()
                .map(|list| list.map(|list| Program::compile(graph, &list, horizon)))
                .collect(),
            past: Program::compile(graph, &past, horizon),
            guards: Guards::new(graph, &guards, horizon),
            panels: 1,
            data,
        };
        for fraction in [1.0, 0.61, 0.173] {
            exact.resolve(fraction * horizon)?;
        }
        Ok(exact)
    }

    /// ∂j_i of every functional.
    pub fn laws(&self) -> Vec<Option<LawNumbers>> {
        self.data.traces.iter().map(|trace| trace.law.clone()).collect()
    }

    fn resolve(&mut self, t: f64) -> Result<(), Unresolved> {
        let size = |list: &[f64]| list.iter().fold(0f64, |size, v| size.max(v.abs()));
        let mut change = 0.0;
        for _ in 0..HALVINGS {
            let coarse = self.integrals(t, self.panels, 1);
            let fine = self.integrals(t, self.panels, 2);
            let differences: Vec<f64> = coarse.iter().zip(&fine).map(|(a, b)| a - b).collect();
            // NaN is not a small change, and max() would hide it.
            let finite = fine.iter().all(|value| value.is_finite());
            change = if finite { size(&differences) } else { f64::NAN };
            if change <= RESOLVED * size(&fine) {
                return Ok(());
            }
            self.panels *= 2;
        }
        Err(Unresolved { t, change, panels: self.panels })
    }

    /// ∫_0^t (t-s)^{-a_l} q_l(t, s) u_j(s) ds, by l, then j, with each panel between kinks divided into `parts`;
    /// doubling the number of panels instead would repeat them if a kink is halfway.
    fn integrals(&self, t: f64, panels: usize, parts: usize) -> Vec<f64> {
        let (kernels, m) = (&self.data.kernels, self.data.u.len());
        let mut sums = vec![0.0; kernels.len() * m];
        if kernels.is_empty() || t <= 0.0 {
            return sums;
        }
        let cuts = self.cuts(t, panels, parts);
        let mut done: Vec<f64> = Vec::new();
        for power in kernels.iter().map(|kernel| kernel.power) {
            if done.contains(&power) {
                continue;
            }
            done.push(power);
            let rule: Vec<(f64, f64)> = cuts
                .windows(2)
                .flat_map(|ends| against_power(power, t, ends[0], ends[1]))
                .collect();
            let points: Vec<[f64; 3]> = rule.iter().map(|&(s, _)| [s, 0.0, 0.0]).collect();
            let values = self.integrands.values(&points, t, 0.0);
            for (l, _) in kernels.iter().enumerate().filter(|(_, kernel)| kernel.power == power) {
                let inner = self.inner[l].as_ref();
                let inner: Option<Vec<Vec<f64>>> = inner.map(|program| {
                    let at = |&(s, _): &(f64, f64)| self.inner_history(program, s, panels, parts);
                    rule.iter().map(at).collect()
                });
                let of = sums[m * l..m * (l + 1)].iter_mut().zip(&values[m * l..]).enumerate();
                for (j, (sum, list)) in of {
                    let v = |p: usize| inner.as_ref().map_or(1.0, |inner| inner[p][j]);
                    let terms = list.iter().zip(&rule).enumerate();
                    *sum = terms.map(|(p, (value, (_, weight)))| weight * value * v(p)).sum();
                }
            }
        }
        sums
    }

    /// The ends of the panels of [0, t], each between kinks divided into `parts`.
    fn cuts(&self, t: f64, panels: usize, parts: usize) -> Vec<f64> {
        let mut cuts: Vec<f64> = (0..=panels).map(|i| t * i as f64 / panels as f64).collect();
        cuts.extend(self.guards.along([0.0, t], WATCHES, t, |s| [s, 0.0, 0.0]));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| *a - *b <= 1e-13 * t);
        let inner = |ends: &[f64]| {
            let [a, b] = [ends[0], ends[1]];
            (1..parts).map(move |i| a + (b - a) * i as f64 / parts as f64)
        };
        let inner: Vec<f64> = cuts.windows(2).flat_map(inner).collect();
        cuts.extend(inner);
        cuts.sort_by(f64::total_cmp);
        cuts
    }

    /// v(s) = start + ∫_0^s r(s, τ) u(τ) dτ.
    fn inner_history(&self, program: &Program, s: f64, panels: usize, parts: usize) -> Vec<f64> {
        let mut v = self.data.start.clone();
        if s > 0.0 {
            let cuts = self.cuts(s, panels, parts);
            let rule = cuts.windows(2).flat_map(|ends| against_power(0.0, s, ends[0], ends[1]));
            let (points, weights): (Vec<[f64; 3]>, Vec<f64>) =
                rule.map(|(tau, weight)| ([tau, 0.0, 0.0], weight)).unzip();
            for (v, list) in v.iter_mut().zip(program.values(&points, s, 0.0)) {
                *v += dot(&list, &weights);
            }
        }
        v
    }

    /// start + ∫_0^t u ds: of a velocity the displacement.
    pub fn integral(&self, t: f64) -> Vec<f64> {
        self.inner_history(&self.past, t, self.panels, 1)
    }

    /// (S u)(t).
    pub(crate) fn history(&self, t: f64) -> Vec<f64> {
        let (data, m) = (&self.data, self.data.u.len());
        let integrals = self.integrals(t, self.panels, 1);
        let mut sum = data.a_s.clone();
        for (l, kernel) in data.kernels.iter().enumerate() {
            for (i, value) in sum.iter_mut().enumerate() {
                *value += dot(&kernel.matrix[i], &integrals[l * m..(l + 1) * m]);
            }
        }
        data.r.iter().map(|row| dot(row, &sum)).collect()
    }

    /// The solution at time t.
    pub fn at(&self, t: f64) -> FiniteState {
        let (data, m, p) = (&self.data, self.data.u.len(), self.data.traces.len());
        let values = self.present.values(&[[0.0; 3]], t, 0.0);
        let present: Vec<f64> = values.iter().map(|list| list[0]).collect();
        let u = present[..m].to_vec();
        let part = |which: usize| present[m + which * p..m + (which + 1) * p].to_vec();
        let (traces, selection, multiplier) = (part(0), part(1), part(2));
        let history = self.history(t);
        let mut load: Vec<f64> = data.matrix.iter().map(|row| dot(row, &u)).collect();
        for i in 0..m {
            let at = EvaluationPoint { x: u[i], y: history[i], ..EvaluationPoint::default() };
            if let Some(&g) = data.nonlinear.get(i) {
                load[i] += data.graph.evaluate(g, &at);
            }
            load[i] += match data.force.get(i) {
                Some(&force) => data.graph.evaluate(force, &at),
                None => history[i],
            };
        }
        for (i, trace) in data.traces.iter().enumerate() {
            let pressure = trace.weight * (selection[i] + multiplier[i]);
            for (target, a) in load.iter_mut().zip(&trace.functional) {
                *target += pressure * a;
            }
        }
        FiniteState { u, history, traces, selection, multiplier, load }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use formula::Scope;

    /// u = 1 with one kernel q(t, s), s being the first space coordinate.
    fn with(q: &str) -> Result<FiniteExact, Unresolved> {
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::T]);
        let q = graph.parse(q, &scope).expect("a formula");
        let one = || vec![vec![1.0]];
        let kernels = vec![KernelFormulas { q, power: 0.0, inner: None, matrix: one() }];
        let start = vec![0.0];
        let u = vec![graph.constant(1.0)];
        let (matrix, r, a_s) = (one(), one(), vec![0.0]);
        let (nonlinear, force, traces) = (Vec::new(), Vec::new(), Vec::new());
        FiniteExact::new(FiniteData {
            graph,
            matrix,
            nonlinear,
            kernels,
            r,
            a_s,
            start,
            force,
            traces,
            u,
            horizon: 1.0,
        })
    }

    /// A kernel without an integral is unresolved even if its kink lies where panels are cut; kinks there alone do no
    /// harm.
    #[test]
    fn a_kink_between_panels_hides_no_divergence() {
        for place in ["t/2", "t/3", "t/4"] {
            let kink = format!("max(x - {place}, 0)");
            let fine = with(&kink).unwrap_or_else(|error| panic!("{error}"));
            let share = 1.0 - 1.0 / f64::from(place.as_bytes()[2] - b'0');
            assert!((fine.history(1.0)[0] - 0.5 * share * share).abs() < 1e-14, "{place}");
            // At s = 0, where all places of the rule are finite.
            let divergent = with(&format!("max({place} - x, 0)/x^1.2"));
            assert!(
                divergent.is_err(),
                "{place}: {:?}",
                divergent.map(|solution| solution.history(1.0))
            );
        }
    }
}
