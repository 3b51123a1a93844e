//! The floor of a case: what the unresolved residual of the last step and rounding contribute to
//! each error norm.

use super::{Discretization, linear::strain_norm};
use crate::space::strain_of;

/// Floors of the error norms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Floors {
    /// Of ‖ε(u - u_h)‖.
    pub v: f64,
    /// Of ‖u - u_h‖.
    pub l2: f64,
    /// Of ‖σ - σ_h‖.
    pub stress: f64,
    /// Of ‖u_ν - u_{h,ν}‖ on Γ3.
    pub trace: f64,
    /// Of the pressure on Γ3.
    pub pressure: f64,
}

impl Floors {
    /// Floors from the correction `delta` that one more linear solve would make (a nodal vector),
    /// the solution `u`, the residual norm that was accepted, and the stiffest modulus `largest`.
    pub fn new(
        space: &Discretization,
        delta: &[f64],
        u: &[f64],
        residual: f64,
        largest: f64,
    ) -> Self {
        let size = u.iter().fold(0.0f64, |size, value| size.max(value.abs()));
        // Strains are differences of nodal values over h: they round to ε‖u‖/h.
        let rounding = f64::EPSILON * size * f64::from(space.mesh.n);
        let v = strain_norm(space, delta) + rounding;
        let lightest =
            space.trace.points.iter().map(|point| point.weight).fold(f64::INFINITY, f64::min);
        Self {
            v,
            l2: l2_norm(space, delta) + f64::EPSILON * size,
            stress: largest * v,
            trace: trace_norm(space, delta) + f64::EPSILON * size,
            pressure: if lightest.is_finite() { residual / lightest.sqrt() } else { 0.0 },
        }
    }
}

/// ‖v‖ of a nodal vector.
fn l2_norm(space: &Discretization, v: &[f64]) -> f64 {
    let d = space.mesh.dimension;
    let scale = 1.0 / ((d + 1) * (d + 2)) as f64;
    let mut sum = 0.0;
    for c in 0..space.mesh.cell_count() {
        for i in 0..d {
            let at = |node: &u32| v[d * *node as usize + i];
            let total: f64 = space.cell_nodes(c).iter().map(at).sum();
            let squares: f64 = space.cell_nodes(c).iter().map(|node| at(node).powi(2)).sum();
            sum += space.geometry.measure[c] * scale * (squares + total * total);
        }
    }
    sum.sqrt()
}

/// ‖v_ν‖ on Γ3 of a nodal vector, by the lumped rule.
fn trace_norm(space: &Discretization, v: &[f64]) -> f64 {
    let points = space.trace.points.iter().enumerate();
    points.map(|(i, point)| point.weight * space.trace.normal(i, v).powi(2)).sum::<f64>().sqrt()
}

/// ‖ε(v) - ε(w)‖ of two nodal vectors.
pub fn strain_distance(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
    fn sum<const S: usize>(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
        let mut sum = 0.0;
        for c in 0..space.mesh.cell_count() {
            let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
            let (a, b) = (strain_of::<S>(gradients, nodes, v), strain_of::<S>(gradients, nodes, w));
            let square: f64 = a.iter().zip(&b).map(|(x, y)| (x - y).powi(2)).sum();
            sum += space.geometry.measure[c] * square;
        }
        sum
    }
    match space.mesh.dimension {
        2 => sum::<3>(space, v, w).sqrt(),
        _ => sum::<6>(space, v, w).sqrt(),
    }
}
