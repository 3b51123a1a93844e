//! `[domain] mesh`: how the vertices of the meshes are placed.

use super::polygon::A_POINT;
use super::{Domain, Shape};
use crate::diagnostic::Result;
use crate::reading::Reading;
use fem::mesh::{Family as MeshFamily, vertex_at};

/// Larger exponents give cells at the corner below rounding.
const STEEPEST: f64 = 8.0;

/// The kinds of mesh with their keys.
pub(crate) const MESHES: [(&str, &str); 3] =
    [("structured", ""), ("perturbed", "amplitude seed axes"), ("graded", "corner exponent")];

pub(super) fn family(reading: &Reading, domain: &Domain) -> Result<MeshFamily> {
    if !reading.has("domain.mesh") {
        return Ok(MeshFamily::Structured);
    }
    let kind = reading.kind("domain.mesh", &MESHES)?;
    let tetrahedra = matches!(&domain.shape, Shape::Refined(coarse) if coarse.dimension == 3);
    let message = format!("meshes of kind `{kind}` are not made of tetrahedra from a file");
    let hint =
        "remove `mesh`, because the file says where the vertices are and refinement keeps them";
    reading.refuse_if(kind != "structured" && tetrahedra, "domain.mesh.kind", message, hint)?;
    match kind {
        "structured" => Ok(MeshFamily::Structured),
        "perturbed" => perturbed(reading, domain.dimension()),
        _ => graded(reading, domain),
    }
}

fn perturbed(reading: &Reading, dimension: usize) -> Result<MeshFamily> {
    let hint = "it is a part of the mesh width; from 0.25 on a triangle may turn over";
    let range = ["is outside [0, 0.25)", hint];
    let fits = |amplitude| (0.0..0.25).contains(&amplitude);
    let amplitude = reading.number("domain.mesh.amplitude", fits, range)?;
    let seed = reading.seed("domain.mesh.seed")?;
    let axes = axes(reading, dimension)?;
    Ok(MeshFamily::Perturbed { amplitude, seed, axes })
}

/// The axes along which vertices move: by default all.
fn axes(reading: &Reading, dimension: usize) -> Result<[bool; 3]> {
    let known = &[("x", 0), ("y", 1), ("z", 2)][..dimension];
    let mut moved = [!reading.has("domain.mesh.axes"); 3];
    for index in reading.entries("domain.mesh.axes")? {
        moved[reading.choice(&format!("domain.mesh.axes.{index}"), known)?] = true;
    }
    Ok(moved)
}

fn graded(reading: &Reading, domain: &Domain) -> Result<MeshFamily> {
    let key = "domain.mesh.corner";
    let corner = reading.pair(key, A_POINT)?;
    let fault = format!("is outside [1, {STEEPEST}]");
    let hint = "1 leaves the mesh as it is; for u ~ r^s at the corner 1/s or a little more restores order 1";
    let fits = |exponent| (1.0..=STEEPEST).contains(&exponent);
    let exponent = reading.number("domain.mesh.exponent", fits, [&fault, hint])?;
    let (known, what) = match &domain.shape {
        Shape::Box if domain.dimension() == 3 => {
            let message = "a box has no graded meshes";
            return Err(reading.error("domain.mesh.kind", message, "grade a plane scene"));
        }
        Shape::Box => {
            let ends = |axis: usize| corner[axis] == 0.0 || corner[axis] == domain.size[axis];
            (ends(0) && ends(1), "corner of the rectangle")
        }
        Shape::Refined(coarse) => {
            (vertex_at(coarse, corner).is_some(), "vertex of the coarse triangulation")
        }
    };
    let message = format!("({}, {}) is no {what}", corner[0], corner[1]);
    reading.refuse_if(!known, key, message, "grade towards a vertex that is in the file")?;
    Ok(MeshFamily::Graded { corner, exponent })
}
