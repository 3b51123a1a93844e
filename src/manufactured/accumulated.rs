//! ζ(t) = ∫_0^t ‖ε(u(s))‖_ℋ ds of an exact solution, to about 1e-12.
//!
//! ε is piecewise smooth: its guards (expressions whose sign decides a branch) vanish on moving
//! lines. The integral over Ω is cut where a guard changes sign along x, the integral over time
//! where a guard changes sign at an end of Ω. Pieces take Gauss-Legendre rules.

use super::running_integral::RunningIntegral;
use super::sign_changes::sign_changes;
use crate::formula::{Graph, Node, Program, Variable};
use crate::space::quadrature::gauss_legendre;

/// Gauss points a piece and direction, and pieces before cuts at guards, in the plane and in space. A quarter
/// of the domain with 14 points resolves sin(4πx) squared to rounding, half of it with 8 sin(πx) squared.
const PLANE: [usize; 2] = [14, 3];
const SPACE: [usize; 2] = [8, 2];
/// Intervals of the domain, and of a panel in time, in which guards are watched.
const WATCHES: usize = 48;
const TIME_WATCHES: usize = 8;

/// ζ(t) by quadrature.
pub struct AccumulatedStrain {
    /// [ε], upper components; `None` where nothing depends on ζ.
    integrand: Option<Integrand>,
    integral: RunningIntegral,
}

struct Integrand {
    strain: Program,
    guards: Program,
    guard_count: usize,
    /// Weight of each strain component in ‖ε‖².
    weights: Vec<f64>,
    size: Vec<f64>,
    /// Whether ε varies along z; a strain that does not is looked at in one plane.
    along_z: bool,
}

impl AccumulatedStrain {
    /// ζ of the strain formulas; `needed` is false where no term uses it (then ζ reads NaN).
    pub fn new(
        graph: &mut Graph,
        strain: &[Node],
        horizon: f64,
        size: &[f64],
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
                weights: super::symbolic::components(size.len())
                    .into_iter()
                    .map(|(i, j)| if i == j { 1.0 } else { 2.0 })
                    .collect(),
                size: size.to_vec(),
                along_z: strain.iter().any(|&e| graph.depends_on(e, Variable::Z)),
            }
        });
        Self { integrand, integral: RunningIntegral::new(horizon) }
    }

    /// ζ(t); NaN if it was declared as not needed.
    pub fn at(&self, t: f64) -> f64 {
        let Some(integrand) = &self.integrand else { return f64::NAN };
        let value: Result<f64, std::convert::Infallible> =
            self.integral.at(t, |from, to| integrand.events(from, to), |s| Ok(integrand.norm(s)));
        match value {
            Ok(value) => value,
            Err(never) => match never {},
        }
    }

    /// ‖ε(u(t))‖; NaN if it was declared as not needed.
    pub fn strain_norm(&self, t: f64) -> f64 {
        self.integrand.as_ref().map_or(f64::NAN, |integrand| integrand.norm(t))
    }
}

impl Integrand {
    /// Times in (from, to) at which a guard changes sign at an end of the domain.
    fn events(&self, from: f64, to: f64) -> Vec<f64> {
        let ends = [[0.0, 0.0, 0.0], [self.size[0], 0.0, 0.0]];
        let mut events = sign_changes(from, to, TIME_WATCHES, |times| {
            let mut bound = self.guards.bind(&ends);
            let mut values = vec![Vec::new(); self.guard_count];
            let mut rows = vec![Vec::with_capacity(times.len()); 2 * self.guard_count];
            for &t in times {
                bound.evaluate(t, 0.0, &mut values);
                for (g, value) in values.iter().enumerate() {
                    rows[2 * g].push(value[0]);
                    rows[2 * g + 1].push(value[1]);
                }
            }
            rows
        });
        events.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * (to - from));
        events
    }

    /// ‖ε(u(t))‖_ℋ.
    fn norm(&self, t: f64) -> f64 {
        let count = self.rule()[0];
        let xs = pieces(&self.cuts_in_x(t), count);
        let across = |length: f64| pieces(&self.uniform_cuts(length), count);
        let ys = across(self.size[1]);
        let zs = match self.size.get(2) {
            None => vec![(0.0, 1.0)],
            Some(&depth) if self.along_z => across(depth),
            Some(&depth) => vec![(0.5 * depth, depth)],
        };
        let lines = || ys.iter().flat_map(|y| zs.iter().map(move |z| (y, z)));
        let points: Vec<[f64; 3]> = xs
            .iter()
            .flat_map(|(x, _)| lines().map(move |((y, _), (z, _))| [*x, *y, *z]))
            .collect();
        let mut out = vec![Vec::new(); self.weights.len()];
        self.strain.bind(&points).evaluate(t, 0.0, &mut out);
        let mut sum = 0.0;
        for (slice, (_, wx)) in xs.iter().enumerate() {
            let first = slice * ys.len() * zs.len();
            let mut column = 0.0;
            for (p, ((_, wy), (_, wz))) in (first..).zip(lines()) {
                let squares: f64 =
                    out.iter().zip(&self.weights).map(|(e, w)| w * e[p] * e[p]).sum();
                column += wy * wz * squares;
            }
            sum += wx * column;
        }
        sum.sqrt()
    }

    fn rule(&self) -> [usize; 2] {
        if self.size.len() == 2 { PLANE } else { SPACE }
    }

    fn uniform_cuts(&self, length: f64) -> Vec<f64> {
        let count = self.rule()[1];
        (0..=count).map(|i| length * i as f64 / count as f64).collect()
    }

    /// Cuts of (0, a) where a guard changes sign at time t, or did at time 0: the relaxation
    /// integrals keep a kink where a zone began.
    fn cuts_in_x(&self, t: f64) -> Vec<f64> {
        let width = self.size[0];
        let mut cuts = self.uniform_cuts(width);
        for time in [t, 0.0] {
            cuts.extend(sign_changes(0.0, width, WATCHES, |places| {
                let points: Vec<[f64; 3]> = places.iter().map(|&x| [x, 0.0, 0.0]).collect();
                let mut values = vec![Vec::new(); self.guard_count];
                self.guards.bind(&points).evaluate(time, 0.0, &mut values);
                values
            }));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * width);
        cuts
    }
}

/// Gauss points and weights on the pieces between cuts.
fn pieces(cuts: &[f64], count: usize) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(count);
    let mut out = Vec::new();
    for pair in cuts.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        out.extend(rule.iter().map(|(x, w)| (middle + half * x, half * w)));
    }
    out
}
