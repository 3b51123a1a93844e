//! The space error: ‖ε(u - I_h u)‖ on a mesh, and its limit over h.

use super::NoConstant;
use super::cells::square_apart;
use super::sums::{largest_step, times};
use algebra::in_dimension;
use exact::constitutive::{Tensor, full, stress};
use exact::{ComplianceRule, Exact, InterpolatedOnMesh, NodalStrain, point_by_point};
use fem::contact::{Discretization, LoadError};
use fem::space::Element;
use fem::space::quadrature::Rule;
use formula::{BoundProgram, Program};
use judge::verdict::{LeadingLine, LeadingPoint, MeshAndSteps as Case};
use scene::setup::Setup;
use scene::{Hypothesis, MeshFamily, Norm};
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

/// ‖ε(u(t) - I_h u(t))‖ on one mesh, or ‖σ(u(t)) - σ(I_h u(t))‖.
///
/// I_h u is superclose to u_h, so σ_h is the stress of I_h u with its memory, up to higher orders. Both stresses use ζ of u: with
/// f = ε(u)/‖ε(u)‖, integration by parts gives (f, ε(u - I_h u)) = O(h²).
pub struct InterpolationError {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    /// u at the nodes.
    nodal: BoundProgram,
    strains: NodalStrain,
    /// ε(u) at the points of the cells; for stresses with its histories.
    fields: BoundProgram,
    rule: Rule,
    /// For stresses: the histories of I_h u, and the region of each cell.
    of_stress: Option<(InterpolatedOnMesh, Vec<usize>)>,
}

impl InterpolationError {
    /// Binds u to the nodes of a mesh, ε(u) to the points of a rule of degree 4 or 5 per cell: the squared strain error
    /// of linear interpolation has degree 2 for a quadratic, that of quadratic interpolation degree 4 for a cubic.
    pub fn new(exact: &Arc<Exact>, space: &Arc<Discretization>, of_stress: bool) -> Self {
        let (exact, space) = (exact.clone(), space.clone());
        let (graph, horizon) = (&exact.data.graph, exact.data.horizon);
        let rule = space.element.square_rule(space.mesh.dimension + 1);
        let points = space.mesh.points_of(&space.mesh.cells(), &rule.points);
        let fields = match of_stress {
            true => exact.interior.bind(&points),
            false => Program::compile(graph, &exact.strain, horizon).bind(&points),
        };
        let nodal =
            Program::compile(graph, &exact.data.u, horizon).bind(&exact::points_of_nodes(&space));
        let strains = NodalStrain::new(space.clone(), &rule);
        let of_stress = of_stress.then(|| {
            // The rule affects loads only.
            let rule = ComplianceRule::Vertex;
            let interpolant = InterpolatedOnMesh::new(exact.clone(), space.clone(), rule);
            (interpolant, exact.cell_regions(&space.mesh))
        });
        Self { nodal, strains, fields, rule, of_stress, exact, space }
    }

    /// The error at time t.
    ///
    /// # Errors
    /// A formula that is not finite at a vertex.
    pub fn at(&mut self, t: f64) -> Result<f64, LoadError> {
        in_dimension!(self.space.mesh.dimension, D => self.at_in::<D>(t))
    }

    fn at_in<const D: usize>(&mut self, t: f64) -> Result<f64, LoadError> {
        let (u, histories) = match &self.of_stress {
            None => (point_by_point(&self.nodal.values_at(t, 0.0)), Vec::new()),
            Some((interpolant, _)) => interpolant.displacements(t)?,
        };
        let fields = self.fields.values_at(t, 0.0);
        let kappa = if self.of_stress.is_some() { self.exact.kappa(t) } else { f64::NAN };
        let (mut sum, mut remembered): (f64, Vec<Tensor<D>>) = (0.0, Vec::new());
        for (c, measure) in self.space.geometry.measure.iter().enumerate() {
            for (q, weight) in self.rule.weights.iter().enumerate() {
                let p = c * self.rule.weights.len() + q;
                let strain = |nodal: &Vec<f64>| -> Tensor<D> { self.strains.at(nodal, c, q) };
                let square = match &self.of_stress {
                    None => square_apart(&full(|k| fields[k][p]), &strain(&u)),
                    Some((_, regions)) => {
                        let material = self.exact.material_in(regions[c]);
                        let memory: Vec<Tensor<D>> = histories.iter().map(strain).collect();
                        let present = self.exact.tensors(|k| fields[k][p], &mut remembered);
                        let of_exact = stress(material, &present, &remembered, kappa);
                        square_apart(&of_exact, &stress(material, &strain(&u), &memory, kappa))
                    }
                };
                sum += weight * measure * square;
            }
        }
        Ok(sum.sqrt())
    }
}

/// Up to this n all times of the grid are tried: the error depends on where moving fronts are in the cells, less so on
/// finer meshes.
const ALL_TIMES: u32 = 32;
/// Times tried on finer meshes: those of the largest errors on the next coarser one.
const TRIED: usize = 3;

/// The largest interpolation errors over the grids of the cases, of ε or of σ.
pub(super) fn in_space_direction(
    setup: &Setup,
    norm: Norm,
    cases: &[Case],
) -> Result<LeadingLine, NoConstant> {
    let violated = |hypothesis| setup.scene.violates.contains(&hypothesis);
    let Some(exact) = &setup.exact else { return Err(NoConstant::NoExact) };
    // ‖u - u_h‖ is of the order of ‖u - I_h u‖ but not equal to leading order, so L² norms of u have no leading error
    // here.
    let of_stress = match norm {
        Norm::VMax => false,
        Norm::StressL2Max => true,
        other => return Err(NoConstant::InSpace { norm: other.name() }),
    };
    if setup.body.domain.mesh != MeshFamily::Structured {
        return Err(NoConstant::Mesh);
    }
    if setup.body.element.degree() > 2 {
        return Err(NoConstant::Degree { element: setup.body.element.name() });
    }
    if of_stress && setup.body.element != Element::P1 {
        return Err(NoConstant::Element { element: setup.body.element.name() });
    }
    if violated(Hypothesis::RegularInSpace) || violated(Hypothesis::ConcaveGap) {
        return Err(NoConstant::Regularity);
    }
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
        let mut error = InterpolationError::new(exact, &space, of_stress);
        let at = |&t: &f64| Ok((t, error.at(t)?));
        worst = tried.iter().map(at).collect::<Result<_, LoadError>>()?;
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
