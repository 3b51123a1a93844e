//! The checks on a domain of coarse triangles: the same questions as on a rectangle, asked on the cells of
//! a refined mesh and on the real sides.

use super::smoothness::{FINE, STRIDES, judge, largest, rounding, worst};
use super::{Finding, Status, regularity, times};
use crate::manufactured::constitutive::stress;
use crate::manufactured::exact::Polygon;
use crate::manufactured::polygon_points::{PolygonPoints, area, parts};
use crate::manufactured::{AccumulatedStrain, Exact};
use crate::mesh::Mesh;
use crate::space::quadrature::{edge, triangle_product};

/// Cells on which loads are compared, and Gauss points a direction.
const LOAD_CELLS: usize = 64;
const POINTS: usize = 8;
/// Agreement demanded of smooth fields: rounding of some 1e4 terms.
const ROUNDING: f64 = 1e-10;
/// With projection or kinks f0 jumps across curves that no cell follows: an eighth of the domain's
/// length, cut by 8 points, leaves some 1e-3 of the jump.
const UNRESOLVED_JUMP: f64 = 1e-2;
/// Agreement of ζ by two rules that leaves time errors unharmed.
const ZETA: f64 = 1e-9;
/// Lines a coarse triangle and direction, and the power by which they gather at its edge.
const LINES: usize = 16;
const GRADING: i32 = 5;
/// Cells for derivatives in time.
const TIME_CELLS: usize = 512;

/// Strong against weak loads, in the test functions of V^h that interpolate 1, x, y off Γ1, a component at
/// a time: ∫ σ:ε(v) = ∫ f0·v + ∫_{∂Ω} σν·v.
pub(super) fn loads(exact: &Exact, polygon: &Polygon) -> Finding {
    let mesh = parts(&polygon.coarse, LOAD_CELLS);
    let mut worst_share = 0.0f64;
    for t in times(exact) {
        for test in 0..3 {
            let v = test_function(&mesh, &polygon.clamped, test);
            for [difference, absolute] in balance(exact, &mesh, &v, t) {
                worst_share = worst(worst_share, difference / absolute.max(f64::MIN_POSITIVE));
            }
        }
    }
    let graph = &exact.data.graph;
    let smooth = exact.data.material.projection.is_none() && graph.guards(&exact.stress).is_empty();
    let allowed = if smooth { ROUNDING } else { UNRESOLVED_JUMP };
    let status = if worst_share <= allowed { Status::Verified } else { Status::Failed };
    let text =
        format!("strong and weak loads agree to {worst_share:.1e} of the sum of absolute terms");
    Finding::new("loads", status, worst_share, text)
}

/// Nodal values of 1, x or y, zero on the clamped sides.
fn test_function(mesh: &Mesh, clamped: &[u32], test: usize) -> Vec<f64> {
    let value = |v: u32| if test == 0 { 1.0 } else { mesh.vertex(v)[test - 1] };
    let mut values: Vec<f64> = (0..mesh.vertices() as u32).map(value).collect();
    for f in mesh.facets_on(clamped) {
        mesh.facet(f).iter().for_each(|&v| values[v as usize] = 0.0);
    }
    values
}

/// Strong minus weak form and the sum of absolute terms, for each component.
fn balance(exact: &Exact, mesh: &Mesh, v: &[f64], t: f64) -> [[f64; 2]; 2] {
    let mut out = [[0.0; 2]; 2];
    let rule = triangle_product(POINTS);
    let inside = PolygonPoints::of(mesh, &rule);
    let sigma = stresses(exact, &inside.points, t);
    let mut force = vec![Vec::new(); 2];
    exact.forces.bind(&inside.points).evaluate(t, exact.zeta.at(t), &mut force);
    let count = rule.weights.len();
    for (p, weight) in inside.weights.iter().enumerate() {
        let (cell, barycentric) = (mesh.cell(p / count), &rule.points[p % count]);
        let value: f64 = cell.iter().zip(barycentric).map(|(&a, b)| v[a as usize] * b).sum();
        let [dx, dy] = gradient(mesh, p / count, v);
        for (i, out) in out.iter_mut().enumerate() {
            let [x, y] = [sigma[p][i][0] * dx, sigma[p][i][1] * dy];
            let body = force[i][p] * value;
            out[0] += weight * (body - x - y);
            out[1] += weight * (body.abs() + x.abs() + y.abs());
        }
    }
    let rule = edge(POINTS);
    for f in 0..mesh.facet_side.len() {
        let (facet, normal) = (mesh.facet(f), mesh.normal(f));
        let points: Vec<[f64; 3]> = rule.points.iter().map(|b| mesh.point(facet, b)).collect();
        let ends = [mesh.vertex(facet[0]), mesh.vertex(facet[1])];
        let length = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
        for ((sigma, b), weight) in
            stresses(exact, &points, t).iter().zip(&rule.points).zip(&rule.weights)
        {
            let value = b[0] * v[facet[0] as usize] + b[1] * v[facet[1] as usize];
            for (i, out) in out.iter_mut().enumerate() {
                let traction = sigma[i][0] * normal[0] + sigma[i][1] * normal[1];
                out[0] += weight * length * traction * value;
            }
        }
    }
    out
}

fn gradient(mesh: &Mesh, c: usize, v: &[f64]) -> [f64; 2] {
    let cell = mesh.cell(c);
    let at = |a: usize| mesh.vertex(cell[a]);
    let double_area = 2.0 * area(mesh, c);
    let mut sum = [0.0; 2];
    for a in 0..3 {
        let (p, q) = (at((a + 1) % 3), at((a + 2) % 3));
        let value = v[cell[a] as usize] / double_area;
        sum[0] += value * (p[1] - q[1]);
        sum[1] += value * (q[0] - p[0]);
    }
    sum
}

/// σ at points, from the numerical law.
fn stresses(exact: &Exact, points: &[[f64; 3]], t: f64) -> Vec<[[f64; 2]; 2]> {
    let mut out = vec![Vec::new(); 5 + exact.memory.len()];
    exact.interior.bind(points).evaluate(t, 0.0, &mut out);
    let kappa = exact.kappa(t);
    let tensor = |first: usize, p: usize| {
        let at = |i: usize| out.get(first + i).map_or(0.0, |field| field[p]);
        [[at(0), at(1)], [at(1), at(2)]]
    };
    let (regions, terms) = (exact.regions_at(points), exact.data.kernels.len());
    let one = |p: usize| {
        let memory: Vec<_> = (0..terms).map(|term| tensor(5 + 3 * term, p)).collect();
        stress(exact.material_in(regions[p]), &tensor(2, p), &memory, kappa)
    };
    (0..points.len()).map(one).collect()
}

/// ζ(T) by the rule of the truth against the same rule on triangles of half the size: kinks inside the
/// domain, which no triangle follows, show here.
pub(super) fn zeta(exact: &Exact, polygon: &Polygon) -> Option<Finding> {
    let known = exact.zeta.at(exact.data.horizon);
    if known.is_nan() {
        return None;
    }
    let (mut graph, horizon) = (exact.data.graph.clone(), exact.data.horizon);
    let size = &exact.data.size;
    let finer = AccumulatedStrain::new(&mut graph, &exact.strain, horizon, size, true)
        .over_finer(&polygon.coarse)
        .at(horizon);
    let share = ((known - finer) / finer.abs().max(f64::MIN_POSITIVE)).abs();
    let status = if share <= ZETA { Status::Verified } else { Status::Weak };
    let text = format!("zeta(T) = {known:.6} agrees to {share:.1e} with a finer rule");
    Some(Finding::new("zeta", status, share, text))
}

/// Points for derivatives in time: the centroids of cells.
pub(super) fn in_time(polygon: &Polygon) -> (Vec<[f64; 3]>, Vec<f64>) {
    let own = PolygonPoints::of(&parts(&polygon.coarse, TIME_CELLS), &triangle_product(1));
    (own.points, own.weights)
}

/// ‖f(· + δe) - f‖/δ in L² along lines parallel to the edges of each coarse triangle, at three times. The
/// lines gather at the edge.
pub(super) fn space_derivative(
    exact: &Exact,
    polygon: &Polygon,
    values: impl Fn(&[[f64; 3]], f64) -> Vec<Vec<f64>>,
    subject: &str,
) -> Finding {
    let coarse = &polygon.coarse;
    let (mut quotients, mut size) = ([0.0f64; 4], 0.0f64);
    for t in times(exact) {
        for direction in 0..3 {
            let mut sums = [0.0; 4];
            for triangle in 0..coarse.triangles.len() {
                let corners = coarse.corners(triangle);
                let (points, lines) = gathered(corners, direction, coarse.area(triangle));
                for component in values(&points, t) {
                    size = worst(size, largest(&component));
                    for (line, (weight, length)) in component.chunks(FINE).zip(&lines) {
                        for (sum, stride) in sums.iter_mut().zip(STRIDES) {
                            let delta = length * stride as f64 / FINE as f64;
                            let pairs = line.iter().zip(&line[stride..]);
                            let squares = pairs.map(|(a, b)| ((b - a) / delta).powi(2));
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
    let [width, height] = [exact.data.size[0], exact.data.size[1]];
    let floor = rounding(size, (width * height).sqrt(), width.min(height) / FINE as f64);
    judge(subject, "the difference quotient in L2", &quotients, floor)
}

/// Points along lines parallel to an edge of a triangle; of each line the area that a point stands for,
/// and the length.
fn gathered(
    corners: [[f64; 2]; 3],
    direction: usize,
    area: f64,
) -> (Vec<[f64; 3]>, Vec<(f64, f64)>) {
    let [a, b, tip] = [0, 1, 2].map(|i: usize| corners[(direction + i) % 3]);
    // Not towards the tip: on ever shorter lines all strides would resolve a singularity there alike.
    let place = |i: usize| (i as f64 / LINES as f64).powi(GRADING);
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let (mut points, mut lines) = (Vec::new(), Vec::new());
    for line in 0..LINES {
        let (from, to) = (place(line), place(line + 1));
        let up = 0.5 * (from + to);
        lines.push((2.0 * area * (1.0 - up) * (to - from) / FINE as f64, (1.0 - up) * length));
        points.extend((0..FINE).map(|i| {
            let s = (i as f64 + 0.5) / FINE as f64;
            let at = |k: usize| (1.0 - up) * ((1.0 - s) * a[k] + s * b[k]) + up * tip[k];
            [at(0), at(1), 0.0]
        }));
    }
    (points, lines)
}

/// ‖second difference of u_ν‖/δ² in L² along each plane piece of Γ3.
pub(super) fn normal_traces(exact: &Exact, polygon: &Polygon) -> Vec<Finding> {
    contact_segments(polygon)
        .map(|([p, q], normal)| {
            let length = (q[0] - p[0]).hypot(q[1] - p[1]);
            let program = exact.boundary(&normal).program;
            regularity::normal_trace_along(exact, &program, length, |s| along(p, q, s))
        })
        .collect()
}

/// The plane pieces of Γ3: ends and normals.
pub(super) fn contact_segments(
    polygon: &Polygon,
) -> impl Iterator<Item = ([[f64; 2]; 2], [f64; 2])> {
    let own = |side: u32| polygon.contact.contains(&side);
    polygon.coarse.edges.iter().filter(move |e| own(e.side)).map(|e| polygon.coarse.segment(e))
}

/// The point at fraction s of a segment.
pub(super) fn along(p: [f64; 2], q: [f64; 2], s: f64) -> [f64; 3] {
    [(1.0 - s) * p[0] + s * q[0], (1.0 - s) * p[1] + s * q[1], 0.0]
}

#[cfg(test)]
mod tests;
