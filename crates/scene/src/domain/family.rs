//! `[domain] mesh`: how the vertices of the meshes are placed.

use super::polygon::point;
use super::{Domain, Shape};
use crate::diagnostic::SceneError;
use crate::reading::Reading;
use crate::written;
use fem::mesh::{CoarseMesh, Family as MeshFamily, vertex_at};

/// Larger exponents give cells at the corner below rounding.
const STEEPEST: f64 = 8.0;

pub(super) fn family(
    reading: &Reading,
    written: Option<&written::Mesh>,
    domain: &Domain,
) -> Result<MeshFamily, SceneError> {
    let Some(mesh) = written else {
        return Ok(MeshFamily::Structured);
    };
    let kind = &*mesh.kind;
    reading.word("domain.mesh.kind", kind, &["structured", "perturbed", "graded"])?;
    let (moved, gathered): (&[&str], &[&str]) = (&["perturbed"], &["graded"]);
    reading.only(
        "domain.mesh",
        kind,
        &[
            ("amplitude", mesh.amplitude.is_some(), moved),
            ("seed", mesh.seed.is_some(), moved),
            ("axes", mesh.axes.is_some(), moved),
            ("corner", mesh.corner.is_some(), gathered),
            ("exponent", mesh.exponent.is_some(), gathered),
        ],
    )?;
    if kind != "structured" && matches!(domain.shape, Shape::Refined(CoarseMesh::Space(_))) {
        let message =
            format!("meshes of kind `{}` are not made of tetrahedra from a file", mesh.kind);
        let hint =
            "leave `mesh` away: the file says where the vertices are, and refinement keeps them";
        return Err(reading.error("domain.mesh.kind", message, hint));
    }
    match kind {
        "structured" => Ok(MeshFamily::Structured),
        "perturbed" => perturbed(reading, mesh, domain.dimension()),
        _ => graded(reading, mesh, domain),
    }
}

fn perturbed(
    reading: &Reading,
    mesh: &written::Mesh,
    dimension: usize,
) -> Result<MeshFamily, SceneError> {
    let amplitude =
        reading.needed("domain.mesh.amplitude", mesh.amplitude, &mesh.kind, "amplitude = 0.2")?;
    if !(0.0..0.25).contains(&amplitude) {
        let message = format!("amplitude = {amplitude} is outside [0, 0.25)");
        return Err(reading.error(
            "domain.mesh.amplitude",
            message,
            "it is a part of the mesh width; from 0.25 on a triangle may turn over",
        ));
    }
    let seed = reading.needed("domain.mesh.seed", mesh.seed, &mesh.kind, "seed = 1")?;
    let seed = reading.seed("domain.mesh.seed", seed)?;
    let axes = axes(reading, mesh.axes.as_deref(), dimension)?;
    Ok(MeshFamily::Perturbed { amplitude, seed, axes })
}

/// The axes along which vertices move: by default all.
fn axes(
    reading: &Reading,
    words: Option<&[String]>,
    dimension: usize,
) -> Result<[bool; 3], SceneError> {
    let Some(words) = words else { return Ok([true; 3]) };
    let known = &[("x", 0), ("y", 1), ("z", 2)][..dimension];
    let mut moved = [false; 3];
    for (index, word) in words.iter().enumerate() {
        moved[reading.choice(&format!("domain.mesh.axes.{index}"), word, known)?] = true;
    }
    Ok(moved)
}

fn graded(
    reading: &Reading,
    mesh: &written::Mesh,
    domain: &Domain,
) -> Result<MeshFamily, SceneError> {
    let key = "domain.mesh.corner";
    let corner = reading.needed(key, mesh.corner.as_deref(), &mesh.kind, "corner = [0.0, 0.0]")?;
    let corner = point(reading, key, corner)?;
    let exponent =
        reading.needed("domain.mesh.exponent", mesh.exponent, &mesh.kind, "exponent = 2.0")?;
    if !(1.0..=STEEPEST).contains(&exponent) {
        let message = format!("exponent = {exponent} is outside [1, {STEEPEST}]");
        let hint = "1 leaves the mesh as it is; for u ~ r^s at the corner 1/s or a little more restores order 1";
        return Err(reading.error("domain.mesh.exponent", message, hint));
    }
    let (known, what) = match &domain.shape {
        Shape::Box if domain.dimension() == 3 => {
            let message = "a box has no graded meshes";
            return Err(reading.error("domain.mesh.kind", message, "grade a plane scene"));
        }
        Shape::Box => {
            let ends = |axis: usize| corner[axis] == 0.0 || corner[axis] == domain.size[axis];
            (ends(0) && ends(1), "corner of the rectangle")
        }
        Shape::Refined(CoarseMesh::Plane(coarse)) => {
            (vertex_at(coarse, corner).is_some(), "vertex of the coarse triangulation")
        }
        Shape::Refined(CoarseMesh::Space(_)) => (false, "point of the plane"),
    };
    if known {
        return Ok(MeshFamily::Graded { corner, exponent });
    }
    let message = format!("({}, {}) is no {what}", corner[0], corner[1]);
    Err(reading.error(key, message, "grade towards a vertex that is in the file"))
}
