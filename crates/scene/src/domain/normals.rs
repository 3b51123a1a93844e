//! Limit of contact conditions at a vertex.

use nalgebra::DMatrix;

use super::{Domain, Shape, place};
use crate::diagnostic::SceneError;
use crate::reading::Reading;
use fem::mesh::CoarseMesh;

/// |det| of unit normals below which they count as dependent, as in the frames of the unknowns.
const DEPENDENT: f64 = 1e-6;

/// Each condition u_ν ≤ g takes an unknown of its vertex: at most three, along independent normals. In the plane two
/// edges meet, which is always possible; a bent contact side of tetrahedra has a normal per face.
///
/// # Errors
/// The first vertex of Γ3 off Γ1 with too many normals.
pub(super) fn few_at_a_vertex(reading: &Reading, domain: &Domain) -> Result<(), SceneError> {
    let Shape::Refined(coarse) = &domain.shape else { return Ok(()) };
    if coarse.dimension == 2 {
        return Ok(());
    }
    let on = |sides: &[super::Side], side: u32| sides.iter().any(|listed| listed.0 == side);
    let mut normals: Vec<Vec<[f64; 3]>> = vec![Vec::new(); coarse.vertices.len()];
    let mut clamped = vec![false; coarse.vertices.len()];
    for face in &coarse.facets {
        for &v in &face.corners {
            let here = &mut normals[v as usize];
            if on(&domain.contact, face.side) && !here.contains(&face.normal) {
                here.push(face.normal);
            }
            clamped[v as usize] |= on(&domain.clamped, face.side);
        }
    }
    let bad = |v: &usize| !clamped[*v] && !independent(&normals[*v]);
    let Some(v) = (0..normals.len()).find(bad) else { return Ok(()) };
    Err(refusal(reading, coarse, v, normals[v].len()))
}

fn refusal(reading: &Reading, coarse: &CoarseMesh, v: usize, count: usize) -> SceneError {
    let at = place(&coarse.vertices[v].into(), 3);
    let message = format!(
        "{count} faces of the contact sides with different normals meet at {at}: the conditions u_nu <= g there are not independent"
    );
    let hint = "contact sides of tetrahedra must be plane: a bent side of many faces may be a traction side";
    reading.error("domain.contact", message, hint)
}

/// Linear independence of unit vectors, by Gram's determinant.
fn independent(normals: &[[f64; 3]]) -> bool {
    let dot = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
    let gram = DMatrix::from_fn(normals.len(), normals.len(), |i, j| dot(normals[i], normals[j]));
    gram.determinant() > DEPENDENT.powi(2)
}
