//! The checks on a domain of coarse simplices: as on a rectangle or box, on the cells of a refined mesh and on the real
//! sides.

use super::regularity::Lines;
use super::smoothness::{FINE, worst};
use super::{Finding, Status, regularity, times};
use crate::constitutive::Tensor;
use crate::exact::Polytope;
use crate::linear::gradient_of;
use crate::nodal_force::facet_measure;
use crate::simplex_points::{SimplexPoints, parts, points_a_direction};
use crate::zeta_domain::Domain;
use crate::{AccumulatedStrain, Exact};
use fem::mesh::in_dimension;
use fem::mesh::{CoarseMesh, Mesh, Piece};
use fem::space::quadrature::{Rule, edge, tetrahedron_product, triangle_product};

/// Cells on which loads are compared, Gauss points per direction, and in space the approximate total of points.
const LOAD_CELLS: usize = 64;
const POINTS: usize = 8;
const WORK: f64 = 1e5;
/// Tolerance for smooth fields: rounding of some 1e4 terms.
const ROUNDING: f64 = 1e-10;
/// With projection or kinks f0 jumps across curves that no cell follows: an eighth of the domain's length, cut by 8
/// points, leaves some 1e-3 of the jump.
const UNRESOLVED_JUMP: f64 = 1e-2;
/// Agreement of ζ by two rules that leaves time errors unaffected.
const ZETA: f64 = 1e-9;
/// Lines per coarse simplex and direction (in space across each of two directions), on a face of Γ3, and the power by
/// which they crowd at the parallel edge.
const LINES: usize = 16;
const LINES_IN_SPACE: usize = 2;
const LINES_ON_FACE: usize = 4;
const GRADING: i32 = 5;
/// Cells for derivatives in time.
const TIME_CELLS: usize = 512;

/// Strong against weak loads, with the test functions of V^h that interpolate 1, x, y, … off Γ1, component by
/// component: ∫ σ:ε(v) = ∫ f0·v + ∫_{∂Ω} σν·v.
pub(super) fn loads(exact: &Exact, polytope: &Polytope) -> Finding {
    let mesh = parts(&polytope.coarse, LOAD_CELLS);
    let worst_share =
        in_dimension!(mesh.dimension, D => largest_share::<D>(exact, polytope, &mesh));
    let graph = &exact.data.graph;
    let smooth = exact.data.material.projection.is_none() && graph.guards(&exact.stress).is_empty();
    let allowed = if smooth { ROUNDING } else { UNRESOLVED_JUMP };
    let status = if worst_share <= allowed { Status::Verified } else { Status::Failed };
    let text =
        format!("strong and weak loads agree to {worst_share:.1e} of the sum of absolute terms");
    Finding::new("loads", status, worst_share, text)
}

fn largest_share<const D: usize>(exact: &Exact, polytope: &Polytope, mesh: &Mesh) -> f64 {
    let mut found = 0.0f64;
    for t in times(exact) {
        let fields = Fields::<D>::new(exact, mesh, t);
        for test in 0..=D {
            let v = test_function(mesh, &polytope.clamped, test);
            for [difference, absolute] in fields.balance(mesh, &v) {
                found = worst(found, difference / absolute.max(f64::MIN_POSITIVE));
            }
        }
    }
    found
}

/// Nodal values of 1, x, y, …, zero on the clamped sides.
fn test_function(mesh: &Mesh, clamped: &[u32], test: usize) -> Vec<f64> {
    let value = |v: u32| if test == 0 { 1.0 } else { mesh.vertex(v)[test - 1] };
    let mut values: Vec<f64> = (0..mesh.vertices() as u32).map(value).collect();
    for f in mesh.facets_on(clamped) {
        mesh.facet(f).iter().for_each(|&v| values[v as usize] = 0.0);
    }
    values
}

/// Stress and force at the points of the cells, and σν at those of the boundary facets, at one time.
struct Fields<const D: usize> {
    rule: Rule,
    weights: Vec<f64>,
    sigma: Vec<Tensor<D>>,
    force: Vec<Vec<f64>>,
    side_rule: Rule,
    traction: Vec<[f64; D]>,
}

impl<const D: usize> Fields<D> {
    fn new(exact: &Exact, mesh: &Mesh, t: f64) -> Self {
        let (rule, side_rule) = match D {
            2 => (triangle_product(POINTS), edge(POINTS)),
            _ => {
                let points = points_a_direction(mesh.cell_count(), WORK);
                (tetrahedron_product(points), triangle_product(POINTS))
            }
        };
        let inside = SimplexPoints::of(mesh, &rule);
        let sigma = exact.stress_at(&inside.points, t);
        let force = exact.forces.values(&inside.points, t, exact.zeta.at(t));
        let facets = 0..mesh.facet_side.len();
        let on_facet =
            |f: usize| side_rule.points.iter().map(move |b| mesh.point(mesh.facet(f), b));
        let points: Vec<[f64; 3]> = facets.flat_map(on_facet).collect();
        let count = side_rule.points.len();
        let tractions = exact.stress_at::<D>(&points, t).into_iter().enumerate();
        let traction = tractions.map(|(p, sigma)| {
            let normal = mesh.normal(p / count);
            sigma.map(|row| row.iter().zip(normal).map(|(s, n)| s * n).sum())
        });
        let traction = traction.collect();
        Self { rule, weights: inside.weights, sigma, force, side_rule, traction }
    }

    /// Strong minus weak form and the sum of absolute terms, for each component.
    fn balance(&self, mesh: &Mesh, v: &[f64]) -> [[f64; 2]; D] {
        let mut out = [[0.0; 2]; D];
        let count = self.rule.weights.len();
        let at = |corners: &[u32], b: &[f64]| -> f64 {
            corners.iter().zip(b).map(|(&a, b)| v[a as usize] * b).sum()
        };
        for (p, weight) in self.weights.iter().enumerate() {
            let value = at(mesh.cell(p / count), &self.rule.points[p % count]);
            let gradient = gradient::<D>(mesh, p / count, v);
            for (i, out) in out.iter_mut().enumerate() {
                let body = self.force[i][p] * value;
                out[0] += weight * body;
                out[1] += weight * body.abs();
                for (s, slope) in self.sigma[p][i].iter().zip(gradient) {
                    out[0] -= weight * s * slope;
                    out[1] += weight * (s * slope).abs();
                }
            }
        }
        let count = self.side_rule.weights.len();
        for (p, traction) in self.traction.iter().enumerate() {
            let facet = p / count;
            let weight = self.side_rule.weights[p % count] * facet_measure(mesh, facet);
            let value = at(mesh.facet(facet), &self.side_rule.points[p % count]);
            for (out, traction) in out.iter_mut().zip(traction) {
                out[0] += weight * traction * value;
            }
        }
        out
    }
}

fn gradient<const D: usize>(mesh: &Mesh, c: usize, v: &[f64]) -> [f64; D] {
    let cell = mesh.cell(c);
    let at = |a: usize| mesh.vertex(cell[a]);
    let edges: [[f64; D]; D] =
        std::array::from_fn(|a| std::array::from_fn(|i| at(a + 1)[i] - at(0)[i]));
    let rise = std::array::from_fn(|a| v[cell[a + 1] as usize] - v[cell[0] as usize]);
    gradient_of(&edges, &rise)
}

/// ζ(T) by the usual rule against a finer one, which detects kinks inside cells.
pub(super) fn zeta(exact: &Exact, polytope: &Polytope) -> Option<Finding> {
    let known = exact.zeta.at(exact.data.horizon);
    if known.is_nan() {
        return None;
    }
    let (graph, horizon) = (&exact.data.graph, exact.data.horizon);
    let finer = Domain::Finer(&polytope.coarse);
    let finer = AccumulatedStrain::new(graph, &exact.strain, horizon, finer, true).at(horizon);
    let share = ((known - finer) / finer.abs().max(f64::MIN_POSITIVE)).abs();
    let status = if share <= ZETA { Status::Verified } else { Status::Weak };
    let text = format!("zeta(T) = {known:.6} agrees to {share:.1e} with a finer rule");
    Some(Finding::new("zeta", status, share, text))
}

/// Points for derivatives in time: the centroids of cells.
pub(super) fn in_time(polytope: &Polytope) -> (Vec<[f64; 3]>, Vec<f64>) {
    let mesh = parts(&polytope.coarse, TIME_CELLS);
    let corners = mesh.dimension + 1;
    let centroid = Rule { points: vec![vec![1.0 / corners as f64; corners]], weights: vec![1.0] };
    let centroids = SimplexPoints::of(&mesh, &centroid);
    (centroids.points, centroids.weights)
}

/// Number of edges of a simplex.
pub(super) fn directions(coarse: &CoarseMesh) -> usize {
    if coarse.dimension == 2 { 3 } else { 6 }
}

/// The edges of a tetrahedron, each with its opposite one.
const EDGES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]];

/// Lines parallel to an edge of each simplex, crowded at the edge.
pub(super) fn gathered(coarse: &CoarseMesh, direction: usize) -> Vec<Lines> {
    (0..coarse.count()).map(|simplex| in_simplex(coarse, simplex, direction)).collect()
}

fn in_simplex(coarse: &CoarseMesh, simplex: usize, direction: usize) -> Lines {
    let (corners, measure) = (coarse.corners(simplex), coarse.measure_of(simplex));
    // The edge, and the points opposite to it with the share of the opposite edge that each represents.
    let (a, b, opposite, lines) = match coarse.dimension {
        2 => {
            let [a, b, tip] = [0, 1, 2].map(|i: usize| corners[(direction + i) % 3]);
            (a, b, vec![(tip, 1.0)], LINES)
        }
        _ => {
            let [a, b, c, d] = EDGES[direction].map(|i| corners[i]);
            let between = |i: usize| {
                let w = (i as f64 + 0.5) / LINES_IN_SPACE as f64;
                (blend(c, d, w), 1.0 / LINES_IN_SPACE as f64)
            };
            (a, b, (0..LINES_IN_SPACE).map(between).collect(), LINES_IN_SPACE)
        }
    };
    // Not towards the tip: on ever shorter lines all strides would resolve a singularity there equally.
    let place = |i: usize| (i as f64 / lines as f64).powi(GRADING);
    let length = distance(a, blend(a, b, 1.0));
    let (mut points, mut all) = (Vec::new(), Vec::new());
    for (tip, part) in opposite {
        for line in 0..lines {
            let (from, to) = (place(line), place(line + 1));
            let up = 0.5 * (from + to);
            // The density of the distance from the edge: 2(1 - up) in the plane, 6(1 - up) up in space.
            let density = if corners.len() == 3 { 2.0 * (1.0 - up) } else { 6.0 * (1.0 - up) * up };
            let weight = measure * part * density * (to - from) / FINE as f64;
            all.push((weight, (1.0 - up) * length));
            let at = |i: usize| blend(blend(a, b, (i as f64 + 0.5) / FINE as f64), tip, up);
            points.extend((0..FINE).map(at));
        }
    }
    Lines { points, lines: all }
}

/// The second differences of u_ν on each plane piece of Γ3: in space along lines parallel to each of its edges.
pub(super) fn normal_traces(exact: &Exact, polytope: &Polytope) -> Vec<Finding> {
    let family = |([p, q], measure): ([[f64; 3]; 2], f64)| {
        let points = (0..=FINE).map(|i| blend(p, q, i as f64 / FINE as f64)).collect();
        (points, distance(p, q), measure)
    };
    let of_piece = |piece: Piece| {
        let families = lines_on(&piece).into_iter().map(family).collect();
        regularity::normal_trace(exact, (piece.side, piece.normal), families)
    };
    contact_pieces(polytope).map(of_piece).collect()
}

/// Ends of lines on a piece of the boundary, with the measure that each represents: a segment itself, or lines parallel
/// to each edge of a triangle.
fn lines_on(piece: &Piece) -> Vec<([[f64; 3]; 2], f64)> {
    let corners = &piece.corners;
    let [p, q] = [corners[0], corners[1]];
    let Some(&r) = corners.get(2) else { return vec![([p, q], distance(p, q))] };
    let (e, f) = ([0, 1, 2].map(|i| q[i] - p[i]), [0, 1, 2].map(|i| r[i] - p[i]));
    let cross = |i: usize| e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3];
    let doubled_area = distance([0.0; 3], [0, 1, 2].map(cross));
    let lines = |[a, b, tip]: [[f64; 3]; 3]| {
        (0..LINES_ON_FACE).map(move |line| {
            let up = (line as f64 + 0.5) / LINES_ON_FACE as f64;
            let share = doubled_area * (1.0 - up) / LINES_ON_FACE as f64;
            ([blend(a, tip, up), blend(b, tip, up)], share)
        })
    };
    [[p, q, r], [q, r, p], [r, p, q]].into_iter().flat_map(lines).collect()
}

pub(super) fn contact_pieces(polytope: &Polytope) -> impl Iterator<Item = Piece> {
    let pieces = polytope.coarse.pieces().into_iter();
    pieces.filter(|piece| polytope.contact.contains(&piece.side))
}

/// Points of a piece of the boundary: `count` + 1 along a segment or along each edge of a triangle.
pub(super) fn points_of(piece: &Piece, count: usize) -> Vec<[f64; 3]> {
    let share = |i: usize| i as f64 / count as f64;
    let [p, q] = [piece.corners[0], piece.corners[1]];
    match piece.corners.get(2) {
        None => (0..=count).map(|i| blend(p, q, share(i))).collect(),
        Some(&r) => {
            let inside = (0..=count).flat_map(|j| (0..=count - j).map(move |i| (i, j)));
            let at = |(i, j): (usize, usize)| {
                [0, 1, 2].map(|a| p[a] + share(i) * (q[a] - p[a]) + share(j) * (r[a] - p[a]))
            };
            inside.map(at).collect()
        }
    }
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| (q - p).powi(2)).sum::<f64>().sqrt()
}

/// The point at fraction s from p to q.
fn blend(p: [f64; 3], q: [f64; 3], s: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| (1.0 - s) * p[i] + s * q[i])
}

#[cfg(test)]
mod tests;
