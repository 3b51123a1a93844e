//! ζ(t) = ∫_0^t ‖ε(u(s))‖_ℋ ds of an exact solution, to about 1e-12.
//!
//! ε is piecewise smooth: its guards (expressions whose sign decides a branch) vanish on moving lines. The integral
//! over Ω is cut where a guard changes sign along x, the integral over time where a guard changes sign at an end of Ω.
//! Pieces take Gauss-Legendre rules. A polygon is cut likewise, its chords at their ends; on a polyhedron no cell
//! follows a guard.
//!
//! If ε = Σ_m a_m(t) S_m(x), no guard moves, and ‖ε‖² = Σ a_m a_l ∫ S_m:S_l. No guard names a time at which ε vanishes
//! everywhere: the kink of ‖ε‖ there costs about 1e-9 of its slope.

use std::sync::{Mutex, OnceLock, PoisonError};

use super::running_integral::RunningIntegral;
use super::separation::TimeFactors;
use super::sign_changes::Guards;
use super::zeta_domain::{Domain, Region, Shape};
use fem::space::quadrature::gauss_legendre;
use formula::{BoundProgram, Graph, Node, Program, Variable};

/// Gauss points per piece and direction, and pieces before cuts at guards, in the plane and in space. A quarter of the
/// domain with 14 points resolves sin(4πx) squared to rounding, half of it with 8 points sin(πx) squared.
const PLANE: [usize; 2] = [14, 3];
const SPACE: [usize; 2] = [8, 2];
/// Intervals of the domain, and of a panel in time, in which guards are watched.
const WATCHES: usize = 48;
const TIME_WATCHES: usize = 8;

/// ζ(t) by quadrature.
pub struct AccumulatedStrain {
    /// [ε], upper components; None if nothing depends on ζ.
    integrand: Option<Integrand>,
    integral: OnceLock<RunningIntegral>,
    horizon: f64,
}

/// If products of parts cancel below this share of their size, the strain is evaluated at points. Above, at most two
/// digits are lost of sums that are right to some 1e-15.
const CANCELLED: f64 = 1e-2;

struct Integrand {
    strain: Program,
    /// If ε separates as Σ_m a_m(t) S_m(x): the factors, and ∫ S_m:S_l row by row.
    parts: Option<(TimeFactors, Program)>,
    gram: OnceLock<Vec<f64>>,
    /// The strain at the points last used: without moving guards they are always the same.
    bound: Mutex<Option<(Vec<[f64; 3]>, BoundProgram)>>,
    guards: Guards,
    /// Cuts of the height: uniform ones of a rectangle or box, and sign changes of guards that depend on y only.
    cuts_in_y: Vec<f64>,
    /// Ends of the width, and number of its uniform pieces.
    along_x: ([f64; 2], usize),
    /// Cuts of the width where a guard changes sign at time 0.
    cuts_at_start: OnceLock<Vec<f64>>,
    weights: Vec<f64>,
    size: Vec<f64>,
    /// Whether ε varies along z; otherwise one plane suffices.
    along_z: bool,
    /// A domain that is not a rectangle or box.
    polytope: Option<Region>,
}

impl AccumulatedStrain {
    /// ζ of the strain formulas; NaN if not `needed`.
    pub(super) fn new(
        graph: &mut Graph,
        strain: &[Node],
        horizon: f64,
        domain: Domain<'_>,
        needed: bool,
    ) -> Self {
        let integrand = needed.then(|| Integrand::new(graph, strain, horizon, domain));
        Self { integrand, integral: OnceLock::new(), horizon }
    }

    /// ζ(t); NaN if declared as not needed.
    pub fn at(&self, t: f64) -> f64 {
        let Some(integrand) = &self.integrand else { return f64::NAN };
        let integral = self.integral.get_or_init(|| {
            RunningIntegral::new(self.horizon).scaled_to(integrand.left_out(self.horizon))
        });
        let value: Result<f64, std::convert::Infallible> =
            integral.at(t, |from, to| integrand.events(from, to), |s| Ok(integrand.norm(s)));
        match value {
            Ok(value) => value,
            Err(never) => match never {},
        }
    }

    /// ‖ε(u(t))‖; NaN if declared as not needed.
    pub fn strain_norm(&self, t: f64) -> f64 {
        self.integrand.as_ref().map_or(f64::NAN, |integrand| integrand.norm(t))
    }
}

impl Integrand {
    fn new(graph: &mut Graph, strain: &[Node], horizon: f64, domain: Domain<'_>) -> Self {
        let [along_x, along_y] = domain.ends();
        let (parts, size) = match domain {
            Domain::Box(size) => (rule(size.len())[1], size.to_vec()),
            // Strips are cut separately.
            Domain::Coarse(_) | Domain::Finer(_) => (1, Vec::new()),
        };
        let all = graph.guards(strain);
        let cuts_in_y = cuts_in_y(graph, &all, horizon, along_y, parts);
        let polytope = Region::of(graph, &all, domain);
        let moving = |guard: &Node| {
            graph.depends_on(*guard, Variable::X) || graph.depends_on(*guard, Variable::T)
        };
        let guards: Vec<Node> = all.into_iter().filter(moving).collect();
        Self {
            strain: Program::compile(graph, strain, horizon),
            parts: TimeFactors::of(graph, strain, horizon).map(|(factors, shapes)| {
                (factors, Program::compile_once(graph, &shapes.concat(), horizon))
            }),
            gram: OnceLock::new(),
            bound: Mutex::new(None),
            cuts_in_y,
            along_x: (along_x, parts),
            cuts_at_start: OnceLock::new(),
            guards: Guards::new(graph, &guards, horizon),
            weights: super::symbolic::components(domain.dimension())
                .into_iter()
                .map(|(i, j)| if i == j { 1.0 } else { 2.0 })
                .collect(),
            size,
            along_z: strain.iter().any(|&e| graph.depends_on(e, Variable::Z)),
            polytope,
        }
    }

    /// Relative quadrature error of ‖ε‖ where a guard is not cut: at three times, by a finer rule. The integral in time
    /// need not be more accurate.
    fn left_out(&self, horizon: f64) -> f64 {
        let finer = self.polytope.as_ref().and_then(|polytope| polytope.finer.as_ref());
        let share = |finer: &Shape, t: f64| {
            let norm = self.norm(t);
            (self.norm_over(Some(finer), t) - norm).abs() / norm.max(f64::MIN_POSITIVE)
        };
        let at = |finer| [1.0, 2.0, 3.0].map(|third| share(finer, horizon * third / 3.0));
        finer.map_or([0.0; 3], at).into_iter().fold(0.0, f64::max)
    }

    /// Times in (from, to) at which a guard changes sign at an end of the domain.
    fn events(&self, from: f64, to: f64) -> Vec<f64> {
        let ends = match &self.polytope {
            None => vec![[0.0, 0.0, 0.0], [self.size[0], 0.0, 0.0]],
            Some(polytope) => polytope.corners.clone(),
        };
        let mut events = self.guards.in_time([from, to], TIME_WATCHES, &ends);
        events.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * (to - from));
        events
    }

    fn norm(&self, t: f64) -> f64 {
        let shape = self.polytope.as_ref().map(|polytope| &polytope.shape);
        self.square_of_parts(t).map_or_else(|| self.norm_over(shape, t), f64::sqrt)
    }

    fn norm_over(&self, shape: Option<&Shape>, t: f64) -> f64 {
        let square = self.at_points(shape, t, |points, weights| {
            let strain = self.strain_at(points, t);
            self.product(&strain, &strain, weights)
        });
        square.sqrt()
    }

    /// ‖ε(u(t))‖² of a separable strain, whose parts are integrated once, since their guards do not move. None if the
    /// parts cancel, or one is not finite.
    fn square_of_parts(&self, t: f64) -> Option<f64> {
        let (factors, shapes) = self.parts.as_ref()?;
        let gram = self.gram.get_or_init(|| self.gram(factors.parts, shapes));
        let factors = factors.at(t);
        let (mut square, mut size) = (0.0, 0.0);
        for (row, a) in gram.chunks(factors.len().max(1)).zip(&*factors) {
            for (product, b) in row.iter().zip(&*factors) {
                let term = a * product * b;
                square += term;
                size += term.abs();
            }
        }
        // If all factors vanish, so does the strain.
        (square > CANCELLED * size || size == 0.0).then_some(square)
    }

    /// ∫ S_m:S_l of the parts of ε, row by row.
    fn gram(&self, parts: usize, shapes: &Program) -> Vec<f64> {
        let shape = self.polytope.as_ref().map(|polytope| &polytope.shape);
        self.at_points(shape, 0.0, |points, weights| {
            let components = self.weights.len();
            let mut values = vec![Vec::new(); parts * components];
            shapes.bind(points).evaluate(0.0, 0.0, &mut values);
            let parts = || values.chunks(components);
            parts().flat_map(|m| parts().map(|l| self.product(m, l, weights))).collect()
        })
    }

    /// ∫ e:f of tensors given by components at points with weights.
    fn product(&self, e: &[Vec<f64>], f: &[Vec<f64>], weights: &[f64]) -> f64 {
        let component = |((e, f), often): ((&Vec<f64>, &Vec<f64>), &f64)| {
            let products = e.iter().zip(f).zip(weights).map(|((e, f), w)| w * e * f);
            often * products.sum::<f64>()
        };
        e.iter().zip(f).zip(&self.weights).map(component).sum()
    }

    /// Applies `visit` to the points and weights of a shape, or of the rectangle or box, for fields at time t.
    fn at_points<R>(
        &self,
        shape: Option<&Shape>,
        t: f64,
        visit: impl FnOnce(&[[f64; 3]], &[f64]) -> R,
    ) -> R {
        match shape {
            Some(Shape::Points(shape_points)) => {
                return visit(&shape_points.points, &shape_points.weights);
            }
            Some(Shape::Strips(strips)) => {
                let (points, weights) = strips.points(&self.cuts_in_x(t), &self.cuts_in_y);
                return visit(&points, &weights);
            }
            None => {}
        }
        let [count, parts] = rule(self.size.len());
        let xs = pieces(&self.cuts_in_x(t), count);
        let ys = pieces(&self.cuts_in_y, count);
        let zs = match self.size.get(2) {
            None => vec![(0.0, 1.0)],
            Some(&depth) if self.along_z => pieces(&uniform_cuts([0.0, depth], parts), count),
            Some(&depth) => vec![(0.5 * depth, depth)],
        };
        let total = xs.len() * ys.len() * zs.len();
        let (mut points, mut weights) = (Vec::with_capacity(total), Vec::with_capacity(total));
        for &(x, wx) in &xs {
            for &(y, wy) in &ys {
                for &(z, wz) in &zs {
                    points.push([x, y, z]);
                    weights.push(wx * wy * wz);
                }
            }
        }
        visit(&points, &weights)
    }

    fn strain_at(&self, points: &[[f64; 3]], t: f64) -> Vec<Vec<f64>> {
        let mut known = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        let bound = match known.take() {
            Some((bound_points, bound)) if bound_points == points => (bound_points, bound),
            _ => (points.to_vec(), self.strain.bind(points)),
        };
        let mut out = vec![Vec::new(); self.weights.len()];
        known.insert(bound).1.evaluate(t, 0.0, &mut out);
        out
    }

    /// Cuts of the width where a guard changes sign at time t, or did at time 0: relaxation integrals keep a kink where
    /// a zone began.
    fn cuts_in_x(&self, t: f64) -> Vec<f64> {
        let ([from, to], parts) = self.along_x;
        let at = |time: f64| self.guards.along([from, to], WATCHES, time, |x| [x, 0.0, 0.0]);
        let mut cuts = uniform_cuts([from, to], parts);
        cuts.extend(at(t));
        cuts.extend(self.cuts_at_start.get_or_init(|| at(0.0)));
        sorted(cuts, to - from)
    }
}

/// Cuts of the height: `parts` uniform pieces, and sign changes of guards that depend on y only.
fn cuts_in_y(
    graph: &mut Graph,
    guards: &[Node],
    horizon: f64,
    [from, to]: [f64; 2],
    parts: usize,
) -> Vec<f64> {
    let alone = |guard: &Node| {
        let others = [Variable::X, Variable::Z, Variable::T];
        others.iter().all(|&other| !graph.depends_on(*guard, other))
    };
    let fixed: Vec<Node> = guards.iter().copied().filter(alone).collect();
    let fixed = Guards::new(graph, &fixed, horizon);
    let mut cuts = uniform_cuts([from, to], parts);
    cuts.extend(fixed.along([from, to], WATCHES, 0.0, |y| [0.0, y, 0.0]));
    sorted(cuts, to - from)
}

/// Sorts cuts and merges those that differ by rounding.
fn sorted(mut cuts: Vec<f64>, length: f64) -> Vec<f64> {
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * length);
    cuts
}

fn uniform_cuts([from, to]: [f64; 2], parts: usize) -> Vec<f64> {
    (0..=parts).map(|i| from + (to - from) * i as f64 / parts as f64).collect()
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use formula::Scope;

    fn integrand(strain: &[&str]) -> Integrand {
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
        let strain: Vec<Node> =
            strain.iter().map(|text| graph.parse(text, &scope).expect("a formula")).collect();
        let zeta = AccumulatedStrain::new(&mut graph, &strain, 1.0, Domain::Box(&[1.0, 1.0]), true);
        zeta.integrand.expect("an integrand")
    }

    /// Parts against points, and both against closed forms: kinks in x, y and time, memory, moving fronts.
    #[test]
    fn a_strain_that_separates_is_integrated_once() {
        let still = ["t*x + relax(0.5, t)*max(x - 0.3, 0)", "y*max(t - 0.4, 0)", "exp(-t)*x*y"];
        let parts = integrand(&still);
        assert!(parts.parts.is_some());
        let points = Integrand { parts: None, ..integrand(&still) };
        for t in [0.0, 0.3, 1.0] {
            let [a, b] = [&parts, &points].map(|integrand| integrand.norm(t));
            // Sums of some 2,000 products of numbers of order one.
            assert!((a - b).abs() <= 1e-14, "t = {t}: {a} {b}");
        }
        // ‖max(x - a, 0)‖² = (1 - a)³/3 =: c(a), and the mean of max(x - a, 0) is (1 - a)²/2.
        let cube = |a: f64| (1.0 - a) * (1.0 - a) * (1.0 - a) / 3.0;
        let kinks = integrand(&["t*max(x - 0.3, 0) + (1 - t)*max(y - 0.6, 0)", "0", "0"]);
        let mixed = 2.0 * 0.25 * 0.75 * (0.7_f64 * 0.7 / 2.0) * (0.4 * 0.4 / 2.0);
        let exact = (0.0625 * cube(0.3) + 0.5625 * cube(0.6) + mixed).sqrt();
        assert!(kinks.square_of_parts(0.25).is_some());
        assert!((kinks.norm(0.25) - exact).abs() <= 1e-14, "{} {exact}", kinks.norm(0.25));
        // A moving front has separate points at each time.
        let moving = integrand(&["max(x - t, 0)", "0", "0"]);
        assert!(moving.parts.is_none());
        for t in [0.25, 0.5, 0.25] {
            assert!((moving.norm(t) - cube(t).sqrt()).abs() <= 1e-14, "t = {t}");
        }
        // Parts cancel but for 1e-12 of their squares: by points rounding is 1e-10 of the rest.
        let near = integrand(&["cos(t)*x - x*(1 + 1e-6*y)", "0", "0"]);
        assert!(near.square_of_parts(0.0).is_none() && near.square_of_parts(1.0).is_some());
        assert!((near.norm(0.0) - 1e-6 / 3.0).abs() <= 1e-15, "{}", near.norm(0.0));
        assert_eq!(integrand(&["0", "0", "0"]).norm(0.3), 0.0);
        // Shears count twice.
        let shear = integrand(&["0", "t*x", "0"]);
        assert!((shear.norm(3.0) - 6.0_f64.sqrt()).abs() <= 1e-14);
    }
}
