//! One time level of Problem 14 as a [`StepInequality`].
//!
//! F(u) = ∫ σ:ε(v) - F_n(v) [+ compliance on facets], with
//! σ = (𝒜 + W ℬ₀) ε(u) + μ(ε - P_{κ(ζ)}ε), ζ = ζ_past + w‖ε(u)‖, with w = w_nn and W = w_nn b(0) the
//! weights of the last slot ([`LastSlot`]); the memory of the past is part of the load. The Jacobian is K + a bᵀ: K sparse and symmetric, and
//! a rank-one piece from ζ(u), a = w κ'(ζ) ∫ ∂σ/∂κ : ε(v), b = ∂‖ε(u)‖/∂u.

use std::sync::Arc;
use std::time::Instant;

use super::assembly::{ROOM, point_stiffness, stress_force};
use super::boundary::{boundary_graph, set_gaps};
use super::compliance::FacetCompliance;
use super::condensed::Condensed;
use super::friction::Following;
use super::last_slot::{LastSlot, TangentOf};
use super::nodal_norms::{strain_norm, strain_norm_from};
use super::{Discretization, Model, Work};
use algebra::in_dimension;
use algebra::linalg::{
    FactorError, Jacobian, LinearWork, RankOne, TangentSolver, axpy, norm, root_of_squares,
};
use algebra::tensor::contract;
use vhi::law::{Projection, TensorField};
use vhi::{BoundaryGraph, Newton, StepError, StepInequality, StepInfo, StepState};

/// The contact problem on one mesh, at one time level after another.
pub struct ContactProblem<'a> {
    pub(super) space: &'a Discretization,
    pub(super) model: &'a Model,
    pub(super) graph: BoundaryGraph,
    compliance: Vec<FacetCompliance<'a>>,
    /// Positions of the rows and columns of the graph coordinates in the tangent.
    couplings: Vec<Vec<(u32, u32)>>,
    /// Stiffness of 𝒜 and of each ℬ₀.
    elastic: Arc<Vec<f64>>,
    memory: Vec<Vec<f64>>,
    /// 𝒜 + Σ W ℬ₀ as a law and as matrix values.
    linear_law: TensorField,
    /// 𝒜, as full as the terms of the memory: to it they are added in the memory that is there.
    elasticity: TensorField,
    linear: Vec<f64>,
    solver: TangentSolver<'a>,
    /// Where Γ3 is all that is nonlinear.
    condensed: Option<Condensed<'a>>,
    /// The open level was solved so: a solver may also take it in the volume.
    pub(super) by_condensation: bool,
    pub(super) jacobian: Jacobian,
    /// What the last tangent was made of.
    last: TangentOf<LastSlot>,
    /// Load minus memory of the past.
    load: Vec<f64>,
    /// s u° of the open level, if it is known before its solve, and room for it.
    free: Vec<f64>,
    free_is_known: bool,
    /// The unknowns padded to all nodes; the displacements, where they differ; forces on all nodes.
    pub(super) unknowns: Vec<f64>,
    cartesian: Vec<f64>,
    nodal_force: Vec<f64>,
    strains: Vec<f64>,
    past_zeta: f64,
    slot: LastSlot,
    strain_norm: f64,
    /// Increments of the unknowns that the Jacobian holds, and what they move to the right side (dof, value).
    increments: Vec<f64>,
    pub(super) lifted: Vec<(usize, f64)>,
    pub(super) following: Following,
    work: Work,
}

impl<'a> ContactProblem<'a> {
    /// The problem of `model` on `space`, before the first time level.
    ///
    /// # Errors
    /// The pattern cannot be analysed, or 𝒜 is not positive definite.
    pub fn new(space: &'a Discretization, model: &'a Model) -> Result<Self, FactorError> {
        let mut work = Work::default();
        let condensed = Condensed::new(space, model, &mut work)?;
        let elastic = match &condensed {
            Some(condensed) => condensed.elastic.clone(),
            None => Arc::new(space.stiffness_of_unknowns(&model.elasticity)),
        };
        let terms = model.memory.iter();
        let memory = terms.map(|term| space.stiffness_of_unknowns(&term.tensor)).collect();
        let graph = boundary_graph(space, model, &elastic);
        let compliance = FacetCompliance::all(space, model, |point| point.unknown as usize);
        let dofs: Vec<u32> = graph.coordinates.iter().map(|at| at.dof).collect();
        let couplings = if dofs.is_empty() { Vec::new() } else { space.pattern.couplings(&dofs) };
        let d = space.mesh.dimension;
        let elasticity = model
            .memory
            .iter()
            .fold(model.elasticity.clone(), |sum, term| sum.plus(0.0, &term.tensor, d));
        Ok(Self {
            solver: TangentSolver::new(space.analysis()?, &space.pattern),
            condensed,
            by_condensation: false,
            jacobian: Jacobian::default(),
            last: TangentOf::default(),
            linear_law: elasticity.clone(),
            elasticity,
            linear: elastic.to_vec(),
            elastic,
            memory,
            load: vec![0.0; space.dofs()],
            free: Vec::new(),
            free_is_known: false,
            unknowns: vec![0.0; space.nodes.len()],
            cartesian: vec![0.0; if space.frames.is_empty() { 0 } else { space.nodes.len() }],
            nodal_force: vec![0.0; space.nodes.len()],
            strains: vec![0.0; d * (d + 1) / 2 * space.geometry.points()],
            past_zeta: 0.0,
            slot: LastSlot::default(),
            strain_norm: 0.0,
            increments: Vec::new(),
            lifted: Vec::new(),
            following: Following::default(),
            work,
            space,
            model,
            graph,
            compliance,
            couplings,
        })
    }

    /// Sets what Γ3 has at time t: gaps and the factors of friction.
    pub fn set_time(&mut self, t: f64) {
        set_gaps(self.space, self.model, t, &mut self.graph);
        if let Some(condensed) = &mut self.condensed {
            condensed.set_gaps(self.model, t);
        }
        self.set_friction(t);
    }

    /// Opens a time level: weights of the last slot, the sum ζ_past, the load F_n (Cartesian), and the
    /// history vectors Σ_{j<n} w_nj b(t_n - t_j) u_j (of unknowns) of each term of the memory.
    /// They may be padded to all nodes.
    pub fn begin(&mut self, slot: &LastSlot, past_zeta: f64, load: &[f64], past: &[Vec<f64>]) {
        let start = Instant::now();
        self.free_is_known = false;
        self.load.copy_from_slice(load);
        self.space.frames.force_on_unknowns(&mut self.load);
        for (past, memory) in past.iter().zip(&self.memory) {
            let force = &mut self.nodal_force[..load.len()];
            self.space.pattern.multiply(memory, past, force);
            axpy(-1.0, force, &mut self.load);
        }
        self.past_zeta = past_zeta;
        self.by_condensation = false;
        let changed = slot.memory != self.slot.memory;
        self.slot.clone_from(slot);
        if changed {
            self.set_linear_part();
        }
        self.work.seconds_assemble += start.elapsed().as_secs_f64();
    }

    fn set_linear_part(&mut self) {
        self.linear_law.clone_from(&self.elasticity);
        self.linear.copy_from_slice(&self.elastic);
        let d = self.space.mesh.dimension;
        let terms = self.model.memory.iter().zip(&self.memory).zip(&self.slot.memory);
        for ((term, stiffness), &scale) in terms {
            self.linear_law.add(scale, &term.tensor, d);
            axpy(scale, stiffness, &mut self.linear);
        }
    }

    /// ‖ε(u)‖ at the last evaluated u.
    pub fn strain_norm(&self) -> f64 {
        self.strain_norm
    }

    /// ζ at the last evaluated u.
    pub(crate) fn zeta(&self) -> f64 {
        self.past_zeta + self.slot.zeta * self.strain_norm
    }

    /// Subtracts the forces Σ W ℬ₀ x of the memory with these weights.
    pub(super) fn subtract_memory(&self, weights: &[f64], x: &[f64], force: &mut [f64]) {
        let mut product = vec![0.0; x.len()];
        for (memory, &weight) in self.memory.iter().zip(weights) {
            self.space.pattern.multiply(memory, x, &mut product);
            axpy(-weight, &product, force);
        }
    }

    /// Takes 𝒜⁻¹ F_n of the level that was just opened, and the history vectors it was opened with.
    pub(crate) fn take_solved(&mut self, solved: &[f64], past: &[Vec<f64>]) {
        let Some(beta) = self.condensed.as_ref().and_then(Condensed::beta) else { return };
        self.free_is_known = true;
        self.free.clear();
        self.free.extend_from_slice(solved);
        for past in past {
            axpy(-beta, &past[..solved.len()], &mut self.free);
        }
    }

    /// Whether one matrix serves all levels, so that loads can be solved with ahead of them.
    pub(crate) fn solves_ahead(&self) -> bool {
        self.condensed.as_ref().is_some_and(|condensed| condensed.beta().is_some())
    }

    /// 𝒜⁻¹ of loads (Cartesian), one after another, where [`Self::solves_ahead`].
    pub(crate) fn solve_ahead(&mut self, loads: &mut [f64]) {
        let Some(condensed) = &mut self.condensed else { return };
        for load in loads.chunks_exact_mut(self.load.len().max(1)) {
            self.space.frames.force_on_unknowns(load);
        }
        condensed.solve_free(loads);
    }

    /// Solves the open level condensed onto Γ3, where that is the plan.
    pub(crate) fn solve_condensed(
        &mut self,
        newton: &Newton,
        state: &mut StepState,
    ) -> Option<Result<StepInfo, StepError>> {
        let condensed = self.condensed.as_mut()?;
        self.by_condensation = true;
        if let Err(source) = condensed.set(&self.linear, &self.slot.memory) {
            return Some(Err(StepError::Factor { iteration: 0, source }));
        }
        if !self.free_is_known {
            self.free.clone_from(&self.load);
            condensed.solve_free(&mut self.free);
        }
        let outcome = condensed.solve(newton, &self.free, state);
        self.take(&state.u);
        self.strain_norm = strain_norm(self.space, self.displacements());
        Some(outcome)
    }

    /// The forces that a condensed level leaves unbalanced.
    pub(crate) fn unbalanced(&self, state: &StepState) -> Vec<f64> {
        let mut force = vec![0.0; state.u.len()];
        self.space.pattern.multiply(&self.linear, &state.u, &mut force);
        for compliance in &self.compliance {
            compliance.add_force(&self.unknowns, &mut force);
        }
        for (at, pressure) in self.graph.coordinates.iter().zip(&state.pressure) {
            force[at.dof as usize] += at.sign * at.weight * pressure;
        }
        self.load.iter().zip(force).map(|(load, force)| load - force).collect()
    }

    /// What a force would change in the last level, in place, by its last factor; the force is left as it is before the
    /// first factorization (a scene at rest).
    pub(crate) fn solve_with_last_factor(&mut self, rhs: &mut [f64]) {
        match &mut self.condensed {
            Some(condensed) if self.by_condensation => condensed.correct(rhs),
            _ => self.solver.solve_with_last_factor(rhs),
        }
    }

    pub(crate) fn work(&self) -> Work {
        let condensed = self.condensed.as_ref().map_or_else(LinearWork::default, |c| c.work);
        let linear = self.work.linear.plus(&condensed).plus(&self.solver.work());
        Work { linear, ..self.work }
    }

    fn take(&mut self, u: &[f64]) {
        self.unknowns[..u.len()].copy_from_slice(u);
        if !self.space.frames.is_empty() {
            self.cartesian.copy_from_slice(&self.unknowns);
            self.space.frames.to_cartesian(&mut self.cartesian);
        }
    }

    /// The displacements as a nodal vector.
    fn displacements(&self) -> &[f64] {
        if self.space.frames.is_empty() { &self.unknowns } else { &self.cartesian }
    }

    fn force<const D: usize, const S: usize>(&mut self, out: &mut [f64]) {
        let mut sum = 0.0;
        for at in self.space.points() {
            let strain = at.strain::<S>(self.displacements());
            self.strains[S * at.index..S * (at.index + 1)].copy_from_slice(&strain);
            sum += at.weight * contract(&strain, &strain);
        }
        self.strain_norm = strain_norm_from(sum, self.space, self.displacements());
        let projection = &self.model.projection;
        let kappa = projection.limit().map(|limit| limit.value(self.zeta()));
        self.nodal_force.fill(0.0);
        for at in self.space.points() {
            let strain = self.strain_at::<S>(at.index);
            let mut stress = self.linear_law.on(self.space.region(at.cell)).apply(&strain);
            if let Some(extra) = kappa.and_then(|kappa| projection.stress(&strain, kappa)) {
                stress.iter_mut().zip(extra).for_each(|(stress, value)| *stress += value);
            }
            let stress = stress.map(|s| at.weight * s);
            stress_force::<D, S>(at.gradients, at.nodes, &stress, &mut self.nodal_force);
        }
        self.space.frames.force_on_unknowns(&mut self.nodal_force);
        out.copy_from_slice(&self.nodal_force[..out.len()]);
    }

    fn strain_at<const S: usize>(&self, p: usize) -> [f64; S] {
        self.strains[S * p..S * (p + 1)].try_into().expect("S components")
    }

    /// Adds the generalized derivative of the projection to the tangent; returns the rank-one piece, in `room`.
    fn projected_tangent<const D: usize, const S: usize>(
        &self,
        tangent: &mut [f64],
        room: RankOne,
    ) -> Option<RankOne> {
        let limit = self.model.projection.limit()?;
        let zeta = self.zeta();
        let (kappa, slope) = (limit.value(zeta), limit.slope(zeta));
        let coupled = slope != 0.0 && self.slot.zeta != 0.0 && self.strain_norm > 0.0;
        let RankOne { mut a, mut b } = room;
        if coupled {
            for vector in [&mut a, &mut b] {
                vector.clear();
                vector.resize(self.space.nodes.len(), 0.0);
            }
        }
        let mut local = [0.0; ROOM];
        for at in self.space.points() {
            let strain = self.strain_at::<S>(at.index);
            if let Some(response) = self.model.projection.response(&strain, kappa) {
                let local = point_stiffness::<D, S>(&at, &response.tangent, &mut local);
                self.space.frames.rotate_cell(at.nodes, local);
                self.space.pattern.scatter::<D>(at.cell, at.nodes, local, tangent);
                if coupled {
                    let scale = self.slot.zeta * slope * at.weight;
                    let stress = response.by_limit.map(|s| scale * s);
                    stress_force::<D, S>(at.gradients, at.nodes, &stress, &mut a);
                }
            }
            if coupled {
                let stress = strain.map(|e| at.weight * e / self.strain_norm);
                stress_force::<D, S>(at.gradients, at.nodes, &stress, &mut b);
            }
        }
        coupled.then(|| {
            self.space.frames.force_on_unknowns(&mut a);
            self.space.frames.force_on_unknowns(&mut b);
            a.truncate(self.space.dofs());
            b.truncate(self.space.dofs());
            RankOne { a, b }
        })
    }

    /// Replaces the rows and columns of prescribed coordinates by the identity, and notes what their
    /// increments move to the right side.
    fn prescribe(&mut self, prescribed: &[Option<f64>]) {
        let Jacobian { values, rank_one, held, .. } = &mut self.jacobian;
        held.clear();
        self.increments.clear();
        self.lifted.clear();
        for (i, increment) in prescribed.iter().enumerate() {
            let Some(increment) = *increment else { continue };
            for &(other, position) in &self.couplings[i] {
                let value = std::mem::take(&mut values[position as usize]);
                if increment != 0.0 {
                    self.lifted.push((other as usize, value * increment));
                }
            }
            // The diagonal stays: any positive number serves, and this one fits its neighbours.
            held.push(self.graph.coordinates[i].dof as usize);
            self.increments.push(increment);
        }
        let Some(rank_one) = rank_one else { return };
        let pairs = held.iter().zip(&self.increments);
        let moved: f64 = pairs.map(|(&dof, increment)| rank_one.b[dof] * increment).sum();
        if moved != 0.0 {
            let a = rank_one.a.iter().enumerate();
            self.lifted.extend(a.map(|(dof, a)| (dof, moved * a)));
        }
        for &dof in &*held {
            rank_one.a[dof] = 0.0;
            rank_one.b[dof] = 0.0;
        }
    }
}

impl StepInequality for ContactProblem<'_> {
    fn dofs(&self) -> usize {
        self.space.dofs()
    }

    fn graph(&self) -> &BoundaryGraph {
        &self.graph
    }

    fn descent(&self, i: usize) -> f64 {
        let facets = self.compliance.iter().map(FacetCompliance::descent).fold(0.0, f64::max);
        self.graph.descent(i).max(facets)
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        let start = Instant::now();
        self.take(u);
        self.follow_pressure();
        in_dimension!(self.space.mesh.dimension, D, S => self.force::<D, S>(out));
        for compliance in &self.compliance {
            compliance.add_force(&self.unknowns, out);
        }
        axpy(-1.0, &self.load, out);
        self.work.residuals += 1;
        self.work.seconds_assemble += start.elapsed().as_secs_f64();
    }

    fn take_pressures(&mut self, pressures: &[f64]) {
        if !self.following.factors.is_empty() {
            self.following.pressures.clear();
            self.following.pressures.extend_from_slice(pressures);
        }
    }

    fn linearize(&mut self, slopes: &[f64], prescribed: &[Option<f64>]) -> Result<(), FactorError> {
        let start = Instant::now();
        // Without projection and compliance on facets the tangent is known from slot, slopes, pins.
        let constant = self.model.projection.limit().is_none() && self.compliance.is_empty();
        let unchanged = !self.last.replace(&self.slot, slopes, prescribed) && constant;
        let mut tangent = std::mem::take(&mut self.jacobian.values);
        tangent.clone_from(&self.linear);
        let room = self.jacobian.rank_one.take().unwrap_or_default();
        self.jacobian.rank_one = in_dimension!(
            self.space.mesh.dimension, D, S => self.projected_tangent::<D, S>(&mut tangent, room)
        );
        for compliance in &self.compliance {
            let pattern = &self.space.pattern;
            let add = |at, value| pattern.add(at, value, &mut tangent);
            compliance.each_tangent(&self.unknowns, add);
        }
        for (slope, at) in slopes.iter().zip(&self.graph.coordinates) {
            tangent[self.space.pattern.diagonal(at.dof as usize)] += slope;
        }
        self.add_mixed(slopes, &mut tangent);
        self.work.tangents += u32::from(self.model.projection.limit().is_some());
        self.jacobian.values = tangent;
        self.prescribe(prescribed);
        self.couple(prescribed);
        self.work.seconds_assemble += start.elapsed().as_secs_f64();
        self.solver.prepare(&self.jacobian, unchanged)
    }

    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        for &(dof, value) in &self.lifted {
            rhs[dof] -= value;
        }
        for (&dof, increment) in self.jacobian.held.iter().zip(&self.increments) {
            let stiffness = self.jacobian.values[self.space.pattern.diagonal(dof)];
            rhs[dof] = stiffness * increment;
        }
        self.solver.solve(&self.jacobian, rhs, forcing)
    }

    fn force_scale(&self, u: &[f64]) -> f64 {
        let pattern = &self.space.pattern;
        let products = u.iter().enumerate().map(|(i, u)| self.linear[pattern.diagonal(i)] * u);
        let squares = |scale: f64| products.clone().map(|f| (scale * f) * (scale * f)).sum();
        root_of_squares(squares) + norm(&self.load)
    }

    fn add_rounding(&self, state: &StepState, sizes: &mut [f64]) {
        self.graph.add_rounding(state, sizes);
        self.add_rounding_of_friction(state, sizes);
        for compliance in &self.compliance {
            compliance.add_rounding(&state.u, sizes);
        }
    }
}
