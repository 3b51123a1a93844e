//! Contact without projection, condensed onto Γ3: one factor of the volume, a small full problem a level,
//! one pass over the factor for several levels to expand their displacements.
//!
//! The unknowns of Γ3 are the last of [`Discretization::condensing`], so the factor L = [L₁₁ 0; L₂₁ L₂₂] has the Schur
//! complement S = L₂₂L₂₂ᵀ. With ℬ₀ = β𝒜, or without memory, v_n = (1 + βW)u_n + β past_n solves K v_n = F_n - C_n with
//! the contact forces C_n, whatever the last slot's weight W is: what the past is on Γ3 is enough to go on, and levels
//! are solved there before their displacements are expanded together. Else the factor is that of 𝒜 + Σ W_i ℬ_i, a new
//! one where a W_i changes: once on a uniform grid; each level needs the displacements of those before it.

mod expansion;

use std::sync::Arc;
use std::time::Instant;

use expansion::Pending;

use super::boundary::boundary_graph;
use super::condensed_level::CondensedLevel;
use super::march::{CaseError, CaseInfo, Observer};
use super::path::of_storage;
use super::{Discretization, Load, Model, Unknowns};
use algebra::linalg::{Analysis, Factor, FactorError, Front, SIDES, Side, Workspace, axpy};
use vhi::history::{Accumulated, Memory, TimeGrid};
use vhi::law::{Convolution, Projection};
use vhi::{Extrapolation, FailedStep, Newton, Scratch, StepError, StepState};

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
    let mut march = Condensed::new(space, analysis, model, grid).map_err(unanalysed)?;
    for n in 0..=grid.steps() {
        let solved = march.solve(n, grid, load, newton);
        // What was solved is shown, also before a level that has no solution.
        if solved.is_err() || n == grid.steps() || march.solved == march.pending.len() {
            march.expand(grid, observe)?;
        }
        solved?;
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
    /// With a multiple: the memory of the unknowns of Γ3 alone, and its sum over the past.
    on_side: Option<Memory>,
    past_on_side: Vec<f64>,
    elastic: Arc<Vec<f64>>,
    /// Stiffness of each ℬ_i, where it is no multiple, and of 𝒜 + Σ W_i ℬ_i.
    by_memory: Vec<Vec<f64>>,
    matrix: Vec<f64>,
    factor: Arc<Factor>,
    /// Of factors of its own: none with a multiple.
    workspace: Option<Workspace>,
    front: Front<f64>,
    /// Weights W_i of the last slot of the level, and of the factor; `None` before the first.
    slot: Vec<f64>,
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
    /// Levels that are expanded together, the first `solved` of them solved on Γ3.
    pending: Vec<Pending>,
    solved: usize,
    block: Vec<Side>,
    block_front: Front<Side>,
    /// Products with a ℬ_i.
    product: Vec<f64>,
    /// Unknowns and histories padded to all nodes; the same as displacements.
    u: Vec<f64>,
    history: Vec<Vec<f64>>,
    nodal: Vec<f64>,
    balance: Vec<f64>,
    shown_history: Vec<Vec<f64>>,
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
    /// The level shown last, and the largest load whose level has set the floors.
    shown: usize,
    largest_force: f64,
}

impl<'a, P: Projection> Condensed<'a, P> {
    fn new(
        space: &'a Discretization,
        analysis: &'a Analysis,
        model: &'a Model<P>,
        grid: &TimeGrid,
    ) -> Result<Self, FactorError> {
        let mut info = CaseInfo::default();
        let (beta, terms) = (model.memory_multiple(), model.memory.iter());
        let mut by_memory = Vec::new();
        let (elastic, factor) = match beta {
            Some(_) => {
                let (tensor, last) = (&model.elasticity, Unknowns::ContactLast);
                let kept = space.stiffness_factor(tensor, last, &mut info.work)?;
                (kept.values.clone(), kept.factor.clone())
            }
            None => {
                let start = Instant::now();
                by_memory.extend(terms.clone().map(|m| space.stiffness_of_unknowns(&m.tensor)));
                let elastic = space.stiffness_of_unknowns(&model.elasticity);
                info.work.seconds_assemble += start.elapsed().as_secs_f64();
                (Arc::new(elastic), Arc::new(analysis.factor()))
            }
        };
        let graph = boundary_graph(space, model, &elastic);
        let graphs = graph.coordinates.len();
        let (dofs, nodes, points) = (space.dofs(), space.nodes.len(), space.trace.points.len());
        let unknowns = space.trace.unknowns();
        let side = unknowns.len();
        let rule = model.time_rule.as_ref();
        let remember = |dofs| {
            let new = move |term: &super::MemoryTerm| Memory::new(&*term.kernel, rule, grid, dofs);
            terms.clone().map(new)
        };
        let memory: Vec<Memory> = remember(dofs).collect();
        for memory in &memory {
            info.paths.insert(of_storage(memory.storage(), grid));
        }
        let framed = if space.frames.is_empty() { 0 } else { model.memory.len() };
        let ahead = if beta.is_some() { SIDES } else { 1 };
        let level = CondensedLevel::new(graph, unknowns);
        Ok(Self {
            state: StepState { u: vec![0.0; side], pressure: vec![0.0; graphs] },
            memory,
            on_side: beta.and_then(|_| remember(side).next()),
            past_on_side: vec![0.0; side],
            slot: vec![0.0; model.memory.len()],
            matrix: if beta.is_some() { Vec::new() } else { elastic.to_vec() },
            factor,
            workspace: beta.is_none().then(|| analysis.workspace()),
            front: Front::default(),
            factorized: None,
            basis: None,
            factors: Vec::new(),
            scratch: Scratch::default(),
            extrapolation: Extrapolation::default(),
            accumulated: Accumulated::default(),
            pending: vec![Pending::new(dofs); ahead],
            solved: 0,
            block: vec![[0.0; SIDES]; if ahead == SIDES { dofs } else { 0 }],
            block_front: Front::default(),
            product: vec![0.0; if beta.is_some() { 0 } else { dofs }],
            u: vec![0.0; nodes],
            history: vec![vec![0.0; nodes]; model.memory.len()],
            nodal: vec![0.0; nodes],
            balance: Vec::new(),
            shown_history: vec![vec![0.0; nodes]; framed],
            compliance: vec![0.0; points],
            multiplier: vec![0.0; points],
            shown: 0,
            largest_force: 0.0,
            cut: dofs - side,
            space,
            analysis,
            model,
            info,
            beta,
            elastic,
            by_memory,
            level,
        })
    }

    /// Solves level n on Γ3.
    fn solve(
        &mut self,
        n: usize,
        grid: &TimeGrid,
        load: &mut dyn Load,
        newton: &Newton,
    ) -> Result<(), CaseError> {
        let t = grid.time(n);
        let start = Instant::now();
        load.assemble(t, &mut self.pending[self.solved].force)?;
        self.info.seconds_load += start.elapsed().as_secs_f64();
        let rule = self.model.time_rule.as_ref();
        for (term, own) in self.model.memory.iter().zip(&mut self.slot) {
            *own = rule.kernel_weight(&Convolution(&*term.kernel), grid, n, n);
        }
        match (&mut self.on_side, self.model.memory.first()) {
            (Some(memory), Some(term)) => {
                memory.past(&*term.kernel, rule, grid, &mut self.past_on_side);
            }
            _ => self.recall(grid),
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
        self.info.damped_iterations += info.damped;
        self.info.active_set_changes += info.active_set_changes;
        if let Some(memory) = &mut self.on_side {
            memory.commit(grid, &self.state.u);
        }
        let (scale, beta) = (self.level.scale, self.beta.unwrap_or(0.0));
        let pending = &mut self.pending[self.solved];
        let v = pending.swept[self.cut..].iter_mut();
        for ((v, u), past) in v.zip(&self.state.u).zip(&self.past_on_side) {
            *v = scale * u + beta * past;
        }
        pending.n = n;
        pending.scale = scale;
        pending.slot.clone_from(&self.slot);
        pending.state.clone_from(&self.state);
        self.solved += 1;
        self.info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Σ_{j<n} W_nj u_j of each term, for the first level that is not committed.
    fn recall(&mut self, grid: &TimeGrid) {
        let (dofs, rule) = (self.space.dofs(), self.model.time_rule.as_ref());
        let terms = self.model.memory.iter().zip(&mut self.memory).zip(&mut self.history);
        for ((term, memory), history) in terms {
            memory.past(&*term.kernel, rule, grid, &mut history[..dofs]);
        }
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
        let analysis = self.analysis;
        if let Some(workspace) = &mut self.workspace {
            self.matrix.copy_from_slice(&self.elastic);
            for (matrix, own) in self.by_memory.iter().zip(&self.slot) {
                axpy(*own, matrix, &mut self.matrix);
            }
            let (pattern, matrix) = (&self.space.pattern, &self.matrix);
            // Nobody else has it: no copy is made.
            let factor = Arc::make_mut(&mut self.factor);
            self.info.work.linear.factorizations += 1;
            analysis.factorize(pattern, matrix, factor, workspace)?;
        }
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
        let Pending { force, swept, .. } = &mut self.pending[self.solved];
        match &self.basis {
            Some(basis) => {
                load.factors(t, &mut self.factors);
                swept.fill(0.0);
                for (vector, factor) in basis.iter().zip(&self.factors) {
                    axpy(*factor, vector, swept);
                }
            }
            None => {
                let dofs = self.space.dofs();
                let forces = &mut self.nodal[..dofs];
                forces.copy_from_slice(force);
                self.space.frames.force_on_unknowns(forces);
                for (matrix, history) in self.by_memory.iter().zip(&self.history) {
                    self.space.pattern.multiply(matrix, &history[..dofs], &mut self.product);
                    axpy(-1.0, &self.product, forces);
                }
                for (value, &dof) in swept.iter_mut().zip(self.analysis.order()) {
                    *value = forces[dof as usize];
                }
                self.analysis.forward(&self.factor, self.cut, swept, &mut self.front);
            }
        }
        self.level.load.copy_from_slice(&swept[self.cut..]);
        if self.on_side.is_some() {
            let beta = self.beta.unwrap_or(0.0);
            self.level.add_to_load(-beta, self.past_on_side.iter().copied());
        }
    }
}
