//! A body in contact on one mesh as a scene in time: its constants, from proved bounds only; e_n, the error against a truth on
//! the same mesh; g_n, the truncation error of the rule on the truth, ‖S_n u - S_n^k u‖_Y = |ζ part| + ‖memory part‖_ℋ.
//!
//! The truth is the exact u(t) in V^h, or a run with many more steps on the same mesh. Either solves the spatially discrete
//! problem with the history S_n u of its solution, which is all that (3.21) asks of it.

use super::estimate::Estimate;
use super::in_time::{GronwallError, InTime, Levels, named};
use super::recurrence::{HistoryPart, KernelNorms, Weights};
use crate::theory::norms::{DualNorm, remembered, stress_norm};
use exact::InterpolatedOnMesh;
use fem::contact::{
    Load, LoadError, Model, StepView, kkt_residual, march, strain_distance, strain_norm,
};
use run::sweep::lowest_common_multiple;
use scene::setup::{MeshData, Setup, TruthLoad, constants};
use vhi::history::{Accumulated, Memory, TimeGrid};
use vhi::law::{Convolution, HistoryKernel, TensorField};
use vhi::{Newton, monotonicity};

/// Constants of one scene. Where they bound a measured difference, each is the value itself or a proved
/// upper bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GronwallConstants {
    /// m0 = m_𝒜 - α_ν C, C a proved upper bound of c_j² (a stress).
    pub m0: f64,
    /// C, where α_ν > 0 needs it (a length).
    pub trace_bound: Option<f64>,
    /// β_φ = max(μ L_κ √|Ω|, 1).
    pub beta: f64,
    /// μ L_κ √|Ω|, with which ζ enters; zero if κ does not depend on ζ or there is no projection.
    pub yielding: f64,
    /// sup ‖ℬ‖ over [0, T], operator norms on S^d; zero without memory. Of kernels t^{-a} C(t), a the largest power, sup ‖C‖.
    pub memory: f64,
    /// Of ζ: 1, or T^a.
    pub accumulated: f64,
    /// w_nj.
    pub weights: Weights,
}

impl GronwallConstants {
    /// The constants of `setup`.
    ///
    /// # Errors
    /// A rule with weights for each kernel, no history, no proved bound of c_j², m0 ≤ 0, κ not Lipschitz.
    pub fn new(setup: &Setup) -> Result<Self, GronwallError> {
        let found = constants(setup)?;
        let scene = &setup.scene;
        let name = || scene.name.clone();
        let Some(weights) = Weights::of(scene.time.rule, found.singular.0) else {
            return Err(GronwallError::OwnWeights { scene: name() });
        };
        let friction = setup.body.contact.as_ref().and_then(|contact| contact.friction.as_ref());
        if friction.is_some_and(|law| law.alpha() > 0.0 || law.bound.coefficient() > 0.0) {
            return Err(GronwallError::NoTangentialBound { scene: name() });
        }
        let asked = found.alpha_nu > 0.0;
        let trace_bound = asked.then_some(found.c_j_squared_bound).flatten();
        if found.alpha_nu > 0.0 && trace_bound.is_none() {
            return Err(GronwallError::NoTraceBound { scene: name() });
        }
        let m0 = monotonicity(found.m_elastic, found.alpha_nu * trace_bound.unwrap_or(0.0));
        if m0.is_nan() || m0 <= 0.0 {
            return Err(GronwallError::Smallness { scene: name(), m0 });
        }
        let yielding = found.yielding;
        if !yielding.is_finite() {
            return Err(GronwallError::NotLipschitz { scene: name() });
        }
        let accumulated = weights.beside_plain(scene.time.horizon);
        let memory = accumulated * found.memory.operator + found.singular.1.operator;
        if yielding == 0.0 && memory == 0.0 {
            return Err(GronwallError::NoHistory { scene: name() });
        }
        let beta = found.beta_phi;
        Ok(Self { m0, trace_bound, beta, yielding, memory, accumulated, weights })
    }

    /// ‖S‖ is that of the parts the scene has: 1 for ζ, plus sup ‖ℬ‖.
    pub(super) fn lipschitz(&self) -> f64 {
        self.memory + if self.has_zeta() { self.accumulated } else { 0.0 }
    }

    /// True if ζ is a part of the history.
    pub(super) fn has_zeta(&self) -> bool {
        self.yielding > 0.0
    }

    /// The parts of the history on a grid: ζ with κ = 1, the memory stress with κ(n, j) =
    /// ‖ℬ(t_n - t_j)‖. An absent part is left out.
    pub(super) fn parts(&self, setup: &Setup, grid: &TimeGrid) -> Vec<HistoryPart> {
        let mut parts = Vec::new();
        if self.has_zeta() {
            let norms = KernelNorms::Lags(vec![1.0; grid.steps() + 1]);
            let supremum = self.accumulated;
            parts.push(HistoryPart { coefficient: self.yielding, norms, supremum });
        }
        if self.memory > 0.0 {
            let (terms, d) = (&setup.model.memory, setup.scene.dimension);
            let kernels: Vec<Convolution<'_>> =
                terms.iter().map(|term| Convolution(&*term.kernel)).collect();
            let kernels: Vec<&dyn HistoryKernel> =
                kernels.iter().map(|kernel| kernel as _).collect();
            let norm = |factors: &[f64]| {
                let mut each = terms.iter().map(|term| &term.tensor).zip(factors);
                let first = each.next().map(|(tensor, factor)| tensor.scaled(*factor));
                let sum =
                    |sum: TensorField, (tensor, factor): (&_, &f64)| sum.plus(*factor, tensor, d);
                first.map_or(0.0, |first| each.fold(first, sum).norm(d))
            };
            let uniform = setup.scene.time.grid == scene::TimeGrid::Uniform;
            let norms =
                KernelNorms::of(&kernels, norm, (self.weights.integrating(), grid), uniform);
            parts.push(norms.part(1.0, self.memory, grid));
        }
        parts
    }
}

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
    fn constants(&self) -> Vec<(&'static str, f64)> {
        let c = &self.constants;
        let details = [("yielding", c.yielding), ("memory_norm", c.memory)];
        let mut all = named([c.m0, c.beta, c.lipschitz()], details);
        all.extend(c.trace_bound.map(|bound| ("c_j_squared_bound", bound)));
        all
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
        let (c, parts) = (&self.constants, self.constants.parts(self.setup, grid));
        Estimate::blank(grid, c.weights, (c.m0, c.beta), parts)
    }
}

impl Load for Levels<'_> {
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError> {
        let reason = || LoadError::Reference { reason: format!("no load is given at t = {t}") };
        out.copy_from_slice(self.load(t).ok_or_else(reason)?);
        Ok(())
    }
}

/// Steps of the reference, in multiples of the least common multiple of the steps that are judged.
/// The error of the reference is then below 1/64 of the smallest error measured against it.
pub(super) const REFERENCE_STEPS: u32 = 8;

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
