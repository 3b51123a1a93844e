//! A body in contact on one mesh as a scene in time.

use super::GronwallError;
use super::constants::{GronwallConstants, InequalityConstants};
use super::estimate::Estimate;
use super::in_time::{InTime, Levels};
use super::truth::TemporalTruth;
use crate::theory::norms::DualNorm;
use fem::contact::{Load, LoadError, march, strain_distance};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::history::TimeGrid;

/// A body on one mesh with its truth in time.
pub(crate) struct ContactInTime<'a> {
    setup: &'a Setup,
    data: MeshData,
    truth: TemporalTruth,
    /// The constants; a test may spoil them.
    pub constants: GronwallConstants,
}

impl<'a> ContactInTime<'a> {
    /// The scene on the mesh n, for grids with these numbers of steps.
    ///
    /// # Errors
    /// Constants, loads or a reference run that cannot be had.
    pub(crate) fn new(setup: &'a Setup, n: u32, steps: &[u32]) -> Result<Self, GronwallError> {
        let constants = GronwallConstants::new(setup)?;
        let data = MeshData::new(setup, n, None)?;
        let truth = TemporalTruth::new(setup, &data, steps)?;
        Ok(Self { setup, data, truth, constants })
    }
}

impl InTime for ContactInTime<'_> {
    fn constants(&self) -> InequalityConstants {
        self.constants.summary()
    }

    fn truth(&self) -> String {
        self.truth.label()
    }

    fn grid(&self, steps: u32) -> TimeGrid {
        self.setup.grid(steps)
    }

    fn measure(&self, steps: u32) -> Result<Estimate, GronwallError> {
        let Self { setup, data, truth, constants } = self;
        Estimate::measure(setup, &setup.model, data, truth, constants, steps)
    }

    fn loads(&self, grid: &TimeGrid) -> Result<Vec<Vec<f64>>, GronwallError> {
        let mut source = TruthLoad(&*self.data.truth);
        let one = |t: &f64| {
            let mut load = vec![0.0; self.data.space.dofs()];
            source.assemble(*t, &mut load)?;
            Ok(load)
        };
        grid.times().iter().map(one).collect()
    }

    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>, GronwallError> {
        let mut norm = DualNorm::new(&self.data.space)?;
        Ok(loads.iter().map(|load| norm.of(load)).collect())
    }

    fn solutions(
        &self,
        grid: &TimeGrid,
        loads: &[Vec<f64>],
    ) -> Result<(Vec<Vec<f64>>, f64), GronwallError> {
        let mut found = Vec::new();
        let (space, model) = (&self.data.space, &self.setup.model);
        let mut load = Levels { grid, loads };
        let info = march(space, model, grid, &mut load, &Newton::default(), &mut |view| {
            found.push(view.u.to_vec());
            Ok(())
        })
        .map_err(|source| GronwallError::Case { steps: grid.steps() as u32, source })?;
        Ok((found, info.floors.v))
    }

    fn distance(&self, u: &[f64], v: &[f64]) -> f64 {
        strain_distance(&self.data.space, u, v)
    }

    fn blank(&self, grid: &TimeGrid) -> Estimate {
        self.constants.blank(self.setup, grid)
    }
}

impl Load for Levels<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        let reason = || LoadError::Reference { reason: format!("no load is given at t = {t}") };
        out.copy_from_slice(self.load(t).ok_or_else(reason)?);
        Ok(())
    }
}
