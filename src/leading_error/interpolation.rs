//! The space error: ‖ε(u - I_h u)‖ on a mesh, and its limit over h from the second derivatives of u.

use std::sync::Arc;

use super::time::{largest_step, times};
use super::{Case, LeadingError, LeadingErrors, NoConstant};
use crate::contact::Discretization;
use crate::formula::Program;
use crate::manufactured::Exact;
use crate::mesh::Mesh;
use crate::setup::Setup;
use crate::space::quadrature::{gauss_legendre, triangle_degree_4};

/// Second derivatives [[u_xx, u_xy, u_yy], …] of the two components.
type Hessians = [[f64; 3]; 2];

/// Cells and Gauss points of the integral of second derivatives, in each coordinate: moving zones leave jumps in the
/// third derivatives only.
const CELLS: usize = 24;
const POINTS: usize = 2;

/// Mean over the triangle of |ε(q - I q)|² for the quadratic fields with the given Hessians; the triangle by two edges
/// that leave one vertex.
///
/// With the edges d_i, their outward normals ν_i and c the centroid, ∇(q - Iq) = m + H(x - c) and
/// m = -(1/12|T|) Σ_i (d_iᵀ H d_i)|d_i| ν_i, since q - Iq = -½ (d_iᵀ H d_i) s(1-s) on an edge; the mean of
/// (x - c)(x - c)ᵀ is (1/36) Σ_i d_i d_iᵀ.
pub fn interpolation_form(hessians: &Hessians, edges: [[f64; 2]; 2]) -> f64 {
    let [p, q] = edges;
    // The boundary run through once: p, then on to q, then back.
    let around = [p, [q[0] - p[0], q[1] - p[1]], [-q[0], -q[1]]];
    let double_area = p[0] * q[1] - p[1] * q[0];
    let mut mean = [[0.0; 2]; 2];
    let mut spread = [[0.0; 2]; 2];
    for [x, y] in around {
        for (row, [xx, xy, yy]) in mean.iter_mut().zip(hessians) {
            let curvature = xx * x * x + 2.0 * xy * x * y + yy * y * y;
            // |d| ν = (d_y, -d_x) on a boundary run through counterclockwise.
            row[0] -= curvature * y / (6.0 * double_area);
            row[1] += curvature * x / (6.0 * double_area);
        }
        spread[0][0] += x * x / 36.0;
        spread[0][1] += x * y / 36.0;
        spread[1][1] += y * y / 36.0;
    }
    spread[1][0] = spread[0][1];
    let [[uxx, uxy, uyy], [vxx, vxy, vyy]] = *hessians;
    // Derivatives along x and y of ε_xx, ε_yy, √2 ε_xy, and the means of the three.
    let root = std::f64::consts::FRAC_1_SQRT_2;
    let slopes = [[uxx, uxy], [vxy, vyy], [root * (uxy + vxx), root * (uyy + vxy)]];
    let means = [mean[0][0], mean[1][1], root * (mean[0][1] + mean[1][0])];
    let mut sum = 0.0;
    for (slope, mean) in slopes.iter().zip(means) {
        sum += mean * mean;
        for i in 0..2 {
            for j in 0..2 {
                sum += slope[i] * slope[j] * spread[i][j];
            }
        }
    }
    sum
}

/// lim ‖ε(u(t) - I_h u(t))‖/h on the structured family at each of `times`: the squares of side h with their diagonal.
pub fn interpolation_constant(exact: &Exact, size: [f64; 2], times: &[f64]) -> Vec<f64> {
    let mut graph = exact.data.graph.clone();
    let mut nodes = Vec::new();
    for &u in &exact.data.u {
        for [a, b] in [["x", "x"], ["x", "y"], ["y", "y"]] {
            let axis = |name: &str| crate::formula::Variable::named(name);
            if let (Some(a), Some(b)) = (axis(a), axis(b)) {
                let first = graph.derivative(u, a);
                nodes.push(graph.derivative(first, b));
            }
        }
    }
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    let rule = |length: f64| -> Vec<(f64, f64)> {
        let width = length / CELLS as f64;
        let cell = |i: usize| {
            let gauss = gauss_legendre(POINTS).into_iter();
            gauss.map(move |(x, w)| (width * (i as f64 + 0.5 + 0.5 * x), 0.5 * width * w))
        };
        (0..CELLS).flat_map(cell).collect()
    };
    for (x, wx) in rule(size[0]) {
        for (y, wy) in rule(size[1]) {
            points.push([x, y, 0.0]);
            weights.push(wx * wy);
        }
    }
    let mut bound = Program::compile(&mut graph, &nodes, exact.data.horizon).bind(&points);
    let mut out = vec![Vec::new(); nodes.len()];
    let mut constant = |&t: &f64| {
        bound.evaluate(t, 0.0, &mut out);
        let density = |p: usize| {
            let hessians = [0, 3].map(|first| [0, 1, 2].map(|i| out[first + i][p]));
            // The other triangle of the square is this one turned by 180°: the same value.
            interpolation_form(&hessians, [[1.0, 0.0], [1.0, 1.0]])
        };
        weights.iter().enumerate().map(|(p, weight)| weight * density(p)).sum::<f64>().sqrt()
    };
    times.iter().map(|t| constant(t)).collect()
}

/// ‖ε(u(t) - I_h u(t))‖ on a mesh, by a rule of degree 4 a cell: the square of a quadratic's is of degree 2.
pub fn interpolation_error(exact: &Exact, space: &Discretization, t: f64) -> f64 {
    let mut graph = exact.data.graph.clone();
    let (mesh, horizon) = (&space.mesh, exact.data.horizon);
    let vertices: Vec<[f64; 3]> =
        (0..mesh.vertices() as u32).map(|v| mesh.point(&[v], &[1.0])).collect();
    let mut nodal = vec![Vec::new(); 2];
    let at_vertices = Program::compile(&mut graph, &exact.data.u, horizon);
    at_vertices.bind(&vertices).evaluate(t, 0.0, &mut nodal);
    let rule = triangle_degree_4();
    let points: Vec<[f64; 3]> = (0..mesh.cell_count())
        .flat_map(|c| rule.points.iter().map(move |b| mesh.point(mesh.cell(c), b)))
        .collect();
    let mut strain = vec![Vec::new(); 3];
    let at_points = Program::compile(&mut graph, &exact.strain, horizon);
    at_points.bind(&points).evaluate(t, 0.0, &mut strain);
    let mut sum = 0.0;
    for c in 0..mesh.cell_count() {
        let (interpolant, area) = strain_of_interpolant(mesh, c, &nodal);
        for (q, weight) in rule.weights.iter().enumerate() {
            let p = c * rule.weights.len() + q;
            let [xx, xy, yy] = [0, 1, 2].map(|i| strain[i][p] - interpolant[i]);
            sum += weight * area * (xx * xx + 2.0 * xy * xy + yy * yy);
        }
    }
    sum.sqrt()
}

/// [ε_xx, ε_xy, ε_yy] of the linear function with the nodal values of a cell, and the area of the cell.
fn strain_of_interpolant(mesh: &Mesh, c: usize, nodal: &[Vec<f64>]) -> ([f64; 3], f64) {
    let cell = mesh.cell(c);
    let corner = [0, 1, 2].map(|a| mesh.vertex(cell[a]));
    let edge = |a: usize| [corner[a][0] - corner[0][0], corner[a][1] - corner[0][1]];
    let (p, q) = (edge(1), edge(2));
    let double_area = p[0] * q[1] - p[1] * q[0];
    let gradient = |i: usize| {
        let rise = |a: usize| nodal[i][cell[a] as usize] - nodal[i][cell[0] as usize];
        let (a, b) = (rise(1), rise(2));
        [(a * q[1] - b * p[1]) / double_area, (b * p[0] - a * q[0]) / double_area]
    };
    let (u, v) = (gradient(0), gradient(1));
    ([u[0], 0.5 * (u[1] + v[0]), v[1]], 0.5 * double_area)
}

/// The largest interpolation errors over the grids of the cases: taken at the time at which the limit is largest.
pub(super) fn over_cases(
    setup: &Setup,
    exact: &Arc<Exact>,
    cases: &[Case],
) -> Result<LeadingErrors, NoConstant> {
    let size = [setup.body.domain.size[0], setup.body.domain.size[1]];
    let mut limit: Option<(u32, f64)> = None;
    let mut known: Vec<((u32, u64), f64)> = Vec::new();
    let mut worst_times: Vec<(u32, f64)> = Vec::new();
    let mut points = Vec::with_capacity(cases.len());
    for &case in cases {
        let Some(n) = case.n else { continue };
        let grid = times(&setup.scene.time, case.steps);
        let at = match worst_times.iter().find(|(steps, _)| *steps == case.steps) {
            Some((_, at)) => *at,
            None => {
                let constants = interpolation_constant(exact, size, &grid);
                let largest = constants.iter().copied().zip(&grid).max_by(|a, b| a.0.total_cmp(&b.0));
                let Some((constant, &at)) = largest else { continue };
                if limit.is_none_or(|(steps, _)| steps < case.steps) {
                    limit = Some((case.steps, constant));
                }
                worst_times.push((case.steps, at));
                at
            }
        };
        let error = match known.iter().find(|(key, _)| *key == (n, at.to_bits())) {
            Some((_, error)) => *error,
            None => {
                let space = setup.space(n).map_err(|e| NoConstant::Setup(e.to_string()))?;
                let error = interpolation_error(exact, &space, at);
                known.push(((n, at.to_bits()), error));
                error
            }
        };
        let (h, k) = (Some(1.0 / f64::from(n)), largest_step(&grid));
        points.push(LeadingError { case, h, k, error });
    }
    Ok(LeadingErrors { points, limit: limit.map(|(_, constant)| constant) })
}
