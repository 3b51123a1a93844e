//! ζ(t) = ∫_0^t ‖ε(u(s))‖_ℋ ds of an exact solution, to about 1e-12.
//!
//! ε is piecewise smooth: its guards (expressions whose sign decides a branch) vanish on moving
//! lines. The integral over Ω is cut where a guard changes sign along x, the integral over time
//! where a guard changes sign at an end of Ω. Pieces take Gauss-Legendre rules.

use std::sync::Mutex;

use crate::formula::{Graph, Node, Program, Variable};
use crate::space::quadrature::gauss_legendre;

/// Panels of the horizon; the value at t does not depend on which other times were asked for.
const PANELS: usize = 16;
/// Gauss points a piece of a time panel; with smooth pieces of T/16 the error is below 1e-14.
const TIME_POINTS: usize = 8;
/// Gauss points a piece in x and y. A quarter of the domain with 14 points resolves sin(4πx)
/// squared to rounding.
const SPACE_POINTS: usize = 14;
/// Pieces of the domain in x and in y before cuts at guards.
const SPACE_PIECES: usize = 3;
/// Intervals in which sign changes of guards are looked for.
const WATCHES: usize = 48;

/// ζ(t) by quadrature.
pub struct AccumulatedStrain {
    /// [ε], upper components; `None` where nothing depends on ζ.
    integrand: Option<Integrand>,
    horizon: f64,
    /// ζ at panel ends, grown on demand.
    panels: Mutex<Vec<f64>>,
}

struct Integrand {
    strain: Program,
    guards: Program,
    guard_count: usize,
    /// Weight of each strain component in ‖ε‖².
    weights: Vec<f64>,
    size: [f64; 2],
}

impl AccumulatedStrain {
    /// ζ of the strain formulas; `needed` is false where no term uses it (then ζ reads NaN).
    pub fn new(
        graph: &mut Graph,
        strain: &[Node],
        horizon: f64,
        size: [f64; 2],
        needed: bool,
    ) -> Self {
        let integrand = needed.then(|| {
            let guards: Vec<Node> = graph
                .guards(strain)
                .into_iter()
                .filter(|&guard| {
                    graph.depends_on(guard, Variable::X) || graph.depends_on(guard, Variable::T)
                })
                .collect();
            Integrand {
                strain: Program::compile(graph, strain, horizon),
                guard_count: guards.len(),
                guards: Program::compile(graph, &guards, horizon),
                weights: super::symbolic::components(2)
                    .into_iter()
                    .map(|(i, j)| if i == j { 1.0 } else { 2.0 })
                    .collect(),
                size,
            }
        });
        Self { integrand, horizon, panels: Mutex::new(vec![0.0]) }
    }

    /// ζ(t); NaN if it was declared as not needed.
    pub fn at(&self, t: f64) -> f64 {
        let Some(integrand) = &self.integrand else { return f64::NAN };
        let width = self.horizon / PANELS as f64;
        let panel = ((t / width) as usize).min(PANELS - 1);
        let mut ends = self.panels.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        while ends.len() <= panel {
            let p = ends.len();
            let piece = integrand.over_time(width * (p - 1) as f64, width * p as f64);
            let value = ends[p - 1] + piece;
            ends.push(value);
        }
        ends[panel] + integrand.over_time(width * panel as f64, t)
    }

    /// ‖ε(u(t))‖; NaN if it was declared as not needed.
    pub fn strain_norm(&self, t: f64) -> f64 {
        self.integrand.as_ref().map_or(f64::NAN, |integrand| integrand.norm(t))
    }
}

impl Integrand {
    fn over_time(&self, from: f64, to: f64) -> f64 {
        if to <= from {
            return 0.0;
        }
        let mut cuts = vec![from, to];
        for x in [0.0, self.size[0]] {
            let along = |s: f64, out: &mut Vec<f64>| self.guards_at(&[[x, 0.0, 0.0]], s, out);
            cuts.extend(sign_changes(from, to, 8, self.guard_count, along));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * (to - from));
        let rule = gauss_legendre(TIME_POINTS);
        let mut sum = 0.0;
        for pair in cuts.windows(2) {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            for (x, w) in &rule {
                sum += half * w * self.norm(middle + half * x);
            }
        }
        sum
    }

    /// ‖ε(u(t))‖_ℋ.
    fn norm(&self, t: f64) -> f64 {
        let xs = pieces(&self.cuts_in_x(t));
        let ys = pieces(&uniform_cuts(self.size[1]));
        let points: Vec<[f64; 3]> =
            xs.iter().flat_map(|(x, _)| ys.iter().map(move |(y, _)| [*x, *y, 0.0])).collect();
        let mut out = vec![Vec::new(); self.weights.len()];
        self.strain.bind(&points).evaluate(t, 0.0, &mut out);
        let mut sum = 0.0;
        for (i, (_, wx)) in xs.iter().enumerate() {
            let mut column = 0.0;
            for (j, (_, wy)) in ys.iter().enumerate() {
                let p = i * ys.len() + j;
                let squares: f64 =
                    out.iter().zip(&self.weights).map(|(e, w)| w * e[p] * e[p]).sum();
                column += wy * squares;
            }
            sum += wx * column;
        }
        sum.sqrt()
    }

    /// Cuts of (0, a) where a guard changes sign at time t, or did at time 0: the relaxation
    /// integrals keep a kink where a zone began.
    fn cuts_in_x(&self, t: f64) -> Vec<f64> {
        let width = self.size[0];
        let mut cuts = uniform_cuts(width);
        for time in [t, 0.0] {
            let along = |x: f64, out: &mut Vec<f64>| self.guards_at(&[[x, 0.0, 0.0]], time, out);
            cuts.extend(sign_changes(0.0, width, WATCHES, self.guard_count, along));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * width);
        cuts
    }

    fn guards_at(&self, points: &[[f64; 3]], t: f64, out: &mut Vec<f64>) {
        let mut values = vec![Vec::new(); self.guard_count];
        self.guards.bind(points).evaluate(t, 0.0, &mut values);
        out.clear();
        out.extend(values.iter().map(|v| v[0]));
    }
}

fn uniform_cuts(length: f64) -> Vec<f64> {
    (0..=SPACE_PIECES).map(|i| length * i as f64 / SPACE_PIECES as f64).collect()
}

/// Gauss points and weights on the pieces between cuts.
fn pieces(cuts: &[f64]) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(SPACE_POINTS);
    let mut out = Vec::new();
    for pair in cuts.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        out.extend(rule.iter().map(|(x, w)| (middle + half * x, half * w)));
    }
    out
}

/// Places in (from, to) where one of `count` functions changes sign, by bisection to rounding.
pub fn sign_changes(
    from: f64,
    to: f64,
    watches: usize,
    count: usize,
    values: impl Fn(f64, &mut Vec<f64>),
) -> Vec<f64> {
    if count == 0 {
        return Vec::new();
    }
    let (mut before, mut after) = (Vec::new(), Vec::new());
    let mut roots = Vec::new();
    let place = |i: usize| from + (to - from) * i as f64 / watches as f64;
    values(from, &mut before);
    for i in 1..=watches {
        values(place(i), &mut after);
        for g in 0..count {
            if (before[g] < 0.0) != (after[g] < 0.0) {
                roots.push(bisect(place(i - 1), place(i), before[g] < 0.0, |s| {
                    let mut at = Vec::new();
                    values(s, &mut at);
                    at[g]
                }));
            }
        }
        std::mem::swap(&mut before, &mut after);
    }
    roots
}

fn bisect(mut low: f64, mut high: f64, negative: bool, value: impl Fn(f64) -> f64) -> f64 {
    // 52 halvings exhaust the digits of an f64.
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if (value(middle) < 0.0) == negative {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
