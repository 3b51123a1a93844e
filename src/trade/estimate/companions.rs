//! A run with its coarser companions, and the differences of each pair in every norm.

use serde_json::Value;

use crate::contact::{CaseError, Discretization, Floors, LevelFields, LoadError};
use crate::norms::{ReferenceRun, step_errors};
use crate::scene::{Data, Norm};
use crate::setup::{MeshData, Setup, SetupError};
use crate::solution::FinalState;
use crate::sweep::{Runs, as_floors, floor_in};
use crate::trade::NORMS;

/// What the companions of a run show.
pub struct Companions {
    /// The run itself at t = T.
    pub state: FinalState,
    /// Differences in each norm.
    pub norms: Vec<NormDifferences>,
    /// Scalars of the state.
    pub quantities: Vec<Scalar>,
    /// Why there are no companions in h, and in k.
    pub missing: [Option<String>; 2],
    /// The data depend on the mesh, so that each mesh has a solution of its own and h no error.
    pub own_on_each_mesh: bool,
}

/// A named quantity in a run and its companions.
#[derive(Debug, Clone, PartialEq)]
pub struct Scalar {
    /// Its name, see [`FinalState`].
    pub name: String,
    /// On [4h, 2h, h]; none without companions.
    pub space: Option<[f64; 3]>,
    /// On [4k, 2k, k], likewise.
    pub time: Option<[f64; 3]>,
    /// In the run.
    pub value: f64,
}

/// The differences [d₁, d₂] of one norm, of the two finest runs and of the two coarser ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormDifferences {
    /// The norm.
    pub norm: Norm,
    /// In h; NaN where there are no companions.
    pub space: [f64; 2],
    /// In k, likewise.
    pub time: [f64; 2],
    /// What solver and rounding leave in any of the runs.
    pub floor: f64,
}

/// Levels of the coarsest companion in time that are compared at most, beside the last.
const COMPARED: u32 = 64;
/// Two times are the same within rounding.
const SAME_TIME: f64 = 1e-9;

/// One run: fields at the compared times, the state at T, floors.
struct Run {
    levels: Vec<LevelFields>,
    state: FinalState,
    floors: Floors,
    kept: ReferenceRun,
    /// Largest distance to the finer run that it was compared with.
    apart: Floors,
}

/// Runs a scene on (n, N) and on the coarser companions that it has.
///
/// # Errors
/// The run itself; a companion that fails is `missing`.
pub fn companions(setup: &Setup, n: u32, steps: u32) -> Result<Companions, SetupError> {
    let data = MeshData::new(setup, n, None)?;
    let own_on_each_mesh = matches!(setup.body.data, Data::Exact { interpolated: true, .. });
    let own = run(setup, &data, n, [steps, steps], None)?;
    let (in_time, no_time) = split(time_companions(setup, &data, n, steps));
    let (in_space, no_space) = match own_on_each_mesh {
        true => (None, None),
        false => split(space_companions(setup, n, steps, &own)),
    };
    let floors = [&in_time, &in_space]
        .into_iter()
        .flatten()
        .flatten()
        .fold(own.floors, |floors, run| floors.max(run.floors));
    let time = in_time
        .as_ref()
        .map(|[half, quarter]| [distance(&data, &own, half), distance(&data, half, quarter)]);
    let space = in_space.as_ref().map(|[half, quarter]| [half.apart, quarter.apart]);
    let read = |pair: &Option<[Floors; 2]>, norm: Norm| {
        pair.map_or([f64::NAN; 2], |pair| pair.map(|floors| floor_in(&floors, norm)))
    };
    let on_contact = setup.model.boundary.is_some();
    let norms = NORMS.into_iter().filter(|norm| on_contact || !norm.needs_contact());
    let norms = norms.map(|norm| NormDifferences {
        norm,
        space: read(&space, norm),
        time: read(&time, norm),
        floor: floor_in(&floors, norm),
    });
    let triple = |runs: &Option<[Run; 2]>, name: &str, value: f64| {
        let [half, quarter] = runs.as_ref()?;
        Some([scalar(&quarter.state, name)?, scalar(&half.state, name)?, value])
    };
    let quantities = scalars(&own.state).into_iter().map(|(name, value)| {
        let space = match own_on_each_mesh {
            true => Some([value; 3]),
            false => triple(&in_space, &name, value),
        };
        let time = triple(&in_time, &name, value);
        Scalar { name, space, time, value }
    });
    Ok(Companions {
        norms: norms.collect(),
        quantities: quantities.collect(),
        missing: [no_space, no_time],
        own_on_each_mesh,
        state: own.state,
    })
}

/// The runs of [`companions`], the finest of which is the run itself: beside it, the levels of that and of two companions
/// that are compared, u and σ of each twice over.
pub fn companion_runs(setup: &Setup, n: u32, steps: u32) -> Runs<'_> {
    let beside = move |space: &Discretization, _| {
        let d = space.mesh.dimension;
        let stresses = d * (d + 1) / 2 * space.mesh.cell_count();
        let compared = steps / stride(steps, steps) + 2;
        3.0 * 2.0 * 8.0 * f64::from(compared) * (space.nodes.len() + stresses) as f64
    };
    Runs { setup, grid: vec![(n, steps)], beside: Box::new(beside) }
}

fn split<T>(outcome: Result<T, String>) -> (Option<T>, Option<String>) {
    match outcome {
        Ok(value) => (Some(value), None),
        Err(reason) => (None, Some(reason)),
    }
}

/// Half and a quarter of the steps on the same mesh.
fn time_companions(setup: &Setup, data: &MeshData, n: u32, steps: u32) -> Result<[Run; 2], String> {
    if !steps.is_multiple_of(4) {
        return Err(format!("N = {steps} is no multiple of 4"));
    }
    let (fine, coarse) = (setup.grid(steps), setup.grid(steps / 4));
    let apart = |j: usize| (fine.time(4 * j) - coarse.time(j)).abs();
    if (0..=coarse.steps()).any(|j| apart(j) > SAME_TIME * fine.time(fine.steps())) {
        return Err("the grids of N and N/4 steps share no times".into());
    }
    let companion = |own: u32| {
        run(setup, data, n, [own, steps], None)
            .map_err(|error| format!("the companion with N = {own} fails: {error}"))
    };
    Ok([companion(steps / 2)?, companion(steps / 4)?])
}

/// Half and a quarter of the cells a unit length with the same steps, each beside the finer run.
fn space_companions(setup: &Setup, n: u32, steps: u32, own: &Run) -> Result<[Run; 2], String> {
    if !n.is_multiple_of(4) {
        return Err(format!("n = {n} is no multiple of 4"));
    }
    if setup.scene.check_cells(n / 4).is_err() {
        return Err(format!("the domain has no mesh with n = {}", n / 4));
    }
    let companion = |own: u32, finer: &Run| -> Result<Run, String> {
        let failed =
            |error: &dyn std::fmt::Display| format!("the companion with n = {own} fails: {error}");
        let data = MeshData::new(setup, own, None).map_err(|error| failed(&error))?;
        run(setup, &data, own, [steps, steps], Some(&finer.kept)).map_err(|error| failed(&error))
    };
    let half = companion(n / 2, own)?;
    let quarter = companion(n / 4, &half)?;
    Ok([half, quarter])
}

/// One run, kept at the times of N/4 steps (thinned), N being the steps of the finest one.
fn run(
    setup: &Setup,
    data: &MeshData,
    n: u32,
    [own, finest]: [u32; 2],
    finer: Option<&ReferenceRun>,
) -> Result<Run, CaseError> {
    let refused =
        |error: &dyn std::fmt::Display| LoadError::Reference { reason: error.to_string() };
    let refinement = finer.map(|finer| finer.refinement(&data.space)).transpose();
    let refinement = refinement.map_err(|error| refused(&error))?;
    let stride = stride(own, finest);
    let mut kept = ReferenceRun::new(data.space.clone());
    let (mut levels, mut state, mut apart) = (Vec::new(), None, Floors::default());
    let info = setup.scheme.march(setup, data, own, &mut |view| {
        let last = view.n == own as usize;
        if !(last || view.n.is_multiple_of(stride as usize)) {
            return Ok(());
        }
        if let Some((finer, refinement)) = finer.zip(refinement.as_ref()) {
            let truth =
                finer.moments(refinement, &data.space, view.t).map_err(|error| refused(&error))?;
            apart = apart.max(as_floors(&step_errors(&data.space, &setup.model, view, &truth)));
        }
        kept.keep(&setup.model, view);
        levels.push(LevelFields::of(&data.space, &setup.model, view));
        if last {
            state = Some(FinalState::new(&data.space, &setup.model, view));
        }
        Ok(())
    })?;
    let missing =
        || LoadError::Reference { reason: format!("the run on n = {n} has no last level") };
    Ok(Run { levels, state: state.ok_or_else(missing)?, floors: info.floors, kept, apart })
}

/// Levels of a run with `own` steps between two compared ones, N = `finest` being the steps of the finest.
fn stride(own: u32, finest: u32) -> u32 {
    let compared = if finest.is_multiple_of(4) { finest / 4 } else { finest };
    compared.div_ceil(COMPARED).max(1) * (own / compared).max(1)
}

/// The largest distance of two runs on one mesh.
fn distance(data: &MeshData, a: &Run, b: &Run) -> Floors {
    let pairs = a.levels.iter().zip(&b.levels).map(|(a, b)| a.distance(b, &data.space));
    pairs.fold(Floors::default(), Floors::max)
}

/// The scalars of a state; counts of vertices and cells have no order.
fn scalars(state: &FinalState) -> Vec<(String, f64)> {
    let Ok(Value::Object(fields)) = serde_json::to_value(state) else { return Vec::new() };
    let number = |(name, value): (String, Value)| {
        value.as_f64().filter(|_| value.is_f64()).map(|value| (name, value))
    };
    fields.into_iter().filter_map(number).collect()
}

fn scalar(state: &FinalState, name: &str) -> Option<f64> {
    scalars(state).into_iter().find(|(own, _)| own == name).map(|(_, value)| value)
}
