//! The checks on a domain of coarse simplices: as on a rectangle or box, on the cells of a refined mesh and on the real
//! sides.

use super::loads::Places;
use super::regularity::Lines;
use super::smoothness::FINE;
use super::{BodyFace, Finding, Status};
use crate::linear::gradient_of;
use crate::nodal_force::facet_measure;
use crate::simplex_points::{SimplexPoints, measure, parts, points_a_direction};
use crate::zeta_domain::Domain;
use crate::{AccumulatedStrain, Exact};
use fem::mesh::{CoarseMesh, Mesh};
use fem::space::quadrature::{Rule, edge, tetrahedron_product, triangle_product};

/// Cells on which loads are compared, Gauss points per direction, and in space the approximate total of points.
const LOAD_CELLS: usize = 64;
const POINTS: usize = 8;
const WORK: f64 = 1e5;
/// With projection or kinks f0 jumps across curves that no cell follows: an eighth of the domain's length, cut by 8
/// points, leaves some 1e-3 of the jump.
pub(super) const UNRESOLVED_JUMP: f64 = 1e-2;
/// Agreement of ζ by two rules that leaves time errors unaffected.
const ZETA: f64 = 1e-9;
/// Lines per coarse simplex and direction (in space across each of two directions), and the power by which they crowd at
/// the parallel edge.
const LINES: usize = 16;
const LINES_IN_SPACE: usize = 2;
const GRADING: i32 = 5;
/// Cells for derivatives in time.
const TIME_CELLS: usize = 512;

/// The points of the cells and of the boundary facets of a refined mesh, with the test functions of V^h that interpolate
/// 1, x, y, … off Γ1.
pub(super) fn places<const D: usize>(coarse: &CoarseMesh, faces: &[BodyFace]) -> [Places; 2] {
    let mesh = &parts(coarse, LOAD_CELLS);
    let clamped: Vec<u32> = faces.iter().filter(|of| of.clamped).map(|of| of.side).collect();
    let tests: Vec<Vec<f64>> = (0..=D).map(|test| test_function(mesh, &clamped, test)).collect();
    let (rule, side_rule) = match D {
        2 => (triangle_product(POINTS), edge(POINTS)),
        _ => {
            let points = points_a_direction(mesh.cell_count(), WORK);
            (tetrahedron_product(points), triangle_product(POINTS))
        }
    };
    let places = |simplices: &[&[u32]], rule: &Rule, measure: &dyn Fn(usize) -> f64| {
        let mut places = Places {
            points: mesh.points_of(simplices, &rule.points),
            tests: vec![Vec::new(); (D + 1) * tests.len()],
            ..Places::default()
        };
        for (s, &simplex) in simplices.iter().enumerate() {
            places.weights.extend(rule.weights.iter().map(|weight| weight * measure(s)));
            for (fields, v) in places.tests.chunks_mut(D + 1).zip(&tests) {
                let value = |b: &Vec<f64>| {
                    simplex.iter().zip(b).map(|(&a, b)| v[a as usize] * b).sum::<f64>()
                };
                fields[0].extend(rule.points.iter().map(value));
                let slopes = if simplex.len() > D { gradient(mesh, s, v) } else { [f64::NAN; D] };
                for (field, slope) in fields[1..].iter_mut().zip(slopes) {
                    field.extend(rule.points.iter().map(|_| slope));
                }
            }
        }
        places
    };
    let facets: Vec<&[u32]> = (0..mesh.facet_side.len()).map(|f| mesh.facet(f)).collect();
    let inside = places(&mesh.cells(), &rule, &|c| measure(mesh, c));
    let boundary = places(&facets, &side_rule, &|f| facet_measure(mesh, f));
    let normals = (0..facets.len()).flat_map(|f| vec![mesh.normal(f); side_rule.points.len()]);
    [inside, Places { normals: normals.collect(), ..boundary }]
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

fn gradient<const D: usize>(mesh: &Mesh, c: usize, v: &[f64]) -> [f64; D] {
    let cell = mesh.cell(c);
    let at = |a: usize| mesh.vertex(cell[a]);
    let edges: [[f64; D]; D] =
        std::array::from_fn(|a| std::array::from_fn(|i| at(a + 1)[i] - at(0)[i]));
    let rise = std::array::from_fn(|a| v[cell[a + 1] as usize] - v[cell[0] as usize]);
    gradient_of(&edges, &rise)
}

/// ζ(T) by the usual rule against a finer one, which detects kinks inside cells.
pub(super) fn zeta(exact: &Exact, coarse: &CoarseMesh) -> Option<Finding> {
    let known = exact.zeta.at(exact.data.horizon);
    if known.is_nan() {
        return None;
    }
    let (graph, horizon) = (&exact.data.graph, exact.data.horizon);
    let finer = Domain::Finer(coarse);
    let finer = AccumulatedStrain::new(graph, &exact.strain, horizon, finer, true).at(horizon);
    let share = ((known - finer) / finer.abs().max(f64::MIN_POSITIVE)).abs();
    let status = if share <= ZETA { Status::Verified } else { Status::Weak };
    let text = format!("zeta(T) = {known:.6} agrees to {share:.1e} with a finer rule");
    Some(Finding::new("zeta", status, share, text))
}

/// Points for derivatives in time: the centroids of cells.
pub(super) fn in_time(coarse: &CoarseMesh) -> (Vec<[f64; 3]>, Vec<f64>) {
    let mesh = parts(coarse, TIME_CELLS);
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

pub(super) fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    p.iter().zip(q).map(|(p, q)| (q - p).powi(2)).sum::<f64>().sqrt()
}

/// The point at fraction s from p to q.
pub(super) fn blend(p: [f64; 3], q: [f64; 3], s: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| (1.0 - s) * p[i] + s * q[i])
}

#[cfg(test)]
mod tests;
