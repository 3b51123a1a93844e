//! The compliance forces of the separate KKT evaluation: from the subdifferential alone, and, for the
//! exact rule, without a formula for the crossings of kinks.

use super::compliance::facet_rule;
use super::march::StepView;
use super::{Boundary, Discretization};
use crate::space::quadrature::{Rule, edge};

/// Intervals of an edge before any is halved, and Gauss points on each: degree 19, so that intervals of
/// one resolution of a curved law are integrated to rounding by other points than the solver's.
const INTERVALS: usize = 4;
const POINTS: usize = 10;
/// Halvings of an interval in which ∂j_ν has a kink: what remains of it, 2⁻⁴⁰ of an edge, no longer
/// counts.
const HALVINGS: u32 = 40;
/// Changes of u_ν - s below this share of it, and of the kinks, are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Adds ∫ ∂j_ν(u_ν - s) v_ν by the Gauss rule of the facets.
pub fn add_gauss(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    balance: &mut [f64],
) {
    let rule = facet_rule(space.mesh.dimension);
    for facet in 0..space.trace.measure.len() {
        add_points(space, boundary, view, facet, &rule, balance);
    }
}

/// Adds ∫ ∂j_ν(u_ν - s) v_ν by halving intervals at whose ends u_ν - s lies on different pieces.
pub fn add_exact(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    balance: &mut [f64],
) {
    let gauss = edge(POINTS);
    for facet in 0..space.trace.measure.len() {
        let argument = |x: f64| argument(space, boundary, view, facet, &[1.0 - x, x]);
        let piece = |x: f64| boundary.potential.kinks().partition_point(|kink| *kink < argument(x));
        let sizes = boundary.potential.kinks().iter().copied();
        let size = sizes.chain([0.0, 0.5, 1.0].map(argument)).fold(0.0f64, |m, r| m.max(r.abs()));
        let end = |i: usize| i as f64 / INTERVALS as f64;
        let mut left: Vec<(f64, f64, u32)> =
            (0..INTERVALS).map(|i| (end(i), end(i + 1), 0)).collect();
        let mut rule = Rule { points: Vec::new(), weights: Vec::new() };
        while let Some((from, to, halvings)) = left.pop() {
            let middle = 0.5 * (from + to);
            // Between places on one piece a curved argument can still cross a kink twice: it strays
            // from them by less than its second difference.
            let values = [from, middle, to].map(argument);
            let bend = (values[0] - 2.0 * values[1] + values[2]).abs();
            let within_bend = |kink: &f64| values.iter().any(|value| (value - kink).abs() < bend);
            let one_piece = piece(from) == piece(to)
                && piece(middle) == piece(to)
                && !boundary.potential.kinks().iter().any(within_bend);
            // An argument that stays at a kink but for rounding would be halved without end.
            let moves = (argument(to) - argument(from))
                .abs()
                .max(2.0 * (argument(middle) - argument(from)).abs());
            let resolved = moves <= boundary.potential.resolution();
            if (one_piece && resolved) || moves <= ROUNDING * size || halvings == HALVINGS {
                for (b, weight) in gauss.points.iter().zip(&gauss.weights) {
                    let x = from + b[1] * (to - from);
                    rule.points.push(vec![1.0 - x, x]);
                    rule.weights.push(weight * (to - from));
                }
            } else {
                left.push((from, middle, halvings + 1));
                left.push((middle, to, halvings + 1));
            }
        }
        add_points(space, boundary, view, facet, &rule, balance);
    }
}

/// u_ν - s at a point of a facet.
fn argument(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    facet: usize,
    shape: &[f64],
) -> f64 {
    let members = space.trace.facet(facet);
    let values = members.iter().map(|&i| space.trace.normal(i as usize, view.u));
    let normal: f64 = values.zip(shape).map(|(u, s)| s * u).sum();
    normal - (boundary.shift)(space.mesh.point(&vertices(space, facet), shape))
}

fn vertices(space: &Discretization, facet: usize) -> Vec<u32> {
    space.trace.facet(facet).iter().map(|&i| space.trace.points[i as usize].vertex).collect()
}

fn add_points(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    facet: usize,
    rule: &Rule,
    balance: &mut [f64],
) {
    for (shape, weight) in rule.points.iter().zip(&rule.weights) {
        let r = argument(space, boundary, view, facet, shape);
        let mut pressure = boundary.potential.subdifferential(r).0;
        if let Some(scale) = &boundary.scale {
            pressure *= scale(space.mesh.point(&vertices(space, facet), shape));
        }
        for (&i, s) in space.trace.facet(facet).iter().zip(shape) {
            let value = weight * space.trace.measure[facet] * pressure * s;
            space.trace.add_normal(i as usize, value, balance);
        }
    }
}
