//! Friction of an exact solution: s = -σ_τ along d - 1 tangents, |s| ≤ S, s = S u_τ/|u_τ| where u_τ slips.

use super::exact::{Exact, LawNumbers, law_formula, normal_component, on_plane};
use formula::{Graph, Node, Program, Variable};

/// The bound S.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionBound {
    /// S(x, t) by a formula.
    Given(Node),
    /// (r, S(r)) over the slip r = |u_τ|, piecewise linear and constant beyond the last.
    Slip(Vec<[f64; 2]>),
    /// S = μ_f p(u_ν), p the normal law, by its coefficient μ_f.
    Coulomb(f64),
}

/// Friction as formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionFormulas {
    /// S.
    pub bound: FrictionBound,
    /// s(x, t): in the plane one formula, along the tangent; in space three, of which the part orthogonal to ν counts.
    /// None for S u_τ/|u_τ|, and 0 where nothing slips.
    pub multiplier: Option<Vec<Node>>,
}

/// Friction on a part of Γ3 with one normal.
pub struct FrictionOnSide {
    pub tangents: Tangents,
    /// [s, u_τ, S], s and u_τ along the tangents.
    pub program: Program,
}

/// Orthogonal unit tangents. In the plane only the first, the second being zero: towards growing x, on a side along y
/// towards growing y.
pub type Tangents = [[f64; 3]; 2];

/// The state at one point; second numbers are 0 in the plane.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sliding {
    pub tangents: Tangents,
    /// s along them.
    pub s: [f64; 2],
    /// u_τ along them.
    pub slip: [f64; 2],
    /// S.
    pub bound: f64,
}

impl Sliding {
    /// Numbers of a program in dimension d.
    pub fn numbers(d: usize) -> usize {
        2 * (d - 1) + 1
    }

    /// The state from the numbers of a program in dimension d.
    pub fn new(tangents: Tangents, d: usize, number: impl Fn(usize) -> f64) -> Self {
        let m = d - 1;
        let pair = |first: usize| [number(first), if m > 1 { number(first + 1) } else { 0.0 }];
        Self { tangents, s: pair(0), slip: pair(m), bound: number(2 * m) }
    }

    /// s as a vector.
    pub fn stress(&self) -> [f64; 3] {
        let [[a, b, c], [d, e, f]] = self.tangents;
        let [s, q] = self.s;
        [s * a + q * d, s * b + q * e, s * c + q * f]
    }

    /// |s|.
    pub fn size(&self) -> f64 {
        length(self.s)
    }

    /// Whether |s| is below S, by more than rounding of formulas.
    pub fn sticks(&self) -> bool {
        self.size() < self.bound * (1.0 - ROUNDING)
    }

    /// |u_τ|.
    pub fn slipped(&self) -> f64 {
        length(self.slip)
    }

    /// S |u_τ| - s·u_τ, nonnegative for |s| ≤ S.
    pub fn unaligned(&self) -> f64 {
        let [s, u] = [self.s, self.slip];
        self.bound * self.slipped() - (s[0] * u[0] + s[1] * u[1])
    }
}

/// The length of a vector, and in the plane the modulus.
fn length([a, b]: [f64; 2]) -> f64 {
    if b == 0.0 { a.abs() } else { a.hypot(b) }
}

/// Rounding of a formula that is meant to stay at the bound.
const ROUNDING: f64 = 1e-12;

/// A smaller component of a unit vector is rounding.
const ALONG_AXIS: f64 = 1e-12;

/// The tangents of a side with normal ν. In space the first lies along the axis furthest from ν.
fn tangents(normal: &[f64]) -> Tangents {
    if let &[a, b, c] = normal {
        let axis = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
        let mut first =
            normal.iter().map(|component| -normal[axis] * component).collect::<Vec<f64>>();
        first[axis] += 1.0;
        let size = first.iter().map(|component| component * component).sum::<f64>().sqrt();
        let [p, q, r] = [0, 1, 2].map(|i| first[i] / size);
        return [[p, q, r], [b * r - c * q, c * p - a * r, a * q - b * p]];
    }
    let backward = normal[1] > ALONG_AXIS || (normal[1].abs() <= ALONG_AXIS && normal[0] < 0.0);
    let sign = if backward { -1.0 } else { 1.0 };
    [[-sign * normal[1], sign * normal[0], 0.0], [0.0; 3]]
}

impl Exact {
    /// s, u_τ and S on a side for the outward normal ν; None without friction.
    pub fn friction(&self, side: u32, normal: &[f64]) -> Option<FrictionOnSide> {
        self.friction_at(side, normal, None)
    }

    /// The friction on a coordinate plane.
    pub(super) fn friction_at(
        &self,
        side: u32,
        normal: &[f64],
        plane: Option<(Variable, f64)>,
    ) -> Option<FrictionOnSide> {
        let contact = self.contact_on(side)?;
        let friction = contact.friction.as_ref()?;
        let (mut graph, tangents) = (self.data.graph.clone(), tangents(normal));
        let d = normal.len();
        let along = |graph: &mut Graph, vector: &[Node]| -> Vec<Node> {
            let nonzero = tangents[..d - 1].iter();
            nonzero.map(|tangent| normal_component(graph, vector, &tangent[..d])).collect()
        };
        let u_tau = along(&mut graph, &self.data.u);
        let slip = length_formula(&mut graph, &u_tau);
        let u_nu = normal_component(&mut graph, &self.data.u, normal);
        let p = contact.compliance(&mut graph, u_nu);
        let bound = friction.bound.formula(&mut graph, slip, p);
        let s = match &friction.multiplier {
            None => slipping(&mut graph, (&u_tau, slip), bound),
            Some(stress) if d == 2 => stress.clone(),
            Some(stress) => along(&mut graph, stress),
        };
        let mut outputs = [&s[..], &u_tau, &[bound]].concat();
        on_plane(&mut graph, &mut outputs, plane);
        let program = Program::compile(&graph, &outputs, self.data.horizon);
        Some(FrictionOnSide { tangents, program })
    }
}

impl FrictionBound {
    /// S for the value p of the normal law; 0 without one.
    fn formula(&self, graph: &mut Graph, slip: Node, p: Option<Node>) -> Node {
        match self {
            Self::Given(bound) => *bound,
            Self::Coulomb(coefficient) => {
                let (coefficient, zero) = (graph.constant(*coefficient), graph.constant(0.0));
                graph.mul(coefficient, p.unwrap_or(zero))
            }
            Self::Slip(points) => {
                let (points, slope_before, slope_after) = (points.clone(), 0.0, 0.0);
                let law = LawNumbers { points, slope_before, slope_after, curve: None };
                law_formula(graph, &law, slip)
            }
        }
    }

    /// dS/dr at the slip r, to the right of it.
    pub fn slope(&self, r: f64) -> f64 {
        let Self::Slip(points) = self else { return 0.0 };
        let mut pieces = points.windows(2).map(|pair| (pair[0], pair[1]));
        let piece = pieces.find(|([from, _], [to, _])| (*from..*to).contains(&r));
        piece.map_or(0.0, |([from, low], [to, high])| (high - low) / (to - from))
    }

    /// μ_f of a bound that follows the normal law, 0 for others.
    pub fn coefficient(&self) -> f64 {
        if let Self::Coulomb(coefficient) = self { *coefficient } else { 0.0 }
    }
}

/// |u_τ|.
fn length_formula(graph: &mut Graph, u_tau: &[Node]) -> Node {
    match *u_tau {
        [u] => graph.written("max(u, -u)", &[("u", u)], &[]),
        [u, w] => graph.written("sqrt(u^2 + w^2)", &[("u", u), ("w", w)], &[]),
        _ => graph.constant(f64::NAN),
    }
}

/// S u_τ/|u_τ|, 0 at rest.
fn slipping(graph: &mut Graph, (u_tau, slip): (&[Node], Node), bound: Node) -> Vec<Node> {
    if let [u] = *u_tau {
        let nodes = [("u", u), ("bound", bound)];
        return vec![graph.written("if(u > 0, bound, if(u < 0, -bound, 0))", &nodes, &[])];
    }
    let nodes = [("slip", slip), ("bound", bound)];
    let per_length = graph.written("bound/if(slip > 0, slip, 1)", &nodes, &[]);
    u_tau.iter().map(|&u| graph.mul(per_length, u)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_point_along_the_axes() {
        for (normal, along) in [
            ([0.0, -1.0], [1.0, 0.0]),
            ([0.0, 1.0], [1.0, 0.0]),
            ([1.0, 0.0], [0.0, 1.0]),
            ([-1.0, 0.0], [0.0, 1.0]),
            ([-1.0, 1e-17], [0.0, 1.0]),
            ([0.6, 0.8], [0.8, -0.6]),
            ([-0.6, -0.8], [0.8, -0.6]),
        ] {
            let first = tangents(&normal)[0];
            assert!((0..2).all(|i| (first[i] - along[i]).abs() < 1e-15), "{normal:?}: {first:?}");
        }
    }

    #[test]
    fn tangents_in_space_are_orthonormal() {
        for normal in [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.48, -0.6, 0.64], [0.0, 0.6, -0.8]] {
            let [p, q] = tangents(&normal);
            let dot =
                |a: [f64; 3], b: [f64; 3]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
            for (product, wanted) in [
                (dot(p, p), 1.0),
                (dot(q, q), 1.0),
                (dot(p, q), 0.0),
                (dot(p, normal), 0.0),
                (dot(q, normal), 0.0),
            ] {
                // Rounding of sums of three products of numbers below one.
                assert!((product - wanted).abs() < 1e-15, "{normal:?}: {p:?} {q:?}");
            }
        }
    }
}
