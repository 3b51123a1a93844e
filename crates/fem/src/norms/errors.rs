//! Errors at one time level, from the discrete solution and the moments of the truth.

use super::moments::{Moments, facet_samples, hausdorff};
use crate::contact::{Discretization, Model, StepView, TracePoint};
use crate::space::strain_of;
use vhi::law::Projection;

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
    /// ‖(ξ + λ) - (ξ + λ)^{kh}‖ on Γ3, the discrete pressure linear between vertices.
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
pub fn step_errors<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    view: &StepView<'_>,
    truth: &Moments,
) -> StepErrors {
    let mut errors = match space.mesh.dimension {
        2 => cells::<P, 2, 3>(space, model, view, truth),
        _ => cells::<P, 3, 6>(space, model, view, truth),
    };
    facets(space, view, truth, &mut errors);
    errors.contact_set = contact_set(space, model, view, truth);
    errors
}

fn cells<P: Projection, const D: usize, const S: usize>(
    space: &Discretization,
    model: &Model<P>,
    view: &StepView<'_>,
    truth: &Moments,
) -> StepErrors {
    let (mut v, mut stress) = (truth.strain.rest, truth.stress.rest);
    let mut l2 = truth.displacement.rest;
    let corners = D + 1;
    let scale = 1.0 / (corners * (corners + 1)) as f64;
    let (strains, stresses) =
        (truth.strain.mean.as_chunks::<S>().0, truth.stress.mean.as_chunks::<S>().0);
    let (values, exact) = (view.u.as_chunks::<D>().0, truth.displacement.corner.as_chunks::<D>().0);
    for c in 0..space.mesh.cell_count() {
        let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
        let measure = space.geometry.measure[c];
        let strain = strain_of(gradients, nodes, view.u);
        v += measure * squared_distance(&strain, &strains[c]);
        let discrete = view.stress_of(space, model, c, &strain);
        stress += measure * squared_distance(&discrete, &stresses[c]);
        let (mut total, mut squares) = ([0.0; D], 0.0);
        for (exact, &node) in exact[corners * c..corners * (c + 1)].iter().zip(nodes) {
            let value = &values[node as usize];
            for i in 0..D {
                let difference = exact[i] - value[i];
                total[i] += difference;
                squares += difference * difference;
            }
        }
        l2 += measure * scale * (squares + squared_distance(&total, &[0.0; D]));
    }
    StepErrors { v: v.sqrt(), l2: l2.sqrt(), stress: stress.sqrt(), ..StepErrors::default() }
}

/// ‖ε(u - v)‖ of a nodal vector v alone, which need be no level of a run: v = 0 gives ‖ε(u)‖.
pub fn strain_error(space: &Discretization, v: &[f64], truth: &Moments) -> f64 {
    fn squares<const S: usize>(space: &Discretization, v: &[f64], truth: &Moments) -> f64 {
        let means = truth.strain.mean.as_chunks::<S>().0;
        let cell = |c: usize| {
            let strain = strain_of(space.geometry.gradients(c), space.cell_nodes(c), v);
            space.geometry.measure[c] * squared_distance(&strain, &means[c])
        };
        (0..space.mesh.cell_count()).map(cell).sum()
    }
    let cells = match space.mesh.dimension {
        2 => squares::<3>(space, v, truth),
        _ => squares::<6>(space, v, truth),
    };
    (cells + truth.strain.rest).sqrt()
}

#[inline]
fn squared_distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

fn facets(space: &Discretization, view: &StepView<'_>, truth: &Moments, errors: &mut StepErrors) {
    let (mut trace, mut pressure) = (truth.normal.rest, truth.pressure.rest);
    let corners = space.trace.stride;
    let scale = 1.0 / (corners * (corners + 1)) as f64;
    for f in 0..space.trace.measure.len() {
        let members = space.trace.facet(f);
        let mut sums = [[0.0; 2]; 2];
        for (a, &i) in members.iter().enumerate() {
            let i = i as usize;
            let exact = corners * f + a;
            let differences = [
                truth.normal.corner[exact] - space.trace.normal(i, view.u),
                truth.pressure.corner[exact] - view.compliance[i] - view.multiplier[i],
            ];
            for (sum, difference) in sums.iter_mut().zip(differences) {
                sum[0] += difference;
                sum[1] += difference * difference;
            }
        }
        trace += space.trace.measure[f] * scale * (sums[0][1] + sums[0][0] * sums[0][0]);
        pressure += space.trace.measure[f] * scale * (sums[1][1] + sums[1][0] * sums[1][0]);
    }
    errors.trace = trace.sqrt();
    errors.pressure = pressure.sqrt();
}

/// Hausdorff distance of the exact and the discrete locked set, on samples of the facets of Γ3. The discrete
/// set holds its locked vertices, and the edges and triangles whose vertices are all locked.
fn contact_set<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    view: &StepView<'_>,
    truth: &Moments,
) -> f64 {
    let Some(boundary) = &model.boundary else { return 0.0 };
    if truth.locked.is_empty() {
        return 0.0;
    }
    let is_locked = |(i, point): (usize, &TracePoint)| {
        let gap = (boundary.gap)(space.mesh.point(&[point.vertex], &[1.0]));
        is_locked(space.trace.normal(i, view.u), gap)
    };
    let locked: Vec<bool> = space.trace.points.iter().enumerate().map(is_locked).collect();
    let samples = facet_samples(space.trace.stride);
    let facets = 0..space.trace.measure.len();
    let discrete = facets.clone().flat_map(|f| {
        let members = space.trace.facet(f);
        let counts = |(b, i): (&f64, &u32)| *b == 0.0 || locked[*i as usize];
        samples.iter().map(|b| b.iter().zip(members).all(counts)).collect::<Vec<bool>>()
    });
    let discrete: Vec<bool> = discrete.collect();
    if discrete == truth.locked {
        return 0.0;
    }
    let mut points = Vec::with_capacity(discrete.len());
    for f in facets {
        let vertex = |&i: &u32| space.trace.points[i as usize].vertex;
        let vertices: Vec<u32> = space.trace.facet(f).iter().map(vertex).collect();
        points.extend(samples.iter().map(|b| space.mesh.point(&vertices, b)));
    }
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
