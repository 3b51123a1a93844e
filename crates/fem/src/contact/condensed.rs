//! A level whose only nonlinearity is contact, condensed onto Γ3; a linear level is one without Γ3.
//!
//! With K = 𝒜 + Σ W_i ℬ_i, the weights W_i those of the last slot, a level is
//!
//!   K u + p(u) + Σ_i w_i c_i s_i e_i = f,   c_i ∈ G_i(s_i u_i),
//!
//! f the load minus the memory of the past, p the compliance where it is integrated on facets; p and the graphs G_i act on
//! the unknowns of Γ3 alone. These are numbered last, so that K = L Lᵀ, L = [L₁₁ 0; L₂₁ L₂₂], has the Schur complement
//! S = L₂₂ L₂₂ᵀ on them. With u° = K⁻¹ f, free of contact: S u₂ + p(u₂) + Σ_i w_i c_i s_i e_i = S u°₂ by semismooth Newton,
//! a small full problem; then u = u° + L⁻ᵀ [0; L₂₂ᵀ (u₂ - u°₂)]. L is kept while the weights are. Where the memory is a
//! multiple of the elasticity, ℬ = β𝒜 and K is s𝒜: the factor of 𝒜 serves all levels and all runs on the mesh, and
//! s u° = 𝒜⁻¹ F - β Σ w_j u_j, F the load, for several levels together.

use std::sync::Arc;
use std::time::Instant;

use super::boundary::{boundary_graph, set_gaps};
use super::compliance::FacetCompliance;
use super::last_slot::TangentOf;
use super::stiffness::Order;
use super::{Discretization, Model, Plan, Work};
use algebra::linalg::{
    Analysis, DenseCholesky, Factor, FactorError, Front, LinearWork, Workspace, axpy, dot, norm,
    root_of_squares,
};
use vhi::{BoundaryGraph, Newton, Scratch, StepError, StepInequality, StepInfo, StepState};

/// The solver of such levels.
pub(super) struct Condensed<'a> {
    /// The stiffness of 𝒜.
    pub(super) elastic: Arc<Vec<f64>>,
    space: &'a Discretization,
    analysis: &'a Analysis,
    /// The factor of 𝒜, which is shared, or that of the last K, with room to make it.
    factor: Arc<Factor>,
    own: Option<Workspace>,
    /// Weights of the last K that was factorized.
    slot: Option<Vec<f64>>,
    /// β of ℬ₀ = β𝒜, 0 without memory; `None` where memory is no multiple.
    beta: Option<f64>,
    /// K over what is factorized.
    scale: f64,
    /// Γ3; none in a linear scene.
    side: Option<Side<'a>>,
    /// In the order of the factor.
    x: Vec<f64>,
    front: Front,
    pub(super) work: LinearWork,
}

impl<'a> Condensed<'a> {
    /// For levels of `model`; none where Γ3 is not all that is nonlinear.
    ///
    /// # Errors
    /// 𝒜 is not positive definite, or the order of unknowns cannot be analysed.
    pub(super) fn new(
        space: &'a Discretization,
        model: &'a Model,
        work: &mut Work,
    ) -> Result<Option<Self>, FactorError> {
        let order = match Plan::of(space, model) {
            Plan::Newton => return Ok(None),
            Plan::Linear => Order::Usual,
            Plan::Condensed => Order::ContactLast,
        };
        let (analysis, beta) = (space.analysis_in(order)?, model.memory_multiple());
        let (elastic, factor, own) = if beta.is_some() {
            let kept = space.stiffness_factor((&model.elasticity, order), true, work)?;
            (kept.values.clone(), kept.factor.clone(), None)
        } else {
            let elastic = Arc::new(space.stiffness_of_unknowns(&model.elasticity));
            (elastic, Arc::new(analysis.factor()), Some(analysis.workspace()))
        };
        let graph = || boundary_graph(space, model, &elastic);
        let side = (!model.boundary.is_empty()).then(|| Side::new(space, model, graph()));
        let mut condensed = Self {
            elastic,
            space,
            analysis,
            factor,
            own,
            slot: None,
            beta,
            scale: 1.0,
            side,
            x: vec![0.0; space.dofs()],
            front: Front::default(),
            work: LinearWork::default(),
        };
        if beta.is_some() {
            condensed.take_schur_complement();
        }
        Ok(Some(condensed))
    }

    fn take_schur_complement(&mut self) {
        let Some(side) = &mut self.side else { return };
        side.set_triangle(
            self.analysis.last_triangle(&self.factor, self.x.len() - side.dofs.len()),
        );
    }

    /// Sets the gaps to those of the time t.
    pub(super) fn set_gaps(&mut self, model: &Model, t: f64) {
        if let Some(side) = &mut self.side {
            set_gaps(self.space, model, t, &mut side.graph);
        }
    }

    /// Takes the K of a level, with the lower triangle `matrix` and weights `slot` of the last slot.
    ///
    /// # Errors
    /// K is not positive definite.
    pub(super) fn set(&mut self, matrix: &[f64], slot: &[f64]) -> Result<(), FactorError> {
        if let Some(beta) = self.beta {
            self.scale = 1.0 + beta * slot.first().copied().unwrap_or(0.0);
            let positive = self.scale > 0.0;
            return positive.then_some(()).ok_or(FactorError::NotPositiveDefinite { dof: 0 });
        }
        if let Some(workspace) = self.own.as_mut().filter(|_| self.slot.as_deref() != Some(slot)) {
            let start = Instant::now();
            (self.slot, self.work.factorizations) = (None, self.work.factorizations + 1);
            // Nobody else has it: no copy is made.
            let factor = Arc::make_mut(&mut self.factor);
            self.analysis.factorize(&self.space.pattern, matrix, factor, workspace)?;
            self.slot = Some(slot.to_vec());
            self.take_schur_complement();
            self.work.seconds_factor += start.elapsed().as_secs_f64();
        }
        Ok(())
    }

    /// β, where K is s𝒜 in every level.
    pub(super) fn beta(&self) -> Option<f64> {
        self.beta
    }

    /// 𝒜⁻¹ of loads over the unknowns, one after another, where K is s𝒜; else K⁻¹.
    pub(super) fn solve_free(&mut self, loads: &mut [f64]) {
        let start = Instant::now();
        self.analysis.solve(&self.factor, loads, &mut self.front);
        self.work.solves += (loads.len() / self.x.len().max(1)) as u32;
        self.work.seconds_solve += start.elapsed().as_secs_f64();
    }

    /// Solves a level with this K, given s u°, from the start value in `state`.
    ///
    /// # Errors
    /// The problem on Γ3 is not solved.
    pub(super) fn solve(
        &mut self,
        newton: &Newton,
        free: &[f64],
        state: &mut StepState,
    ) -> Result<StepInfo, StepError> {
        let start = Instant::now();
        let mut info = StepInfo { iterations: 1, ..StepInfo::default() };
        if let Some(side) = &mut self.side {
            info = side.solve(newton, self.scale, free, state)?;
        }
        self.add_contact(free, &mut state.u);
        // Values that a graph holds stay exact.
        if let Some(side) = &self.side {
            side.dofs.iter().zip(&side.state.u).for_each(|(&dof, u)| state.u[dof as usize] = *u);
        }
        self.work.seconds_solve += start.elapsed().as_secs_f64();
        Ok(info)
    }

    /// u of s u° and what Γ3 was moved by.
    fn add_contact(&mut self, free: &[f64], u: &mut [f64]) {
        u.iter_mut().zip(free).for_each(|(u, free)| *u = free / self.scale);
        let Some(side) = &self.side else { return };
        let (order, x) = (self.analysis.order(), &mut self.x);
        let first = x.len() - side.dofs.len();
        x[..first].fill(0.0);
        side.times_transpose(&side.moved, &mut x[first..]);
        self.analysis.backward(&self.factor, x, &mut self.front);
        for (x, &dof) in x.iter().zip(order) {
            u[dof as usize] += x / self.scale;
        }
    }

    /// What a force would change in the last level. Γ3 answers by its own tangent, where a stiff law holds what rounding of
    /// its forces would move.
    pub(super) fn correct(&mut self, force: &mut [f64]) {
        let mut free = force.to_vec();
        self.analysis.solve(&self.factor, &mut free, &mut self.front);
        if let Some(side) = &mut self.side {
            side.correct(&free);
        }
        self.add_contact(&free, force);
    }
}

/// The problem on Γ3 of a level.
struct Side<'a> {
    /// The graphs; their dofs count the unknowns of Γ3.
    graph: BoundaryGraph,
    /// The unknowns of Γ3 in the volume.
    dofs: Vec<u32>,
    /// L₂₂, by columns, and S, full and symmetric; K is s times what they are of.
    triangle: Vec<f64>,
    schur: Vec<f64>,
    scale: f64,
    /// S s u°₂.
    load: Vec<f64>,
    /// s (u₂ - u°₂).
    moved: Vec<f64>,
    /// The tangent, its factor without what is prescribed, and what it was made of, with s for the last slot.
    matrix: Vec<f64>,
    tangent: DenseCholesky,
    last: TangentOf<f64>,
    /// Prescribed increments.
    increments: Vec<f64>,
    /// p, of the unknowns with a zero behind them.
    compliance: Vec<FacetCompliance<'a>>,
    unknowns: Vec<f64>,
    /// u₂ and the pressures.
    state: StepState,
    scratch: Scratch,
}

impl<'a> Side<'a> {
    fn new(space: &Discretization, model: &'a Model, mut graph: BoundaryGraph) -> Self {
        let dofs = space.trace.unknowns();
        let size = dofs.len();
        let place = |unknown: u32| dofs.iter().position(|&dof| dof == unknown).unwrap_or(size);
        graph.coordinates.iter_mut().for_each(|at| at.dof = place(at.dof) as u32);
        let compliance = FacetCompliance::all(space, model, |point| place(point.unknown));
        Self {
            graph,
            dofs,
            triangle: Vec::new(),
            schur: vec![0.0; size * size],
            scale: 1.0,
            load: vec![0.0; size],
            moved: vec![0.0; size],
            matrix: vec![0.0; size * size],
            tangent: DenseCholesky::new(size),
            last: TangentOf::default(),
            increments: vec![0.0; size],
            compliance,
            unknowns: vec![0.0; size + 1],
            state: StepState::default(),
            scratch: Scratch::default(),
        }
    }

    /// Takes L₂₂, and S = L₂₂ L₂₂ᵀ of it.
    fn set_triangle(&mut self, triangle: Vec<f64>) {
        let size = self.dofs.len();
        self.schur.fill(0.0);
        for (k, column) in triangle.chunks_exact(size.max(1)).enumerate() {
            for j in k..size {
                axpy(column[j], &column[k..], &mut self.schur[size * j + k..size * (j + 1)]);
            }
        }
        self.triangle = triangle;
        self.last.made = None;
    }

    /// `out` ← L₂₂ᵀ x.
    fn times_transpose(&self, x: &[f64], out: &mut [f64]) {
        for (k, column) in self.triangle.chunks_exact(self.dofs.len().max(1)).enumerate() {
            out[k] = dot(&column[k..], &x[k..]);
        }
    }

    /// Takes s u°₂ into `moved`, with the other sign, and its forces.
    fn take_free(&mut self, free: &[f64]) {
        self.moved.iter_mut().zip(&self.dofs).for_each(|(x, &dof)| *x = -free[dof as usize]);
        self.load.fill(0.0);
        for (x, column) in self.moved.iter().zip(self.schur.chunks_exact(self.dofs.len().max(1))) {
            axpy(-x, column, &mut self.load);
        }
    }

    /// Solves with s u° in `free`; the start value and the pressures are those of the volume.
    fn solve(
        &mut self,
        newton: &Newton,
        scale: f64,
        free: &[f64],
        of_volume: &mut StepState,
    ) -> Result<StepInfo, StepError> {
        self.scale = scale;
        self.take_free(free);
        let mut state = std::mem::take(&mut self.state);
        let mut scratch = std::mem::take(&mut self.scratch);
        state.u.clear();
        state.u.extend(self.dofs.iter().map(|&dof| of_volume.u[dof as usize]));
        state.pressure.clone_from(&of_volume.pressure);
        let outcome = newton.solve(self, &mut state, &mut scratch);
        of_volume.pressure.clone_from(&state.pressure);
        axpy(scale, &state.u, &mut self.moved);
        (self.state, self.scratch) = (state, scratch);
        outcome
    }

    /// Solves with the last tangent and 𝒜⁻¹ of a force in `free`; Γ3 is free before the first tangent.
    fn correct(&mut self, free: &[f64]) {
        self.take_free(free);
        if self.last.made.is_none() {
            self.moved.fill(0.0);
            return;
        }
        let mut change = self.load.clone();
        for (at, _) in self.graph.coordinates.iter().zip(&self.last.prescribed).filter(|p| *p.1) {
            change[at.dof as usize] = 0.0;
        }
        self.tangent.solve(&mut change);
        axpy(self.scale, &change, &mut self.moved);
    }

    fn factorize(&mut self) -> Result<(), FactorError> {
        let (size, matrix) = (self.dofs.len(), &mut self.matrix);
        matrix.iter_mut().zip(&self.schur).for_each(|(value, s)| *value = self.scale * s);
        for compliance in &self.compliance {
            compliance.each_tangent(&self.unknowns, |[i, j], value| {
                matrix[size * i + j] += value;
                if i != j {
                    matrix[size * j + i] += value;
                }
            });
        }
        let TangentOf { slopes, prescribed, .. } = &self.last;
        for (at, slope) in self.graph.coordinates.iter().zip(slopes) {
            matrix[(size + 1) * at.dof as usize] += slope;
        }
        let indefinite = |dof| FactorError::NotPositiveDefinite { dof };
        let outcome = self.tangent.factorize(|values| {
            values.copy_from_slice(matrix);
            for (at, _) in self.graph.coordinates.iter().zip(prescribed).filter(|(_, held)| **held)
            {
                let i = at.dof as usize;
                (0..i).for_each(|j| values[size * j + i] = 0.0);
                values[size * i..size * (i + 1)].fill(0.0);
                values[size * i + i] = 1.0;
            }
        });
        outcome.map_err(|error| match error {
            FactorError::NotPositiveDefinite { dof } => indefinite(self.dofs[dof] as usize),
            other => other,
        })
    }
}

impl StepInequality for Side<'_> {
    fn dofs(&self) -> usize {
        self.dofs.len()
    }

    fn graph(&self) -> &BoundaryGraph {
        &self.graph
    }

    fn descent(&self, i: usize) -> f64 {
        let facets = self.compliance.iter().map(FacetCompliance::descent).fold(0.0, f64::max);
        self.graph.descent(i).max(facets)
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        out.iter_mut().zip(&self.load).for_each(|(value, load)| *value = -load);
        let columns = self.schur.chunks_exact(u.len().max(1));
        for (column, u) in columns.zip(u) {
            axpy(self.scale * u, column, out);
        }
        for compliance in &self.compliance {
            self.unknowns[..u.len()].copy_from_slice(u);
            compliance.add_force(&self.unknowns, out);
        }
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        self.increments.fill(0.0);
        for (at, increment) in self.graph.coordinates.iter().zip(prescribed) {
            self.increments[at.dof as usize] = increment.unwrap_or(0.0);
        }
        if !self.last.replace(&self.scale, slopes, prescribed) && self.compliance.is_empty() {
            return Ok(());
        }
        self.factorize().inspect_err(|_| self.last.made = None)
    }

    fn solve(&mut self, rhs: &mut [f64], _: f64) -> Result<(), FactorError> {
        let size = self.dofs.len();
        for (j, increment) in self.increments.iter().enumerate().filter(|(_, d)| **d != 0.0) {
            axpy(-increment, &self.matrix[size * j..size * (j + 1)], rhs);
        }
        for (at, held) in self.graph.coordinates.iter().zip(&self.last.prescribed) {
            if *held {
                rhs[at.dof as usize] = self.increments[at.dof as usize];
            }
        }
        self.tangent.solve(rhs);
        Ok(())
    }

    /// As in the volume, on Γ3 alone: the condensed forces are no larger than those they are made of.
    fn force_scale(&self, u: &[f64]) -> f64 {
        let size = self.dofs.len();
        let product = |(i, u): (usize, &f64)| self.schur[size * i + i] * u;
        let products = root_of_squares(|scale| {
            u.iter().enumerate().map(product).map(|f| (scale * f).powi(2)).sum()
        });
        self.scale * products + norm(&self.load)
    }

    fn add_rounding(&self, state: &StepState, sizes: &mut [f64]) {
        self.graph.add_rounding(state, sizes);
        for compliance in &self.compliance {
            compliance.add_rounding(&state.u, sizes);
        }
    }
}
