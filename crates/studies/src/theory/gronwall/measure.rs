//! e_n and g_n of a run: the error against a truth on the same mesh, and the truncation error of the
//! rule on the truth, g_n = ‖S_n u - S_n^k u‖_Y = |ζ part| + ‖memory part‖_ℋ.

use super::GronwallError;
use super::constants::GronwallConstants;
use super::estimate::Estimate;
use super::rule::Weights;
use super::truth::{TemporalTruth, TruthAtLevel};
use crate::theory::norms::{remembered, stress_norm};
use fem::contact::{Discretization, Model, march, strain_distance, strain_norm};
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::history::{Accumulated, Memory, TimeGrid};

impl Estimate {
    /// Runs `model`, which a test may have changed, under the loads of `setup`, and compares it with
    /// the truth of `setup`. Truncation errors and constants are those of `setup`.
    ///
    /// # Errors
    /// The run or the truth fails.
    pub fn measure(
        setup: &Setup,
        model: &Model,
        data: &MeshData,
        truth: &TemporalTruth,
        constants: &GronwallConstants,
        steps: u32,
    ) -> Result<Self, GronwallError> {
        let grid = setup.grid(steps);
        let levels = truth.levels(setup, steps)?;
        let mut error = Vec::with_capacity(levels.len());
        let info = march(
            &data.space,
            model,
            &grid,
            &mut TruthLoad(&*data.truth),
            &Newton::default(),
            &mut |view| {
                error.push(strain_distance(&data.space, view.u, &levels[view.n].u));
                Ok(())
            },
        )
        .map_err(|source| GronwallError::Case { steps, source })?;
        let size = levels.iter().map(|level| strain_norm(&data.space, &level.u));
        let floor = info.floors.v + truth.accuracy() * size.fold(0.0, f64::max);
        let truncation_zeta = match constants.has_zeta() {
            true => truncation_of_zeta(&data.space, constants.weights, &grid, &levels),
            false => vec![0.0; levels.len()],
        };
        let truncation_memory =
            truncation_of_memory(setup, &data.space, constants.weights, &grid, &levels);
        let both = truncation_zeta.iter().zip(&truncation_memory);
        Ok(Self {
            error,
            weighted_source: both.clone().map(|(z, b)| constants.yielding * z + b).collect(),
            source: both.map(|(z, b)| constants.beta * (z + b)).collect(),
            floor,
            truncation: [truncation_zeta, truncation_memory],
            ..constants.blank(setup, &grid)
        })
    }
}

fn truncation_of_zeta(
    space: &Discretization,
    weights: Weights,
    grid: &TimeGrid,
    levels: &[TruthAtLevel],
) -> Vec<f64> {
    let (mut accumulated, rule) = (Accumulated::default(), weights.rule());
    let defect = |level: &TruthAtLevel| {
        accumulated.commit(grid, strain_norm(space, &level.u));
        (level.zeta - accumulated.value(&*rule, grid)).abs()
    };
    levels.iter().map(defect).collect()
}

fn truncation_of_memory(
    setup: &Setup,
    space: &Discretization,
    weights: Weights,
    grid: &TimeGrid,
    levels: &[TruthAtLevel],
) -> Vec<f64> {
    let terms = &setup.model.memory;
    if terms.is_empty() {
        return vec![0.0; levels.len()];
    }
    let (rule, length) = (weights.rule(), space.nodes.len());
    let mut histories: Vec<Memory> =
        terms.iter().map(|term| Memory::new(&*term.kernel, &*rule, grid, length)).collect();
    let defect = |(n, level): (usize, &TruthAtLevel)| {
        let mut missed = remembered(terms, &mut histories, &*rule, (grid, n), &level.u);
        for (missed, exact) in missed.iter_mut().zip(&level.memory) {
            missed.iter_mut().zip(exact).for_each(|(sum, exact)| *sum = exact - *sum);
        }
        stress_norm(space, terms, &missed)
    };
    levels.iter().enumerate().map(defect).collect()
}
