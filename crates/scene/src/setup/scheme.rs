//! The solver under test: marches a scene through the levels of a time grid.

use super::{MeshData, Setup};
use crate::{Scene, SceneError};
use fem::contact::{CaseError, CaseInfo, Observer};
use vhi::Newton;

/// A solver of Problem 14 on a given mesh and time grid. A sweep measures and judges what it shows.
pub trait Scheme: Send + Sync {
    /// Refuses scenes with an unsupported term; by default none.
    ///
    /// # Errors
    /// At the key of the term.
    fn takes(&self, _scene: &Scene) -> Result<(), SceneError> {
        Ok(())
    }

    /// Solves the scene with `steps` steps on its time grid and shows every level, n = 0 first, to `observe`.
    ///
    /// # Errors
    /// A level that has no solution or was not found; errors of `observe` are passed on.
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError>;
}

/// P1 elements, the time rule of the scene, semismooth Newton: [`fem::contact::march`].
#[derive(Debug, Clone, Copy, Default)]
pub struct NewtonMarch;

impl Scheme for NewtonMarch {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        data.march(setup, steps, &Newton::default(), observe)
    }
}
