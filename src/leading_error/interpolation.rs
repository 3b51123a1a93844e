//! The space error: ‖ε(u - I_h u)‖ on a mesh, and its limit over h from the second derivatives of u.

use super::time::{largest_step, times};
use super::{Case, LeadingError, LeadingErrors, NoConstant};
use crate::formula::{Bound, Program, Variable};
use crate::manufactured::Exact;
use crate::mesh::Mesh;
use crate::scene::Shape;
use crate::setup::Setup;
use crate::space::quadrature::{Rule, gauss_legendre, triangle_degree_4};

/// Second derivatives [[u_xx, u_xy, u_yy], …] of the two components.
type Hessians = [[f64; 3]; 2];

/// Cells and Gauss points of the integral of second derivatives, in each coordinate. Moving zones leave jumps in third
/// derivatives of the profile, which are second derivatives of u: the sum over 128 points meets them within 1 %.
const CELLS: usize = 64;
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

/// lim ‖ε(u(t) - I_h u(t))‖/h on the structured family, the squares of side h with their diagonal.
pub fn interpolation_constant(exact: &Exact, size: [f64; 2], t: f64) -> f64 {
    let mut graph = exact.data.graph.clone();
    let mut nodes = Vec::new();
    for &u in &exact.data.u {
        for (a, b) in
            [(Variable::X, Variable::X), (Variable::X, Variable::Y), (Variable::Y, Variable::Y)]
        {
            let first = graph.derivative(u, a);
            nodes.push(graph.derivative(first, b));
        }
    }
    let rule = |length: f64| -> Vec<(f64, f64)> {
        let width = length / CELLS as f64;
        let cell = |i: usize| {
            let gauss = gauss_legendre(POINTS).into_iter();
            gauss.map(move |(x, w)| (width * (i as f64 + 0.5 + 0.5 * x), 0.5 * width * w))
        };
        (0..CELLS).flat_map(cell).collect()
    };
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for (x, wx) in rule(size[0]) {
        for (y, wy) in rule(size[1]) {
            points.push([x, y, 0.0]);
            weights.push(wx * wy);
        }
    }
    let mut out = vec![Vec::new(); nodes.len()];
    let program = Program::compile(&mut graph, &nodes, exact.data.horizon);
    program.bind(&points).evaluate(t, 0.0, &mut out);
    let density = |p: usize| {
        let hessians = [0, 3].map(|first| [0, 1, 2].map(|i| out[first + i][p]));
        // The other triangle of the square is this one turned by 180°: the same value.
        interpolation_form(&hessians, [[1.0, 0.0], [1.0, 1.0]])
    };
    weights.iter().enumerate().map(|(p, weight)| weight * density(p)).sum::<f64>().sqrt()
}

/// ‖ε(u(t) - I_h u(t))‖ on one mesh.
pub struct InterpolationError<'a> {
    mesh: &'a Mesh,
    /// u at the vertices.
    nodal: Bound,
    /// ε(u) at the points of the cells.
    strain: Bound,
    rule: Rule,
}

impl<'a> InterpolationError<'a> {
    /// Binds u to the vertices of a mesh, ε(u) to the points of a rule of degree 4 a cell: the square of what
    /// interpolation leaves of a quadratic's strain is of degree 2.
    pub fn new(exact: &Exact, mesh: &'a Mesh) -> Self {
        let mut graph = exact.data.graph.clone();
        let horizon = exact.data.horizon;
        let vertices: Vec<[f64; 3]> =
            (0..mesh.vertices() as u32).map(|v| mesh.point(&[v], &[1.0])).collect();
        let rule = triangle_degree_4();
        let points: Vec<[f64; 3]> = (0..mesh.cell_count())
            .flat_map(|c| rule.points.iter().map(move |b| mesh.point(mesh.cell(c), b)))
            .collect();
        let nodal = Program::compile(&mut graph, &exact.data.u, horizon).bind(&vertices);
        let strain = Program::compile(&mut graph, &exact.strain, horizon).bind(&points);
        Self { mesh, nodal, strain, rule }
    }

    /// The error at time t.
    pub fn at(&mut self, t: f64) -> f64 {
        let mut nodal = vec![Vec::new(); 2];
        self.nodal.evaluate(t, 0.0, &mut nodal);
        let mut strain = vec![Vec::new(); 3];
        self.strain.evaluate(t, 0.0, &mut strain);
        let mut sum = 0.0;
        for c in 0..self.mesh.cell_count() {
            let (interpolant, area) = strain_of_interpolant(self.mesh, c, &nodal);
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let p = c * self.rule.weights.len() + q;
                let [xx, xy, yy] = [0, 1, 2].map(|i| strain[i][p] - interpolant[i]);
                sum += weight * area * (xx * xx + 2.0 * xy * xy + yy * yy);
            }
        }
        sum.sqrt()
    }
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

/// Up to this n all times of the grid are tried. A front that moves through the cells makes the largest error depend
/// on where it stands in them, less so on finer meshes.
const ALL_TIMES: u32 = 32;
/// On finer meshes the times with the largest errors of the next coarser one are tried, so many of them.
const TRIED: usize = 3;

/// The largest interpolation errors over the grids of the cases.
pub(super) fn over_cases(
    setup: &Setup,
    exact: &Exact,
    cases: &[Case],
) -> Result<LeadingErrors, NoConstant> {
    let mut sorted: Vec<(u32, Case)> =
        cases.iter().filter_map(|&case| Some((case.n?, case))).collect();
    sorted.sort_unstable_by_key(|&(n, case)| (case.steps, n));
    let mut points = Vec::with_capacity(cases.len());
    let mut worst: Vec<(f64, f64)> = Vec::new();
    for (at, &(n, case)) in sorted.iter().enumerate() {
        let grid = times(&setup.scene.time, case.steps);
        let first = at == 0 || sorted[at - 1].1.steps != case.steps;
        let tried = match first || n <= ALL_TIMES {
            true => grid.clone(),
            false => worst.iter().take(TRIED).map(|&(t, _)| t).collect(),
        };
        let space = setup.space(n).map_err(|error| NoConstant::Setup(error.to_string()))?;
        let mut interpolation = InterpolationError::new(exact, &space.mesh);
        worst = tried.iter().map(|&t| (t, interpolation.at(t))).collect();
        // A NaN comes first and stays.
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        let Some(&(_, error)) = worst.first() else { continue };
        let (h, k) = (Some(space.mesh.h()), largest_step(&grid));
        points.push(LeadingError { case, h, k, error });
    }
    let domain = &setup.body.domain;
    let size = [domain.size[0], domain.size[1]];
    // The integral of second derivatives is over a rectangle.
    let at = worst.first().filter(|_| domain.shape == Shape::Box);
    let limit = at.map(|&(t, _)| interpolation_constant(exact, size, t));
    Ok(LeadingErrors { points, limit, tolerance: TOLERANCE })
}

/// On the finest meshes of the shipped scenes ‖ε(u - u_h)‖ is within 0.3 % of the interpolation error, on the coarsest in
/// their windows within 2.5 %: what is left is ‖ε(I_h u - u_h)‖, of higher order, and the time error.
const TOLERANCE: f64 = 0.03;
