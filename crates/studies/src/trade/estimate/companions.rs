//! A run with its coarser companions, and the differences of each pair in every norm.

use std::collections::BTreeMap;

use serde_json::Value;

use super::quantity::{QuantityEstimate, quantity};
use crate::guarantee::{self, Bounding, Guarantee, GuaranteeError};
use crate::solution::FinalState;
use crate::trade::SPAN;
use crate::trade::bench::Meshed;
use fem::contact::{CaseError, Discretization, Floors, LevelFields, LoadError, Observer, StepView};
use fem::norms::{ReferenceError, ReferenceRun, step_errors};
use run::sweep::{NORMS, Runs, as_floors, floor_in};
use scene::Norm;
use scene::setup::{Setup, SetupError};

/// What the companions of a run show.
#[derive(Clone)]
pub struct Companions {
    /// The run itself at t = T.
    pub state: FinalState,
    /// Differences in each norm.
    pub norms: Vec<NormDifferences>,
    /// Scalars of the state with what their companions say of them.
    pub quantities: Vec<QuantityEstimate>,
    /// Why there are no companions in h, and in k.
    pub missing: [Option<String>; 2],
    /// The data depend on the mesh: another mesh is another problem, and h has no error.
    pub on_mesh: bool,
    /// No level depends on another: k has no error.
    pub no_history: bool,
    /// Largest ‖ε(u_n)‖ of the run.
    pub size: f64,
    /// What each run took, the run itself first.
    pub times: Vec<RunTime>,
}

/// CPU seconds of one run as if it were alone: mesh, analysis, loads and march, without what companions are kept and
/// compared for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunTime {
    /// Cells per unit length.
    pub n: u32,
    /// Number of steps.
    pub steps: u32,
    /// CPU seconds of the thread.
    pub seconds: f64,
}

/// The differences [d₁, d₂] of one norm, of the two finest runs and of the two coarser ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormDifferences {
    /// The norm.
    pub norm: Norm,
    /// The changes in h; NaN where there are no companions.
    pub space: [f64; 2],
    /// The changes of the quantity in k, likewise.
    pub time: [f64; 2],
    /// What solver and rounding leave in any of the runs.
    pub floor: f64,
}

/// Levels of the coarsest companion in time that are compared at most, beside the last.
const COMPARED: u32 = 64;
/// Times that differ by less than this part of T are the same, but for rounding.
const SAME_TIME: f64 = 1e-9;

/// One run: levels at the compared times, the state at T, floors.
struct Run {
    time: RunTime,
    size: f64,
    state: FinalState,
    floors: Floors,
    levels: Vec<LevelFields>,
    kept: ReferenceRun,
    /// Largest distance to the finer run that it was compared with.
    apart: Floors,
}

/// Runs a scene on (n, N) and on the coarser companions that it has.
///
/// # Errors
/// The run itself; a companion that fails is `missing`.
pub fn companions(setup: &Setup, n: u32, steps: u32) -> Result<Companions, SetupError> {
    let finest = run(setup, &Meshed::new(setup, n)?, [steps, steps], None, &mut |_| Ok(()))?;
    Ok(beside(setup, finest))
}

/// What sees the levels of the run itself, on its space.
pub type Watch<'a> = dyn FnMut(&Discretization, &StepView<'_>) + 'a;

/// [`companions`], and the guaranteed bound of the error in space of that very run, or why there is none.
///
/// # Errors
/// Of the run, and of a bound that the theorem covers.
pub fn companions_and_bound(
    setup: &Setup,
    n: u32,
    steps: u32,
    watch: &mut Watch<'_>,
) -> Result<(Companions, Result<Guarantee, String>), GuaranteeError> {
    let mesh = Meshed::new(setup, n)?;
    let mut bounding = Bounding::new(setup, &mesh.data, steps);
    let finest = run(setup, &mesh, [steps, steps], None, &mut |view| {
        bounding.iter_mut().for_each(|bounding| bounding.see(view));
        watch(&mesh.data.space, view);
        Ok(())
    });
    let finest = finest.map_err(SetupError::from)?;
    let bound = match bounding.and_then(Bounding::finish) {
        Err(GuaranteeError::Refused { reason }) => Err(reason),
        found => Ok(found?),
    };
    drop(mesh);
    Ok((beside(setup, finest), bound))
}

/// What a run and its companions show.
fn beside(setup: &Setup, finest: Run) -> Companions {
    let RunTime { n, steps, .. } = finest.time;
    let on_mesh = setup.body.data.is_interpolated();
    let no_history = setup.model.memory.is_empty() && setup.kappa.lipschitz == 0.0;
    let in_time = match no_history {
        true => Ok(Vec::new()),
        false => shares_times(setup, steps)
            .and_then(|()| coarser(setup, &finest, [[n, steps / 2], [n, steps / 4]])),
    };
    let in_space = match on_mesh {
        true => Ok(Vec::new()),
        false => has_meshes(setup, n)
            .and_then(|()| coarser(setup, &finest, [[n / 2, steps], [n / 4, steps]])),
    };
    let all =
        || std::iter::once(&finest).chain([&in_time, &in_space].into_iter().flatten().flatten());
    let floors = all().fold(Floors::default(), |floors, run| floors.max(run.floors));
    let differences = |runs: &Companion, norm| match runs.as_deref() {
        Ok([half, quarter]) => [half, quarter].map(|run| floor_in(&run.apart, norm)),
        _ => [f64::NAN; 2],
    };
    let on_contact = setup.model.boundary.is_some();
    let norms = NORMS.into_iter().filter(|norm| on_contact || !norm.needs_contact());
    let norms = norms.map(|norm| NormDifferences {
        norm,
        space: differences(&in_space, norm),
        time: differences(&in_time, norm),
        floor: floor_in(&floors, norm),
    });
    let triple = |runs: &Companion, name: &str, value: f64| {
        let Ok([half, quarter]) = runs.as_deref() else { return None };
        let [half, quarter] = [half, quarter].map(|run| scalars(&run.state).get(name).copied());
        Some([quarter?, half?, value])
    };
    let quantities = scalars(&finest.state).into_iter().map(|(name, value)| {
        // A field of functions in V^h has no error in h.
        let space = match on_mesh {
            true => Some([value; 3]),
            false => triple(&in_space, &name, value),
        };
        let time = match no_history {
            true => Some([value; 3]),
            false => triple(&in_time, &name, value),
        };
        quantity(&name, space, time, value)
    });
    Companions {
        norms: norms.collect(),
        quantities: quantities.collect(),
        times: all().map(|run| run.time).collect(),
        missing: [&in_space, &in_time].map(|runs| runs.as_ref().err().cloned()),
        on_mesh,
        no_history,
        size: finest.size,
        state: finest.state,
    }
}

/// The run of [`companions`] with the memory that it takes: beside the run, the compared levels of it and of two
/// companions, with u and σ held twice.
pub fn companion_runs(setup: &Setup, n: u32, steps: u32) -> Runs<'_> {
    let beside = move |space: &Discretization, _| {
        let d = space.mesh.dimension;
        let stresses = d * (d + 1) / 2 * space.geometry.points();
        let compared = steps / stride(steps, steps) + 2;
        let held = 3.0 * 2.0 * 8.0 * f64::from(compared) * (space.nodes.len() + stresses) as f64;
        held + guarantee::bytes(setup, space)
    };
    Runs { setup, grid: vec![(n, steps)], beside: Box::new(beside) }
}

/// The two companions in one step, none where it makes no difference; or why there are none.
type Companion = Result<Vec<Run>, String>;

fn shares_times(setup: &Setup, steps: u32) -> Result<(), String> {
    if !steps.is_multiple_of(SPAN) {
        return Err(format!("N = {steps} is no multiple of {SPAN}"));
    }
    let (fine, coarse) = (setup.grid(steps), setup.grid(steps / SPAN));
    let apart = |j: usize| (fine.time(SPAN as usize * j) - coarse.time(j)).abs();
    match (0..=coarse.steps()).any(|j| apart(j) > SAME_TIME * fine.time(fine.steps())) {
        true => Err("the grids of N and N/4 steps share no times".into()),
        false => Ok(()),
    }
}

fn has_meshes(setup: &Setup, n: u32) -> Result<(), String> {
    if !n.is_multiple_of(SPAN) {
        return Err(format!("n = {n} is no multiple of {SPAN}"));
    }
    let none = |_| format!("the domain has no mesh with n = {}", n / SPAN);
    setup.scene.check_cells(n / SPAN).map_err(none)
}

/// Coarser runs, each from nothing and compared with the one before: on the same mesh point by point, on another one by
/// moments.
fn coarser(setup: &Setup, finest: &Run, grid: [[u32; 2]; 2]) -> Companion {
    let mut found: Vec<Run> = Vec::new();
    for [n, steps] in grid {
        let finer = found.last().unwrap_or(finest);
        let other = (n != finer.time.n).then_some(&finer.kept);
        let one = || -> Result<Run, SetupError> {
            let mesh = Meshed::new(setup, n)?;
            let mut one = run(setup, &mesh, [steps, finest.time.steps], other, &mut |_| Ok(()))?;
            if other.is_none() {
                let pairs = finer.levels.iter().zip(&one.levels);
                let apart = pairs.map(|(a, b)| a.distance(b, &mesh.data.space));
                one.apart = apart.fold(Floors::default(), Floors::max);
            }
            Ok(one)
        };
        let failed = |e| format!("the companion with n = {n}, N = {steps} fails: {e}");
        let one = one().map_err(failed)?;
        found.push(one);
    }
    Ok(found)
}

/// A run whose levels are kept at the times of N/4 steps (thinned), N = `finest`; `finer` is what it is compared with.
fn run(
    setup: &Setup,
    mesh: &Meshed,
    [steps, finest]: [u32; 2],
    finer: Option<&ReferenceRun>,
    watch: &mut Observer<'_>,
) -> Result<Run, CaseError> {
    let refused = |error: ReferenceError| LoadError::Reference { reason: error.to_string() };
    let (n, space) = (mesh.n, &mesh.data.space);
    let refinement = finer.map(|finer| finer.refinement(space)).transpose().map_err(refused)?;
    let stride = stride(steps, finest) as usize;
    let mut kept = ReferenceRun::new(space.clone());
    let (mut levels, mut state, mut apart) = (Vec::new(), None, Floors::default());
    let (info, seconds) = mesh.march(setup, steps, &mut |view| {
        watch(view)?;
        let last = view.n == steps as usize;
        if !(last || view.n.is_multiple_of(stride)) {
            return Ok(());
        }
        if let Some((finer, refinement)) = finer.zip(refinement.as_ref()) {
            let truth = finer.moments(refinement, space, view.t).map_err(refused)?;
            apart = apart.max(as_floors(&step_errors(space, &setup.model, view, &truth)));
        }
        kept.keep(&setup.model, view);
        levels.push(LevelFields::of(space, &setup.model, view));
        if last {
            state = Some(FinalState::new(space, &setup.model, view));
        }
        Ok(())
    })?;
    let missing =
        || LoadError::Reference { reason: format!("the run on n = {n} has no last level") };
    let (state, time) = (state.ok_or_else(missing)?, RunTime { n, steps, seconds });
    Ok(Run { time, size: info.strain_norm, state, floors: info.floors, levels, kept, apart })
}

/// Levels of a run with `steps` steps between two compared ones, N = `finest` being the steps of the finest.
fn stride(steps: u32, finest: u32) -> u32 {
    let compared = if finest.is_multiple_of(SPAN) { finest / SPAN } else { finest };
    compared.div_ceil(COMPARED).max(1) * (steps / compared).max(1)
}

/// The scalars of a state; counts of vertices and cells have no order.
fn scalars(state: &FinalState) -> BTreeMap<String, f64> {
    let Ok(Value::Object(fields)) = serde_json::to_value(state) else { return BTreeMap::new() };
    let number = |(name, value): (String, Value)| {
        value.as_f64().filter(|_| value.is_f64()).map(|value| (name, value))
    };
    fields.into_iter().filter_map(number).collect()
}
