//! The regularity that (5.26) requires, measured by differences under refinement: the quotient converges if and only if
//! the derivative is bounded.

use super::polytope::{self, blend, distance};
use super::smoothness::{
    FINE, STRIDES, judge, largest, rounding, second_difference, second_quotients, worst,
};
use super::{BodyFace, Finding, times};
use crate::Exact;
use crate::symbolic::components;
use fem::mesh::Face;
use formula::{EvaluationPoint, Program};

/// Lines across the direction of differences in time.
const LINES: usize = 12;
/// Lines across the direction of differences in space, and the power by which they crowd at the sides: singularities
/// are at corners and sides, and the nearest lines are 1e-5 from these.
const GRADED_LINES: usize = 16;
const GRADING: i32 = 5;
/// Graded points in space, across each of two directions.
const GRADED_IN_SPACE: usize = 8;
/// Points across the direction in which zones move, for the derivatives in time.
const ACROSS_ZONES: usize = 96;
/// Lines along each direction of a rectangle of the boundary, and beside each edge of a triangle.
const ON_FACE: usize = 12;
const ON_TRIANGLE: usize = 4;

pub(super) fn regularity(exact: &Exact, faces: &[BodyFace]) -> Vec<Finding> {
    let mut findings = time_derivatives(exact).to_vec();
    let [in_space, normal] = space_findings(exact, faces);
    findings.extend(in_space);
    let subject = in_body(exact, "sigma in H1", "(5.18)");
    findings.push(space_derivative(exact, Field::Stress, &subject));
    findings.extend(normal);
    findings.extend(kernels(exact));
    findings
}

/// Requirements of Theorem 7: (5.15), and ℬ in C².
pub fn regularity_in_time(exact: &Exact) -> Vec<Finding> {
    let [second, _] = time_derivatives(exact);
    let mut findings = vec![second];
    findings.extend(kernels(exact));
    findings
}

/// Requirements of (5.25).
pub fn regularity_in_space(exact: &Exact, faces: &[BodyFace]) -> Vec<Finding> {
    space_findings(exact, faces).concat()
}

fn space_findings(exact: &Exact, faces: &[BodyFace]) -> [Vec<Finding>; 2] {
    let contact = faces.iter().filter(|of| of.contact && !exact.data.contact.is_empty());
    let traces = contact.map(|of| normal_trace(exact, of)).collect();
    let subject = in_body(exact, "u in H2", "(5.25)");
    [vec![space_derivative(exact, Field::Strain, &subject)], traces]
}

/// `what`(Omega), or on each region.
fn in_body(exact: &Exact, what: &str, equation: &str) -> String {
    match exact.data.regions.is_empty() {
        true => format!("{what}(Omega) {equation}"),
        false => format!("{what} by region {equation}"),
    }
}

/// sup_t ‖ε(u(t+δ) - 2u(t) + u(t-δ))‖/δ², and the norm in L²(Ω) of the pointwise variation Σ |ε(u(t+δ) - 2u(t) +
/// u(t-δ))|/δ, which order 2 of the trapezoidal rule needs.
fn time_derivatives(exact: &Exact) -> [Finding; 2] {
    let (points, areas) = match &exact.data.polytope {
        Some(coarse) => polytope::in_time(coarse),
        None => {
            let points = grid(exact);
            let area = exact.data.measure() / points.len() as f64;
            let count = points.len();
            (points, vec![area; count])
        }
    };
    let mut bound = exact.interior.bind(&points);
    let d = exact.dimension();
    let strains = d..d + exact.strain.len();
    let count = FINE / 3;
    let step = exact.data.horizon / count as f64;
    let history: Vec<Vec<f64>> = (0..=count)
        .map(|n| {
            let out = bound.values_at(step * n as f64, 0.0);
            out[strains.clone()].concat()
        })
        .collect();
    let (mut second, mut variation) = ([0.0f64; 4], [0.0f64; 4]);
    for (level, stride) in STRIDES.into_iter().enumerate() {
        let delta = step * stride as f64;
        let mut bends = vec![0.0; points.len()];
        for n in (stride..=count - stride).step_by(stride) {
            let [a, b, c] = [n - stride, n, n + stride].map(|i| &history[i]);
            let mut sum = 0.0;
            for (p, bend) in bends.iter_mut().enumerate() {
                let component = |i: usize| {
                    let at = i * points.len() + p;
                    a[at] - 2.0 * b[at] + c[at]
                };
                // Shear counts twice in the Frobenius norm.
                let weighted = components(d).into_iter().enumerate().map(|(at, (i, j))| {
                    if i == j { component(at).powi(2) } else { 2.0 * component(at).powi(2) }
                });
                let square: f64 = weighted.sum();
                sum += areas[p] * square;
                *bend += square.sqrt() / delta;
            }
            second[level] = worst(second[level], sum.sqrt() / delta.powi(2));
        }
        let squares = bends.iter().zip(&areas).map(|(bend, area)| area * bend * bend);
        variation[level] = squares.sum::<f64>().sqrt();
    }
    let (size, one) = (largest(history.iter().flatten()), exact.data.measure().sqrt());
    let second_rounding = rounding(size, one, step.powi(2));
    let variation_rounding = rounding(size, one * count as f64, step);
    let what = "sup_t |eps(second time difference)|";
    let pointwise = "the pointwise variation of eps(u')";
    [
        judge("u in W2,inf(0,T;V) (5.15)", what, &second, second_rounding),
        judge("eps(u') in L2(Omega;BV)", pointwise, &variation, variation_rounding),
    ]
}

#[derive(Clone, Copy)]
enum Field {
    Strain,
    Stress,
}

/// Lines of equally many points each, in order.
pub(super) struct Lines {
    pub points: Vec<[f64; 3]>,
    /// The measure per point of each line, and its length.
    pub lines: Vec<(f64, f64)>,
}

/// ‖f(· + δe) - f‖/δ in L², in all directions (along the edges of each coarse simplex), at three times.
fn space_derivative(exact: &Exact, field: Field, subject: &str) -> Finding {
    let directions = match &exact.data.polytope {
        Some(coarse) => polytope::directions(coarse),
        None => exact.dimension(),
    };
    let (mut quotients, mut size) = ([0.0f64; 4], 0.0f64);
    for t in times(exact) {
        for direction in 0..directions {
            let families = match &exact.data.polytope {
                Some(coarse) => polytope::gathered(coarse, direction),
                None => vec![gathered(exact, direction)],
            };
            let mut sums = [0.0; 4];
            for Lines { points, lines } in families {
                let regions = exact.regions_at(&points);
                for component in field_values(exact, field, &points, t) {
                    size = worst(size, largest(&component));
                    let on_lines = component.chunks(FINE).zip(regions.chunks(FINE)).zip(&lines);
                    for ((line, region), (weight, length)) in on_lines {
                        for (sum, stride) in sums.iter_mut().zip(STRIDES) {
                            let delta = length * stride as f64 / FINE as f64;
                            // Strains jump where the material does: H² is required on each region.
                            let pairs =
                                (0..FINE - stride).filter(|&i| region[i] == region[i + stride]);
                            let squares =
                                pairs.map(|i| ((line[i + stride] - line[i]) / delta).powi(2));
                            *sum += weight * squares.sum::<f64>();
                        }
                    }
                }
            }
            for (quotient, sum) in quotients.iter_mut().zip(sums) {
                *quotient = worst(*quotient, sum.sqrt());
            }
        }
    }
    let lengths = &exact.data.size;
    let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
    let floor = rounding(size, lengths.iter().product::<f64>().sqrt(), shortest / FINE as f64);
    judge(subject, "the difference quotient in L2", &quotients, floor)
}

fn field_values(exact: &Exact, field: Field, points: &[[f64; 3]], t: f64) -> Vec<Vec<f64>> {
    let (nodes, zeta) = match field {
        Field::Strain => (&exact.strain, 0.0),
        Field::Stress => (&exact.stress, exact.zeta.at(t)),
    };
    Program::compile(&exact.data.graph, nodes, exact.data.horizon).values(points, t, zeta)
}

/// Families of parallel lines of [`FINE`] intervals on a piece of the boundary, with their length and the measure of what a
/// family represents: along each edge of a rectangle, and in a triangle each line parallel to an edge by itself.
fn families(face: &Face) -> Vec<(Vec<[f64; 3]>, f64, f64)> {
    let plus = |p: [f64; 3], e: [f64; 3], share: f64| [0, 1, 2].map(|i| p[i] + share * e[i]);
    let line =
        |p: [f64; 3], q: [f64; 3]| (0..=FINE).map(move |i| blend(p, q, i as f64 / FINE as f64));
    let (p, measure) = (face.corner, face.measure());
    match (&face.edges[..], face.triangle) {
        (&[e, f], false) => {
            let along = |(along, across)| {
                let start = |i: usize| plus(p, across, middle(i, ON_FACE));
                let lines = (0..ON_FACE).flat_map(|i| line(start(i), plus(start(i), along, 1.0)));
                (lines.collect(), distance([0.0; 3], along), measure)
            };
            [(e, f), (f, e)].map(along).to_vec()
        }
        (&[e, f], true) => {
            let [q, r] = [e, f].map(|edge| plus(p, edge, 1.0));
            let beside = |[a, b, tip]: [[f64; 3]; 3]| {
                (0..ON_TRIANGLE).map(move |i| {
                    let up = middle(i, ON_TRIANGLE);
                    let [a, b] = [a, b].map(|end| blend(end, tip, up));
                    let share = 2.0 * measure * (1.0 - up) / ON_TRIANGLE as f64;
                    (line(a, b).collect(), distance(a, b), share)
                })
            };
            [[p, q, r], [q, r, p], [r, p, q]].into_iter().flat_map(beside).collect()
        }
        (edges, _) => {
            edges.iter().map(|&e| (line(p, plus(p, e, 1.0)).collect(), measure, measure)).collect()
        }
    }
}

/// ‖second difference of u_ν‖/δ² in L² along families of lines on a part of Γ3.
fn normal_trace(exact: &Exact, BodyFace { side, face, .. }: &BodyFace) -> Finding {
    let program = exact.boundary(*side, &face.normal[..exact.dimension()]).program;
    // The largest over directions and times.
    let (mut quotients, mut floor) = ([0.0f64; 4], 0.0f64);
    for (points, length, measure) in families(face) {
        let (mut bound, mut extent) = (program.bind(&points), 0.0f64);
        let (lines, step) = (points.len() / (FINE + 1), length / FINE as f64);
        for t in times(exact) {
            let out = bound.values_at(t, 0.0);
            extent = worst(extent, largest(&out[0]));
            for (quotient, stride) in quotients.iter_mut().zip(STRIDES) {
                let delta = length * stride as f64 / FINE as f64;
                let squares = |u_nu: &[f64]| {
                    second_quotients(u_nu, stride, delta).map(|second| second.powi(2)).sum::<f64>()
                };
                let sum = out[0].chunks(FINE + 1).fold(0.0, |sum, u_nu| sum + squares(u_nu));
                let mean = measure / (FINE * lines) as f64;
                *quotient = worst(*quotient, (mean * sum).sqrt());
            }
        }
        floor = floor.max(rounding(extent, measure.sqrt(), step.powi(2)));
    }
    let (subject, what) = ("u_nu in H2(Gamma3) (5.25)", "the second difference quotient in L2");
    judge(subject, what, &quotients, floor)
}

/// max |b''| by second differences, of each term of the memory.
fn kernels(exact: &Exact) -> impl Iterator<Item = Finding> {
    let inner = exact.data.inner.iter().map(|(_, node)| node);
    exact.data.kernels.iter().chain(inner).map(|&node| {
        let at = |t: f64| EvaluationPoint { t, ..EvaluationPoint::default() };
        let value = |t: f64| exact.data.graph.evaluate(node, &at(t));
        second_difference("B in C2[0,T]", "the kernel", exact.data.horizon, value)
    })
}

/// Lines in a direction, with [`FINE`] midpoints each; they crowd at the sides.
fn gathered(exact: &Exact, direction: usize) -> Lines {
    let size = &exact.data.size;
    let graded = if size.len() == 2 { GRADED_LINES } else { GRADED_IN_SPACE };
    let place = |i: usize| {
        let x = 2.0 * i as f64 / graded as f64;
        let half = |x: f64| 0.5 * x.powi(GRADING);
        if x <= 1.0 { half(x) } else { 1.0 - half(2.0 - x) }
    };
    // Where a line crosses the other directions, and the part of their product that it represents.
    let mut crossings = vec![([0.0; 3], 1.0)];
    for across in (0..size.len()).filter(|&axis| axis != direction) {
        let strip = |(point, share): ([f64; 3], f64)| {
            (0..graded).map(move |line| {
                let (from, to) = (place(line), place(line + 1));
                let mut point = point;
                point[across] = size[across] * 0.5 * (from + to);
                (point, share * (to - from))
            })
        };
        crossings = crossings.into_iter().flat_map(strip).collect();
    }
    let weight = |share| size.iter().fold(share, |weight, length| weight * length) / FINE as f64;
    let lines = crossings.iter().map(|(_, share)| (weight(*share), size[direction])).collect();
    let starts = crossings.into_iter().map(|(point, _)| point).collect();
    let middles: Vec<f64> =
        (0..FINE).map(|i| size[direction] * (i as f64 + 0.5) / FINE as f64).collect();
    Lines { points: spread(starts, direction, &middles), lines }
}

/// Each point at all places of an axis, which vary fastest.
fn spread(points: Vec<[f64; 3]>, axis: usize, places: &[f64]) -> Vec<[f64; 3]> {
    let at_places = |point: [f64; 3]| {
        places.iter().map(move |&place| {
            let mut point = point;
            point[axis] = place;
            point
        })
    };
    points.into_iter().flat_map(at_places).collect()
}

fn middle(i: usize, n: usize) -> f64 {
    (i as f64 + 0.5) / n as f64
}

/// Midpoints of equal cells of the domain, many of them along x.
fn grid(exact: &Exact) -> Vec<[f64; 3]> {
    let size = &exact.data.size;
    size.iter().enumerate().fold(vec![[0.0; 3]], |points, (axis, length)| {
        let count = if axis == 0 { ACROSS_ZONES } else { LINES / 2 };
        let middles: Vec<f64> = (0..count).map(|i| length * middle(i, count)).collect();
        spread(points, axis, &middles)
    })
}

#[cfg(test)]
mod tests;
