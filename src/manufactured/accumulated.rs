//! ζ(t) = ∫_0^t ‖ε(u(s))‖_ℋ ds of an exact solution, to about 1e-12.
//!
//! ε is piecewise smooth: its guards (expressions whose sign decides a branch) vanish on moving
//! lines. The integral over Ω is cut where a guard changes sign along x, the integral over time
//! where a guard changes sign at an end of Ω. Pieces take Gauss-Legendre rules.

use std::sync::{Mutex, PoisonError};

use super::running_integral::RunningIntegral;
use super::sign_changes::sign_changes;
use super::simplex_points::SimplexPoints;
use crate::formula::{Bound, Graph, Node, Program, Variable};
use crate::mesh::CoarseMesh;
use crate::space::quadrature::gauss_legendre;

/// Gauss points a piece and direction, and pieces before cuts at guards, in the plane and in space. A quarter
/// of the domain with 14 points resolves sin(4πx) squared to rounding, half of it with 8 sin(πx) squared.
const PLANE: [usize; 2] = [14, 3];
const SPACE: [usize; 2] = [8, 2];
/// Intervals of the domain, and of a panel in time, in which guards are watched.
const WATCHES: usize = 48;
const TIME_WATCHES: usize = 32;

/// ζ(t) by quadrature.
pub struct AccumulatedStrain {
    /// [ε], upper components; `None` where nothing depends on ζ.
    integrand: Option<Integrand>,
    integral: RunningIntegral,
}

struct Integrand {
    strain: Program,
    /// The strain at the points last asked for: where no guard moves they are the same at all times.
    bound: Mutex<Option<(Vec<[f64; 3]>, Bound)>>,
    guards: Program,
    guard_count: usize,
    /// Cuts of (0, height): uniform ones, and where a guard that depends on y alone changes sign.
    cuts_in_y: Vec<f64>,
    /// Weight of each strain component in ‖ε‖².
    weights: Vec<f64>,
    size: Vec<f64>,
    /// Whether ε varies along z; a strain that does not is looked at in one plane.
    along_z: bool,
    /// Points with weights of a domain that is no rectangle or box, and the corners where guards are watched.
    polytope: Option<(SimplexPoints, Vec<[f64; 3]>)>,
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
            let all = graph.guards(strain);
            let cuts_in_y = cuts_in_y(graph, &all, horizon, size[1], rule(size.len())[1]);
            let guards: Vec<Node> = all
                .into_iter()
                .filter(|&guard| {
                    graph.depends_on(guard, Variable::X) || graph.depends_on(guard, Variable::T)
                })
                .collect();
            Integrand {
                strain: Program::compile(graph, strain, horizon),
                bound: Mutex::new(None),
                cuts_in_y,
                guard_count: guards.len(),
                guards: Program::compile(graph, &guards, horizon),
                weights: super::symbolic::components(size.len())
                    .into_iter()
                    .map(|(i, j)| if i == j { 1.0 } else { 2.0 })
                    .collect(),
                size: size.to_vec(),
                along_z: strain.iter().any(|&e| graph.depends_on(e, Variable::Z)),
                polytope: None,
            }
        });
        Self { integrand, integral: RunningIntegral::new(horizon) }
    }

    /// The same over coarse simplices in place of the rectangle or box; none leaves it.
    pub(super) fn over(mut self, polytope: Option<&CoarseMesh>) -> Self {
        if let (Some(integrand), Some(coarse)) = (&mut self.integrand, polytope) {
            integrand.polytope = Some((SimplexPoints::fine(coarse), coarse.vertices()));
        }
        self
    }

    /// The same by a finer rule: what the rule leaves out shows in the difference.
    pub(super) fn over_finer(mut self, coarse: &CoarseMesh) -> Self {
        self = self.over(Some(coarse));
        if let Some((points, _)) = self.integrand.as_mut().and_then(|own| own.polytope.as_mut()) {
            *points = SimplexPoints::finer(coarse);
        }
        self
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
        let ends = match &self.polytope {
            None => vec![[0.0, 0.0, 0.0], [self.size[0], 0.0, 0.0]],
            Some((_, corners)) => corners.clone(),
        };
        let mut events = sign_changes(from, to, TIME_WATCHES, |times| {
            let mut bound = self.guards.bind(&ends);
            let mut values = vec![Vec::new(); self.guard_count];
            let mut rows = vec![Vec::with_capacity(times.len()); ends.len() * self.guard_count];
            for &t in times {
                bound.evaluate(t, 0.0, &mut values);
                for (g, value) in values.iter().enumerate() {
                    for (e, at) in value.iter().enumerate() {
                        rows[ends.len() * g + e].push(*at);
                    }
                }
            }
            rows
        });
        events.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * (to - from));
        events
    }

    /// ‖ε(u(t))‖_ℋ.
    fn norm(&self, t: f64) -> f64 {
        if let Some((polytope, _)) = &self.polytope {
            let out = self.strain_at(&polytope.points, t);
            let parts = out.iter().zip(&self.weights);
            return parts.map(|(e, w)| w * polytope.sum_of_squares(e)).sum::<f64>().sqrt();
        }
        let [count, parts] = rule(self.size.len());
        let xs = pieces(&self.cuts_in_x(t), count);
        let ys = pieces(&self.cuts_in_y, count);
        let zs = match self.size.get(2) {
            None => vec![(0.0, 1.0)],
            Some(&depth) if self.along_z => pieces(&uniform_cuts(depth, parts), count),
            Some(&depth) => vec![(0.5 * depth, depth)],
        };
        let lines = || ys.iter().flat_map(|y| zs.iter().map(move |z| (y, z)));
        let points: Vec<[f64; 3]> = xs
            .iter()
            .flat_map(|(x, _)| lines().map(move |((y, _), (z, _))| [*x, *y, *z]))
            .collect();
        let out = self.strain_at(&points, t);
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

    /// The components of ε(t) at the points.
    fn strain_at(&self, points: &[[f64; 3]], t: f64) -> Vec<Vec<f64>> {
        let mut known = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        let bound = match known.take() {
            Some((own, bound)) if own == points => (own, bound),
            _ => (points.to_vec(), self.strain.bind(points)),
        };
        let mut out = vec![Vec::new(); self.weights.len()];
        known.insert(bound).1.evaluate(t, 0.0, &mut out);
        out
    }

    /// Cuts of (0, a) where a guard changes sign at time t, or did at time 0: the relaxation
    /// integrals keep a kink where a zone began.
    fn cuts_in_x(&self, t: f64) -> Vec<f64> {
        let width = self.size[0];
        let mut cuts = uniform_cuts(width, rule(self.size.len())[1]);
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

/// Cuts of (0, height), uniform ones and where a guard that depends on y alone changes sign; `parts` is the number of
/// uniform pieces.
fn cuts_in_y(
    graph: &mut Graph,
    guards: &[Node],
    horizon: f64,
    height: f64,
    parts: usize,
) -> Vec<f64> {
    let alone = |guard: &Node| {
        let others = [Variable::X, Variable::Z, Variable::T];
        others.iter().all(|&other| !graph.depends_on(*guard, other))
    };
    let fixed: Vec<Node> = guards.iter().copied().filter(alone).collect();
    let program = Program::compile(graph, &fixed, horizon);
    let mut cuts = uniform_cuts(height, parts);
    cuts.extend(sign_changes(0.0, height, WATCHES, |places| {
        let points: Vec<[f64; 3]> = places.iter().map(|&y| [0.0, y, 0.0]).collect();
        let mut values = vec![Vec::new(); fixed.len()];
        program.bind(&points).evaluate(0.0, 0.0, &mut values);
        values
    }));
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * height);
    cuts
}

fn uniform_cuts(length: f64, parts: usize) -> Vec<f64> {
    (0..=parts).map(|i| length * i as f64 / parts as f64).collect()
}

/// [`PLANE`] or [`SPACE`].
fn rule(dimension: usize) -> [usize; 2] {
    if dimension == 2 { PLANE } else { SPACE }
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
