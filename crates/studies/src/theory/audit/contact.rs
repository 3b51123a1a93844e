//! Integrals over Γ3 at one level.

use super::edges::{EdgeSample, between};
use super::integrals::Sum;
use super::law::ClarkeLaw;
use fem::contact::{Boundary, BoundaryRule, Discretization, StepView};
use fem::space::quadrature::edge;

/// Normal traces at the points of Γ3: of v^h and of u^{kh}.
pub(crate) struct Traces {
    /// v^h_ν.
    pub v: Vec<f64>,
    /// u^{kh}_ν.
    pub u_h: Vec<f64>,
}

/// What the lines of the proof need from Γ3.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ContactIntegrals {
    /// ‖u_ν - v^h_ν‖².
    pub delta: f64,
    /// ‖u_ν - u^{kh}_ν‖².
    pub trace: f64,
    /// ‖u_ν - s‖², ‖u^{kh}_ν - s‖².
    pub arguments: [f64; 2],
    /// ‖ξ + λ‖², ‖λ‖².
    pub pressure: f64,
    /// ‖λ‖².
    pub multiplier: f64,
    /// ∫ j_ν⁰(u_ν; v^h_ν - u_ν).
    pub j_u_v: Sum,
    /// ∫ j_ν⁰(u_ν; u_ν - v^h_ν).
    pub j_v_u: Sum,
    /// ∫ j_ν⁰(u_ν; u^{kh}_ν - u_ν).
    pub j_u_h: Sum,
    /// ∫ j_ν⁰(u^{kh}_ν; v^h_ν - u^{kh}_ν).
    pub j_h_v: Sum,
    /// ∫ c (v^h_ν - u_ν), ∫ c (u^{kh}_ν - u_ν).
    pub work: [Sum; 2],
    /// ∫ λ(g - v^h_ν), ∫ λ(g - u^{kh}_ν).
    pub slack: [Sum; 2],
    /// ∫ λ(v^h_ν - g)₊, ∫ λ(u^{kh}_ν - g)₊: U^h is in U only if both are zero.
    pub outside: [f64; 2],
    /// ∫ [j_ν⁰(u_ν; w) - ξ w] for w = v^h_ν - u_ν, u^{kh}_ν - u_ν, u_ν - v^h_ν.
    pub selection: [Sum; 3],
}

/// The integrals over Γ3; `nodal_multiplier` is λ at the points of the trace where it acts there.
pub(crate) fn over_contact(
    space: &Discretization,
    law: &ClarkeLaw,
    edges: &[EdgeSample],
    traces: &Traces,
    boundary: &Boundary,
    nodal_multiplier: Option<&[f64]>,
) -> ContactIntegrals {
    let mut sums = ContactIntegrals::default();
    let samples = edges.iter().filter_map(|sample| Some((sample, sample.contact?)));
    for (sample, at) in samples {
        let value = |nodal: &[f64]| between(at.trace, &sample.shape, nodal);
        let (weight, u, v, u_h) = (sample.weight, at.normal, value(&traces.v), value(&traces.u_h));
        let (r, r_h) = (u - at.shift, u_h - at.shift);
        sums.delta += weight * (u - v).powi(2);
        sums.trace += weight * (u - u_h).powi(2);
        sums.arguments[0] += weight * r * r;
        sums.arguments[1] += weight * r_h * r_h;
        let pressure = at.compliance + at.multiplier;
        sums.pressure += weight * pressure * pressure;
        sums.multiplier += weight * at.multiplier * at.multiplier;
        sums.j_h_v.add(weight * at.scale * law.directional(r_h, v - u_h));
        for (i, w) in [v - u, u_h - u].into_iter().enumerate() {
            sums.work[i].add(weight * pressure * w);
            let slack = if at.multiplier == 0.0 {
                0.0
            } else {
                at.multiplier * (at.gap - if i == 0 { v } else { u_h })
            };
            sums.slack[i].add(weight * slack);
            sums.outside[i] += weight * (-slack).max(0.0);
        }
        for (i, w) in [v - u, u_h - u, u - v].into_iter().enumerate() {
            let directional = at.scale * law.directional(r, w);
            [&mut sums.j_u_v, &mut sums.j_u_h, &mut sums.j_v_u][i].add(weight * directional);
            sums.selection[i].add(weight * (directional - at.compliance * w));
        }
    }
    for (i, lambda) in nodal_multiplier.unwrap_or_default().iter().enumerate() {
        let weight = space.trace.points[i].weight;
        // u lies in V^h, so v^h = u, and λ(g - u_ν) = 0 at the vertices.
        let (v, u_h) = (traces.v[i], traces.u_h[i]);
        sums.work[1].add(weight * lambda * (u_h - v));
        sums.multiplier += weight * lambda * lambda;
        sums.pressure += weight * lambda * lambda;
        if *lambda != 0.0 {
            let gap = (boundary.gap)(place(space, i));
            sums.slack[0].add(weight * lambda * (gap - v));
            sums.slack[1].add(weight * lambda * (gap - u_h));
        }
    }
    sums
}

/// The boundary terms of the scheme itself at v^h: j_ν⁰(u^{kh}; v^h - u^{kh}) by its rule (`exact` is
/// the integral), the multipliers' Σ w λ(g - v^h), and, where ∂j_ν is set-valued, j_ν⁰ less
/// ξ(v^h - u^{kh}).
pub(crate) fn scheme_terms(
    space: &Discretization,
    law: &ClarkeLaw,
    boundary: &Boundary,
    view: &StepView<'_>,
    traces: &Traces,
    exact: Sum,
) -> [Sum; 3] {
    let (mut directional, mut slack, mut selection) =
        (Sum::default(), Sum::default(), Sum::default());
    for (i, point) in space.trace.points.iter().enumerate().filter(|(_, point)| !point.clamped) {
        let (v, u_h, x) = (traces.v[i], traces.u_h[i], place(space, i));
        if boundary.rule == BoundaryRule::Vertex {
            let slope = law.directional(u_h - (boundary.shift)(x), v - u_h);
            let value = boundary.scale_at(x) * slope;
            directional.add(point.weight * value);
            selection.add(point.weight * (value - view.compliance[i] * (v - u_h)));
        }
        if view.multiplier[i] != 0.0 {
            slack.add(point.weight * view.multiplier[i] * ((boundary.gap)(x) - v));
        }
    }
    match boundary.rule {
        BoundaryRule::Vertex => {}
        BoundaryRule::Exact => directional = exact,
        BoundaryRule::Gauss => directional = gauss(space, law, boundary, traces),
    }
    [directional, slack, selection]
}

/// ∫ j_ν⁰(u^{kh}; v^h - u^{kh}) by three Gauss points per edge.
fn gauss(space: &Discretization, law: &ClarkeLaw, boundary: &Boundary, traces: &Traces) -> Sum {
    let (mut sum, rule) = (Sum::default(), edge(3));
    for (f, measure) in space.trace.measure.iter().enumerate() {
        let [a, b] = [0, 1].map(|end| space.trace.facet(f)[end] as usize);
        let vertices = [a, b].map(|i| space.trace.points[i].vertex);
        for (shape, weight) in rule.points.iter().zip(&rule.weights) {
            let value = |nodal: &[f64]| shape[0] * nodal[a] + shape[1] * nodal[b];
            let u_h = value(&traces.u_h);
            let x = space.mesh.point(&vertices, shape);
            let slope = law.directional(u_h - (boundary.shift)(x), value(&traces.v) - u_h);
            sum.add(measure * weight * boundary.scale_at(x) * slope);
        }
    }
    sum
}

fn place(space: &Discretization, i: usize) -> [f64; 3] {
    space.mesh.point(&[space.trace.points[i].vertex], &[1.0])
}
