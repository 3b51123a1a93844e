//! Friction of an exact solution in the plane: s = -σ_τ along the tangent, |s| ≤ S, s = S where u_τ slips.

use super::exact::{Exact, LawNumbers, law_formula, normal_component};
use formula::{Graph, Node, Program, Variable};

/// The bound S.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionBound {
    /// S(x, t) by a formula.
    Given(Node),
    /// (r, S(r)) over the slip r = |u_τ|, joined by lines and constant beyond the last.
    Slip(Vec<[f64; 2]>),
    /// S = μ_f p(u_ν), p the normal law, by its coefficient μ_f.
    Coulomb(f64),
}

/// Friction as formulas.
#[derive(Debug, Clone, PartialEq)]
pub struct FrictionFormulas {
    /// S.
    pub bound: FrictionBound,
    /// s(x, t); none where it is S sign u_τ, and 0 where nothing slips.
    pub multiplier: Option<Node>,
}

/// Friction on a part of Γ3 with one normal.
pub struct FrictionOnSide {
    /// The unit tangent: towards growing x, on a side along y towards growing y.
    pub tangent: [f64; 2],
    /// [s, u_τ, S].
    pub program: Program,
}

/// A component of a unit vector that is zero but for rounding.
const ALONG_AXIS: f64 = 1e-12;

/// The tangent of a side with the normal ν.
fn tangent(normal: &[f64]) -> [f64; 2] {
    let backward = normal[1] > ALONG_AXIS || (normal[1].abs() <= ALONG_AXIS && normal[0] < 0.0);
    let sign = if backward { -1.0 } else { 1.0 };
    [-sign * normal[1], sign * normal[0]]
}

impl Exact {
    /// s, u_τ and S where the outward normal is ν; `None` without friction.
    pub fn friction(&self, normal: &[f64]) -> Option<FrictionOnSide> {
        self.friction_at(normal, None)
    }

    /// The same on a plane where a coordinate has one value.
    pub(super) fn friction_at(
        &self,
        normal: &[f64],
        plane: Option<(Variable, f64)>,
    ) -> Option<FrictionOnSide> {
        let friction = self.data.contact.as_ref()?.friction.as_ref()?;
        let (mut graph, tangent) = (self.data.graph.clone(), tangent(normal));
        let u_tau = normal_component(&mut graph, &self.data.u, &tangent);
        let u_nu = normal_component(&mut graph, &self.data.u, normal);
        let p = self.data.contact.as_ref().and_then(|own| own.compliance(&mut graph, u_nu));
        let bound = friction.bound.formula(&mut graph, u_tau, p);
        let s = friction.multiplier.unwrap_or_else(|| slipping(&mut graph, u_tau, bound));
        let mut outputs = [s, u_tau, bound];
        if let Some((axis, value)) = plane {
            let value = graph.constant(value);
            outputs = outputs.map(|formula| graph.substitute(formula, axis, value));
        }
        let program = Program::compile(&mut graph, &outputs, self.data.horizon);
        Some(FrictionOnSide { tangent, program })
    }
}

impl FrictionBound {
    /// S, where the normal law has the value p: 0 without one.
    fn formula(&self, graph: &mut Graph, u_tau: Node, p: Option<Node>) -> Node {
        match self {
            Self::Given(bound) => *bound,
            Self::Coulomb(coefficient) => {
                let (coefficient, zero) = (graph.constant(*coefficient), graph.constant(0.0));
                graph.mul(coefficient, p.unwrap_or(zero))
            }
            Self::Slip(points) => {
                let backward = graph.neg(u_tau);
                let slip = graph.max(u_tau, backward);
                let (points, slope_before, slope_after) = (points.clone(), 0.0, 0.0);
                let law = LawNumbers { points, slope_before, slope_after, curve: None };
                law_formula(graph, &law, slip)
            }
        }
    }
}

/// S sign u_τ.
fn slipping(graph: &mut Graph, u_tau: Node, bound: Node) -> Node {
    let (zero, backward) = (graph.constant(0.0), graph.neg(bound));
    let not_forward = graph.select_less(u_tau, zero, backward, zero);
    graph.select_less(zero, u_tau, bound, not_forward)
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
            let own = tangent(&normal);
            assert!((0..2).all(|i| (own[i] - along[i]).abs() < 1e-15), "{normal:?}: {own:?}");
        }
    }
}
