//! The space error: ‖ε(u - I_h u)‖ on a mesh, and its limit over h from the second derivatives of u.

use algebra::in_dimension;
use std::sync::Arc;

use super::NoConstant;
use super::interpolation_stress::StressInterpolationError;
use super::measures::square_apart;
use super::own_history::{nodal, points_of_cells, points_of_nodes};
use super::quadratic::QuadraticError;
use super::time::{largest_step, times};
use exact::constitutive::{Tensor, full};
use exact::{Exact, NodalStrain};
use fem::contact::{Discretization, LoadError};
use fem::space::Element;
use fem::space::quadrature::{Rule, gauss_legendre};
use formula::{BoundProgram, Program, Variable};
use judge::verdict::{LeadingLine, LeadingPoint, MeshAndSteps as Case};
use scene::Shape;
use scene::setup::Setup;

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
