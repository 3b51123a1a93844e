//! The scenes of the study, a body in contact and a problem in ℝ^m.
//!
//! The body on one mesh: its constants, from proved bounds only; e_n, the error against a truth on
//! the same mesh; g_n, the truncation error of the rule on the truth, ‖S_n u - S_n^k u‖_Y = |ζ part| + ‖memory part‖_ℋ.
//!
//! The truth is the exact u(t) in V^h, or a run with many more steps on the same mesh. Either solves the spatially discrete
//! problem with the history S_n u of its solution, which is all that (3.21) asks of it.

use super::super::norms::{DualNorm, stress_norm};
use super::recurrence::{
    Estimate, GivenLoads, HistoryPart, InTime, Known, Levels, NO_HISTORY, OWN_WEIGHTS, Terms,
    Weights, named, refused, smallness,
};
use crate::study::{Result, StudyError};
use exact::InterpolatedOnMesh;
use fem::contact::{
    Histories, Load, LoadError, MemoryTerm, Model, StepView, kkt_residual, march, strain_distance,
    strain_norm,
};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use run::sweep::lowest_common_multiple;
use scene::setup::{AbstractSetup, MeshData, Setup, constants};
use vhi::finite::{self, FiniteError, FiniteLoad};
use vhi::history::TimeGrid;
use vhi::law::{Convolution, TensorField};
use vhi::{Newton, monotonicity};

/// Constants of one scene. Where they bound a measured difference, each is the value itself or a proved
/// upper bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GronwallConstants {
    /// m0 = m_𝒜 - α_ν C, C a proved upper bound of c_ν², which is c_j² with one law (a stress).
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
    pub fn new(setup: &Setup) -> Result<Self> {
        let (found, scene) = (constants(setup)?, &setup.scene);
        if setup.body.material.memory.iter().any(|term| term.inner.is_some()) {
            let why = " has a history of a history: its envelopes are those of abstract scenes; state the problem with kind = \"abstract\"";
            return Err(refused(scene, why));
        }
        let Some(weights) = Weights::of(scene.time.rule, found.singular.0) else {
            return Err(refused(scene, OWN_WEIGHTS));
        };
        let refuse_if = |wrong, why: &str| if wrong { Err(refused(scene, why)) } else { Ok(()) };
        let friction = setup.body.friction();
        refuse_if(
            friction.is_some_and(|law| law.alpha() > 0.0 || law.bound.coefficient() > 0.0),
            ": m0 needs an upper bound of c_tau^2 where friction falls with the slip or follows the pressure, and none is proved; take a bound that is given",
        )?;
        let asked = found.alpha_nu > 0.0;
        let trace_bound = asked.then_some(found.c_nu_squared_bound).flatten();
        refuse_if(
            asked && trace_bound.is_none(),
            " has a falling contact law, and no bound of c_j^2 is proved for its sides: place the contact side opposite a clamped one",
        )?;
        let m0 = monotonicity(found.m_elastic, found.alpha_nu * trace_bound.unwrap_or(0.0));
        smallness(scene, m0)?;
        let yielding = found.yielding;
        let endless = ": kappa is not Lipschitz, so (3.24) has no constant C2";
        refuse_if(!yielding.is_finite(), endless)?;
        let accumulated = weights.beside_plain(scene.time.horizon);
        let memory = accumulated * found.memory.operator + found.singular.1.operator;
        refuse_if(yielding == 0.0 && memory == 0.0, NO_HISTORY)?;
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
        let (mut parts, rule) = (Vec::new(), self.weights.rule());
        let levels = 0..=grid.steps();
        if self.has_zeta() {
            let row = |n: usize| (0..=n).map(|j| rule.weight(grid, n, j)).collect();
            let (rows, supremum) = (levels.clone().map(row).collect(), self.accumulated);
            parts.push(HistoryPart { coefficient: self.yielding, rows, supremum });
        }
        if self.memory > 0.0 {
            let (terms, d) = (&setup.model.memory, setup.scene.dimension);
            let of_term = |term: &MemoryTerm| -> Vec<Vec<f64>> {
                let kernel = Convolution(&*term.kernel);
                levels.clone().map(|n| rule.kernel_row(&kernel, grid, n)).collect()
            };
            let each: Vec<_> = terms.iter().map(of_term).collect();
            let norm = |factors: &[f64]| {
                let mut each = terms.iter().map(|term| &term.tensor).zip(factors);
                let first = each.next().map(|(tensor, factor)| tensor.scaled(*factor));
                let sum =
                    |sum: TensorField, (tensor, factor): (&_, &f64)| sum.plus(*factor, tensor, d);
                first.map_or(0.0, |first| each.fold(first, sum).norm(d))
            };
            parts.push(HistoryPart::of(1.0, self.memory, &each, norm));
        }
        parts
    }
}

/// An error on the grid with so many steps.
pub(super) fn in_steps(steps: u32, source: impl std::fmt::Display) -> StudyError {
    StudyError::at(format!("{steps} steps"), source)
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
    pub fn new(setup: &'a Setup, n: u32, steps: &[u32]) -> Result<Self> {
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
    pub fn measure_model(&self, model: &Model, steps: u32) -> Result<Estimate> {
        let grid = self.grid(steps);
        let run = self.run(model, &grid, &self.loads(&grid)?)?;
        self.compared(grid, run)
    }

    fn run(&self, model: &Model, grid: &TimeGrid, loads: &[Vec<f64>]) -> Result<(Levels, f64)> {
        let (mut found, mut load) = (Vec::new(), GivenLoads(grid, loads));
        let newton = Newton::default();
        let info = march(&self.data.space, model, grid, &mut load, &newton, &mut |view| {
            found.push(view.u.to_vec());
            Ok(())
        })
        .map_err(|source| in_steps(grid.steps() as u32, source))?;
        Ok((found, info.floors.v))
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
        match &self.truth {
            TemporalTruth::Exact(_) => "exact u(t) in V^h".into(),
            TemporalTruth::Reference { steps, own_error, .. } => format!(
                "run on the same mesh with {steps} steps, own error {own_error:.1e} (Richardson)"
            ),
        }
    }

    fn grid(&self, steps: u32) -> TimeGrid {
        self.setup.grid(steps)
    }

    fn loads(&self, grid: &TimeGrid) -> Result<Levels> {
        grid.times().iter().map(|t| Ok(self.data.truth.load(*t)?.to_vec())).collect()
    }

    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>> {
        let mut norm = DualNorm::new(&self.data.space)?;
        Ok(loads.iter().map(|load| norm.of(load)).collect())
    }

    fn solutions(&self, grid: &TimeGrid, loads: &[Vec<f64>]) -> Result<(Levels, f64)> {
        self.run(&self.setup.model, grid, loads)
    }

    fn distance(&self, u: &[f64], v: &[f64]) -> f64 {
        strain_distance(&self.data.space, u, v)
    }

    fn terms(&self, grid: &TimeGrid) -> Terms {
        let c = &self.constants;
        (c.m0, c.beta, c.weights, c.parts(self.setup, grid))
    }

    fn known(&self, grid: &TimeGrid) -> Result<Known> {
        let Self { setup, data: MeshData { space, .. }, truth, constants } = self;
        let (terms, rule) = (&setup.model.memory, constants.weights.rule());
        let mut histories = Histories::new(terms, &*rule, grid, space.nodes.len());
        let mut size = 0f64;
        let (mut u, mut truncation) = (Vec::new(), [Vec::new(), Vec::new()]);
        for (n, level) in truth.levels(setup, grid.steps() as u32)?.into_iter().enumerate() {
            let norm = strain_norm(space, &level.u);
            size = size.max(norm);
            let (mut missed, zeta) = histories.level((grid, n), &level.u, norm);
            let off = || (level.zeta - zeta).abs();
            truncation[0].push(if constants.has_zeta() { off() } else { 0.0 });
            for (missed, exact) in missed.iter_mut().zip(&level.memory) {
                missed.iter_mut().zip(exact).for_each(|(sum, exact)| *sum = exact - *sum);
            }
            truncation[1].push(stress_norm(space, terms, &missed));
            u.push(level.u);
        }
        let factors = [constants.yielding, 1.0];
        // What formulas and quadrature leave in u(t), relative to its size.
        let accuracy = if matches!(truth, TemporalTruth::Exact(_)) { 1e-12 } else { 0.0 };
        Ok(Known { u, truncation, factors, unknown: accuracy * size })
    }
}

impl Load for GivenLoads<'_> {
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
    /// Levels of a run with many more steps on the same mesh.
    Reference {
        steps: u32,
        /// max_n ‖ε(u_ref - u)‖ by Richardson from a run with half the steps; it is a part of every
        /// measured e_n, and none of the inequalities.
        own_error: f64,
        /// The levels of the coarser grids.
        levels: Vec<TruthAtLevel>,
    },
}

impl TemporalTruth {
    /// The truth of a scene on a mesh for grids with the given numbers of steps: exact where the
    /// exact solution lies in V^h, else a reference run.
    ///
    /// # Errors
    /// A load or a run fails, or `steps` is empty.
    pub fn new(setup: &Setup, data: &MeshData, steps: &[u32]) -> Result<Self> {
        // With friction the exact state is no nodal vector alone: s of a vertex that sticks stands beside it.
        if let Some(exact) = setup.exact.as_ref().filter(|_| setup.model.friction.is_none()) {
            let rule = setup.compliance_rule();
            let exact = InterpolatedOnMesh::new(exact.clone(), data.space.clone(), rule);
            if in_space(setup, data, &exact)? {
                return Ok(Self::Exact(Box::new(exact)));
            }
        }
        // The levels of the coarsest grid that contains all others.
        let common = steps.iter().copied().fold(1, lowest_common_multiple);
        let every = |stride: u32| -> Result<Vec<TruthAtLevel>> {
            let (steps, mut levels) = (stride * common, Vec::new());
            data.march(setup, steps, &Newton::default(), &mut |view| {
                if view.n % stride as usize == 0 {
                    let (u, memory) = (view.u.to_vec(), view.history.to_vec());
                    levels.push(TruthAtLevel { t: view.t, u, memory, zeta: view.zeta });
                }
                Ok(())
            })
            .map_err(|source| in_steps(steps, source))?;
            Ok(levels)
        };
        let (levels, half) = (every(REFERENCE_STEPS)?, every(REFERENCE_STEPS / 2)?);
        let pairs = levels.iter().zip(&half);
        let apart = pairs.map(|(a, b)| strain_distance(&data.space, &a.u, &b.u));
        let own_error = apart.fold(0.0, f64::max) / 3.0;
        let steps = REFERENCE_STEPS * common;
        Ok(Self::Reference { steps, own_error, levels })
    }

    /// The levels at the times of the grid with `steps` steps.
    ///
    /// # Errors
    /// A formula that is not finite, a grid that is not part of the reference's.
    pub fn levels(&self, setup: &Setup, steps: u32) -> Result<Vec<TruthAtLevel>> {
        let grid = setup.grid(steps);
        let (finer, known) = match self {
            Self::Exact(exact) => {
                let level = |t: &f64| exact_level(setup, exact, *t);
                return Ok(grid.times().iter().map(level).collect::<Result<_, _>>()?);
            }
            Self::Reference { steps, levels, .. } => (steps, levels),
        };
        let common = finer / REFERENCE_STEPS;
        let level = |(n, t): (usize, &f64)| {
            let level = known.get(n * (common / steps) as usize)?;
            ((level.t - t).abs() <= 1e-12 * t.abs()).then(|| level.clone())
        };
        let nested = common.is_multiple_of(steps);
        let levels = grid.times().iter().enumerate().map(level);
        let found = nested.then(|| levels.collect::<Option<_>>()).flatten();
        found.ok_or_else(|| {
            StudyError::other(format!(
                "the grid with {steps} steps is not part of the reference's with {finer}: random grids need an exact solution in V^h"
            ))
        })
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
fn in_space(setup: &Setup, data: &MeshData, exact: &InterpolatedOnMesh) -> Result<bool> {
    let (model, trace, horizon) = (&setup.model, &data.space.trace, setup.scene.time.horizon);
    for share in [0.0, 1.0 / 3.0, 0.5, 1.0] {
        let TruthAtLevel { t, u, memory, zeta } = exact_level(setup, exact, share * horizon)?;
        // ξ takes what ∂j_ν allows, λ the rest.
        let split = |(i, pressure): (usize, f64)| {
            let boundary = model.boundary_on(trace.points[i].side);
            let Some(boundary) = boundary else { return (0.0, 0.0) };
            let x = data.space.mesh.point(&[trace.points[i].vertex], &[1.0]);
            let r = trace.normal(i, &u) - (boundary.shift)(x);
            let (lo, hi) = boundary.potential.subdifferential(r);
            let xi = pressure.clamp(lo, hi);
            (xi, pressure - xi)
        };
        let pressures = exact.pressures(t).into_iter().enumerate();
        let (compliance, multiplier): (Vec<f64>, Vec<f64>) = pressures.map(split).unzip();
        let limit = vhi::law::Projection::limit(&model.projection);
        let view = StepView {
            n: 0,
            t,
            u: &u,
            history: &memory,
            zeta,
            kappa: limit.map_or(f64::INFINITY, |limit| limit.value(zeta)),
            strain_norm: f64::NAN,
            compliance: &compliance,
            multiplier: &multiplier,
            friction: &[],
        };
        let residual = kkt_residual(&data.space, model, &view, &data.truth.load(t)?);
        if residual.is_nan() || residual > IN_SPACE {
            return Ok(false);
        }
    }
    Ok(true)
}

// An abstract problem in ℝ^m as a scene in time: no mesh, u(t) and (S u)(t) known, any kernel q(t, s),
// uniform, graded and random grids.

/// Accuracy of the exact side's histories, relative.
const EXACT: f64 = 1e-12;

/// An abstract scene with the square roots of its inner product.
pub(super) struct FiniteInTime<'a> {
    setup: &'a AbstractSetup,
    /// G^{-1/2}: ‖y‖_{X*} = |G^{-1/2} y|.
    inverse_root: DMatrix<f64>,
    /// m0, β_φ and ‖R‖‖q‖; a test may spoil them.
    pub constants: [f64; 3],
    /// ‖q‖, of kernels with (t - s)^{-a} of what stands beside it.
    q_norm: f64,
    weights: Weights,
}

impl<'a> FiniteInTime<'a> {
    /// The scene with its constants.
    ///
    /// # Errors
    /// A rule with weights for each kernel, no history, m0 ≤ 0.
    pub(super) fn new(setup: &'a AbstractSetup) -> Result<Self> {
        let (found, scene) = (&setup.constants, &setup.scene);
        let own = || refused(scene, OWN_WEIGHTS);
        let weights = Weights::of(scene.time.rule, found.power).ok_or_else(own)?;
        smallness(scene, found.m0)?;
        let plain = weights.beside_plain(scene.time.horizon) * found.plain.all;
        // ‖∫_0^t q ∫_0^s r u‖ ≤ T ‖q‖‖r‖ ∫_0^t ‖u‖, and W_nj ≤ T ‖q‖‖r‖ w_nj by a rule that repeats.
        let q_norm = plain + found.singular.all + scene.time.horizon * found.nested.all;
        let constants = [found.m0, found.beta_phi, found.r_norm * q_norm];
        if constants[2] == 0.0 {
            return Err(refused(scene, NO_HISTORY));
        }
        let gram = SymmetricEigen::new(setup.model.inner_product.clone());
        if gram.eigenvalues.min() <= 0.0 {
            return Err(StudyError::other("the inner product is singular"));
        }
        let scale = DMatrix::from_diagonal(&gram.eigenvalues.map(|value| value.sqrt().recip()));
        let inverse_root = &gram.eigenvectors * scale * gram.eigenvectors.transpose();
        Ok(Self { setup, inverse_root, constants, q_norm, weights })
    }
}

impl InTime for FiniteInTime<'_> {
    fn constants(&self) -> Vec<(&'static str, f64)> {
        let c = &self.setup.constants;
        let details = [
            ("m_A", c.m_a),
            ("alpha_phi", c.alpha_phi),
            ("alpha_j", c.alpha_j),
            ("c_j_squared", c.c_j_squared),
            ("r_norm", c.r_norm),
            ("q_norm", self.q_norm),
        ];
        named(self.constants, details)
    }

    fn truth(&self) -> String {
        "exact u(t) in R^m".to_string()
    }

    fn grid(&self, steps: u32) -> TimeGrid {
        self.setup.grid(steps)
    }

    fn loads(&self, grid: &TimeGrid) -> Result<Levels> {
        Ok(grid.times().iter().map(|t| self.setup.state(*t).load.clone()).collect())
    }

    fn dual_norms(&self, loads: &[Vec<f64>]) -> Result<Vec<f64>> {
        let norm = |load: &Vec<f64>| (&self.inverse_root * DVector::from_column_slice(load)).norm();
        Ok(loads.iter().map(norm).collect())
    }

    fn solutions(&self, grid: &TimeGrid, loads: &[Vec<f64>]) -> Result<(Levels, f64)> {
        let (mut found, mut load) = (Vec::new(), GivenLoads(grid, loads));
        let model = &self.setup.model;
        let info = finite::march(model, grid, &mut load, &Newton::default(), &mut |view| {
            found.push(view.u.as_slice().to_vec());
        })
        .map_err(|source| in_steps(grid.steps() as u32, source))?;
        Ok((found, info.floor))
    }

    fn distance(&self, u: &[f64], v: &[f64]) -> f64 {
        let difference = DVector::from_column_slice(u) - DVector::from_column_slice(v);
        self.setup.model.norm(&difference)
    }

    /// w_nj κ(n, j) = ‖R Σ_l W^l_nj Q_l‖ from X to X*.
    fn terms(&self, grid: &TimeGrid) -> Terms {
        let ([m0, beta, lipschitz], model) = (self.constants, &self.setup.model);
        // Operators X → X* between orthonormal coordinates.
        let matrices: Vec<DMatrix<f64>> = model
            .kernels
            .iter()
            .map(|term| &self.inverse_root * &model.r * &term.matrix * &self.inverse_root)
            .collect();
        let norm = |matrix: &DMatrix<f64>| matrix.singular_values().max();
        let alone: Vec<f64> = matrices.iter().map(norm).collect();
        let of = |factors: &[f64]| match factors {
            [factor] => factor.abs() * alone[0],
            _ => {
                let each = matrices.iter().zip(factors).map(|(matrix, factor)| *factor * matrix);
                each.reduce(|sum, matrix| sum + matrix).map_or(0.0, |sum| norm(&sum))
            }
        };
        let rule = self.weights.rule();
        let each: Vec<_> = model.kernels.iter().map(|term| term.weights(&*rule, grid)).collect();
        (m0, beta, self.weights, vec![HistoryPart::of(beta, lipschitz, &each, of)])
    }

    /// g_n = ‖S_n u - S_n^k u‖_{X*}, S_n^k u = R(Σ_l Q_l Σ_j w_nj q_l(t_n, t_j) u_j + a_S).
    fn known(&self, grid: &TimeGrid) -> Result<Known> {
        let (model, rule) = (&self.setup.model, self.weights.rule());
        let states: Vec<_> = grid.times().iter().map(|t| self.setup.state(*t)).collect();
        let column = |values: &[f64]| DVector::from_column_slice(values);
        let u: Vec<DVector<f64>> = states.iter().map(|state| column(&state.u)).collect();
        let weights: Vec<_> = model.kernels.iter().map(|term| term.weights(&*rule, grid)).collect();
        let defect = |n: usize| {
            let mut sum = model.a_s.clone();
            for (term, weights) in model.kernels.iter().zip(&weights) {
                let mut integral = DVector::zeros(model.dimension());
                if term.inner.is_some() {
                    integral +=
                        rule.kernel_row(&*term.kernel, grid, n).iter().sum::<f64>() * &model.start;
                }
                for (u, weight) in u.iter().zip(&weights[n]) {
                    integral.axpy(*weight, u, 1.0);
                }
                sum += &term.matrix * integral;
            }
            (&self.inverse_root * (column(&states[n].history) - &model.r * sum)).norm()
        };
        Ok(Known {
            truncation: [vec![0.0; u.len()], (0..u.len()).map(defect).collect()],
            factors: [0.0, self.constants[1]],
            unknown: EXACT * u.iter().map(|u| model.norm(u)).fold(0.0, f64::max),
            u: states.iter().map(|state| state.u.clone()).collect(),
        })
    }
}

impl FiniteLoad for GivenLoads<'_> {
    fn at(&mut self, t: f64) -> Result<DVector<f64>, FiniteError> {
        let missing = FiniteError::Load { component: 0, value: f64::NAN, t };
        self.load(t).map(DVector::from_column_slice).ok_or(missing)
    }
}
