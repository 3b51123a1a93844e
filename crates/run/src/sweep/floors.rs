//! Measured floors: the change of an error when something other than the discretisation is improved. The solver goes on
//! to 1/100 of its tolerance, the recursion is replaced by the direct sum, loads and errors use the next rule, the
//! reference is changed.

use std::sync::Arc;

use nalgebra::DVector;

use super::case::{
    ERROR_RULE, as_floors, floor_in, reference_share, scene_reference, time_reference_floor,
};
use super::cost::Cost;
use super::plan::CasePlan;
use fem::contact::{CaseError, CaseInfo, Floors, LevelFields, LoadError, strain_distance};
use fem::norms::step_errors;
use fem::space::quadrature::TruthRules;
use leading_error::TIME_REFERENCE;
use scene::setup::{AbstractLoad, AbstractSetup, MeshData, Setup, SetupError, reference_run};
use scene::{Norm, Reference};
use serde::Serialize;
use vhi::finite::{FiniteError, march};
use vhi::{Newton, Polished, StepSolver};

/// The source of a floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FloorPart {
    /// The accepted residual of the solver.
    Solver,
    /// The recursion of the history against the direct sum.
    History,
    #[serde(rename = "load quadrature")]
    Load,
    #[serde(rename = "error quadrature")]
    Error,
    Reference,
}

/// One part of the floor of one norm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FloorRow {
    pub norm: Norm,
    pub part: FloorPart,
    /// The error of the case in this norm.
    pub error: f64,
    pub measured: f64,
    /// The estimate in the case's floor for this part, including rounding. Solver and history share one, and so do the
    /// two quadratures.
    pub estimated: f64,
}

/// Norms whose floors are distances of two discrete solutions or of two errors: those of levels that have a truth at
/// every time.
pub const NORMS: [Norm; 5] =
    [Norm::VMax, Norm::L2Max, Norm::TraceL2Max, Norm::PressureL2Max, Norm::StressL2Max];

/// The scene with the direct sum in place of a recursion; None without a recursion.
pub fn direct_history(setup: Setup) -> Option<Setup> {
    let trapezoidal = setup.model.time_rule.is_trapezoidal();
    let recursive = setup.model.memory.iter().any(|term| term.kernel.exponentials().is_some());
    (trapezoidal && recursive).then(|| setup.with_history(None))
}

/// Every part of the floor of the case (n, steps) of `setup`; `direct` is the scene of [`direct_history`], `norms`
/// those of the sweep. Costs four to six marches, more if a reference has to be repeated.
///
/// # Errors
/// A run that fails.
pub fn contact_floors(
    setup: &Setup,
    direct: Option<&Setup>,
    n: u32,
    steps: u32,
    norms: &[Norm],
) -> Result<Vec<FloorRow>, SetupError> {
    let reference = scene_reference(setup);
    let run = |reference: Reference| {
        let every = (reference.steps / steps).max(1);
        reference_run(setup, reference.n, reference.steps, every).map(Arc::new)
    };
    let truth = reference.map(run).transpose()?;
    let data = MeshData::new(setup, n, truth.clone())?;
    let stronger = MeshData::with_rules(
        setup,
        n,
        truth,
        &TruthRules::stronger_for(setup.body.element, setup.scene.dimension),
    )?;
    let measured = measure_errors(setup, &data, &stronger, steps)?;
    let polished = levels(setup, &data, steps)?;
    let apart = |other: &[LevelFields]| distance(&data, &polished, other);
    let solver = measured.info.floors;
    // Rounding of the compared marches is in every part.
    let load = data.rule_check(setup).map_err(CaseError::from)?.floors.plus(solver);
    let quadrature = load.plus(measured.at_times.times(ERROR_RULE));
    let reloaded = measure_errors(setup, &stronger, &data, steps)?;
    let mut parts = vec![
        (FloorPart::Solver, apart(&measured.levels), solver),
        (FloorPart::Load, reloaded.by_other.minus(measured.errors), quadrature),
        (FloorPart::Error, measured.moved, quadrature),
    ];
    if let Some(direct) = direct {
        parts.insert(1, (FloorPart::History, apart(&levels(direct, &data, steps)?), solver));
    }
    if setup.body.data.is_interpolated() {
        // Nothing is integrated: the fields are in V^h.
        parts.retain(|(part, ..)| !matches!(part, FloorPart::Load | FloorPart::Error));
    }
    // A reference of half the cells and steps, if still finer than the case.
    let finer = |half: u32, whole: u32, of_case: u32| {
        2 * half == whole && half.is_multiple_of(of_case) && half > of_case
    };
    let halved = reference.and_then(|whole| {
        let half = Reference { n: whole.n / 2, steps: whole.steps / 2 };
        let serves = finer(half.n, whole.n, n) && finer(half.steps, whole.steps, steps);
        serves.then_some(half)
    });
    if let Some(half) = halved {
        let coarser = MeshData::new(setup, n, Some(run(half)?))?;
        let errors = measure_errors(setup, &coarser, &coarser, steps)?.errors;
        let share = reference_share(half, n, steps);
        parts.push((FloorPart::Reference, errors.minus(measured.errors), errors.times(share)));
    }
    let mut rows: Vec<FloorRow> = parts
        .iter()
        .flat_map(|(part, measured_floors, estimated)| {
            let kept = NORMS.into_iter().filter(|norm| norms.contains(norm));
            kept.map(|norm| FloorRow {
                norm,
                part: *part,
                error: floor_in(&measured.errors, norm),
                measured: floor_in(measured_floors, norm),
                estimated: floor_in(estimated, norm),
            })
        })
        .collect();
    if norms.contains(&Norm::VTimeMax) {
        // The run with 8N steps against one with 16N, which misses a quarter of its error.
        let run = |factor: u32| data.trajectory(setup, factor * steps, steps);
        let (finer, finest) = (run(TIME_REFERENCE)?, run(2 * TIME_REFERENCE)?);
        let apart = |(a, b): (&Vec<f64>, &Vec<f64>)| strain_distance(&data.space, a, b);
        let levels = measured.levels.iter().map(|level| &level.u);
        let error = levels.zip(&finer.displacements).map(apart).fold(0.0, f64::max);
        let pairs = finer.displacements.iter().zip(&finest.displacements);
        let measured = pairs.map(apart).fold(0.0, f64::max);
        let (part, estimated) = (FloorPart::Reference, time_reference_floor(error));
        rows.push(FloorRow { norm: Norm::VTimeMax, part, error, measured, estimated });
    }
    Ok(rows)
}

/// Bytes held beside the largest of these cases in [`contact_floors`]: the exact solution by stronger rules, of about
/// twice the points, and its check by yet stronger ones, u and σ at the levels of three marches, and the whole past of
/// one. There are about as many cells as unknowns in the plane, twice as many in space.
pub fn floors_beside(dimension: usize, cases: &[(&CasePlan, &Cost)]) -> f64 {
    let stresses = if dimension == 2 { 3.0 } else { 12.0 };
    let of = |&(case, cost): &(&CasePlan, &Cost)| {
        let vector = 8.0 * cost.dofs as f64 * (f64::from(case.steps) + 1.0);
        2.0 * cost.kept_bytes + 3.0 * (1.0 + stresses) * vector + vector
    };
    cases.iter().map(of).fold(0.0, f64::max)
}

/// Errors of the scheme by the rules of `data` and by those of `stronger`.
struct Measured {
    levels: Vec<LevelFields>,
    /// Largest errors, by the rule of each.
    errors: Floors,
    by_other: Floors,
    /// Largest difference of the two, over all levels and over those that a sweep compares.
    moved: Floors,
    at_times: Floors,
    info: CaseInfo,
}

fn measure_errors(
    setup: &Setup,
    data: &MeshData,
    stronger: &MeshData,
    steps: u32,
) -> Result<Measured, CaseError> {
    let mut levels = Vec::new();
    let [mut errors, mut by_other, mut moved, mut at_times] = [Floors::default(); 4];
    let info = setup.scheme.march(setup, data, steps, &mut |view| {
        let by = |data: &MeshData| -> Result<Floors, LoadError> {
            let moments = data.truth.moments(view.t)?;
            Ok(as_floors(&step_errors(&data.space, &setup.model, view, &moments)))
        };
        let (by_rule, by_stronger) = (by(data)?, by(stronger)?);
        errors = errors.max(by_rule);
        by_other = by_other.max(by_stronger);
        moved = moved.max(by_rule.minus(by_stronger));
        if data.rule_check(setup)?.moments(view.t).is_some() {
            at_times = at_times.max(by_rule.minus(by_stronger));
        }
        levels.push(LevelFields::of(&data.space, &setup.model, view));
        Ok(())
    })?;
    Ok(Measured { levels, errors, by_other, moved, at_times, info })
}

fn levels(setup: &Setup, data: &MeshData, steps: u32) -> Result<Vec<LevelFields>, CaseError> {
    let mut levels = Vec::new();
    data.march(setup, steps, &Polished::default(), &mut |view| {
        levels.push(LevelFields::of(&data.space, &setup.model, view));
        Ok(())
    })?;
    Ok(levels)
}

fn distance(data: &MeshData, a: &[LevelFields], b: &[LevelFields]) -> Floors {
    let pairs = a.iter().zip(b).map(|(a, b)| a.distance(b, &data.space));
    pairs.fold(Floors::default(), Floors::max)
}

/// The floor of a case of an abstract scene: its histories are direct sums and its solution is exact.
///
/// # Errors
/// A run that fails.
pub fn abstract_floors(setup: &AbstractSetup, steps: u32) -> Result<Vec<FloorRow>, FiniteError> {
    let (standard, error, estimated) = abstract_levels(setup, steps, &Newton::default())?;
    let (polished, ..) = abstract_levels(setup, steps, &Polished::default())?;
    let apart = standard.iter().zip(&polished).map(|(a, b)| setup.model.norm(&(a - b)));
    let measured = apart.fold(0.0, f64::max);
    let (norm, part) = (Norm::VMax, FloorPart::Solver);
    Ok(vec![FloorRow { norm, part, error, measured, estimated }])
}

fn abstract_levels(
    setup: &AbstractSetup,
    steps: u32,
    solver: &dyn StepSolver,
) -> Result<(Vec<DVector<f64>>, f64, f64), FiniteError> {
    let (mut levels, mut error) = (Vec::new(), 0f64);
    let grid = setup.grid(steps);
    let info = march(&setup.model, &grid, &mut AbstractLoad(setup), solver, &mut |view| {
        let exact = DVector::from_column_slice(&setup.state(view.t).u);
        error = error.max(setup.model.norm(&(exact - view.u)));
        levels.push(view.u.clone());
    })?;
    Ok((levels, error, info.floor))
}
