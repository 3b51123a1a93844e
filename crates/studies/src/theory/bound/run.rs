//! The step-size study of any run: factors at all its levels, and the ladder at the worst of them.

use super::branch::{self, Branch};
use super::ladder::{BoundError, StepLadder, StepRung};
use super::linear::LinearLoss;
use super::{factor, starts};
use files::digits;
use vhi::history::TimeGrid;
use vhi::{FailedStep, FrozenDerivative, StepBounds, StepState};

/// The factor of Λ at a level of the run, with the step size of the run.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct FactorAtLevel {
    /// Cells per unit length; none without a mesh.
    pub mesh: Option<u32>,
    /// n.
    pub level: usize,
    /// t_n.
    pub t: f64,
    /// The step size there.
    pub k: f64,
    /// ‖DΛ‖.
    pub norm: f64,
    /// Spectral radius of DΛ.
    pub radius: f64,
    /// The sharpened bound.
    pub sharpened: f64,
}

/// What the study found.
#[derive(Debug, Clone, Default, serde::Serialize)]
pub struct ContractionStudy {
    /// Every level of the run.
    pub levels: Vec<FactorAtLevel>,
    /// The level of the ladder: the one with the largest factor.
    pub worst: FactorAtLevel,
    /// That level on this and other meshes; empty without a mesh.
    pub meshes: Vec<FactorAtLevel>,
    /// Uniqueness at the step size of the run, by many starts.
    pub starts: starts::Starts,
    /// The ladder.
    pub rungs: Vec<StepRung>,
    /// Where factors reach one and solvability ends.
    #[serde(skip)]
    pub thresholds: Branch,
    /// Why there are neither rungs nor thresholds, where there are none.
    #[serde(skip)]
    pub not_followed: Option<String>,
    /// Linear scenes: the exact loss.
    #[serde(skip)]
    pub linear: Option<LinearLoss>,
}

/// Rungs of a ladder, and how far it goes beyond the largest finite threshold that is known.
const RUNGS: u32 = 17;
const REACH: f64 = 4.0;
/// The share of the sharpened bound at which the solution begins to be followed.
const SURE: f64 = 0.9;
/// Random starts at the step size of the run.
const MANY_STARTS: u64 = 24;
/// Factors are solved for to 1e-10 of themselves or better: of levels that agree to ten times that the last one is taken,
/// so that rounding does not choose.
const EQUAL: f64 = 1e-9;

impl ContractionStudy {
    /// The factors of a run, before its level with the largest one is looked at.
    ///
    /// # Errors
    /// [`BoundError::NoLevel`] if there is none.
    pub(crate) fn of_levels(levels: Vec<FactorAtLevel>, steps: u32) -> Result<Self, BoundError> {
        let worse = |best: FactorAtLevel, next: &FactorAtLevel| {
            if next.norm >= best.norm * (1.0 - EQUAL) { *next } else { best }
        };
        let first = levels.last().copied().ok_or(BoundError::NoLevel { steps })?;
        let worst = levels.iter().fold(first, worse);
        Ok(Self { worst, levels, ..Self::default() })
    }

    /// Starts, thresholds and ladder at the open `level` whose solution is `state`; neither thresholds nor rungs where
    /// m0 ≤ 0, with the reason.
    ///
    /// # Errors
    /// [`BoundError`].
    pub(crate) fn climb<L: FrozenDerivative>(
        &mut self,
        level: &mut L,
        state: StepState,
        bounds: &StepBounds,
    ) -> Result<(), BoundError> {
        self.starts = starts::random_starts(level, &state, MANY_STARTS);
        if bounds.m0.is_nan() || bounds.m0 <= 0.0 {
            self.not_followed = Some(no_ladder(bounds.m0));
            return Ok(());
        }
        let ks = step_sizes(bounds, self.linear.map_or(f64::INFINITY, |loss| loss.mesh));
        // Below the sharpened bound all factors are below one and the solution is unique.
        let sharpened = bounds.sharpened_limit();
        let from = if sharpened.is_finite() { SURE * sharpened } else { ks[0] };
        self.thresholds = branch::follow(level, &state, from, ks[ks.len() - 1])?;
        let mut ladder = StepLadder::new(level, *bounds, state);
        self.rungs = ks.iter().map(|&k| ladder.rung(k)).collect::<Result<_, _>>()?;
        Ok(())
    }
}

/// A ladder begins below (3.4), and no k is below it.
fn no_ladder(m0: f64) -> String {
    format!(
        "the least m0 = {} is not positive, (2.9) is violated or unknown: no k is known to have one solution, from which it could be followed",
        digits(m0, 7)
    )
}

/// A geometric ladder from a quarter of (3.4) to beyond all thresholds that are known beforehand,
/// `exact` among them.
fn step_sizes(bounds: &StepBounds, exact: f64) -> Vec<f64> {
    let known = [bounds.limit(), bounds.sharpened_limit(), bounds.solvable_limit(), exact];
    let finite = known.into_iter().filter(|k| k.is_finite());
    let (low, high) = (0.25 * bounds.paper_limit(), REACH * finite.fold(0.0, f64::max));
    let share = |i: u32| f64::from(i) / f64::from(RUNGS - 1);
    (0..RUNGS).map(|i| low * (high / low).powf(share(i))).collect()
}

/// The factor at every level n ≥ 1 of a run that has not begun.
///
/// # Errors
/// The run's, or a factor that is not found.
pub(crate) fn all_levels<L: FrozenDerivative<Error: Into<BoundError>>>(
    level: &mut L,
    bounds: &StepBounds,
    mesh: Option<u32>,
) -> Result<Vec<FactorAtLevel>, BoundError> {
    let grid: TimeGrid = level.grid().clone();
    let mut found = Vec::new();
    run_seen(level, grid.steps(), |level, number, state| {
        if number == 0 {
            return Ok(());
        }
        let (k, t) = (grid.step(number), grid.time(number));
        let contraction = factor::contraction(level, &state.u, state)
            .map_err(|source| BoundError::Factor { k, source })?;
        found.push(FactorAtLevel {
            mesh,
            level: number,
            t,
            k,
            norm: contraction.norm,
            radius: contraction.radius,
            sharpened: bounds.sharpened_factor(k),
        });
        // Once more with the last slot implicit, which commit records.
        solve(level, state, number)
    })?;
    Ok(found)
}

/// Runs to level `number`, leaves it open, and returns its solution.
///
/// # Errors
/// The run's.
pub(crate) fn run_to<L: FrozenDerivative<Error: Into<BoundError>>>(
    level: &mut L,
    number: usize,
) -> Result<StepState, BoundError> {
    run_seen(level, number, |_, _, _| Ok(()))
}

/// Runs to level `last`, which stays open; `see` gets each level with its number and its solution.
fn run_seen<L: FrozenDerivative<Error: Into<BoundError>>>(
    level: &mut L,
    last: usize,
    mut see: impl FnMut(&mut L, usize, &mut StepState) -> Result<(), BoundError>,
) -> Result<StepState, BoundError> {
    let graphs = level.graph().coordinates.len();
    let mut state = StepState { u: vec![0.0; level.dofs()], pressure: vec![0.0; graphs] };
    for number in 0..=last {
        if number > 0 {
            level.commit(&state);
        }
        level.open().map_err(Into::into)?;
        solve(level, &mut state, number)?;
        see(level, number, &mut state)?;
    }
    Ok(state)
}

fn solve<L: FrozenDerivative>(
    level: &mut L,
    state: &mut StepState,
    n: usize,
) -> Result<(), BoundError> {
    let t = level.grid().time(n);
    factor::solve(level, None, state).map_err(|source| FailedStep { n, t, source })?;
    Ok(())
}
