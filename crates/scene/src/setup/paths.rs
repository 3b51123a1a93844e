//! Code paths that a scene takes: its time rule, its loads, its rule on Γ3.

use super::{MeshData, Setup};
use crate::{Data, LoadForm};
use fem::contact::{BoundaryRule, Path, Paths, by_grid};
use vhi::history::TimeGrid;

/// The code paths of a run of `setup` on a mesh and grid.
pub(super) fn of_scene(setup: &Setup, data: &MeshData, grid: &TimeGrid) -> Paths {
    let mut paths = Paths::default();
    let in_plane = setup.scene.dimension == 2;
    // Without memory and ζ no time rule is used.
    if !setup.model.memory.is_empty() || setup.model.projection.is_some() {
        paths.insert(by_grid(grid.is_uniform(), setup.scene.time.rule.paths()));
    }
    paths.insert(match &setup.body.data {
        Data::Exact { interpolated: true, .. } => Path::InterpolatedTruth,
        Data::Exact { form: LoadForm::Weak, .. } if in_plane => Path::WeakInPlane,
        Data::Exact { form: LoadForm::Weak, .. } => Path::WeakInSpace,
        Data::Exact { form: LoadForm::Strong, .. } if in_plane => Path::StrongInPlane,
        Data::Exact { form: LoadForm::Strong, .. } => Path::StrongInSpace,
        Data::Loads { .. } if data.truth.load_basis().is_some() => Path::LoadInParts,
        Data::Loads { .. } => Path::LoadApart,
    });
    if let Some(boundary) = setup.model.boundary.as_ref().filter(|b| !b.potential.is_absent()) {
        let pair = match boundary.rule {
            BoundaryRule::Vertex => [Path::AtVertices, Path::AtVerticesScaled],
            BoundaryRule::Gauss => [Path::AtGaussPoints, Path::AtGaussPointsScaled],
            BoundaryRule::Exact => [Path::Exactly, Path::ExactlyScaled],
        };
        paths.insert(pair[usize::from(boundary.scale.is_some())]);
    }
    paths
}
