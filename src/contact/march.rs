//! The march in time: Problem 14 step after step, with the history committed after convergence.

use std::time::Instant;

use super::problem::Work;
use super::{ContactProblem, Discretization, Floors, Load, LoadError, Model, kkt_residual, linear};
use crate::history::{Accumulated, Memory, TimeGrid};
use crate::law::Projection;
use crate::vhi::{Newton, Scratch, StepError, StepState};

/// The solution at one time level, as an observer sees it.
pub struct StepView<'a> {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// u_n as a nodal vector, clamped nodes included.
    pub u: &'a [f64],
    /// Σ'_{j ≤ n} b(t_n - t_j) u_j as a nodal vector, where there is memory.
    pub history: Option<&'a [f64]>,
    /// ζ_n, also for scenes without projection.
    pub zeta: f64,
    /// κ(ζ_n); infinite without projection.
    pub kappa: f64,
    /// ‖ε(u_n)‖.
    pub strain_norm: f64,
    /// ξ_n at the points of the trace (a pressure).
    pub compliance: &'a [f64],
    /// λ_n at the points of the trace (a pressure).
    pub multiplier: &'a [f64],
}

/// Sees every time level; an error of its own ends the march.
pub type Observer<'a> = dyn FnMut(&StepView<'_>) -> Result<(), CaseError> + 'a;

/// Why a case has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CaseError {
    /// A step failed.
    #[error("step {n} (t = {t}): {source}")]
    Step {
        /// n.
        n: usize,
        /// t_n.
        t: f64,
        /// What the solver said.
        source: StepError,
    },
    /// A load failed.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The separate evaluation of the KKT system disagrees with the solver.
    #[error(
        "step {n} (t = {t}): KKT residual {residual:.3e} by separate evaluation exceeds {allowed:.1e}"
    )]
    Kkt {
        /// n.
        n: usize,
        /// t_n.
        t: f64,
        /// The relative residual.
        residual: f64,
        /// What is allowed.
        allowed: f64,
    },
}

/// What one case took.
#[derive(Debug, Clone, Copy, Default)]
pub struct CaseInfo {
    /// Newton iterations over all steps.
    pub newton_iterations: u32,
    /// Changes of the active set over all steps.
    pub active_set_changes: u32,
    /// Largest relative KKT residual over all steps (separate evaluation).
    pub kkt_residual: f64,
    /// Factorizations, solves and their times.
    pub work: Work,
    /// Seconds in loads.
    pub seconds_load: f64,
    /// Largest memory held by the history.
    pub peak_history_bytes: usize,
    /// What solver and rounding contribute to each error.
    pub floors: Floors,
}

/// A relative KKT residual above this is a failure. Rounding of nodal forces against the largest of
/// them is n·1e-16 at worst on the meshes of this project; 1e-9 is the accuracy promised for results.
pub const KKT_ALLOWED: f64 = 1e-9;

/// Solves all steps of a case and shows each to `observe`.
///
/// # Errors
/// A step that does not converge, a load that is not finite, a KKT residual above [`KKT_ALLOWED`].
pub fn march<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    grid: &TimeGrid,
    load: &mut dyn Load,
    newton: &Newton,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    if model.is_linear() && (model.memory.is_none() || model.memory_multiple().is_some()) {
        return linear::march(space, model, grid, load, observe);
    }
    let mut march = March::new(space, model, grid, newton);
    for n in 0..=grid.steps() {
        march.step(n, load, observe)?;
    }
    Ok(march.finish())
}

struct March<'a, P> {
    space: &'a Discretization,
    model: &'a Model<P>,
    grid: &'a TimeGrid,
    newton: &'a Newton,
    problem: ContactProblem<'a, P>,
    memory: Option<Memory>,
    accumulated: Accumulated,
    state: StepState,
    /// The last solutions (u, c), newest first: the start of the next step is extrapolated.
    last: Vec<StepState>,
    scratch: Scratch,
    load: Vec<f64>,
    /// Σ_{j<n}, then completed to Σ'_{j≤n}, as a nodal vector.
    history: Vec<f64>,
    nodal: Vec<f64>,
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
    last_residual: f64,
    info: CaseInfo,
}

impl<'a, P: Projection> March<'a, P> {
    fn new(
        space: &'a Discretization,
        model: &'a Model<P>,
        grid: &'a TimeGrid,
        newton: &'a Newton,
    ) -> Self {
        let problem = ContactProblem::new(space, model);
        let graphs = crate::vhi::StepInequality::graph(&problem).coordinates.len();
        let rule = model.time_rule.as_ref();
        let memory =
            model.memory.as_ref().map(|term| Memory::new(&*term.kernel, rule, space.dofs()));
        Self {
            state: StepState { u: vec![0.0; space.dofs()], pressure: vec![0.0; graphs] },
            last: Vec::new(),
            scratch: Scratch::default(),
            load: vec![0.0; space.dofs()],
            history: vec![0.0; if memory.is_some() { space.nodes.len() } else { 0 }],
            nodal: vec![0.0; space.nodes.len()],
            compliance: vec![0.0; space.trace.points.len()],
            multiplier: vec![0.0; space.trace.points.len()],
            last_residual: 0.0,
            info: CaseInfo::default(),
            accumulated: Accumulated::default(),
            space,
            model,
            grid,
            newton,
            problem,
            memory,
        }
    }

    fn step(
        &mut self,
        n: usize,
        load: &mut dyn Load,
        observe: &mut Observer<'_>,
    ) -> Result<(), CaseError> {
        let t = self.grid.time(n);
        let start = Instant::now();
        load.assemble(t, &mut self.load)?;
        self.info.seconds_load += start.elapsed().as_secs_f64();

        let rule = self.model.time_rule.as_ref();
        let dofs = self.space.dofs();
        let weight = rule.weight(self.grid, n, n);
        let past_zeta = self.accumulated.past(rule, self.grid);
        if let (Some(memory), Some(term)) = (&self.memory, &self.model.memory) {
            memory.past(&*term.kernel, rule, self.grid, &mut self.history[..dofs]);
        }
        let past = self.memory.as_ref().filter(|_| n > 0).map(|_| &self.history[..dofs]);
        self.problem.begin(weight, past_zeta, &self.load, past);
        self.extrapolate(n);
        let info = self
            .newton
            .solve(&mut self.problem, &mut self.state, &mut self.scratch)
            .map_err(|source| CaseError::Step { n, t, source })?;
        self.last_residual = info.residual;
        self.info.newton_iterations += info.iterations;
        self.info.active_set_changes += info.active_set_changes;
        self.commit(weight);
        self.show(n, t, observe)
    }

    /// Start values: u and c extrapolated through the last (up to three) levels.
    fn extrapolate(&mut self, n: usize) {
        let last = &self.last;
        if last.is_empty() {
            return;
        }
        // Lagrange weights at t_n for the times t_{n-1}, …: exact for quadratics on any grid.
        let times: Vec<f64> = (1..=last.len()).map(|back| self.grid.time(n - back)).collect();
        let weights: Vec<f64> = (0..times.len())
            .map(|a| {
                let others = (0..times.len()).filter(|&b| b != a);
                others.map(|b| (self.grid.time(n) - times[b]) / (times[a] - times[b])).product()
            })
            .collect();
        let blend = |pick: fn(&StepState) -> &[f64], out: &mut [f64]| {
            out.fill(0.0);
            for (state, weight) in last.iter().zip(&weights) {
                crate::linalg::axpy(*weight, pick(state), out);
            }
        };
        blend(|state| &state.u, &mut self.state.u);
        blend(|state| &state.pressure, &mut self.state.pressure);
    }

    /// Commits the converged level to the history.
    fn commit(&mut self, weight: f64) {
        let dofs = self.space.dofs();
        self.accumulated.commit(self.grid, self.problem.strain_norm());
        if let (Some(memory), Some(term)) = (&mut self.memory, &self.model.memory) {
            memory.commit(self.grid, &self.state.u);
            let implicit = weight * term.kernel.value(0.0);
            crate::linalg::axpy(implicit, &self.state.u, &mut self.history[..dofs]);
            self.info.peak_history_bytes = self.info.peak_history_bytes.max(memory.bytes());
        }
        if self.last.len() == 3 {
            self.last.rotate_right(1);
            self.last[0].clone_from(&self.state);
        } else {
            self.last.insert(0, self.state.clone());
        }
    }

    /// Counters, and the floors from the correction that one more solve would make.
    fn finish(mut self) -> CaseInfo {
        let mut delta = vec![0.0; self.space.nodes.len()];
        let unbalanced = self.scratch.unbalanced();
        delta[..unbalanced.len()].copy_from_slice(unbalanced);
        self.problem.solve_with_last_factor(&mut delta[..self.space.dofs()]);
        let largest = self.model.elasticity.eigenvalues(self.space.mesh.dimension).1;
        let residual = self.last_residual;
        self.info.floors = Floors::new(self.space, &delta, &self.nodal, residual, largest);
        self.info.work = self.problem.work();
        self.info
    }

    fn show(&mut self, n: usize, t: f64, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        self.nodal[..self.state.u.len()].copy_from_slice(&self.state.u);
        self.split_pressures();
        let zeta = self.problem.zeta();
        let view = StepView {
            n,
            t,
            u: &self.nodal,
            history: self.memory.as_ref().map(|_| self.history.as_slice()),
            zeta,
            kappa: self.model.projection.limit().map_or(f64::INFINITY, |l| l.value(zeta)),
            strain_norm: self.problem.strain_norm(),
            compliance: &self.compliance,
            multiplier: &self.multiplier,
        };
        let residual = kkt_residual(self.space, self.model, &view, &self.load);
        if residual.is_nan() || residual > KKT_ALLOWED {
            return Err(CaseError::Kkt { n, t, residual, allowed: KKT_ALLOWED });
        }
        self.info.kkt_residual = self.info.kkt_residual.max(residual);
        observe(&view)
    }

    /// c = ξ + λ: ξ ∈ ∂j_ν(u_ν) takes what the interval allows, λ the rest.
    fn split_pressures(&mut self) {
        let Some(boundary) = &self.model.boundary else { return };
        let graph = crate::vhi::StepInequality::graph(&self.problem);
        let mut next = 0;
        for (i, point) in self.space.trace.points.iter().enumerate() {
            if point.clamped {
                continue;
            }
            let pressure = self.state.pressure[next];
            let at = &graph.coordinates[next];
            next += 1;
            let normal = self.space.trace.normal(i, &self.nodal);
            let (lo, hi) = boundary.potential.subdifferential(normal - at.shift);
            let vertex_rule = boundary.rule == super::BoundaryRule::Vertex;
            if vertex_rule {
                self.compliance[i] = if normal >= at.gap { lo } else { pressure.clamp(lo, hi) };
                self.multiplier[i] = pressure - self.compliance[i];
            } else {
                self.compliance[i] = lo;
                self.multiplier[i] = pressure;
            }
        }
    }
}
