//! Errors at one time level, from the discrete solution and the moments of the truth.

use super::moments::{Moments, facet_samples, hausdorff};
use crate::contact::{Discretization, Model, StepView, TracePoint};
use crate::space::StrainPoint;
use algebra::in_dimension;

/// Errors at one time level.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepErrors {
    /// ‖ε(u_n - u_n^{kh})‖.
    pub v: f64,
    /// ‖u_n - u_n^{kh}‖.
    pub l2: f64,
    /// ‖σ_n - σ_n^{kh}‖.
    pub stress: f64,
    /// ‖u_ν - u_ν^{kh}‖ on Γ3.
    pub trace: f64,
    /// ‖(ξ + λ) - (ξ + λ)^{kh}‖ on Γ3, the discrete pressure interpolated by the element between its points.
    pub pressure: f64,
    /// Hausdorff distance of the locked sets.
    pub contact_set: f64,
}

/// u_ν counts as locked within this distance of g, relative to |g|: the exact field comes from
/// formulas that round, the discrete one is set to g.
const LOCKED_WITHIN: f64 = 1e-9;

/// True if u_ν is at its bound, to rounding.
pub fn is_locked(normal: f64, gap: f64) -> bool {
    gap.is_finite() && gap - normal <= LOCKED_WITHIN * gap.abs().max(f64::MIN_POSITIVE)
}

/// All errors of `view` against `truth`.
pub fn step_errors(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    truth: &Moments,
) -> StepErrors {
    let mut errors =
        in_dimension!(space.mesh.dimension, D, S => cells::<D, S>(space, model, view, truth));
    facets(space, view, truth, &mut errors);
    errors.contact_set = contact_set(space, model, view, truth);
    errors
}

fn cells<const D: usize, const S: usize>(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    truth: &Moments,
) -> StepErrors {
    let (mut v, mut stress) = (truth.strain.rest, truth.stress.rest);
    let mut l2 = truth.displacement.rest;
    let (strains, stresses) =
        (truth.strain.at.as_chunks::<S>().0, truth.stress.at.as_chunks::<S>().0);
    for at in space.points() {
        let strain = at.strain(view.u);
        v += at.weight * squared_distance(&strain, &strains[at.index]);
        let discrete = view.stress_of(space, model, &at, &strain);
        stress += at.weight * squared_distance(&discrete, &stresses[at.index]);
    }
    let (values, exact) = (view.u.as_chunks::<D>().0, truth.displacement.node.as_chunks::<D>().0);
    let (square, mut differences) = (space.element.mean_square(D + 1), Vec::new());
    for (c, &measure) in space.geometry.measure.iter().enumerate() {
        let nodes = space.cell_nodes(c);
        let exact = &exact[nodes.len() * c..nodes.len() * (c + 1)];
        differences.clear();
        differences.extend(exact.iter().zip(nodes).map(|(exact, &node)| {
            let value = &values[node as usize];
            std::array::from_fn::<f64, D, _>(|i| exact[i] - value[i])
        }));
        l2 += square.over(measure, &differences);
    }
    StepErrors { v: v.sqrt(), l2: l2.sqrt(), stress: stress.sqrt(), ..StepErrors::default() }
}

/// ‖ε(u - v)‖ of a nodal vector v alone, which need be no level of a run: v = 0 gives ‖ε(u)‖.
pub fn strain_error(space: &Discretization, v: &[f64], truth: &Moments) -> f64 {
    fn squares<const S: usize>(space: &Discretization, v: &[f64], truth: &Moments) -> f64 {
        let exact = truth.strain.at.as_chunks::<S>().0;
        let square =
            |at: StrainPoint<'_>| at.weight * squared_distance(&at.strain(v), &exact[at.index]);
        space.points().map(square).sum()
    }
    let cells = in_dimension!(space.mesh.dimension, D, S => squares::<S>(space, v, truth));
    (cells + truth.strain.rest).sqrt()
}

#[inline]
fn squared_distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

fn facets(space: &Discretization, view: &StepView<'_>, truth: &Moments, errors: &mut StepErrors) {
    let (mut trace, mut pressure) = (truth.normal.rest, truth.pressure.rest);
    let nodes = space.trace.stride;
    let square = space.element.mean_square(space.mesh.dimension);
    let (mut of_trace, mut of_pressure) = (Vec::new(), Vec::new());
    for (f, &measure) in space.trace.measure.iter().enumerate() {
        of_trace.clear();
        of_pressure.clear();
        for (a, &i) in space.trace.facet(f).iter().enumerate() {
            let (i, exact) = (i as usize, nodes * f + a);
            of_trace.push([truth.normal.node[exact] - space.trace.normal(i, view.u)]);
            let exact = truth.pressure.node[exact];
            of_pressure.push([exact - view.compliance[i] - view.multiplier[i]]);
        }
        trace += square.over(measure, &of_trace);
        pressure += square.over(measure, &of_pressure);
    }
    errors.trace = trace.sqrt();
    errors.pressure = pressure.sqrt();
}

/// Hausdorff distance of the exact and the discrete locked set, on samples of the facets of Γ3. The discrete
/// set holds its locked corners, and the edges and triangles whose corners are all locked; of elements with one point a
/// facet, the facets where it is.
fn contact_set(space: &Discretization, model: &Model, view: &StepView<'_>, truth: &Moments) -> f64 {
    if model.boundary.is_empty() || truth.locked.is_empty() {
        return 0.0;
    }
    let is_locked = |(i, point): (usize, &TracePoint)| {
        let gap = model.gap(point.side, space.mesh.point(&[point.vertex], &[1.0]), view.t);
        is_locked(space.trace.normal(i, view.u), gap)
    };
    let locked: Vec<bool> = space.trace.points.iter().enumerate().map(is_locked).collect();
    let samples = facet_samples(space.mesh.dimension);
    let facets = 0..space.trace.measure.len();
    let discrete = facets.clone().flat_map(|f| {
        // An edge with one point is locked where that is.
        let members = space.trace.facet(f).iter().cycle();
        let counts = |(b, i): (&f64, &u32)| *b == 0.0 || locked[*i as usize];
        samples.iter().map(|b| b.iter().zip(members.clone()).all(counts)).collect::<Vec<bool>>()
    });
    let discrete: Vec<bool> = discrete.collect();
    if discrete == truth.locked {
        return 0.0;
    }
    let corners = |f| space.mesh.facet(space.trace.mesh_facet[f] as usize);
    let points = space.mesh.points_of(&facets.map(corners).collect::<Vec<_>>(), &samples);
    hausdorff(&points, &truth.locked, &discrete, diameter(space, &points))
}

/// The distance of two sets of which one is empty: the length of Γ3, in space the diagonal of its box.
fn diameter(space: &Discretization, points: &[[f64; 3]]) -> f64 {
    if space.mesh.dimension == 2 {
        return space.trace.measure.iter().sum();
    }
    let range = |i: usize| {
        let ends = points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            [low.min(p[i]), high.max(p[i])]
        });
        (ends[1] - ends[0]).powi(2)
    };
    (0..3).map(range).sum::<f64>().sqrt()
}
