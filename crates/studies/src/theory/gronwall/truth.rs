//! The truth of a purely temporal error: exact u(t) in V^h, or a run with many more steps on the same
//! mesh. Either solves the spatially discrete problem with the history S_n u of its solution, which is all that
//! (3.21) asks of it.

use super::GronwallError;
use exact::InterpolatedOnMesh;
use fem::contact::{Load, LoadError, StepView, kkt_residual, strain_distance};
use run::sweep::lowest_common_multiple;
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::Newton;
use vhi::history::TimeGrid;

/// Steps of the reference, in multiples of the least common multiple of the steps that are judged.
/// The error of the reference is then below 1/64 of the smallest error measured against it.
pub(crate) const REFERENCE_STEPS: u32 = 8;

/// An exact state is in V^h and compatible with the quadrature on Γ3 if its KKT residual is below
/// this, relative to the largest force: history integrals are good to 1e-12, and a field that is not
/// in V^h leaves a residual of the order of h.
const IN_SPACE: f64 = 1e-9;

/// The truth at one time.
#[derive(Debug, Clone)]
pub struct TruthAtLevel {
    /// t.
    pub t: f64,
    /// u(t), a nodal vector.
    pub u: Vec<f64>,
    /// ∫_0^t b(t - s) u(s) ds, a nodal vector per term of the memory (the fine sum for a reference).
    pub memory: Vec<Vec<f64>>,
    /// ζ(t) (the fine sum for a reference); NaN where κ does not depend on it.
    pub zeta: f64,
}

/// Where the truth comes from.
pub enum TemporalTruth {
    /// u(t) ∈ V^h, evaluated from formulas.
    Exact(Box<InterpolatedOnMesh>),
    /// A run on the same mesh.
    Reference(ReferenceLevels),
}

/// Levels of a run with many more steps.
pub struct ReferenceLevels {
    /// Its number of steps.
    pub steps: u32,
    /// max_n ‖ε(u_ref - u)‖ by Richardson from a run with half the steps; it is a part of every
    /// measured e_n, and none of the inequalities.
    pub own_error: f64,
    /// Every [`REFERENCE_STEPS`]-th level.
    levels: Vec<TruthAtLevel>,
}

impl TemporalTruth {
    /// The truth of a scene on a mesh for grids with the given numbers of steps: exact where the
    /// exact solution lies in V^h, else a reference run.
    ///
    /// # Errors
    /// A load or a run fails, or `steps` is empty.
    pub fn new(setup: &Setup, data: &MeshData, steps: &[u32]) -> Result<Self, GronwallError> {
        // With friction the exact state is no nodal vector alone: s of a vertex that sticks stands beside it.
        if let Some(exact) = setup.exact.as_ref().filter(|_| setup.model.friction.is_none()) {
            let rule = setup.compliance_rule();
            let exact = InterpolatedOnMesh::new(exact.clone(), data.space.clone(), rule);
            if in_space(setup, data, &exact)? {
                return Ok(Self::Exact(Box::new(exact)));
            }
        }
        ReferenceLevels::run(setup, data, steps).map(Self::Reference)
    }

    /// The levels at the times of the grid with `steps` steps.
    ///
    /// # Errors
    /// A formula that is not finite, a grid that is not part of the reference's.
    pub fn levels(&self, setup: &Setup, steps: u32) -> Result<Vec<TruthAtLevel>, GronwallError> {
        let grid = setup.grid(steps);
        match self {
            Self::Exact(exact) => {
                let level = |t: &f64| exact_level(setup, exact, *t);
                Ok(grid.times().iter().map(level).collect::<Result<_, _>>()?)
            }
            Self::Reference(reference) => reference.at(&grid, steps),
        }
    }

    /// One line for tables.
    pub(crate) fn label(&self) -> String {
        match self {
            Self::Exact(_) => "exact u(t) in V^h".to_string(),
            Self::Reference(reference) => format!(
                "run on the same mesh with {} steps, own error {:.1e} (Richardson)",
                reference.steps, reference.own_error
            ),
        }
    }

    /// What formulas and quadrature leave in u(t), relative to its size.
    pub(crate) fn accuracy(&self) -> f64 {
        // ζ and the memory integrals of the exact side.
        if matches!(self, Self::Exact(_)) { 1e-12 } else { 0.0 }
    }
}

fn exact_level(
    setup: &Setup,
    exact: &InterpolatedOnMesh,
    t: f64,
) -> Result<TruthAtLevel, LoadError> {
    let (u, memory) = exact.displacements(t)?;
    let yields = setup.body.material.projection.is_some();
    let zeta = if yields { exact.zeta(t)? } else { f64::NAN };
    Ok(TruthAtLevel { t, u, memory, zeta })
}

/// Whether the nodal interpolant of the exact solution, with its exact history, solves the spatially
/// discrete problem: KKT residual at four times.
fn in_space(
    setup: &Setup,
    data: &MeshData,
    exact: &InterpolatedOnMesh,
) -> Result<bool, GronwallError> {
    let mut load = vec![0.0; data.space.dofs()];
    let horizon = setup.scene.time.horizon;
    for share in [0.0, 1.0 / 3.0, 0.5, 1.0] {
        let level = exact_level(setup, exact, share * horizon)?;
        TruthLoad(&*data.truth).assemble(level.t, &mut load)?;
        let (compliance, multiplier) = pressures(setup, data, exact, &level);
        let view = StepView {
            n: 0,
            t: level.t,
            u: &level.u,
            history: &level.memory,
            zeta: level.zeta,
            kappa: vhi::law::Projection::limit(&setup.model.projection)
                .map_or(f64::INFINITY, |limit| limit.value(level.zeta)),
            strain_norm: f64::NAN,
            compliance: &compliance,
            multiplier: &multiplier,
            friction: &[],
        };
        let residual = kkt_residual(&data.space, &setup.model, &view, &load);
        if residual.is_nan() || residual > IN_SPACE {
            return Ok(false);
        }
    }
    Ok(true)
}

/// ξ and λ of the exact state at the points of the trace: ξ takes what ∂j_ν allows, λ the rest.
fn pressures(
    setup: &Setup,
    data: &MeshData,
    exact: &InterpolatedOnMesh,
    level: &TruthAtLevel,
) -> (Vec<f64>, Vec<f64>) {
    let trace = &data.space.trace;
    let Some(boundary) = &setup.model.boundary else {
        return (vec![0.0; trace.points.len()], vec![0.0; trace.points.len()]);
    };
    let split = |(i, pressure): (usize, f64)| {
        let x = data.space.mesh.point(&[trace.points[i].vertex], &[1.0]);
        let r = trace.normal(i, &level.u) - (boundary.shift)(x);
        let (lo, hi) = boundary.potential.subdifferential(r);
        let xi = pressure.clamp(lo, hi);
        (xi, pressure - xi)
    };
    exact.pressures(level.t).into_iter().enumerate().map(split).unzip()
}

impl ReferenceLevels {
    fn run(setup: &Setup, data: &MeshData, steps: &[u32]) -> Result<Self, GronwallError> {
        let common = steps.iter().copied().fold(1, lowest_common_multiple);
        // The levels of the coarsest grid that contains all others.
        let levels = kept(setup, data, common, REFERENCE_STEPS)?;
        let half = kept(setup, data, common, REFERENCE_STEPS / 2)?;
        let distance =
            |(a, b): (&TruthAtLevel, &TruthAtLevel)| strain_distance(&data.space, &a.u, &b.u);
        let apart = levels.iter().zip(&half).map(distance).fold(0.0, f64::max);
        Ok(Self { steps: REFERENCE_STEPS * common, own_error: apart / 3.0, levels })
    }

    fn at(&self, grid: &TimeGrid, steps: u32) -> Result<Vec<TruthAtLevel>, GronwallError> {
        let refused = || GronwallError::NotNested { steps, reference: self.steps };
        let every = self.steps / REFERENCE_STEPS;
        if !every.is_multiple_of(steps) {
            return Err(refused());
        }
        let every = (every / steps) as usize;
        let level = |(n, t): (usize, &f64)| {
            let level = self.levels.get(n * every).ok_or_else(refused)?;
            let same = (level.t - t).abs() <= 1e-12 * t.abs();
            if same { Ok(level.clone()) } else { Err(refused()) }
        };
        grid.times().iter().enumerate().map(level).collect()
    }
}

/// Every `stride`-th level of a run, `count` of them beside the first.
fn kept(
    setup: &Setup,
    data: &MeshData,
    count: u32,
    stride: u32,
) -> Result<Vec<TruthAtLevel>, GronwallError> {
    let (steps, mut levels) = (stride * count, Vec::new());
    data.march(setup, steps, &Newton::default(), &mut |view| {
        if view.n % stride as usize == 0 {
            let memory = view.history.to_vec();
            levels.push(TruthAtLevel { t: view.t, u: view.u.to_vec(), memory, zeta: view.zeta });
        }
        Ok(())
    })
    .map_err(|source| GronwallError::Case { steps, source })?;
    Ok(levels)
}
