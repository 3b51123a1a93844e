//! What the quadrature of the loads contributes to the errors on a mesh.

use std::sync::Arc;

use crate::contact::{Discretization, Floors, LevelFields, LoadError};
use crate::law::Isotropic;
use crate::norms::ElasticProjection;

/// The loads at a few times are taken by their own and by the next rule; `SAFETY` times the largest
/// answer of A = 𝒜 + μ to a difference stands for all times, and for the error norm as well.
///
/// `sweep floors` measures 1/4.2 to 1/1.8 of this for the loads, and for the error norm, whose rule is
/// stronger, a tenth of that and less (tests/floors.rs).
const SAFETY: f64 = 3.0;

/// Times at which loads are compared, on top of t = 0: a front that passes in between is smooth then,
/// and its quadrature no better.
pub(super) const TIMES: u32 = 4;

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
    let mut floors = Floors::default();
    for [own, stronger] in loads {
        let difference: Vec<f64> = stronger.iter().zip(&**own).map(|(a, b)| a - b).collect();
        let moved = LevelFields { u: operator.response(&difference), ..LevelFields::default() };
        floors = floors.max(moved.distance(&still, space));
    }
    let (least, largest) = elasticity.eigenvalues(space.mesh.dimension);
    // Stresses follow strains by the stiffest modulus; normal stress on Γ3 is that of the cells there,
    // whose share of the body is that of their strains: by the softest.
    Ok(Floors { stress: largest * floors.v, pressure: least * floors.v, ..floors }.times(SAFETY))
}
