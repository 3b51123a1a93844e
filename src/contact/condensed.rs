//! Contact without projection, condensed onto Γ3: one factor of the volume, a small full problem a level,
//! one pass over the factor to expand the displacement.
//!
//! The unknowns of Γ3 are the last of [`Discretization::condensing`], so the factor L = [L₁₁ 0; L₂₁ L₂₂] has the Schur complement
//! S = L₂₂L₂₂ᵀ. With ℬ₀ = β𝒜, or without memory, v_n = (1 + βW)u_n + β past_n solves K v_n = F_n - C_n with the
//! contact forces C_n, whatever the last slot's weight W is. Else the factor is that of 𝒜 + Σ W_i ℬ_i, a new one
//! where a W_i changes: once on a uniform grid.

use std::time::Instant;

use super::boundary::boundary_graph;
use super::condensed_level::CondensedLevel;
use super::floor::Accepted;
use super::march::{CaseError, CaseInfo, Observer, StepView, split_pressures};
use super::{Discretization, Floors, Load, Model, kkt_residual, strain_norm};
use crate::history::{Accumulated, Memory, TimeGrid};
use crate::law::{Convolution, Projection};
use crate::linalg::{Analysis, Factor, FactorError, Front, Workspace, axpy, norm};
use crate::vhi::{
    Extrapolation, FailedStep, Newton, Scratch, StepError, StepInequality, StepState,
};

/// Whether a scene with contact at the vertices and without projection can be condensed on this mesh: one
/// graph an unknown of Γ3, and a full matrix there that is no dearer to factorize than the volume's.
pub fn applies<P: Projection>(space: &Discretization, model: &Model<P>) -> bool {
    let free = space.trace.points.iter().filter(|point| !point.clamped).count();
    model.boundary.is_some()
        && free == space.trace.unknowns().len()
        && (free as f64).powi(3) <= 3.0 * space.analysis.multiplications().max(1e5)
}

/// Solves all levels and shows each to `observe`.
///
/// # Errors
/// As [`super::march`].
pub fn march<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    grid: &TimeGrid,
    load: &mut dyn Load,
    newton: &Newton,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let unanalysed =
        |source| FailedStep { n: 0, t: 0.0, source: StepError::Factor { iteration: 0, source } };
    let analysis = space.condensing().map_err(unanalysed)?;
    let mut march = Condensed::new(space, analysis, model, grid);
    for n in 0..=grid.steps() {
        march.step(n, grid, load, newton, observe)?;
    }
    march.raise_floors();
    Ok(march.info)
}

struct Condensed<'a, P> {
    space: &'a Discretization,
    /// With the unknowns of Γ3 last.
    analysis: &'a Analysis,
    model: &'a Model<P>,
    info: CaseInfo,
    /// β of ℬ₀ = β𝒜, 0 without memory; `None` where memory is no multiple.
    beta: Option<f64>,
    memory: Vec<Memory>,
    /// Weights W_i of the last slot.
    slot: Vec<f64>,
    elastic: Vec<f64>,
    /// Stiffness of each ℬ_i, where it is no multiple, and of 𝒜 + Σ W_i ℬ_i.
    by_memory: Vec<Vec<f64>>,
    matrix: Vec<f64>,
    factor: Factor,
    workspace: Workspace,
    front: Front<f64>,
    /// The weights of the factor; `None` before the first.
    factorized: Option<Vec<f64>>,
    /// L₁₁⁻¹F_i where the load is Σ a_i(t) F_i and memory a multiple.
    basis: Option<Vec<Vec<f64>>>,
    factors: Vec<f64>,
    /// The first unknown of Γ3 in the order of the factor.
    cut: usize,
    level: CondensedLevel,
    state: StepState,
    scratch: Scratch,
    extrapolation: Extrapolation,
    accumulated: Accumulated,
    /// F_n, Cartesian; the right side in the order of the factor; products with a ℬ_i.
    force: Vec<f64>,
    swept: Vec<f64>,
    product: Vec<f64>,
    /// Unknowns and histories padded to all nodes; the same as displacements.
    u: Vec<f64>,
    history: Vec<Vec<f64>>,
    nodal: Vec<f64>,
    shown_history: Vec<Vec<f64>>,
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
    /// The largest load whose level has set the floors.
    largest_force: f64,
}

impl<'a, P: Projection> Condensed<'a, P> {
    fn new(
        space: &'a Discretization,
        analysis: &'a Analysis,
        model: &'a Model<P>,
        grid: &TimeGrid,
    ) -> Self {
        let start = Instant::now();
        let elastic = space.stiffness_of_unknowns(&model.elasticity);
        let beta = model.memory_multiple();
        let terms = model.memory.iter();
        let by_memory = match beta {
            Some(_) => Vec::new(),
            None => terms.clone().map(|m| space.stiffness_of_unknowns(&m.tensor)).collect(),
        };
        let graph = boundary_graph(space, model, &elastic);
        let graphs = graph.coordinates.len();
        let (dofs, nodes, points) = (space.dofs(), space.nodes.len(), space.trace.points.len());
        let unknowns = space.trace.unknowns();
        let cut = dofs - unknowns.len();
        let rule = model.time_rule.as_ref();
        let framed = if space.frames.is_empty() { 0 } else { model.memory.len() };
        let level = CondensedLevel::new(graph, unknowns);
        let mut info = CaseInfo::default();
        info.work.seconds_assemble += start.elapsed().as_secs_f64();
        Self {
            state: StepState { u: vec![0.0; dofs - cut], pressure: vec![0.0; graphs] },
            memory: terms.map(|term| Memory::new(&*term.kernel, rule, grid, dofs)).collect(),
            slot: vec![0.0; model.memory.len()],
            matrix: if beta.is_some() { Vec::new() } else { elastic.clone() },
            factor: analysis.factor(),
            workspace: analysis.workspace(1),
            front: Front::default(),
            factorized: None,
            basis: None,
            factors: Vec::new(),
            scratch: Scratch::default(),
            extrapolation: Extrapolation::default(),
            accumulated: Accumulated::default(),
            force: vec![0.0; dofs],
            swept: vec![0.0; dofs],
            product: vec![0.0; if beta.is_some() { 0 } else { dofs }],
            u: vec![0.0; nodes],
            history: vec![vec![0.0; nodes]; model.memory.len()],
            nodal: vec![0.0; nodes],
            shown_history: vec![vec![0.0; nodes]; framed],
            compliance: vec![0.0; points],
            multiplier: vec![0.0; points],
            largest_force: 0.0,
            space,
            analysis,
            model,
            info,
            beta,
            elastic,
            by_memory,
            cut,
            level,
        }
    }

    fn step(
        &mut self,
        n: usize,
        grid: &TimeGrid,
        load: &mut dyn Load,
        newton: &Newton,
        observe: &mut Observer<'_>,
    ) -> Result<(), CaseError> {
        let t = grid.time(n);
        let start = Instant::now();
        load.assemble(t, &mut self.force)?;
        self.info.seconds_load += start.elapsed().as_secs_f64();
        let dofs = self.space.dofs();
        let rule = self.model.time_rule.as_ref();
        let terms = self.model.memory.iter().zip(&mut self.memory).zip(&mut self.history);
        for (((term, memory), history), own) in terms.zip(&mut self.slot) {
            memory.past(&*term.kernel, rule, grid, &mut history[..dofs]);
            *own = rule.kernel_weight(&Convolution(&*term.kernel), grid, n, n);
        }
        let failed = |source| FailedStep { n, t, source };
        let refused = |source| failed(StepError::Factor { iteration: 0, source });
        self.prepare(&*load).map_err(refused)?;
        let start = Instant::now();
        self.condense(t, &*load);
        self.extrapolation.start(t, &mut self.state);
        let info =
            newton.solve(&mut self.level, &mut self.state, &mut self.scratch).map_err(failed)?;
        self.extrapolation.keep(t, &self.state);
        self.info.newton_iterations += info.iterations;
        self.info.active_set_changes += info.active_set_changes;
        self.expand();
        self.info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        for ((memory, history), own) in
            self.memory.iter_mut().zip(&mut self.history).zip(&self.slot)
        {
            memory.commit(grid, &self.u[..dofs]);
            axpy(*own, &self.u[..dofs], &mut history[..dofs]);
        }
        let bytes = self.memory.iter().map(Memory::bytes).sum();
        self.info.peak_history_bytes = self.info.peak_history_bytes.max(bytes);
        self.show(n, grid, observe)
    }

    /// The factor and s for the weights of the last slot.
    fn prepare(&mut self, load: &dyn Load) -> Result<(), FactorError> {
        let own = self.slot.first().copied().unwrap_or(0.0);
        self.level.scale = 1.0 + self.beta.map_or(0.0, |beta| beta * own);
        if self.level.scale.is_nan() || self.level.scale <= 0.0 {
            return Err(FactorError::NotPositiveDefinite { dof: 0 });
        }
        let known = self.factorized.as_ref();
        if known.is_some_and(|slot| self.beta.is_some() || *slot == self.slot) {
            return Ok(());
        }
        let start = Instant::now();
        if self.beta.is_none() {
            self.matrix.copy_from_slice(&self.elastic);
            for (matrix, own) in self.by_memory.iter().zip(&self.slot) {
                axpy(*own, matrix, &mut self.matrix);
            }
        }
        let matrix = if self.beta.is_some() { &self.elastic } else { &self.matrix };
        let analysis = self.analysis;
        self.info.work.linear.factorizations += 1;
        analysis.factorize(&self.space.pattern, matrix, &mut self.factor, &mut self.workspace)?;
        self.factorized = Some(self.slot.clone());
        self.level.set_schur(&analysis.last_triangle(&self.factor, self.cut));
        self.info.work.linear.seconds_factor += start.elapsed().as_secs_f64();
        if self.beta.is_some() {
            self.basis = load.basis().map(|basis| {
                let sweep = |vector: &Vec<f64>| {
                    let mut rotated = vector.clone();
                    self.space.frames.force_on_unknowns(&mut rotated);
                    let order = analysis.order();
                    let mut swept: Vec<f64> =
                        order.iter().map(|&dof| rotated[dof as usize]).collect();
                    analysis.forward(&self.factor, self.cut, &mut swept, &mut self.front);
                    swept
                };
                basis.iter().map(sweep).collect()
            });
            self.factors = vec![0.0; self.basis.as_ref().map_or(0, Vec::len)];
        }
        Ok(())
    }

    /// The right side with the volume eliminated, and the load of the level.
    fn condense(&mut self, t: f64, load: &dyn Load) {
        match &self.basis {
            Some(basis) => {
                load.factors(t, &mut self.factors);
                self.swept.fill(0.0);
                for (vector, factor) in basis.iter().zip(&self.factors) {
                    axpy(*factor, vector, &mut self.swept);
                }
            }
            None => {
                let analysis = self.analysis;
                let dofs = self.space.dofs();
                let force = &mut self.nodal[..dofs];
                force.copy_from_slice(&self.force);
                self.space.frames.force_on_unknowns(force);
                for (matrix, history) in self.by_memory.iter().zip(&self.history) {
                    self.space.pattern.multiply(matrix, &history[..dofs], &mut self.product);
                    axpy(-1.0, &self.product, force);
                }
                for (value, &dof) in self.swept.iter_mut().zip(analysis.order()) {
                    *value = force[dof as usize];
                }
                analysis.forward(&self.factor, self.cut, &mut self.swept, &mut self.front);
            }
        }
        self.level.load.copy_from_slice(&self.swept[self.cut..]);
        if let (Some(beta), Some(history)) = (self.beta, self.history.first()) {
            let unknowns = self.analysis.order()[self.cut..].iter();
            self.level.add_to_load(-beta, unknowns.map(|&dof| history[dof as usize]));
        }
    }

    /// u from its part on Γ3.
    fn expand(&mut self) {
        let analysis = self.analysis;
        let past = self.beta.zip(self.history.first());
        let scale = self.level.scale;
        let on_side = self.swept[self.cut..].iter_mut().zip(self.level.unknowns());
        for ((value, &dof), u) in on_side.zip(&self.state.u) {
            *value = scale * u + past.map_or(0.0, |(beta, past)| beta * past[dof as usize]);
        }
        analysis.backward(&self.factor, self.cut, &mut self.swept, &mut self.front);
        self.info.work.linear.solves += 1;
        for (&value, &dof) in self.swept.iter().zip(analysis.order()) {
            let dof = dof as usize;
            self.u[dof] = match past {
                Some((beta, past)) => (value - beta * past[dof]) / scale,
                None => value,
            };
        }
        // Values that a graph holds stay exact.
        for (&dof, u) in self.level.unknowns().iter().zip(&self.state.u) {
            self.u[dof as usize] = *u;
        }
    }

    fn show(
        &mut self,
        n: usize,
        grid: &TimeGrid,
        observe: &mut Observer<'_>,
    ) -> Result<(), CaseError> {
        let t = grid.time(n);
        let framed = !self.space.frames.is_empty();
        self.nodal.copy_from_slice(&self.u);
        self.space.frames.to_cartesian(&mut self.nodal);
        for (shown, history) in self.shown_history.iter_mut().zip(&self.history) {
            shown.copy_from_slice(history);
            self.space.frames.to_cartesian(shown);
        }
        split_pressures(
            self.space,
            self.model,
            self.level.graph(),
            &self.state,
            [&mut self.compliance, &mut self.multiplier],
        );
        let strain_norm = strain_norm(self.space, &self.nodal);
        self.accumulated.commit(grid, strain_norm);
        let view = StepView {
            n,
            t,
            u: &self.nodal,
            history: if framed { &self.shown_history } else { &self.history },
            zeta: self.accumulated.value(),
            kappa: f64::INFINITY,
            strain_norm,
            compliance: &self.compliance,
            multiplier: &self.multiplier,
        };
        let residual = kkt_residual(self.space, self.model, &view, &self.force);
        self.info.accept(&view, residual)?;
        observe(&view)?;
        // Floors grow with the load: levels of twice the largest load so far are few.
        if norm(&self.force) > 2.0 * self.largest_force {
            self.raise_floors();
        }
        Ok(())
    }

    /// Raises the floors to those of the correction that one more solve of the level would make.
    fn raise_floors(&mut self) {
        self.largest_force = self.largest_force.max(norm(&self.force));
        let (space, dofs) = (self.space, self.space.dofs());
        let mut unbalanced = self.force.clone();
        space.frames.force_on_unknowns(&mut unbalanced);
        let graph = self.level.graph().coordinates.iter();
        for (at, pressure) in graph.zip(&self.state.pressure) {
            let dof = self.level.unknowns()[at.dof as usize] as usize;
            unbalanced[dof] -= at.sign * at.weight * pressure;
        }
        // K acts on v, see above; each ℬ_i acts on its history, which holds u_n.
        let mut v = self.u[..dofs].to_vec();
        if let (Some(beta), Some(history)) = (self.beta, self.history.first()) {
            axpy(beta, &history[..dofs], &mut v);
        }
        let mut product = vec![0.0; dofs];
        space.pattern.multiply(&self.elastic, &v, &mut product);
        axpy(-1.0, &product, &mut unbalanced);
        for (matrix, history) in self.by_memory.iter().zip(&self.history) {
            space.pattern.multiply(matrix, &history[..dofs], &mut product);
            axpy(-1.0, &product, &mut unbalanced);
        }
        let diagonal = |i: usize| self.elastic[space.pattern.diagonal(i)] * v[i];
        let forces: Vec<f64> = (0..dofs).map(diagonal).collect();
        let size = norm(&forces) + norm(&self.force);
        // What the tolerance of Newton's method in the volume would be.
        let tolerance = Newton::default().rounding_units * f64::EPSILON * size;
        let accepted = Accepted { residual: norm(&unbalanced), tolerance };
        self.analysis.solve(&self.factor, &mut unbalanced, &mut self.workspace);
        unbalanced.resize(space.nodes.len(), 0.0);
        space.frames.to_cartesian(&mut unbalanced);
        let largest = self.model.elasticity.eigenvalues(space.mesh.dimension).1;
        let floors = Floors::new(space, &unbalanced, &self.nodal, accepted, largest);
        self.info.floors = self.info.floors.max(floors);
    }
}
