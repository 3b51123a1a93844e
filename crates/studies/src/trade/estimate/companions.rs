//! A run with its coarser companions, and the differences of each pair in every norm.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use serde_json::Value;

use super::quantity::{QuantityEstimate, quantity};
use crate::guarantee::{self, Bounding, Guarantee, GuaranteeError};
use crate::solution::FinalState;
use crate::trade::NORMS;
use fem::contact::{
    CaseError, CaseInfo, Discretization, Floors, LevelFields, LoadError, Observer, StepView,
};
use fem::norms::{ReferenceRun, step_errors};
use run::sweep::{Runs, as_floors, floor_in};
use scene::Norm;
use scene::setup::{MeshData, Setup, SetupError};

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

/// A mesh with its loads, and the CPU seconds that it took.
struct Meshed {
    n: u32,
    data: MeshData,
    seconds: f64,
}

impl Meshed {
    fn new(setup: &Setup, n: u32) -> Result<Self, SetupError> {
        let clock = ThreadTime::now();
        let data = MeshData::new(setup, n, None)?;
        Ok(Self { n, data, seconds: clock.elapsed().as_secs_f64() })
    }
}

/// One run: fields at the compared times, the state at T, floors.
struct Run {
    n: u32,
    steps: u32,
    /// CPU seconds of its loads, and of its mesh and the rest of its march.
    seconds: [f64; 2],
    size: f64,
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
    companions_beside(setup, &Meshed::new(setup, n)?, steps, &mut |_| Ok(()))
}

/// [`companions`], and the guaranteed bound of the error in space of that very run, or why there is none.
///
/// # Errors
/// Of the run, and of a bound that the theorem covers.
pub fn companions_and_bound(
    setup: &Setup,
    n: u32,
    steps: u32,
) -> Result<(Companions, Result<Guarantee, String>), GuaranteeError> {
    let mesh = Meshed::new(setup, n)?;
    let mut bounding = Bounding::new(setup, &mesh.data, steps);
    let found = companions_beside(setup, &mesh, steps, &mut |view| {
        bounding.iter_mut().for_each(|bounding| bounding.see(view));
        Ok(())
    })?;
    match bounding.and_then(Bounding::finish) {
        Ok(bound) => Ok((found, Ok(bound))),
        Err(GuaranteeError::Refused { reason }) => Ok((found, Err(reason))),
        Err(other) => Err(other),
    }
}

/// [`companions`] on a mesh that is made; `watch` sees every level of the run itself.
fn companions_beside(
    setup: &Setup,
    mesh: &Meshed,
    steps: u32,
    watch: &mut Observer<'_>,
) -> Result<Companions, SetupError> {
    let n = mesh.n;
    let on_mesh = setup.body.data.is_interpolated();
    let finest = run(setup, mesh, [steps, steps], None, watch)?;
    let in_time = time_companions(setup, mesh, steps);
    let in_space = match on_mesh {
        true => Ok(Vec::new()),
        false => space_companions(setup, n, steps, &finest),
    };
    let all =
        || std::iter::once(&finest).chain([&in_time, &in_space].into_iter().flatten().flatten());
    let floors = all().fold(Floors::default(), |floors, run| floors.max(run.floors));
    let time = pair(&in_time).map(|[half, quarter]| {
        [(&finest, half), (half, quarter)].map(|(a, b)| distance(&mesh.data, a, b))
    });
    let space = pair(&in_space).map(|pair| pair.map(|run| run.apart));
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
    let triple = |runs: &Companion, name: &str, value: f64| {
        let [half, quarter] = pair(runs)?.map(|run| scalars(&run.state).get(name).copied());
        Some([quarter?, half?, value])
    };
    let times = all().map(|run| run.alone(&finest)).collect();
    let quantities = scalars(&finest.state).into_iter().map(|(name, value)| {
        // A field of functions in V^h has no error in h.
        let space = match on_mesh {
            true => Some([value; 3]),
            false => triple(&in_space, &name, value),
        };
        quantity(&name, space, triple(&in_time, &name, value), value)
    });
    Ok(Companions {
        norms: norms.collect(),
        quantities: quantities.collect(),
        missing: [in_space.err(), in_time.err()],
        on_mesh,
        size: finest.size,
        times,
        state: finest.state,
    })
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

fn pair(runs: &Companion) -> Option<[&Run; 2]> {
    match runs.as_deref() {
        Ok([half, quarter]) => Some([half, quarter]),
        _ => None,
    }
}

/// The runs with N/2 and N/4 steps on the same mesh.
fn time_companions(setup: &Setup, mesh: &Meshed, steps: u32) -> Companion {
    if !steps.is_multiple_of(4) {
        return Err(format!("N = {steps} is no multiple of 4"));
    }
    let (fine, coarse) = (setup.grid(steps), setup.grid(steps / 4));
    let apart = |j: usize| (fine.time(4 * j) - coarse.time(j)).abs();
    if (0..=coarse.steps()).any(|j| apart(j) > SAME_TIME * fine.time(fine.steps())) {
        return Err("the grids of N and N/4 steps share no times".into());
    }
    let companion = |count: u32| {
        run(setup, mesh, [count, steps], None, &mut |_| Ok(()))
            .map_err(|error| format!("the companion with N = {count} fails: {error}"))
    };
    Ok(vec![companion(steps / 2)?, companion(steps / 4)?])
}

/// The runs on n/2 and n/4 with the same steps, each compared with the run on the next finer mesh.
fn space_companions(setup: &Setup, n: u32, steps: u32, finest: &Run) -> Companion {
    if !n.is_multiple_of(4) {
        return Err(format!("n = {n} is no multiple of 4"));
    }
    if setup.scene.check_cells(n / 4).is_err() {
        return Err(format!("the domain has no mesh with n = {}", n / 4));
    }
    let companion = |cells: u32, finer: &Run| -> Result<Run, String> {
        let failed = |error: &dyn std::fmt::Display| {
            format!("the companion with n = {cells} fails: {error}")
        };
        let mesh = Meshed::new(setup, cells).map_err(|error| failed(&error))?;
        run(setup, &mesh, [steps, steps], Some(&finer.kept), &mut |_| Ok(()))
            .map_err(|error| failed(&error))
    };
    let half = companion(n / 2, finest)?;
    let quarter = companion(n / 4, &half)?;
    Ok(vec![half, quarter])
}

impl Run {
    /// The seconds of this run as if it were alone. On the mesh of `first` a level's loads cost what they cost `first`:
    /// companions may find them made.
    fn alone(&self, first: &Self) -> RunTime {
        let levels = |run: &Self| f64::from(run.steps + 1);
        let [load, rest] = self.seconds;
        let load = match self.n == first.n {
            true => first.seconds[0] * levels(self) / levels(first),
            false => load,
        };
        RunTime { n: self.n, steps: self.steps, seconds: load + rest }
    }
}

/// A run whose levels are kept at the times of N/4 steps (thinned), N = `finest`; `finer` is what it is compared with.
fn run(
    setup: &Setup,
    mesh: &Meshed,
    [steps, finest]: [u32; 2],
    finer: Option<&ReferenceRun>,
    watch: &mut Observer<'_>,
) -> Result<Run, CaseError> {
    let refused =
        |error: &dyn std::fmt::Display| LoadError::Reference { reason: error.to_string() };
    let (n, space) = (mesh.n, &mesh.data.space);
    let refinement = finer.map(|finer| finer.refinement(space)).transpose();
    let refinement = refinement.map_err(|error| refused(&error))?;
    let stride = stride(steps, finest);
    let mut kept = ReferenceRun::new(space.clone());
    let (mut levels, mut state, mut apart) = (Vec::new(), None, Floors::default());
    let mut keep = |view: &StepView<'_>| -> Result<(), CaseError> {
        watch(view)?;
        let last = view.n == steps as usize;
        if !(last || view.n.is_multiple_of(stride as usize)) {
            return Ok(());
        }
        if let Some((finer, refinement)) = finer.zip(refinement.as_ref()) {
            let truth =
                finer.moments(refinement, space, view.t).map_err(|error| refused(&error))?;
            apart = apart.max(as_floors(&step_errors(space, &setup.model, view, &truth)));
        }
        kept.keep(&setup.model, view);
        levels.push(LevelFields::of(space, &setup.model, view));
        if last {
            state = Some(FinalState::new(space, &setup.model, view));
        }
        Ok(())
    };
    let (info, seconds) = timed(setup, mesh, steps, &mut keep)?;
    let missing =
        || LoadError::Reference { reason: format!("the run on n = {n} has no last level") };
    Ok(Run {
        n,
        steps,
        seconds,
        size: info.strain_norm,
        levels,
        state: state.ok_or_else(missing)?,
        floors: info.floors,
        kept,
        apart,
    })
}

/// A march that shows its levels to `keep`, and the CPU seconds of its loads and of mesh and march without those of `keep`.
fn timed(
    setup: &Setup,
    mesh: &Meshed,
    steps: u32,
    keep: &mut Observer<'_>,
) -> Result<(CaseInfo, [f64; 2]), CaseError> {
    let (clock, wall, mut keeping) = (ThreadTime::now(), Instant::now(), Duration::ZERO);
    let info = setup.scheme.march(setup, &mesh.data, steps, &mut |view| {
        let clock = ThreadTime::now();
        let outcome = keep(view);
        keeping += clock.elapsed();
        outcome
    })?;
    let taken = clock.elapsed().as_secs_f64();
    // The share is one of wall time, since the thread may have waited in between.
    let load = taken * (info.seconds_load / wall.elapsed().as_secs_f64()).min(1.0);
    let march = (taken - keeping.as_secs_f64() - load).max(0.0);
    Ok((info, [load, mesh.seconds + march]))
}

/// Levels of a run with `steps` steps between two compared ones, N = `finest` being the steps of the finest.
fn stride(steps: u32, finest: u32) -> u32 {
    let compared = if finest.is_multiple_of(4) { finest / 4 } else { finest };
    compared.div_ceil(COMPARED).max(1) * (steps / compared).max(1)
}

/// The largest distance of two runs on one mesh.
fn distance(data: &MeshData, a: &Run, b: &Run) -> Floors {
    let pairs = a.levels.iter().zip(&b.levels).map(|(a, b)| a.distance(b, &data.space));
    pairs.fold(Floors::default(), Floors::max)
}

/// The scalars of a state; counts of vertices and cells have no order.
fn scalars(state: &FinalState) -> BTreeMap<String, f64> {
    let Ok(Value::Object(fields)) = serde_json::to_value(state) else { return BTreeMap::new() };
    let number = |(name, value): (String, Value)| {
        value.as_f64().filter(|_| value.is_f64()).map(|value| (name, value))
    };
    fields.into_iter().filter_map(number).collect()
}
