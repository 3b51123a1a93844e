//! The KKT residual of the discrete form of (5.14), evaluated apart from the solver: from strains,
//! laws and multipliers only, without tangents, active sets or stored matrices.

use super::assembly::stress_force;
use super::case::{KKT_ALLOWED, StepView};
use super::kkt_compliance::{add_exact, add_gauss};
use super::{Boundary, BoundaryRule, Discretization, Model, TracePoint, friction_force};
use crate::space::StrainPoint;
use algebra::in_dimension;
use algebra::linalg::{axpy, larger, largest};
use vhi::Newton;
use vhi::law::{Potential, Projection, graph_distance};

/// The residual with which Newton's method in the volume would accept a level with forces of this size.
pub(super) fn accepted_residual(size: f64) -> f64 {
    Newton::default().rounding_units * f64::EPSILON * size
}

/// Largest violation of the discrete KKT system at one time level, relative to the largest nodal
/// force of the stresses (or of the load, if larger); dimensionless. Zero force: the violation.
///
/// Where that is above [`KKT_ALLOWED`] and rounding of u moves forces by more, it is relative to what a solve may leave of
/// their terms: (16 ε/1e-9) max Σ |B|ᵀ|C||B||u|. At λ/μ = 10⁶ these are 4·10⁷ times their sum on n = 32. At most, it is
/// relative to (M - m)/m nodal forces, m and M the least and largest stiffness of 𝒜, by which forces λ tr ε outweigh their
/// effect: a body that is held so badly that rounding turns it has no such excuse.
/// Nor do single forces count that rounding of u_ν and s in a stiff law p(u_ν - s) explains: 16 ε p' (|u_ν| + |s|). A wrong
/// law or slope is seen while it is wrong by more than 16 ε (|u_ν| + |s|)/|u_ν - s| of p, and wrong forces elsewhere as before.
///
/// Parts: force balance with ξ, λ and s; 0 ≤ λ ⊥ g - u_ν ≥ 0; ξ ∈ ∂j_ν(u_ν) and s ∈ S ∂|u_τ| at the vertices.
pub fn kkt_residual(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    load: &[f64],
) -> f64 {
    kkt_residual_in(space, model, view, load, &mut Vec::new())
}

/// [`kkt_residual`] with a buffer for the forces, which a march reuses at every level.
pub(super) fn kkt_residual_in(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    load: &[f64],
    room: &mut Vec<f64>,
) -> f64 {
    in_dimension!(space.mesh.dimension, D, S => evaluate::<D, S>(space, model, view, load, room))
}

/// ∫ σ : ε(v) as a nodal vector, σ the stress that `view` shows.
fn internal_force<const D: usize, const S: usize>(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    force: &mut Vec<f64>,
) {
    force.clear();
    force.resize(space.nodes.len(), 0.0);
    for at in space.points() {
        let stress = view.stress_at::<S>(space, model, &at).map(|s| s * at.weight);
        stress_force::<D, S>(at.gradients, at.nodes, &stress, force);
    }
}

/// What the stresses of `view` and its pressures on Γ3 leave of the load, as a nodal vector: B with B·v = (σ, ε(v)) +
/// ∫_{Γ3} (ξ + λ) v_ν - F(v) for every v in V^h, by the boundary rule of the model.
pub fn out_of_balance(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    load: &[f64],
) -> Vec<f64> {
    let mut balance = Vec::new();
    in_dimension!(space.mesh.dimension, D, S => internal_force::<D, S>(space, model, view, &mut balance));
    add_contact_forces(space, model, view, &mut balance);
    axpy(-1.0, load, &mut balance);
    space.frames.without_support(&mut balance);
    balance
}

fn evaluate<const D: usize, const S: usize>(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    load: &[f64],
    balance: &mut Vec<f64>,
) -> f64 {
    internal_force::<D, S>(space, model, view, balance);
    let mut scale = largest(balance).max(largest(load));
    add_contact_forces(space, model, view, balance);
    axpy(-1.0, load, balance);
    space.frames.without_support(balance);
    let unbalanced = largest(&balance[..space.dofs()]);
    let mut contact = 0.0f64;
    if !model.boundary.is_empty() {
        for (i, point) in space.trace.points.iter().enumerate().filter(|(_, p)| p.carries()) {
            let Some(boundary) = model.boundary_on(point.side) else { continue };
            let x = space.mesh.point(&[point.vertex], &[1.0]);
            let stiffness = model.elasticity.eigenvalues(D).1;
            let (normal, lambda) = (space.trace.normal(i, view.u), view.multiplier[i]);
            let gap = (boundary.gap)(x, view.t);
            contact = contact.max(-lambda * point.weight);
            if gap.is_finite() {
                // A violated or missed bound, as the force that the stiffness answers it with.
                contact = contact.max((normal - gap) * stiffness);
                contact = contact.max((lambda * point.weight).min((gap - normal) * stiffness));
            }
            if boundary.rule == BoundaryRule::Vertex {
                let place = [normal - (boundary.shift)(x), view.compliance[i]];
                let potential = boundary.potential_at(x);
                contact = contact.max(graph_distance(&potential, place, point.weight, stiffness));
            }
        }
        scale = scale.max(f64::MIN_POSITIVE);
    }
    if model.friction.is_some() {
        let stiffness = model.elasticity.eigenvalues(D).1;
        contact = larger(contact, friction_force::violation(space, model, view, stiffness));
        scale = scale.max(f64::MIN_POSITIVE);
    }
    // Every unknown and pressure is part of the balance: a NaN in one of them shows in it.
    let mut worst = larger(contact, unbalanced);
    let relative = |worst: f64, scale: f64| if scale > 0.0 { worst / scale } else { worst };
    if relative(worst, scale) > KKT_ALLOWED {
        // Terms that cancel leave more than a share of their sum. They are summed where this decides alone.
        let rounding = accepted_residual(largest_terms(space, model, view));
        let (softest, stiffest) = model.elasticity.eigenvalues(D);
        let by_stiffness = scale * (stiffest - softest) / softest;
        scale = scale.max(by_stiffness.min(rounding / KKT_ALLOWED));
        let allowed = contact_rounding(space, model, view);
        for (force, size) in balance.iter_mut().zip(allowed) {
            let beyond = force.abs() - accepted_residual(size);
            *force = if beyond < 0.0 { 0.0 } else { beyond };
        }
        worst = larger(contact, largest(&balance[..space.dofs()]));
    }
    relative(worst, scale)
}

/// How large the terms of nodal forces are before they cancel: max_i Σ_j |K_ij||v_j|, summed over 𝒜 with u and each ℬ_i with
/// its history. With v rounded to doubles the forces are off by half a unit of rounding of it, whatever solves (Oettli and
/// Prager 1964); as an allowance for rounding it may come from stored matrices, and leaves the projection out.
fn largest_terms(space: &Discretization, model: &Model, view: &StepView<'_>) -> f64 {
    let sizes = |values: &[f64]| values.iter().map(|value| value.abs()).collect::<Vec<f64>>();
    let (mut sums, mut terms) = (vec![0.0; space.dofs()], vec![0.0; space.dofs()]);
    let laws = model.memory.iter().map(|memory| &memory.tensor);
    let histories = view.history.iter().map(Vec::as_slice);
    for (law, v) in std::iter::once((&model.elasticity, view.u)).chain(laws.zip(histories)) {
        let stiffness = sizes(&space.stiffness(law));
        space.pattern.multiply(&stiffness, &sizes(&v[..space.dofs()]), &mut terms);
        axpy(1.0, &terms, &mut sums);
    }
    largest(&sums)
}

/// How large the parts u_ν - s of the forces of the law, and of friction that follows it, are before they cancel, by dofs: the
/// change of these forces by a few units of rounding of u_ν and s, over ε.
fn contact_rounding(space: &Discretization, model: &Model, view: &StepView<'_>) -> Vec<f64> {
    const UNITS: f64 = 8.0;
    let [mut more, mut less] = [(); 2].map(|()| vec![0.0; space.nodes.len()]);
    if model.boundary.iter().all(|boundary| boundary.potential.is_absent()) {
        return more;
    }
    let shift = |point: &TracePoint, x| {
        model.boundary_on(point.side).map_or(0.0, |boundary| (boundary.shift)(x))
    };
    let place = |point: &TracePoint| space.mesh.point(&[point.vertex], &[1.0]);
    let points: Vec<[f64; 2]> = (0..)
        .zip(&space.trace.points)
        .map(|(i, point)| [space.trace.normal(i, view.u), shift(point, place(point))])
        .collect();
    let by = points.iter().fold(0.0f64, |size, [u, s]| size.max(u.abs() + s.abs()))
        * UNITS
        * f64::EPSILON;
    for (i, (point, [u, s])) in space.trace.points.iter().zip(points).enumerate() {
        let boundary = model.boundary_on(point.side).filter(|_| point.carries());
        let Some(boundary) = boundary.filter(|b| b.rule == BoundaryRule::Vertex) else { continue };
        let potential = boundary.potential_at(place(point));
        // A vertex at a jump is held there.
        if potential.jumps().iter().any(|jump| (u - s - jump).abs() <= by) {
            continue;
        }
        let [high, low] = [by, -by].map(|by| potential.subdifferential(u - s + by).0);
        let change = point.weight * (high - low);
        space.trace.add_normal(i, change, &mut more);
        if view.compliance[i] > 0.0 && model.friction.as_ref().is_some_and(|f| f.follows_pressure) {
            let m = space.mesh.dimension - 1;
            let of_p = |s: &f64| change * s / view.compliance[i];
            let parts: Vec<f64> = view.friction[m * i..m * (i + 1)].iter().map(of_p).collect();
            point.add_tangential(&parts, &mut more);
        }
    }
    for boundary in &model.boundary {
        add_facets(space, boundary, view, by, &mut more);
        add_facets(space, boundary, view, -by, &mut less);
    }
    let over = 2.0 * UNITS * f64::EPSILON;
    more.iter().zip(less).map(|(more, less)| (more - less).abs() / over).collect()
}

fn add_contact_forces(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    balance: &mut [f64],
) {
    friction_force::add_force(space, view, balance);
    for (i, point) in space.trace.points.iter().enumerate() {
        let Some(boundary) = model.boundary_on(point.side) else { continue };
        let pressure = match boundary.rule {
            BoundaryRule::Vertex => view.compliance[i] + view.multiplier[i],
            BoundaryRule::Gauss | BoundaryRule::Exact => view.multiplier[i],
        };
        space.trace.add_normal(i, point.weight * pressure, balance);
    }
    for boundary in &model.boundary {
        add_facets(space, boundary, view, 0.0, balance);
    }
}

/// Adds the forces of a law that is integrated over facets, with u_ν - s `moved`.
fn add_facets(
    space: &Discretization,
    boundary: &Boundary,
    view: &StepView<'_>,
    moved: f64,
    force: &mut [f64],
) {
    match boundary.rule {
        // A law that vanishes costs nothing.
        _ if boundary.potential.is_absent() => {}
        BoundaryRule::Vertex => {}
        BoundaryRule::Gauss => add_gauss(space, boundary, view, moved, force),
        BoundaryRule::Exact => add_exact(space, boundary, view, moved, force),
    }
}

impl StepView<'_> {
    /// The mean of σ_n^{kh} over cell c.
    pub fn stress<const S: usize>(
        &self,
        space: &Discretization,
        model: &Model,
        c: usize,
    ) -> [f64; S] {
        let mut mean = [0.0; S];
        for (at, share) in space.points_of(c).zip(&space.geometry.shares) {
            let stress = self.stress_at::<S>(space, model, &at);
            mean.iter_mut().zip(stress).for_each(|(mean, s)| *mean += share * s);
        }
        mean
    }

    /// σ_n^{kh} at a strain point, from (5.1) with the discrete history.
    #[inline]
    pub(crate) fn stress_at<const S: usize>(
        &self,
        space: &Discretization,
        model: &Model,
        at: &StrainPoint<'_>,
    ) -> [f64; S] {
        self.stress_of(space, model, at, &at.strain(self.u))
    }

    /// The same where ε(u_n^{kh}) is known there.
    #[inline]
    pub fn stress_of<const S: usize>(
        &self,
        space: &Discretization,
        model: &Model,
        at: &StrainPoint<'_>,
        strain: &[f64; S],
    ) -> [f64; S] {
        let region = space.region(at.cell);
        let mut stress = model.elasticity.on(region).apply(strain);
        for (memory, history) in model.memory.iter().zip(self.history) {
            let remembered = at.strain::<S>(history);
            let part = memory.tensor.on(region).apply(&remembered);
            for (target, value) in stress.iter_mut().zip(part) {
                *target += value;
            }
        }
        if let Some(extra) = model.projection.stress(strain, self.kappa) {
            for (target, value) in stress.iter_mut().zip(extra) {
                *target += value;
            }
        }
        stress
    }

    /// True where the projection acts somewhere on cell c.
    pub fn yields<const S: usize>(&self, space: &Discretization, model: &Model, c: usize) -> bool {
        let yields = |at: StrainPoint<'_>| {
            model.projection.stress(&at.strain::<S>(self.u), self.kappa).is_some()
        };
        space.points_of(c).any(yields)
    }
}
