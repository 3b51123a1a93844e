//! Points of Γ2 and Γ3: edges cut where a field has a kink, and Gauss points on the pieces.

use super::pointwise::Plane;
use exact::{Exact, sign_changes};
use fem::space::Element;
use fem::space::quadrature::gauss_legendre;
use formula::{EvaluationPoint, Node};

/// Gauss points a piece: degree 31. The identities hold to rounding only if a curved law over a coarse edge is
/// integrated to rounding as well.
const POINTS: usize = 16;
/// Intervals of an edge in which sign changes are looked for.
const WATCHES: usize = 8;

/// The truth at a point of an edge.
#[derive(Debug, Clone, Default)]
pub(crate) struct EdgeSample {
    /// The vertices of the edge at which there are nodes: its ends, and of quadratic elements its midpoint; an end again of
    /// linear ones.
    pub vertices: [u32; 3],
    /// The values of their functions; zero for the third of linear elements.
    pub shape: [f64; 3],
    /// Length.
    pub weight: f64,
    /// ν.
    pub normal: [f64; 2],
    /// u.
    pub u: [f64; 2],
    /// ε(u).
    pub strain: Plane,
    /// H.
    pub history: Plane,
    /// Contact data, where the edge lies on Γ3.
    pub contact: Option<ContactSample>,
}

/// The numbers of an edge, the first once more as a third where there are two: its function is zero.
pub(crate) fn padded<T: Copy>(members: &[T]) -> [T; 3] {
    [members[0], members[1], *members.get(2).unwrap_or(&members[0])]
}

/// The values of the functions of an edge at the part x of its length.
pub(crate) fn shape(element: Element, x: f64) -> [f64; 3] {
    let (mut shape, values) = ([0.0; 3], element.values(&[1.0 - x, x]));
    shape[..values.len()].copy_from_slice(&values);
    shape
}

/// A function of the edge by its values at the given points.
pub(crate) fn between(trace: [usize; 3], shape: &[f64; 3], values: &[f64]) -> f64 {
    let ends = shape[0] * values[trace[0]] + shape[1] * values[trace[1]];
    if shape[2] == 0.0 { ends } else { ends + shape[2] * values[trace[2]] }
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactSample {
    /// The vertices of the edge as points of the trace.
    pub trace: [usize; 3],
    /// u_ν.
    pub normal: f64,
    /// g.
    pub gap: f64,
    /// s.
    pub shift: f64,
    /// c(x): the law is c ∂j_ν(u_ν - s).
    pub scale: f64,
    /// ξ.
    pub compliance: f64,
    /// λ.
    pub multiplier: f64,
}

/// A formula of place alone, such as s, or the number in its absence.
pub(crate) fn number(
    exact: &Exact,
    (formula, absent): (Option<Node>, f64),
    [x, y, z]: [f64; 3],
) -> f64 {
    let at = EvaluationPoint { x, y, z, ..EvaluationPoint::default() };
    formula.map_or(absent, |node| exact.data.graph.evaluate(node, &at))
}

/// Functions of places along a chain of edges: one list a function.
pub(crate) type Along<'a> = dyn Fn(&[f64]) -> Vec<Vec<f64>> + 'a;

/// A place along a chain of edges: the edge and ξ in [0, 1].
pub(crate) fn edge_and_place(q: f64, edges: usize) -> (usize, f64) {
    let edge = (q.floor() as usize).min(edges.saturating_sub(1));
    (edge, q - edge as f64)
}

/// Points (edge, ξ, weight; the weights of an edge sum to one) on a chain of edges cut where one of the
/// `functions` changes sign.
pub(crate) fn cut_points(edges: usize, functions: &[&Along<'_>]) -> Vec<(usize, f64, f64)> {
    let length = edges as f64;
    let mut cuts: Vec<f64> = (0..=edges).map(|e| e as f64).collect();
    for function in functions {
        cuts.extend(sign_changes(0.0, length, WATCHES * edges, function));
    }
    cuts.sort_by(f64::total_cmp);
    // Cuts closer than this hold less than rounding.
    cuts.dedup_by(|a, b| (*a - *b).abs() <= 1e-14 * length);
    let mut points = Vec::new();
    for pair in cuts.windows(2) {
        let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let (edge, _) = edge_and_place(middle, edges);
        for &(x, weight) in gauss_legendre(POINTS) {
            points.push((edge, middle + half * x - edge as f64, half * weight));
        }
    }
    points
}
