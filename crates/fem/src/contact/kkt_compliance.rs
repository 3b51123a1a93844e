//! The compliance forces of the separate KKT evaluation: from the subdifferential alone, and, for the
//! exact rule, without a formula for the crossings of kinks.

use std::sync::LazyLock;

use super::case::StepView;
use super::{Boundary, Discretization};
use crate::space::quadrature::gauss_legendre;

/// Intervals of an edge before any is halved, and Gauss points on each: degree 19, so that intervals of
/// one resolution of a curved law are integrated to rounding by other points than the solver's.
const INTERVALS: usize = 4;
const POINTS: usize = 10;
/// Halvings of an interval in which ∂j_ν has a kink: what remains of it, 2⁻⁴⁰ of an edge, no longer
/// counts.
const HALVINGS: u32 = 40;
/// Changes of u_ν - s below this share of it, and of the kinks, are rounding.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Adds ∫ ∂j_ν(u_ν - s) v_ν by the Gauss rule of the facets, with u_ν - s `moved`.
pub(crate) fn add_gauss(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    moved: f64,
    balance: &mut [f64],
) {
    let rule = if space.mesh.dimension == 2 { &*ON_EDGES } else { &*ON_TRIANGLES };
    for facet in facets_of(space, boundary) {
        for (shape, weight) in rule {
            add_point(space, boundary, view, (facet, shape, *weight), moved, balance);
        }
    }
}

fn facets_of<'a>(
    space: &'a Discretization,
    boundary: &'a Boundary,
) -> impl Iterator<Item = usize> + 'a {
    (0..space.trace.measure.len()).filter(|&f| boundary.is_on(space.side(f)))
}

/// The rule of the discrete problem by closed forms of its own, so that a solver with other points is refused: Gauss's
/// three points of an edge.
static ON_EDGES: LazyLock<Vec<(Vec<f64>, f64)>> = LazyLock::new(|| {
    let end = 0.5 * (1.0 - 0.6f64.sqrt());
    let at = |x: f64, weight: f64| (vec![1.0 - x, x], weight / 18.0);
    vec![at(end, 5.0), at(0.5, 8.0), at(1.0 - end, 5.0)]
});

/// Twice three points of a triangle, exact for degree 4 (Strang and Fix).
static ON_TRIANGLES: LazyLock<Vec<(Vec<f64>, f64)>> = LazyLock::new(|| {
    let ten = 10f64.sqrt();
    let (inner, outer) =
        ((38.0 - 44.0 * 0.4f64.sqrt()).sqrt(), (213_125.0 - 53_320.0 * ten).sqrt());
    let three = |sign: f64| {
        let (a, weight) = ((8.0 - ten + sign * inner) / 18.0, (620.0 + sign * outer) / 3720.0);
        (0..3).map(move |i| {
            ((0..3).map(|j| if i == j { 1.0 - 2.0 * a } else { a }).collect(), weight)
        })
    };
    three(1.0).chain(three(-1.0)).collect()
});

/// Adds ∫ ∂j_ν(u_ν - s) v_ν, with u_ν - s `moved`, by halving intervals at whose ends it lies on different pieces.
pub(crate) fn add_exact(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    moved: f64,
    balance: &mut [f64],
) {
    let gauss = gauss_legendre(POINTS);
    for facet in facets_of(space, boundary) {
        let argument = |x: f64| argument(space, boundary, view, facet, &[1.0 - x, x]) + moved;
        let piece = |x: f64| boundary.potential.kinks().partition_point(|kink| *kink < argument(x));
        let sizes = boundary.potential.kinks().iter().copied();
        let size = sizes.chain([0.0, 0.5, 1.0].map(argument)).fold(0.0f64, |m, r| m.max(r.abs()));
        let end = |i: usize| i as f64 / INTERVALS as f64;
        // Depth first: of every halving one half waits.
        let mut left = [(0.0, 0.0, 0); INTERVALS + HALVINGS as usize];
        let mut waiting = INTERVALS;
        for (i, interval) in left.iter_mut().enumerate().take(INTERVALS) {
            *interval = (end(i), end(i + 1), 0);
        }
        while waiting > 0 {
            waiting -= 1;
            let (from, to, halvings) = left[waiting];
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
                for (place, weight) in gauss {
                    let x = from + 0.5 * (1.0 + place) * (to - from);
                    let weight = 0.5 * weight * (to - from);
                    let shape = &[1.0 - x, x];
                    add_point(space, boundary, view, (facet, shape, weight), moved, balance);
                }
            } else {
                left[waiting] = (from, middle, halvings + 1);
                left[waiting + 1] = (middle, to, halvings + 1);
                waiting += 2;
            }
        }
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
    normal - (boundary.shift)(place(space, facet, shape))
}

fn place(space: &Discretization, facet: usize, shape: &[f64]) -> [f64; 3] {
    let members = space.trace.facet(facet);
    let mut vertices = [0; 3];
    for (vertex, &i) in vertices.iter_mut().zip(members) {
        *vertex = space.trace.points[i as usize].vertex;
    }
    space.mesh.point(&vertices[..members.len()], shape)
}

fn add_point(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    (facet, shape, weight): (usize, &[f64], f64),
    moved: f64,
    balance: &mut [f64],
) {
    let r = argument(space, boundary, view, facet, shape) + moved;
    let mut pressure = boundary.potential.subdifferential(r).0;
    if let Some(scale) = &boundary.scale {
        pressure *= scale(place(space, facet, shape));
    }
    for (&i, s) in space.trace.facet(facet).iter().zip(shape) {
        let value = weight * space.trace.measure[facet] * pressure * s;
        space.trace.add_normal(i as usize, value, balance);
    }
}
