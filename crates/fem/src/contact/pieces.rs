//! An edge of Γ3 cut where u_ν - s crosses a kink of ∂j_ν: on each piece ∂j_ν(u_ν - s) is smooth,
//! so Gauss points integrate it exactly where the shift is affine and ∂j_ν piecewise linear, and to
//! rounding where ∂j_ν is curved, on pieces no longer than its resolution.

use crate::space::quadrature::gauss_legendre;

/// Gauss points a piece where s is affine on the edge: ∂j_ν φ is a quadratic polynomial there.
const POINTS_AFFINE: usize = 2;
/// Gauss points a piece where it is not, where ∂j_ν is curved or has a factor c(x): degree 15.
const POINTS_CURVED: usize = 8;
/// Parts of a piece at most: beyond, u_ν - s ranges over 64 resolutions on one edge, and the mesh is
/// too coarse for any rule.
const PARTS: f64 = 64.0;
/// Intervals of an edge on which crossings are looked for under a curved shift.
const WATCHES: usize = 16;
/// A shift within this many units of rounding of its chord counts as affine.
const ROUNDING_UNITS: f64 = 16.0;

/// The shift along one edge, by ξ in [0, 1].
pub(crate) enum EdgeShift {
    /// By its values at the ends.
    Affine([f64; 2]),
    /// By its values at the ends of 2·[`WATCHES`] intervals; between them it is asked for.
    Curved(Vec<f64>),
}

impl EdgeShift {
    /// Looks at `shift` on the whole edge.
    pub(crate) fn new(shift: impl Fn(f64) -> f64) -> Self {
        let count = 2 * WATCHES;
        let place = |i: usize| i as f64 / count as f64;
        let values: Vec<f64> = (0..=count).map(|i| shift(place(i))).collect();
        let [first, last] = [values[0], values[count]];
        let size = values.iter().fold(0.0f64, |size, value| size.max(value.abs()));
        let affine = values.iter().enumerate().all(|(i, value)| {
            let chord = first + place(i) * (last - first);
            (value - chord).abs() <= ROUNDING_UNITS * f64::EPSILON * size
        });
        if affine { Self::Affine([first, last]) } else { Self::Curved(values) }
    }
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

/// What the rule must know of ∂j_ν.
pub(crate) struct Pieces {
    /// Its kinks.
    pub kinks: Vec<f64>,
    /// [`vhi::law::Potential::resolution`].
    pub resolution: f64,
    /// Whether it has a factor c(x).
    pub scaled: bool,
}

/// Points of an edge and the places where it is cut, in memory that is kept.
#[derive(Debug, Default)]
pub(crate) struct Room {
    /// The points.
    pub points: Vec<EdgePoint>,
    cuts: Vec<f64>,
}

/// The points of an edge with end values `normal` of u_ν; `shift` is s by ξ.
pub(crate) fn points(
    normal: [f64; 2],
    along: &EdgeShift,
    shift: impl Fn(f64) -> f64,
    law: &Pieces,
    room: &mut Room,
) {
    let Room { points: out, cuts } = room;
    let (kinks, resolution) = (law.kinks.as_slice(), law.resolution);
    let straight = |ends: [f64; 2], x: f64| ends[0] + x * (ends[1] - ends[0]);
    out.clear();
    cuts.clear();
    cuts.extend([0.0, 1.0]);
    match along {
        EdgeShift::Affine(ends) => {
            let argument = [normal[0] - ends[0], normal[1] - ends[1]];
            affine_cuts(argument, kinks, cuts);
            let polynomial = resolution.is_infinite() && !law.scaled;
            let count = if polynomial { POINTS_AFFINE } else { POINTS_CURVED };
            fill(cuts, count, resolution, |x| straight(argument, x), out);
        }
        EdgeShift::Curved(values) => {
            let argument = |x: f64| straight(normal, x) - shift(x);
            let count = values.len() - 1;
            let at = |i: usize| straight(normal, i as f64 / count as f64) - values[i];
            curved_cuts(argument, at, kinks, cuts);
            fill(cuts, POINTS_CURVED, resolution, argument, out);
        }
    }
}

/// Adds the crossings of kinks to 0 and 1.
fn affine_cuts(argument: [f64; 2], kinks: &[f64], cuts: &mut Vec<f64>) {
    let slope = argument[1] - argument[0];
    let crossing = |kink: &f64| (kink - argument[0]) / slope;
    cuts.extend(kinks.iter().map(crossing).filter(|x| *x > 0.0 && *x < 1.0));
    cuts.sort_unstable_by(f64::total_cmp);
}

/// Zeros of a curved argument: sign changes on half intervals, and between two crossings in
/// one interval, which the vertex of the parabola through its ends and its middle shows.
fn curved_cuts(
    argument: impl Fn(f64) -> f64,
    at: impl Fn(usize) -> f64,
    kinks: &[f64],
    cuts: &mut Vec<f64>,
) {
    let place = |i: usize| i as f64 / (2 * WATCHES) as f64;
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

fn fill(
    cuts: &[f64],
    count: usize,
    resolution: f64,
    argument: impl Fn(f64) -> f64,
    out: &mut Vec<EdgePoint>,
) {
    let rule = gauss_legendre(count);
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
