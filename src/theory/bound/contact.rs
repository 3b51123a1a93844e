//! The step-size study of a contact scene: a run to its worst level, and the ladder there.

use super::branch::Branch;
use super::ladder::{BoundError, Ladder, Rung};
use super::linear::{LinearLoss, linear_loss};
use super::{branch, factor, starts};
use crate::contact::{Evolution, OpenLevel};
use crate::law::VonMises;
use crate::setup::{MeshData, Setup, TruthLoad, YieldFormula};
use crate::vhi::{
    FailedStep, FrozenDerivative, HistoryInequality, Newton, Scratch, StepBounds, StepInequality,
    StepState,
};

/// An open level of a scene's run.
pub type SceneLevel<'a> = OpenLevel<'a, Option<VonMises<YieldFormula>>>;

/// The factor of Λ at a level of the run, with the run's own step size.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct AtLevel {
    /// Cells a unit length.
    pub mesh: u32,
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
#[derive(Debug, Clone)]
pub struct Study {
    /// Every level of the run.
    pub levels: Vec<AtLevel>,
    /// The level of the ladder: the one with the largest factor.
    pub worst: AtLevel,
    /// The same level on other meshes.
    pub meshes: Vec<AtLevel>,
    /// Uniqueness at the run's own step size, by many starts.
    pub starts: starts::Starts,
    /// The ladder.
    pub rungs: Vec<Rung>,
    /// Where factors reach one and solvability ends.
    pub thresholds: Branch,
    /// Linear scenes: the exact loss.
    pub linear: Option<LinearLoss>,
}

/// Rungs of a ladder, and how far it goes beyond the largest finite threshold that is known.
const RUNGS: u32 = 17;
const REACH: f64 = 4.0;
/// The share of the sharpened bound at which the solution begins to be followed.
const SURE: f64 = 0.9;
/// Random starts at the run's own step size.
const MANY_STARTS: u64 = 24;

/// Runs the scene on the mesh `n` with `steps` steps and studies its worst level.
///
/// # Errors
/// [`BoundError`].
pub fn study(setup: &Setup, bounds: &StepBounds, n: u32, steps: u32) -> Result<Study, BoundError> {
    let levels = levels_of_run(setup, bounds, n, steps)?;
    let worse = |best: AtLevel, next: &AtLevel| if next.norm > best.norm { *next } else { best };
    let Some(first) = levels.last().copied() else {
        return Err(BoundError::NoLevel { steps });
    };
    let worst = levels.iter().fold(first, worse);
    let mut meshes = Vec::new();
    for other in [n / 2, n, 2 * n] {
        if other > 0 && setup.scene.check_cells(other).is_ok() {
            let all = levels_of_run(setup, bounds, other, steps)?;
            meshes.extend(all.get(worst.level - 1));
        }
    }
    let data = MeshData::new(setup, n, None)?;
    let linear = linear_loss(&data.space, &setup.model)?;
    let ks = step_sizes(bounds, linear);
    let (starts, rungs, thresholds) =
        at_level(setup, &data, steps, worst.level, |level, state| {
            let starts = starts::random_starts(level, &state, MANY_STARTS);
            // Below the sharpened bound all factors are below one and the solution is unique.
            let from = if bounds.sharpened_limit().is_finite() {
                SURE * bounds.sharpened_limit()
            } else {
                ks[0]
            };
            let thresholds = branch::follow(level, &state, from, ks[ks.len() - 1])?;
            let mut ladder = Ladder::new(level, *bounds, state);
            let rungs = ks.iter().map(|&k| ladder.rung(k)).collect::<Result<_, _>>()?;
            Ok((starts, rungs, thresholds))
        })?;
    Ok(Study { levels, worst, meshes, starts, rungs, thresholds, linear })
}

/// A geometric ladder from a quarter of (3.4) to beyond all thresholds that are known beforehand.
fn step_sizes(bounds: &StepBounds, linear: Option<LinearLoss>) -> Vec<f64> {
    let exact = linear.map_or(f64::INFINITY, |loss| loss.mesh);
    let known = [bounds.limit(), bounds.sharpened_limit(), bounds.solvable_limit(), exact];
    let finite = known.into_iter().filter(|k| k.is_finite());
    let (low, high) = (0.25 * bounds.paper_limit(), REACH * finite.fold(0.0, f64::max));
    let share = |i: u32| f64::from(i) / f64::from(RUNGS - 1);
    (0..RUNGS).map(|i| low * (high / low).powf(share(i))).collect()
}

/// The factor at every level n ≥ 1 of a run.
fn levels_of_run(
    setup: &Setup,
    bounds: &StepBounds,
    n: u32,
    steps: u32,
) -> Result<Vec<AtLevel>, BoundError> {
    let data = MeshData::new(setup, n, None)?;
    let grid = setup.grid(steps);
    let mut load = TruthLoad(&*data.truth);
    let evolution = Evolution::new(&data.space, &setup.model, &grid, &mut load);
    let mut level = OpenLevel::new(&data.space, &setup.model, evolution)
        .map_err(|source| BoundError::Constant(source.into()))?;
    let mut state = rest(&level);
    let mut found = Vec::new();
    for number in 0..=grid.steps() {
        let t = grid.time(number);
        level.open()?;
        solve(&mut level, &mut state, number, t)?;
        if number > 0 {
            let k = grid.step(number);
            let eta = state.u.clone();
            let contraction = factor::contraction(&mut level, &eta, &state)
                .map_err(|source| BoundError::Factor { k, source })?;
            // The level is solved once more with its last slot implicit, which commit records.
            solve(&mut level, &mut state, number, t)?;
            found.push(AtLevel {
                mesh: n,
                level: number,
                t,
                k,
                norm: contraction.norm,
                radius: contraction.radius,
                sharpened: bounds.sharpened_factor(k),
            });
        }
        level.commit(&state);
    }
    Ok(found)
}

/// Runs to level `number`, leaves it open, and shows it with its solution.
///
/// # Errors
/// The run's, and those of `see`.
pub fn at_level<T>(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    number: usize,
    see: impl FnOnce(&mut SceneLevel<'_>, StepState) -> Result<T, BoundError>,
) -> Result<T, BoundError> {
    let grid = setup.grid(steps);
    let mut load = TruthLoad(&*data.truth);
    let evolution = Evolution::new(&data.space, &setup.model, &grid, &mut load);
    let mut level = OpenLevel::new(&data.space, &setup.model, evolution)
        .map_err(|source| BoundError::Constant(source.into()))?;
    let mut state = rest(&level);
    for before in 0..=number {
        level.open()?;
        solve(&mut level, &mut state, before, grid.time(before))?;
        if before < number {
            level.commit(&state);
        }
    }
    see(&mut level, state)
}

fn rest<L: StepInequality>(level: &L) -> StepState {
    let graphs = level.graph().coordinates.len();
    StepState { u: vec![0.0; level.dofs()], pressure: vec![0.0; graphs] }
}

fn solve<L: FrozenDerivative>(
    level: &mut L,
    state: &mut StepState,
    n: usize,
    t: f64,
) -> Result<(), BoundError>
where
    BoundError: From<FailedStep>,
{
    level.freeze(None);
    Newton::default()
        .solve(level, state, &mut Scratch::default())
        .map_err(|source| FailedStep { n, t, source })?;
    Ok(())
}
