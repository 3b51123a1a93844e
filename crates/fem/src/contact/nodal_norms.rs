//! Norms of nodal vectors by the quadrature of the scheme.

use super::Discretization;
use crate::space::StrainPoint;
use algebra::in_dimension;
use algebra::linalg::{is_sound_sum, root_of_squares};
use algebra::tensor::contract;

/// ‖ε(v)‖ of a nodal vector.
pub fn strain_norm(space: &Discretization, v: &[f64]) -> f64 {
    fn sum<const S: usize>(space: &Discretization, v: &[f64], scale: f64) -> f64 {
        let square = |at: StrainPoint<'_>| {
            let scaled = at.strain::<S>(v).map(|e| scale * e);
            at.weight * contract(&scaled, &scaled)
        };
        space.points().map(square).sum()
    }
    root_of_squares(|scale| in_dimension!(space.mesh.dimension, D, S => sum::<S>(space, v, scale)))
}

/// ‖ε(v)‖ from its square, or anew where squares of these strains leave the range of doubles.
pub(super) fn strain_norm_from(square: f64, space: &Discretization, v: &[f64]) -> f64 {
    if is_sound_sum(square) { square.sqrt() } else { strain_norm(space, v) }
}

pub(super) fn l2_norm(space: &Discretization, v: &[f64]) -> f64 {
    let d = space.mesh.dimension;
    let square = space.element.mean_square(d + 1);
    let (mut sum, mut of_cell) = (0.0, Vec::new());
    for c in 0..space.mesh.cell_count() {
        for i in 0..d {
            of_cell.clear();
            of_cell.extend(space.cell_nodes(c).iter().map(|node| [v[d * *node as usize + i]]));
            sum += square.over(space.geometry.measure[c], &of_cell);
        }
    }
    sum.sqrt()
}

/// ‖v_ν‖ on Γ3 of a nodal vector, by the lumped rule.
pub(super) fn trace_norm(space: &Discretization, v: &[f64]) -> f64 {
    let points = space.trace.points.iter().enumerate();
    points.map(|(i, point)| point.weight * space.trace.normal(i, v).powi(2)).sum::<f64>().sqrt()
}

/// ‖ε(v) - ε(w)‖ of two nodal vectors.
pub fn strain_distance(space: &Discretization, v: &[f64], w: &[f64]) -> f64 {
    let difference: Vec<f64> = v.iter().zip(w).map(|(v, w)| v - w).collect();
    strain_norm(space, &difference)
}
