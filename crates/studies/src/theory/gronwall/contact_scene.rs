//! A body in contact on one mesh as a scene in time. e_n is the error against a truth on the same mesh, g_n the truncation
//! error of the rule on the truth, ‖S_n u - S_n^k u‖_Y = |ζ part| + ‖memory part‖_ℋ.

use super::GronwallError;
use super::constants::{GronwallConstants, InequalityConstants};
use super::estimate::Estimate;
use super::in_time::{InTime, Levels};
use super::truth::{TemporalTruth, TruthAtLevel};
use crate::theory::norms::{DualNorm, remembered, stress_norm};
use fem::contact::{Load, LoadError, Model, march, strain_distance, strain_norm};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::history::{Accumulated, Memory, TimeGrid};

/// A body on one mesh with its truth in time.
pub struct ContactInTime<'a> {
    setup: &'a Setup,
    data: MeshData,
    /// The truth.
    pub truth: TemporalTruth,
    /// The constants; a test may spoil them.
    pub constants: GronwallConstants,
}

impl<'a> ContactInTime<'a> {
    /// The scene on the mesh n, for grids with these numbers of steps.
    ///
    /// # Errors
    /// Constants, loads or a reference run that cannot be had.
    pub fn new(setup: &'a Setup, n: u32, steps: &[u32]) -> Result<Self, GronwallError> {
        let constants = GronwallConstants::new(setup)?;
        let data = MeshData::new(setup, n, None)?;
        let truth = TemporalTruth::new(setup, &data, steps)?;
        Ok(Self { setup, data, truth, constants })
    }

    /// Runs `model`, which a test may have changed, under the loads of the scene, and compares it with
    /// its truth. Truncation errors and constants are those of the scene.
    ///
    /// # Errors
    /// The run or the truth fails.
    pub fn measure_model(&self, model: &Model, steps: u32) -> Result<Estimate, GronwallError> {
        let Self { setup, data: MeshData { space, truth: source, .. }, truth, constants } = self;
        let grid = setup.grid(steps);
        let levels = truth.levels(setup, steps)?;
        let mut error = Vec::with_capacity(levels.len());
        let mut load = TruthLoad(&**source);
        let info = march(space, model, &grid, &mut load, &Newton::default(), &mut |view| {
            error.push(strain_distance(space, view.u, &levels[view.n].u));
            Ok(())
        })
        .map_err(|source| GronwallError::Case { steps, source })?;
        let size = levels.iter().map(|level| strain_norm(space, &level.u));
        let [zeta, memory] =
            [self.truncation_of_zeta(&grid, &levels), self.truncation_of_memory(&grid, &levels)];
        let both = zeta.iter().zip(&memory);
        Ok(Estimate {
            error,
            weighted_source: both.clone().map(|(z, b)| constants.yielding * z + b).collect(),
            source: both.map(|(z, b)| constants.beta * (z + b)).collect(),
            floor: info.floors.v + truth.accuracy() * size.fold(0.0, f64::max),
            truncation: [zeta, memory],
            ..self.blank(&grid)
        })
    }

    fn truncation_of_zeta(&self, grid: &TimeGrid, levels: &[TruthAtLevel]) -> Vec<f64> {
        if !self.constants.has_zeta() {
            return vec![0.0; levels.len()];
        }
        let (mut accumulated, rule) = (Accumulated::default(), self.constants.weights.rule());
        let defect = |level: &TruthAtLevel| {
            accumulated.commit(grid, strain_norm(&self.data.space, &level.u));
            (level.zeta - accumulated.value(&*rule, grid)).abs()
        };
        levels.iter().map(defect).collect()
    }

    fn truncation_of_memory(&self, grid: &TimeGrid, levels: &[TruthAtLevel]) -> Vec<f64> {
        let (terms, space) = (&self.setup.model.memory, &self.data.space);
        if terms.is_empty() {
            return vec![0.0; levels.len()];
        }
        let (rule, length) = (self.constants.weights.rule(), space.nodes.len());
        let empty = terms.iter().map(|term| Memory::new(&*term.kernel, &*rule, grid, length));
        let mut histories: Vec<Memory> = empty.collect();
        let defect = |(n, level): (usize, &TruthAtLevel)| {
            let mut missed = remembered(terms, &mut histories, &*rule, (grid, n), &level.u);
            for (missed, exact) in missed.iter_mut().zip(&level.memory) {
                missed.iter_mut().zip(exact).for_each(|(sum, exact)| *sum = exact - *sum);
            }
            stress_norm(space, terms, &missed)
        };
        levels.iter().enumerate().map(defect).collect()
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
        self.measure_model(&self.setup.model, steps)
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
