//! An edge of Γ3 cut where u_ν - s crosses a kink of ∂j_ν: on each piece ∂j_ν(u_ν - s) is smooth,
//! so Gauss points integrate it exactly where the shift is affine and ∂j_ν piecewise linear, and to
//! rounding elsewhere, on pieces no longer than the resolution of ∂j_ν.

use crate::space::quadrature::gauss_legendre;
use vhi::law::Potential;

/// Gauss points a piece: degree 15.
const POINTS: usize = 8;
/// Parts of a piece at most: beyond, u_ν - s ranges over 64 resolutions on one edge, and the mesh is
/// too coarse for any rule.
const PARTS: f64 = 64.0;
/// Intervals of an edge on which crossings are looked for.
const WATCHES: usize = 16;

/// Where s is asked for ahead: ξ of the ends and middles of the intervals.
pub(crate) fn watched() -> impl Iterator<Item = f64> {
    (0..=2 * WATCHES).map(place)
}

/// A point on an edge: ξ, weight (the weights of an edge sum to one), u_ν - s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct EdgePoint {
    /// ξ.
    pub place: f64,
    /// Weight.
    pub weight: f64,
    /// u_ν - s.
    pub argument: f64,
}

/// Points of an edge and the places where it is cut, in memory that is kept.
#[derive(Debug, Default)]
pub(crate) struct Room {
    /// The points.
    pub points: Vec<EdgePoint>,
    cuts: Vec<f64>,
}

/// The points of an edge with end values `normal` of u_ν for ∂j_ν; `shift` is s by ξ, and `at_watched` its values there.
pub(crate) fn points(
    normal: [f64; 2],
    at_watched: &[f64],
    shift: impl Fn(f64) -> f64,
    law: &dyn Potential,
    room: &mut Room,
) {
    let Room { points: out, cuts } = room;
    let straight = |x: f64| normal[0] + x * (normal[1] - normal[0]);
    let argument = |x: f64| straight(x) - shift(x);
    out.clear();
    cuts.clear();
    cuts.extend([0.0, 1.0]);
    let at = |i: usize| straight(place(i)) - at_watched[i];
    add_cuts(argument, at, law.kinks(), cuts);
    fill(cuts, law.resolution(), argument, out);
}

fn place(i: usize) -> f64 {
    i as f64 / (2 * WATCHES) as f64
}

/// Adds the zeros of u_ν - s less a kink to 0 and 1: sign changes on half intervals, and between two crossings in
/// one interval, which the vertex of the parabola through its ends and its middle shows.
fn add_cuts(
    argument: impl Fn(f64) -> f64,
    at: impl Fn(usize) -> f64,
    kinks: &[f64],
    cuts: &mut Vec<f64>,
) {
    for kink in kinks {
        let offset = |x: f64| argument(x) - kink;
        for watch in 0..WATCHES {
            let (a, m, b) = (2 * watch, 2 * watch + 1, 2 * watch + 2);
            let [fa, fm, fb] = [a, m, b].map(|i| at(i) - kink);
            let (mut ends, mut count) = ([place(a), place(m), place(b), 0.0], 3);
            let bend = fa - 2.0 * fm + fb;
            let vertex = 0.5 * (fa - fb) / bend;
            if vertex.abs() < 1.0 {
                (ends[3], count) = (place(m) + 0.5 * vertex / WATCHES as f64, 4);
                ends.sort_unstable_by(f64::total_cmp);
            }
            for pair in ends[..count].windows(2) {
                cuts.extend(crossing(offset, pair[0], pair[1]));
            }
        }
    }
    cuts.sort_unstable_by(f64::total_cmp);
}

/// The sign change of f between two places, by bisection to rounding.
fn crossing(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> Option<f64> {
    let negative = f(low) < 0.0;
    if (f(high) < 0.0) == negative {
        return None;
    }
    // 52 halvings exhaust the digits of an f64.
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        if (f(middle) < 0.0) == negative { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

fn fill(cuts: &[f64], resolution: f64, argument: impl Fn(f64) -> f64, out: &mut Vec<EdgePoint>) {
    let rule = gauss_legendre(POINTS);
    for pair in cuts.windows(2).filter(|pair| pair[1] > pair[0]) {
        let range = (argument(pair[1]) - argument(pair[0])).abs();
        // A NaN argument shows in the points; it must not make a number of parts.
        let parts = (range / resolution).ceil().clamp(1.0, PARTS);
        let parts = if parts.is_nan() { 1.0 } else { parts };
        let length = (pair[1] - pair[0]) / parts;
        for part in 0..parts as usize {
            let (middle, half) = (pair[0] + (part as f64 + 0.5) * length, 0.5 * length);
            out.extend(rule.iter().map(|(x, weight)| {
                let place = middle + half * x;
                EdgePoint { place, weight: 0.5 * weight * length, argument: argument(place) }
            }));
        }
    }
}
