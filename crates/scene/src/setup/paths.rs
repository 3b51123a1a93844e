//! Code paths that a scene takes: its loads, its rule on Γ3.

use super::{MeshData, Setup};
use crate::{Data, LoadForm};
use fem::contact::{BoundaryRule, CaseInfo, Path, Paths};

/// The code paths of a run of `setup` on a mesh.
pub(super) fn of_scene(setup: &Setup, data: &MeshData) -> Paths {
    let mut paths = Paths::default();
    let in_plane = setup.scene.dimension == 2;
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

impl Setup {
    /// The paths that a run with so many steps took, in words, and its time rule if it has a history.
    pub fn paths_in_words(&self, steps: u32, info: &CaseInfo) -> Vec<String> {
        let mut words: Vec<String> = info.paths.iter().map(|path| path.name().into()).collect();
        if !self.model.memory.is_empty() || self.model.projection.is_some() {
            let steps = if self.grid(steps).is_uniform() { "equal" } else { "unequal" };
            words.push(format!("{}, {steps} steps", self.scene.time.rule.name()));
        }
        words
    }
}
