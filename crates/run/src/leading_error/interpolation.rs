//! The space error: ‖ε(u - I_h u)‖ on a mesh, and its limit over h from the second derivatives of u.

use super::NoConstant;
use super::cells::square_apart;
use super::sums::{largest_step, nodal, points_of_cells, points_of_nodes, times};
use algebra::in_dimension;
use exact::constitutive::{Tensor, full, stress};
use exact::linear::gradient_of;
use exact::{ComplianceRule, Exact, InterpolatedOnMesh, NodalStrain};
use fem::contact::{Discretization, LoadError};
use fem::space::Element;
use fem::space::quadrature::{Rule, gauss_legendre};
use formula::{BoundProgram, Program, Variable};
use judge::verdict::{LeadingLine, LeadingPoint, MeshAndSteps as Case};
use scene::Shape;
use scene::setup::Setup;
use std::sync::Arc;

/// Cells per coordinate for the integral of second derivatives, in the plane and in space, and Gauss points per cell.
/// I_h u is superclose: ‖ε(I_h u - u_h)‖ is O(h^(3/2)) at worst, so by orthogonality the squares of ‖ε(u - u_h)‖ and
/// ‖ε(u - I_h u)‖ differ by a share O(h), and so does a time error along I_h u in place of u_h. That share, over h by
/// the length of the body, is at most 0.13 on the finest meshes of the shipped scenes; a third leaves a factor 2.5.
const SUPERCLOSE: f64 = 1.0 / 3.0;
/// On meshes coarser than 1/16 the next terms count, and the scene has to state how much.
const COARSEST: f64 = 0.02;

/// Allowed relative difference of an error on mesh size h from that of the interpolant.
pub(super) fn along_the_interpolant(setup: &Setup, h: f64) -> f64 {
    let domain = &setup.body.domain;
    let length = domain.measure().powf(1.0 / setup.scene.dimension as f64);
    (SUPERCLOSE * h / length).min(COARSEST)
}

/// Moving zones cause jumps in third derivatives of the profile, which are second derivatives of u: 128 points resolve
/// them within 1 %. Smooth fields need fewer.
const CELLS: [usize; 2] = [64, 8];
const POINTS: usize = 2;

const AXES: [Variable; 3] = [Variable::X, Variable::Y, Variable::Z];

/// lim ‖ε(u(t) - I_h u(t))‖/h on the structured family, the squares or cubes of side h with their diagonal, in the
/// domain of the given `size`.
pub fn interpolation_constant(exact: &Exact, size: &[f64], t: f64) -> f64 {
    in_dimension!(size.len(), D => constant_in::<D>(exact, size, t))
}

fn constant_in<const D: usize>(exact: &Exact, size: &[f64], t: f64) -> f64 {
    let mut graph = exact.data.graph.clone();
    let mut nodes = Vec::new();
    for &u in &exact.data.u {
        for i in 0..D {
            let first = graph.derivative(u, AXES[i]);
            nodes.extend((i..D).map(|j| graph.derivative(first, AXES[j])));
        }
    }
    let rule = |length: f64| -> Vec<(f64, f64)> {
        let count = CELLS[D - 2];
        let width = length / count as f64;
        let cell = |i: usize| {
            let gauss = gauss_legendre(POINTS).iter();
            gauss.map(move |(x, w)| (width * (i as f64 + 0.5 + 0.5 * x), 0.5 * width * w))
        };
        (0..count).flat_map(cell).collect()
    };
    let mut points = vec![([0.0; 3], 1.0)];
    for (axis, &length) in size.iter().enumerate() {
        let places = rule(length);
        let with = |(point, weight): ([f64; 3], f64)| {
            places.iter().map(move |&(place, w)| {
                let mut point = point;
                point[axis] = place;
                (point, weight * w)
            })
        };
        points = points.into_iter().flat_map(with).collect();
    }
    let places: Vec<[f64; 3]> = points.iter().map(|(point, _)| *point).collect();
    let mut out = vec![Vec::new(); nodes.len()];
    let program = Program::compile(&graph, &nodes, exact.data.horizon);
    program.bind(&places).evaluate(t, 0.0, &mut out);
    let simplices = simplices_of_a_cube::<D>();
    let numbers = nodes.len() / D;
    let density = |p: usize| {
        let hessians: [Tensor<D>; D] = std::array::from_fn(|i| full(|k| out[numbers * i + k][p]));
        let sum: f64 = simplices.iter().map(|simplex| simplex.mean_square(&hessians)).sum();
        sum / simplices.len() as f64
    };
    points.iter().enumerate().map(|(p, (_, weight))| weight * density(p)).sum::<f64>().sqrt()
}

/// Simplices of the structured family in a unit square or cube: the paths from the origin to the opposite corner along
/// the axes in cyclic order. In the plane these are both; in space the other three are their reflections at the centre,
/// with equal values.
fn simplices_of_a_cube<const D: usize>() -> Vec<QuadraticError<D>> {
    let path = |start: usize| {
        let mut corner = [0.0; D];
        let mut corners = vec![corner];
        for step in 0..D {
            corner[(start + step) % D] = 1.0;
            corners.push(corner);
        }
        QuadraticError::new(&corners)
    };
    (0..D).map(path).collect()
}

/// ‖ε(u(t) - I_h u(t))‖ on one mesh.
pub struct InterpolationError<'a> {
    space: &'a Discretization,
    /// u at the nodes.
    nodal: BoundProgram,
    /// ε(u) at the points of the cells.
    strain: BoundProgram,
    rule: Rule,
    of_interpolant: NodalStrain,
}

impl<'a> InterpolationError<'a> {
    /// Binds u to the nodes of a mesh, ε(u) to the points of a rule of degree 4 or 5 per cell: the squared strain error
    /// of linear interpolation has degree 2 for a quadratic, that of quadratic interpolation degree 4 for a cubic.
    pub fn new(exact: &Exact, space: &'a Arc<Discretization>) -> Self {
        let (graph, horizon) = (exact.data.graph.clone(), exact.data.horizon);
        let rule = space.element.square_rule(space.mesh.dimension + 1);
        let u = Program::compile(&graph, &exact.data.u, horizon);
        let strain = Program::compile(&graph, &exact.strain, horizon);
        let of_interpolant = NodalStrain::new(space.clone(), &rule);
        let strain = strain.bind(&points_of_cells(&space.mesh, &rule));
        Self { space, nodal: u.bind(&points_of_nodes(space)), strain, rule, of_interpolant }
    }

    /// The error at time t.
    pub fn at(&mut self, t: f64) -> f64 {
        in_dimension!(self.space.mesh.dimension, D => self.at_in::<D>(t))
    }

    fn at_in<const D: usize>(&mut self, t: f64) -> f64 {
        let nodal = nodal(&mut self.nodal, self.space, t);
        let mut strain = vec![Vec::new(); D * (D + 1) / 2];
        self.strain.evaluate(t, 0.0, &mut strain);
        let mut sum = 0.0;
        for (c, measure) in self.space.geometry.measure.iter().enumerate() {
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let p = c * self.rule.weights.len() + q;
                let interpolant: Tensor<D> = self.of_interpolant.at(&nodal, c, q);
                sum += weight * measure * square_apart(&full(|k| strain[k][p]), &interpolant);
            }
        }
        sum.sqrt()
    }
}

/// Up to this n all times of the grid are tried: the error depends on where moving fronts are in the cells, less so on
/// finer meshes.
const ALL_TIMES: u32 = 32;
/// Times tried on finer meshes: those of the largest errors on the next coarser one.
const TRIED: usize = 3;

/// The largest interpolation errors over the grids of the cases, of ε or, if `of_stress`, of σ.
pub(super) fn over_cases(
    setup: &Setup,
    exact: &Arc<Exact>,
    of_stress: bool,
    cases: &[Case],
) -> Result<LeadingLine, NoConstant> {
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
        worst = match of_stress {
            true => {
                let mut stress = StressInterpolationError::new(exact.clone(), space.clone());
                let at = |&t: &f64| Ok((t, stress.at(t)?));
                tried.iter().map(at).collect::<Result<_, LoadError>>()?
            }
            false => {
                let mut strain = InterpolationError::new(exact, &space);
                tried.iter().map(|&t| (t, strain.at(t))).collect()
            }
        };
        // NaN sorts first and is kept.
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        let Some(&(_, error)) = worst.first() else { continue };
        // Of the domain, not of the mesh: a mesh that reports another size is to show in the constant.
        let (h, k) = (Some(setup.body.domain.h(n)), largest_step(&grid));
        points.push(LeadingPoint { n: case.n, steps: case.steps, h, k, error });
    }
    let domain = &setup.body.domain;
    // The limit is computed for rectangles and boxes, and linear interpolation.
    let linear = setup.body.element == Element::P1;
    let at = worst.first().filter(|_| domain.shape == Shape::Box && !of_stress && linear);
    let limit = at.map(|&(t, _)| interpolation_constant(exact, &domain.size, t));
    let finest = points.iter().filter_map(|point| point.h).fold(f64::INFINITY, f64::min);
    let tolerance = along_the_interpolant(setup, finest);
    Ok(LeadingLine { points, limit, tolerance })
}

// The space error of the stress: ‖σ(u) - σ(I_h u)‖ on a mesh.  I_h u is superclose to u_h, so σ_h is the stress of
// I_h u with its memory, up to higher orders. Both use ζ of u: with f = ε(u)/‖ε(u)‖, integration by parts gives (f,
// ε(u - I_h u)) = O(h²).

/// ‖σ(u(t)) - σ(I_h u(t))‖ on one mesh.
pub(crate) struct StressInterpolationError {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    /// I_h u and its histories.
    interpolant: InterpolatedOnMesh,
    strains: NodalStrain,
    /// ε(u) and its histories at the points of the cells.
    fields: BoundProgram,
    rule: Rule,
    regions: Vec<usize>,
}

impl StressInterpolationError {
    pub(crate) fn new(exact: Arc<Exact>, space: Arc<Discretization>) -> Self {
        let (mesh, element) = (&space.mesh, space.element);
        let rule = element.square_rule(mesh.dimension + 1);
        let fields = exact.interior.bind(&points_of_cells(mesh, &rule));
        let regions = exact.cell_regions(mesh);
        let strains = NodalStrain::new(space.clone(), &element.strain_rule(mesh.dimension));
        // The rule affects loads only.
        let interpolant =
            InterpolatedOnMesh::new(exact.clone(), space.clone(), ComplianceRule::Vertex);
        Self { exact, space, interpolant, strains, fields, rule, regions }
    }

    /// The error at time t.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub(crate) fn at(&mut self, t: f64) -> Result<f64, LoadError> {
        in_dimension!(self.space.mesh.dimension, D => self.at_in::<D>(t))
    }

    fn at_in<const D: usize>(&mut self, t: f64) -> Result<f64, LoadError> {
        let (u, histories) = self.interpolant.displacements(t)?;
        let mut out = vec![Vec::new(); D + self.exact.strain.len() + self.exact.memory.len()];
        self.fields.evaluate(t, 0.0, &mut out);
        let kappa = self.exact.kappa(t);
        let (mut sum, mut remembered): (f64, Vec<Tensor<D>>) = (0.0, Vec::new());
        for c in 0..self.space.mesh.cell_count() {
            let material = self.exact.material_in(self.regions[c]);
            let of_cell = |nodal: &Vec<f64>| -> Tensor<D> { self.strains.at(nodal, c, 0) };
            let memory: Vec<Tensor<D>> = histories.iter().map(of_cell).collect();
            let of_interpolant = stress(material, &of_cell(&u), &memory, kappa);
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let p = c * self.rule.weights.len() + q;
                let present: Tensor<D> = self.exact.tensors(|k| out[k][p], &mut remembered);
                let of_exact = stress(material, &present, &remembered, kappa);
                let square = square_apart(&of_exact, &of_interpolant);
                sum += weight * self.space.geometry.measure[c] * square;
            }
        }
        Ok(sum.sqrt())
    }
}

// Strain error of linear interpolation of a quadratic field on one simplex.

/// A simplex, prepared for many fields.
///
/// With corners v_a relative to the centroid c, q - Iq has the gradient m + H(x - c), where m = -½ Σ_a (v_aᵀ H v_a)
/// ∇λ_a, and the mean of (x - c)(x - c)ᵀ is Σ_a v_a v_aᵀ/((D + 1)(D + 2)).
pub(crate) struct QuadraticError<const D: usize> {
    corners: Vec<[f64; D]>,
    gradients: Vec<[f64; D]>,
    spread: [[f64; D]; D],
}

impl<const D: usize> QuadraticError<D> {
    pub(crate) fn new(corners: &[[f64; D]]) -> Self {
        let count = corners.len() as f64;
        let centre: [f64; D] =
            std::array::from_fn(|i| corners.iter().map(|v| v[i]).sum::<f64>() / count);
        let relative = |v: &[f64; D]| -> [f64; D] { std::array::from_fn(|i| v[i] - centre[i]) };
        let edges: [[f64; D]; D] =
            std::array::from_fn(|a| std::array::from_fn(|i| corners[a + 1][i] - corners[0][i]));
        // λ_0 falls by one along every edge, λ_a rises along the a-th.
        let mut gradients = vec![gradient_of(&edges, &[-1.0; D])];
        let along = |a: usize| std::array::from_fn(|b| f64::from(u8::from(a == b)));
        gradients.extend((0..D).map(|a| gradient_of(&edges, &along(a))));
        let corners: Vec<[f64; D]> = corners.iter().map(relative).collect();
        let product = |i: usize, j: usize| corners.iter().map(|v| v[i] * v[j]).sum::<f64>();
        let spread = |i, j| product(i, j) / (count * (count + 1.0));
        let spread = std::array::from_fn(|i| std::array::from_fn(|j| spread(i, j)));
        Self { corners, gradients, spread }
    }

    /// Mean over the simplex of |ε(q - I q)|² for the field whose component i has the Hessian `hessians[i]`.
    pub(crate) fn mean_square(&self, hessians: &[[[f64; D]; D]; D]) -> f64 {
        let mean = hessians.map(|hessian| self.mean_gradient(&hessian));
        let mut sum = 0.0;
        for i in 0..D {
            for j in 0..D {
                let shift = 0.5 * (mean[i][j] + mean[j][i]);
                let slope: [f64; D] =
                    std::array::from_fn(|l| 0.5 * (hessians[i][j][l] + hessians[j][i][l]));
                sum += shift * shift + form(&self.spread, &slope);
            }
        }
        sum
    }

    /// m of one component.
    fn mean_gradient(&self, hessian: &[[f64; D]; D]) -> [f64; D] {
        let mut mean = [0.0; D];
        for (corner, gradient) in self.corners.iter().zip(&self.gradients) {
            let value = 0.5 * form(hessian, corner);
            mean.iter_mut().zip(gradient).for_each(|(m, g)| *m -= value * g);
        }
        mean
    }
}

fn form<const D: usize>(matrix: &[[f64; D]; D], v: &[f64; D]) -> f64 {
    let row = |i: usize| (0..D).map(|j| matrix[i][j] * v[j]).sum::<f64>();
    (0..D).map(|i| v[i] * row(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand on the triangle (0,0), (1,0), (1,1) for u = (x²/2, 0): ∇(q - Iq) = (x - ½, 0), whose square has the mean
    /// ½ - ⅔ + ¼ = 1/12.
    #[test]
    fn one_second_derivative_in_the_plane() {
        let triangle = QuadraticError::new(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        let (zero, bent) = ([[0.0; 2]; 2], [[1.0, 0.0], [0.0, 0.0]]);
        assert!((triangle.mean_square(&[bent, zero]) - 1.0 / 12.0).abs() < 1e-15);
        // u = (0, x²/2): the shear ½(x - ½), twice its square.
        assert!((triangle.mean_square(&[zero, bent]) - 1.0 / 24.0).abs() < 1e-15);
        // The triangle turned by 180°.
        let turned = QuadraticError::new(&[[0.0, 0.0], [-1.0, 0.0], [-1.0, -1.0]]);
        let field = [[[0.3, -0.2], [-0.2, 0.7]], [[0.1, 0.5], [0.5, -0.4]]];
        assert!((turned.mean_square(&field) - triangle.mean_square(&field)).abs() < 1e-15);
    }

    /// The tetrahedron 1 ≥ x ≥ y ≥ z ≥ 0 and u = (x²/2, 0, 0): again x - ½, with x of density 3x²: 3/5 - 3/4 + 1/4 =
    /// 1/10. For u = (0, 0, xz): Iq = z, so ∇(q - Iq) = (z, 0, x - 1) and |ε|² = ½z² + (x - 1)², where z has the
    /// density 3(1 - z)²: ½·1/10 + 1/10.
    #[test]
    fn one_second_derivative_in_space() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]];
        let tetrahedron = QuadraticError::new(&corners);
        let zero = [[0.0; 3]; 3];
        let mut bent = zero;
        bent[0][0] = 1.0;
        assert!((tetrahedron.mean_square(&[bent, zero, zero]) - 0.1).abs() < 1e-15);
        let mut twisted = zero;
        (twisted[0][2], twisted[2][0]) = (1.0, 1.0);
        assert!((tetrahedron.mean_square(&[zero, zero, twisted]) - 0.15).abs() < 1e-15);
    }
}
