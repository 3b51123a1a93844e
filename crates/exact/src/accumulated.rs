//! ζ(t) = ∫_0^t ‖ε(u(s))‖_ℋ ds of an exact solution, to about 1e-12.
//!
//! ε is piecewise smooth: its guards (expressions whose sign decides a branch) vanish on moving lines. The integral
//! over Ω is cut where a guard changes sign along x, the integral over time where a guard changes sign at an end of Ω.
//! Pieces take Gauss-Legendre rules. A polygon is cut likewise, its chords at their ends; on a polyhedron no cell
//! follows a guard.
//! No guard names a time at which ε vanishes everywhere: the kink of ‖ε‖ there costs about 1e-9 of its slope.

use std::convert::Infallible;
use std::sync::{Mutex, OnceLock, PoisonError};

use super::running_integral::RunningIntegral;
use super::sign_changes::Guards;
use super::simplex_points::SimplexPoints;
use super::zeta_domain::{Domain, Region, Shape};
use formula::{BoundProgram, Graph, Node, Program, Variable};

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

struct Integrand {
    strain: Program,
    /// Without moving guards always the same.
    last: Mutex<Option<Points>>,
    guards: Guards,
    /// Cuts of the height: sign changes of guards that depend on y only.
    cuts_in_y: Vec<f64>,
    /// Cuts of the width where a guard changes sign at time 0.
    cuts_at_start: OnceLock<Vec<f64>>,
    weights: Vec<f64>,
    region: Region,
}

impl AccumulatedStrain {
    /// ζ of the strain formulas; NaN if not `needed`.
    pub(super) fn new(
        graph: &Graph,
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
        let events = |from, to| integrand.events(from, to);
        let Ok(value) = integral.at::<Infallible>(t, events, |s| Ok(integrand.norm(s)));
        value
    }

    /// ‖ε(u(t))‖; NaN if declared as not needed.
    pub fn strain_norm(&self, t: f64) -> f64 {
        self.integrand.as_ref().map_or(f64::NAN, |integrand| integrand.norm(t))
    }
}

impl Integrand {
    fn new(graph: &Graph, strain: &[Node], horizon: f64, domain: Domain<'_>) -> Self {
        let all = graph.guards(strain);
        let along_z = strain.iter().any(|&e| graph.depends_on(e, Variable::Z));
        let region = Region::of(graph, &all, domain, along_z);
        let cuts_in_y = match &region.shape {
            Shape::Strips(strips) => cuts_in_y(graph, &all, horizon, strips.bounds.map(|[_, y]| y)),
            Shape::Points(_) => Vec::new(),
        };
        let moving = |guard: &Node| {
            graph.depends_on(*guard, Variable::X) || graph.depends_on(*guard, Variable::T)
        };
        let guards: Vec<Node> = all.into_iter().filter(moving).collect();
        Self {
            strain: Program::compile(graph, strain, horizon),
            last: Mutex::new(None),
            cuts_in_y,
            cuts_at_start: OnceLock::new(),
            guards: Guards::new(graph, &guards, horizon),
            weights: super::symbolic::components(if strain.len() == 3 { 2 } else { 3 })
                .into_iter()
                .map(|(i, j)| if i == j { 1.0 } else { 2.0 })
                .collect(),
            region,
        }
    }

    /// Relative quadrature error of ‖ε‖ where a guard is not cut: at three times, by a finer rule. The integral in time
    /// need not be more accurate.
    fn left_out(&self, horizon: f64) -> f64 {
        let share = |finer: &Shape, t: f64| {
            let norm = self.norm(t);
            let mut points = self.points(finer, self.cuts_in_x(finer, t));
            (points.norm(&self.weights, t) - norm).abs() / norm.max(f64::MIN_POSITIVE)
        };
        let at = |finer| [1.0, 2.0, 3.0].map(|third| share(finer, horizon * third / 3.0));
        self.region.finer.as_ref().map_or([0.0; 3], at).into_iter().fold(0.0, f64::max)
    }

    /// Times in (from, to) at which a guard changes sign at an end of the domain.
    fn events(&self, from: f64, to: f64) -> Vec<f64> {
        let corners = &self.region.corners;
        let mut events = self.guards.in_time([from, to], TIME_WATCHES, corners);
        events.dedup_by(|a, b| (*a - *b).abs() <= 1e-13 * (to - from));
        events
    }

    fn norm(&self, t: f64) -> f64 {
        let cuts = self.cuts_in_x(&self.region.shape, t);
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let points = match last.take() {
            Some(points) if points.cuts_in_x == cuts => points,
            _ => self.points(&self.region.shape, cuts),
        };
        last.insert(points).norm(&self.weights, t)
    }

    fn points(&self, shape: &Shape, cuts_in_x: Vec<f64>) -> Points {
        let (points, weights) = match shape {
            Shape::Points(SimplexPoints { points, weights }) => (points.clone(), weights.clone()),
            Shape::Strips(strips) => strips.points(&cuts_in_x, &self.cuts_in_y),
        };
        Points { cuts_in_x, weights, strain: self.strain.bind(&points) }
    }

    /// Cuts of the width where a guard changes sign at time t, or did at time 0: relaxation integrals keep a kink where
    /// a zone began.
    fn cuts_in_x(&self, shape: &Shape, t: f64) -> Vec<f64> {
        let Shape::Strips(strips) = shape else { return Vec::new() };
        let width = strips.bounds.map(|[x, _]| x);
        let at = |time: f64| self.guards.along(width, WATCHES, time, |x| [x, 0.0, 0.0]);
        let mut cuts = at(t);
        cuts.extend(self.cuts_at_start.get_or_init(|| at(0.0)));
        cuts
    }
}

/// Where the strain is evaluated.
struct Points {
    /// Cuts of the width of which they come.
    cuts_in_x: Vec<f64>,
    weights: Vec<f64>,
    strain: BoundProgram,
}

impl Points {
    /// ‖ε‖ at time t; components count as often as `often` says.
    fn norm(&mut self, often: &[f64], t: f64) -> f64 {
        let strain = self.strain.values_at(t, 0.0);
        let component = |(e, often): (&Vec<f64>, &f64)| {
            often * e.iter().zip(&self.weights).map(|(e, w)| w * e * e).sum::<f64>()
        };
        strain.iter().zip(often).map(component).sum::<f64>().sqrt()
    }
}

fn cuts_in_y(graph: &Graph, guards: &[Node], horizon: f64, height: [f64; 2]) -> Vec<f64> {
    let alone = |guard: &Node| {
        let others = [Variable::X, Variable::Z, Variable::T];
        others.iter().all(|&other| !graph.depends_on(*guard, other))
    };
    let fixed: Vec<Node> = guards.iter().copied().filter(alone).collect();
    Guards::new(graph, &fixed, horizon).along(height, WATCHES, 0.0, |y| [0.0, y, 0.0])
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
        let zeta = AccumulatedStrain::new(&graph, &strain, 1.0, Domain::Box(&[1.0, 1.0]), true);
        zeta.integrand.expect("an integrand")
    }

    /// Against closed forms: kinks in x and y, moving fronts.
    #[test]
    fn a_strain_with_kinks_has_the_norm_of_its_closed_form() {
        // ‖max(x - a, 0)‖² = (1 - a)³/3 =: c(a), and the mean of max(x - a, 0) is (1 - a)²/2.
        let cube = |a: f64| (1.0 - a) * (1.0 - a) * (1.0 - a) / 3.0;
        let kinks = integrand(&["t*max(x - 0.3, 0) + (1 - t)*max(y - 0.6, 0)", "0", "0"]);
        let mixed = 2.0 * 0.25 * 0.75 * (0.7_f64 * 0.7 / 2.0) * (0.4 * 0.4 / 2.0);
        let exact = (0.0625 * cube(0.3) + 0.5625 * cube(0.6) + mixed).sqrt();
        assert!((kinks.norm(0.25) - exact).abs() <= 1e-14, "{} {exact}", kinks.norm(0.25));
        let moving = integrand(&["max(x - t, 0)", "0", "0"]);
        for t in [0.25, 0.5, 0.25] {
            assert!((moving.norm(t) - cube(t).sqrt()).abs() <= 1e-14, "t = {t}");
        }
        assert_eq!(integrand(&["0", "0", "0"]).norm(0.3), 0.0);
        // Shears count twice.
        let shear = integrand(&["0", "t*x", "0"]);
        assert!((shear.norm(3.0) - 6.0_f64.sqrt()).abs() <= 1e-14);
    }
}
