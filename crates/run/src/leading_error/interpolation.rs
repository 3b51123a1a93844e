//! The space error: ‖ε(u - I_h u)‖ on a mesh, and its limit over h.

use super::NoConstant;
use super::cells::square_apart;
use super::sums::{largest_step, nodal, points_of_cells, points_of_nodes, times};
use algebra::in_dimension;
use exact::constitutive::{Tensor, full, stress};
use exact::{ComplianceRule, Exact, InterpolatedOnMesh, NodalStrain};
use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::Rule;
use formula::{BoundProgram, Program};
use judge::verdict::{LeadingLine, LeadingPoint, MeshAndSteps as Case};
use scene::setup::Setup;
use std::sync::Arc;

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
    let degree = setup.body.element.degree() as i32;
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
    let limit = match points[..] {
        [.., ref a, ref b] if !of_stress && a.steps == b.steps => {
            limit([a, b].map(|point| (point.h.unwrap_or(f64::NAN), point.error)), degree)
        }
        _ => None,
    };
    let finest = points.iter().filter_map(|point| point.h).fold(f64::INFINITY, f64::min);
    let tolerance = along_the_interpolant(setup, finest);
    Ok(LeadingLine { points, limit, tolerance })
}

/// lim e/h^p from two meshes, with a term of one more power; none of one mesh alone.
fn limit([(h, e), (finer, f)]: [(f64, f64); 2], p: i32) -> Option<f64> {
    let (coarse, fine) = (e / h.powi(p), f / finer.powi(p));
    Some((h * fine - finer * coarse) / (h - finer)).filter(|limit| limit.is_finite())
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
