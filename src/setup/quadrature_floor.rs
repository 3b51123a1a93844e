//! What the quadrature of the loads contributes to the errors on a mesh.

use std::sync::Arc;

use crate::contact::{Discretization, Floors, LevelFields, LoadError, strain_norm};
use crate::law::Isotropic;
use crate::norms::ElasticProjection;
use crate::space::strain_of;

/// The loads at a few times are taken by their own and by the next rule; `SAFETY` times the largest
/// answer of A = 𝒜 + μ to a difference stands for all times. The answer bounds what an error moves by;
/// errors move less, as they are nearly orthogonal to V^h (`sweep floors` measures it).
const SAFETY: f64 = 1.5;

/// Parts of [0, T] at whose ends rules are compared: once fronts are on their way, once at the end,
/// where some scenes have no front left.
pub const QUADRATURE_TIMES: u32 = 2;

/// Floors from pairs of load vectors; `elasticity` and `mu` are the scene's.
///
/// # Errors
/// A mesh on which A cannot be factorized.
pub(super) fn quadrature_floors(
    space: &Discretization,
    loads: &[[Arc<Vec<f64>>; 2]],
    elasticity: Isotropic,
    mu: f64,
) -> Result<Floors, LoadError> {
    let mut operator = ElasticProjection::new(space, &elasticity, mu)
        .map_err(|error| LoadError::Reference { reason: error.to_string() })?;
    let still = LevelFields { u: vec![0.0; space.nodes.len()], ..LevelFields::default() };
    // Stresses follow strains by the stiffest modulus, on Γ3 those of the cells there.
    let largest = elasticity.eigenvalues(space.mesh.dimension).1;
    let mut floors = Floors::default();
    for [own, stronger] in loads {
        let difference: Vec<f64> = stronger.iter().zip(&**own).map(|(a, b)| a - b).collect();
        let u = operator.response(&difference);
        let pressure = largest * strain_on_contact(space, &u);
        let moved = LevelFields { u, ..LevelFields::default() }.distance(&still, space);
        floors = floors.max(Floors { stress: largest * moved.v, pressure, ..moved });
    }
    Ok(floors.times(SAFETY))
}

/// ‖ε(v)‖ on Γ3, from the cells with a side on it: a cell of measure m has about 2m/h of Γ3. In the
/// plane; in space the norm in the body stands for it.
fn strain_on_contact(space: &Discretization, v: &[f64]) -> f64 {
    if space.mesh.dimension != 2 {
        return strain_norm(space, v);
    }
    let mut on_contact = vec![false; space.mesh.vertices()];
    for point in &space.trace.points {
        on_contact[point.vertex as usize] = true;
    }
    let touches = |c: &usize| {
        space.mesh.cell(*c).iter().filter(|&&vertex| on_contact[vertex as usize]).count() > 1
    };
    let cells = (0..space.mesh.cell_count()).filter(touches).map(|c| {
        let strain = strain_of::<3>(space.geometry.gradients(c), space.cell_nodes(c), v);
        space.geometry.measure[c] * strain.iter().map(|e| e * e).sum::<f64>()
    });
    (2.0 * cells.sum::<f64>() / space.mesh.h()).sqrt()
}
