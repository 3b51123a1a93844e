//! A solver in this process as a [`Scheme`]: it takes a case as arrays and returns displacements of all levels.

use super::{Given, show};
use fem::contact::{CaseError, CaseInfo, Observer};
use scene::setup::{MeshData, Scheme, Setup};

/// What a solver gives back.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// (N + 1) × vertices × d, the last axis fastest.
    pub displacement: Vec<f64>,
    /// ξ + λ, (N + 1) × rows of Γ3, if given.
    pub pressure: Option<Vec<f64>>,
}

/// A solver of one case, by whatever means.
pub trait Solve: Send + Sync {
    /// Solves a case.
    ///
    /// # Errors
    /// The reason, recorded with the failed case.
    fn solve(&self, given: &Given, data: &MeshData) -> Result<Answer, String>;
}

/// Adapts a solver; it is measured and judged like an external one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InProcess<S>(pub S);

impl<S: Solve> Scheme for InProcess<S> {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        let (space, grid) = (&*data.space, setup.grid(steps));
        let given = Given::new(setup, data, steps)?;
        let solved = data.comparing_beside(setup, || self.0.solve(&given, data));
        let solved = solved.map_err(CaseError::Outside)?;
        let (levels, points) = (grid.steps() + 1, space.trace.points.len());
        let Answer { displacement, pressure } = solved;
        let lengths = [displacement.len(), pressure.as_ref().map_or(levels * points, Vec::len)];
        let numbers = space.mesh.vertices() * space.mesh.dimension;
        let wanted = [levels * numbers, levels * points];
        if lengths != wanted {
            let message =
                format!("{lengths:?} displacements and pressures, but {wanted:?} are expected");
            return Err(CaseError::Outside(message));
        }
        show(space, &setup.model, &grid, (&displacement, pressure), observe)
    }
}
