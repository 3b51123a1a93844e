//! Limit of contact conditions at a vertex.

use nalgebra::DMatrix;

use super::{Domain, Face, Shape, place};
use crate::diagnostic::{Result, SceneError};
use crate::reading::Reading;
use fem::mesh::CoarseMesh;

/// |det| of unit normals below which they count as dependent, as in the frames of the unknowns.
const DEPENDENT: f64 = 1e-6;

/// Each condition u_ν ≤ g takes an unknown of its vertex, and so does u_ν = 0 on a plane of symmetry: at most d, along
/// independent normals. In the plane two contact edges meet, which is always possible; a bent contact side of tetrahedra has
/// a normal per face.
///
/// # Errors
/// The first vertex of Γ3 off Γ1 with too many normals.
pub(super) fn few_at_a_vertex(reading: &Reading, domain: &Domain) -> Result<()> {
    let Shape::Refined(coarse) = &domain.shape else { return Ok(()) };
    let on = |sides: &[super::Side], side: u32| sides.iter().any(|listed| listed.0 == side);
    let mut normals: Vec<Vec<[f64; 3]>> = vec![Vec::new(); coarse.vertices.len()];
    let mut across = normals.clone();
    let mut clamped = vec![false; coarse.vertices.len()];
    for face in &coarse.facets {
        for &v in &face.corners {
            let here = &mut normals[v as usize];
            if on(&domain.contact, face.side) && !here.contains(&face.normal) {
                here.push(face.normal);
            }
            if on(&domain.symmetry, face.side) {
                add_independent(&mut across[v as usize], face.normal);
            }
            clamped[v as usize] |= on(&domain.clamped, face.side);
        }
    }
    let bad = |v: &usize| {
        let conditions = [&normals[*v][..], &across[*v]].concat();
        let possible = coarse.dimension == 2 && across[*v].is_empty();
        !clamped[*v] && !normals[*v].is_empty() && !possible && !independent(&conditions)
    };
    let Some(v) = (0..normals.len()).find(bad) else { return Ok(()) };
    if across[v].is_empty() {
        return Err(refusal(reading, coarse, v, normals[v].len()));
    }
    let at = place(&coarse.vertices[v].into(), coarse.dimension);
    let message = format!(
        "a contact side and a plane of symmetry meet at {at} along one line: u_nu = 0 and u_nu <= g there are not independent"
    );
    let hint = "put a traction or clamped side between them, or let them meet at an angle";
    Err(reading.error("domain.symmetry", message, hint))
}

fn refusal(reading: &Reading, coarse: &CoarseMesh, v: usize, count: usize) -> SceneError {
    let at = place(&coarse.vertices[v].into(), coarse.dimension);
    let message = format!(
        "{count} faces of the contact sides with different normals meet at {at}: the conditions u_nu <= g there are not independent"
    );
    let hint = "contact sides of tetrahedra must be plane: a bent side of many faces may be a traction side";
    reading.error("domain.contact", message, hint)
}

fn add_independent(known: &mut Vec<[f64; 3]>, normal: [f64; 3]) {
    known.push(normal);
    if !independent(known) {
        known.pop();
    }
}

/// Number of rigid motions with u_ν = 0 on the planes of symmetry: what the rank of ν·r at the corners of each plane piece,
/// r the translations and rotations, leaves of d(d + 1)/2.
pub(super) fn rigid_motions_left(domain: &Domain) -> usize {
    let d = domain.dimension();
    let size = domain.size.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let faces: Vec<Face> = domain.symmetry.iter().flat_map(|&side| domain.faces(side)).collect();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for face in &faces {
        for p in face.points(1) {
            let (n, x) = (face.normal, [0, 1, 2].map(|i| (p[i] - faces[0].corner[i]) / size));
            let turn = |i: usize, j: usize| n[j] * x[i] - n[i] * x[j];
            let all = [n[0], n[1], turn(0, 1), n[2], turn(1, 2), turn(2, 0)];
            rows.push(all[..d * (d + 1) / 2].to_vec());
        }
    }
    let motions = d * (d + 1) / 2;
    let matrix = DMatrix::from_fn(rows.len(), motions, |i, j| rows[i][j]);
    // Rotations are in units of the body: a plane that is a 1e-6th of it fixes none.
    motions - matrix.rank(DEPENDENT)
}

/// Linear independence of unit vectors, by Gram's determinant.
fn independent(normals: &[[f64; 3]]) -> bool {
    let dot = |p: [f64; 3], q: [f64; 3]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
    let gram = DMatrix::from_fn(normals.len(), normals.len(), |i, j| dot(normals[i], normals[j]));
    gram.determinant() > DEPENDENT.powi(2)
}
