//! Friction in the balance of forces: its part of them, and how far (u_τ, s) is from the law.

use super::{Discretization, Model, StepView};
use vhi::law::{Potential, Scaled, graph_distance};

/// Adds Σ w s v_τ to forces by nodes.
pub(super) fn add_force(space: &Discretization, view: &StepView<'_>, force: &mut [f64]) {
    for (point, s) in space.trace.points.iter().zip(view.friction_stresses(space)) {
        let mut components = [0.0; 2];
        components.iter_mut().zip(s).for_each(|(component, s)| *component = point.weight * s);
        point.add_tangential(&components[..s.len()], force);
    }
}

/// Largest distance of (u_τ, s) from the law at the free points, as a force; `stiffness` answers to a displacement.
pub(super) fn violation(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
    stiffness: f64,
) -> f64 {
    let Some(friction) = &model.friction else { return 0.0 };
    let points = space.trace.points.iter().zip(view.friction_stresses(space)).enumerate();
    let distances = points.filter(|(_, (point, _))| point.carries()).map(|(i, (point, s))| {
        let x = space.mesh.point(&[point.vertex], &[1.0]);
        let pressure = model.boundary_on(point.side).map_or(0.0, |boundary| {
            let normal = space.trace.normal(i, view.u);
            boundary.potential_at(x).subdifferential(normal - (boundary.shift)(x)).0
        });
        let law = friction.at(x, view.t, pressure);
        distance(&law, (&point.slip(view.u)[..s.len()], s), point.weight, stiffness)
    });
    distances.fold(0.0, f64::max)
}

impl StepView<'_> {
    /// The components of s along the tangents, point by point; nothing without friction.
    pub fn friction_stresses(&self, space: &Discretization) -> impl Iterator<Item = &[f64]> {
        self.friction.chunks_exact(space.mesh.dimension - 1)
    }
}

/// Distance of (u_τ, s) from the law as a force. With r = `stiffness`/`weight`, the point of the graph whose s + r u_τ is
/// that of (u_τ, s) lies along it: what is across counts as it is, what is along as a law of numbers has it.
fn distance(law: &Scaled, (slip, s): (&[f64], &[f64]), weight: f64, stiffness: f64) -> f64 {
    let (&[a, b], &[p, q]) = (slip, s) else {
        return graph_distance(law, [slip[0], s[0]], weight, stiffness);
    };
    let r = stiffness / weight;
    let z = [p + r * a, q + r * b];
    let length = z[0].hypot(z[1]);
    let [c, d] = if length > 0.0 { z.map(|z| z / length) } else { [1.0, 0.0] };
    let across = weight * (c * q - d * p).abs();
    graph_distance(law, [c * a + d * b, c * p + d * q], weight, stiffness).max(across)
}
