//! Levels with one matrix: linear scenes, and contact without projection, condensed onto Γ3.
//!
//! A level is a forward pass over the factor of K, with contact a small full problem on Γ3, and a backward pass. The
//! unknowns of Γ3 are the last of [`Discretization::condensing`], so the factor L = [L₁₁ 0; L₂₁ L₂₂] has the Schur
//! complement S = L₂₂L₂₂ᵀ.
//!
//! With ℬ₀ = β𝒜, or without memory, K is 𝒜, and v_n = (1 + βW)u_n + β past_n solves K v_n = F_n - C_n with the contact
//! forces C_n, whatever the last slot's weight W is: no pass asks for the past, and what it is on Γ3 is enough for the
//! problems there, so that passes are made for several levels together. Else K = 𝒜 + Σ W_i ℬ_i, a new one where a W_i
//! changes: once on a uniform grid; the past is a force, and each level needs the displacements of those before it. On
//! other grids an old K serves, and what it lacks at u_n is a force that passes are repeated for.

mod expansion;
mod pending;

use std::time::Instant;

pub(super) use pending::Pending;

use super::case::{CaseError, CaseInfo, Observer, failed};
use super::histories::Histories;
use super::shown::Shown;
use super::side::Side;
use super::volume::Volume;
use super::{Discretization, LinearSolver, Load, Model, Unknowns};
use algebra::linalg::{FactorError, axpy};
use vhi::history::{Accumulated, TimeGrid};
use vhi::{Extrapolation, FailedStep, Newton, StepError, StepState};

/// Passes for one level with an old matrix, beyond the first, before a new one is factored: each leaves some 1e-3 of
/// what the one before it left.
const MOST_REPEATED: u32 = 8;

/// Solves all levels and shows each to `observe`.
///
/// # Errors
/// As [`super::march`].
pub fn march(
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
    load: &mut dyn Load,
    newton: &Newton,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let unanalysed = |source| failed(0, grid.time(0), source);
    let mut march = OneMatrix::new(space, model, grid).map_err(unanalysed)?;
    for first in (0..=grid.steps()).step_by(march.pending.len()) {
        let solved = march.solve(first, load, newton);
        // What was solved is shown, also before a level that has no solution.
        march.expand(observe)?;
        solved?;
    }
    march.raise_floors();
    let of_levels = march.info.work.linear.seconds_solve;
    march.info.work = march.volume.work();
    march.info.work.linear.seconds_solve += of_levels;
    Ok(march.info)
}

fn refused(source: FactorError) -> StepError {
    StepError::Factor { iteration: 0, source }
}

struct OneMatrix<'a> {
    space: &'a Discretization,
    model: &'a Model,
    grid: &'a TimeGrid,
    info: CaseInfo,
    volume: Volume<'a>,
    /// Γ3; none in a linear scene.
    side: Option<Side<'a>>,
    histories: Histories<'a>,
    /// L₁₁⁻¹F_i where the load is Σ a_i(t) F_i and memory a multiple; the a_i.
    basis: Option<Vec<Vec<f64>>>,
    factors: Vec<f64>,
    /// The first unknown of Γ3 in the order of the factor.
    cut: usize,
    /// Levels whose passes are made together, the first `solved` of them solved on Γ3.
    pending: Vec<Pending>,
    solved: usize,
    /// The right side of one level.
    right: Vec<f64>,
    /// In the order of the factor, of each pending level: L₁₁⁻¹ of the right side, with v_n on Γ3 behind it where it is
    /// known; v_n throughout after the backward pass.
    swept: Vec<f64>,
    /// Where an old matrix may serve: displacements of the last levels, and what a pass takes for those of its levels.
    trend: Extrapolation,
    guess: StepState,
    accumulated: Accumulated,
    /// Unknowns padded to all nodes.
    u: Vec<f64>,
    shown: Shown<'a>,
    /// The pending level shown last, and the largest load whose level has set the floors.
    last: usize,
    largest_force: f64,
}

impl<'a> OneMatrix<'a> {
    fn new(
        space: &'a Discretization,
        model: &'a Model,
        grid: &'a TimeGrid,
    ) -> Result<Self, FactorError> {
        // What is condensed is a factor.
        let (solver, unknowns) = match &model.boundary {
            Some(_) => (LinearSolver::Direct, Unknowns::ContactLast),
            None => (LinearSolver::of(space, model, grid.steps()), Unknowns::Displacements),
        };
        let volume = Volume::new(space, model, solver, unknowns, grid.is_uniform())?;
        let boundary = model.boundary.as_ref();
        let side = boundary.map(|_| Side::new(space, model, grid, &volume));
        let histories = Histories::new(space, model, grid, side.is_some());
        let info = CaseInfo { paths: histories.paths(), ..CaseInfo::default() };
        let (dofs, width, terms) = (space.dofs(), volume.width(), model.memory.len());
        let guessed = if volume.serves() { dofs } else { 0 };
        Ok(Self {
            cut: dofs - side.as_ref().map_or(0, Side::size),
            histories,
            basis: None,
            factors: Vec::new(),
            pending: vec![Pending::new(dofs, terms); width],
            solved: 0,
            right: vec![0.0; dofs],
            swept: vec![0.0; dofs * width],
            trend: Extrapolation::default(),
            guess: StepState { u: vec![0.0; guessed], pressure: Vec::new() },
            accumulated: Accumulated::default(),
            u: vec![0.0; space.nodes.len()],
            shown: Shown::new(space, model),
            last: 0,
            largest_force: 0.0,
            space,
            model,
            grid,
            info,
            volume,
            side,
        })
    }

    /// Solves the pending levels from `first` on as far as Γ3; those before a failure stay solved.
    fn solve(
        &mut self,
        first: usize,
        load: &mut dyn Load,
        newton: &Newton,
    ) -> Result<(), CaseError> {
        let count = self.pending.len().min(self.grid.steps() + 1 - first);
        let (mut ready, mut late) = (0, Ok(()));
        while ready < count && late.is_ok() {
            late = self.assemble(ready, first + ready, load);
            ready += usize::from(late.is_ok());
        }
        if ready > 0 {
            self.passes(first, ready, &*load, newton)?;
        }
        late
    }

    /// Passes for the levels that are ready; with an old matrix one level is repeated until its residual is small.
    fn passes(
        &mut self,
        first: usize,
        ready: usize,
        load: &dyn Load,
        newton: &Newton,
    ) -> Result<(), CaseError> {
        let (n, t) = (first, self.grid.time(first));
        let failed = |source| FailedStep { n, t, source: refused(source) };
        let anew = self.volume.set(&self.pending[0].slot).map_err(failed)?;
        self.prepare(anew, load);
        // With a multiple the past waits for the displacements.
        if self.volume.beta.is_none() {
            self.histories.recall();
        }
        if self.volume.is_behind() {
            self.trend.start(t, &mut self.guess);
        }
        for repeated in 0.. {
            self.pass(first, ready, load, newton, repeated > 0)?;
            let behind = self.volume.is_behind();
            if !self.volume.serves() {
                break;
            }
            let solved = self.replace_guess();
            if !behind || solved {
                self.volume.count(repeated + 1);
                break;
            }
            if repeated == MOST_REPEATED {
                self.volume.renew(&self.pending[0].slot).map_err(failed)?;
                self.prepare(true, load);
                self.add_up(0, load);
            }
        }
        if self.volume.serves() {
            self.trend.keep(t, &self.guess);
        }
        if let Some(side) = self.side.as_mut().filter(|_| self.volume.is_behind()) {
            side.keep(self.grid, t);
        }
        Ok(())
    }

    /// One pass; levels before a failure are solved in any case.
    fn pass(
        &mut self,
        first: usize,
        ready: usize,
        load: &dyn Load,
        newton: &Newton,
        again: bool,
    ) -> Result<(), CaseError> {
        self.eliminate(ready, load, again);
        self.solved = 0;
        let mut outcome = Ok(());
        while self.solved < ready && outcome.is_ok() {
            let (at, n) = (self.solved, first + self.solved);
            let step = self.condensed(at, newton, again);
            outcome = step.map_err(|source| FailedStep { n, t: self.pending[at].t, source });
            self.solved += usize::from(outcome.is_ok());
        }
        let (width, n, t) = (self.pending.len(), first, self.pending[0].t);
        let volume = self.volume.backward(self.cut, width, &mut self.swept, self.solved);
        if let Err(source) = volume {
            self.solved = 0;
            return Err(FailedStep { n, t, source: refused(source) }.into());
        }
        Ok(outcome?)
    }

    /// Takes the displacements of a pass for the next one; whether they solve the level.
    fn replace_guess(&mut self) -> bool {
        for (&value, &dof) in self.swept.iter().zip(&self.volume.order) {
            self.u[dof as usize] = value;
        }
        let (dofs, force) = (self.space.dofs(), &self.pending[0].force);
        let (u, left) = (&self.u[..dofs], &mut self.shown.nodal[..dofs]);
        let solved =
            self.volume.is_behind() && self.volume.is_solved(u, &self.guess.u, force, left);
        axpy(1.0, left, &mut self.right);
        self.guess.u.copy_from_slice(u);
        solved
    }

    /// Load and weights of level n.
    fn assemble(&mut self, at: usize, n: usize, load: &mut dyn Load) -> Result<(), CaseError> {
        let (pending, t) = (&mut self.pending[at], self.grid.time(n));
        let start = Instant::now();
        load.assemble(t, &mut pending.force)?;
        self.info.seconds_load += start.elapsed().as_secs_f64();
        pending.slot.clear();
        pending.slot.extend(self.model.last_weights(self.grid, n));
        let last_weight = pending.slot.first().copied().unwrap_or(0.0);
        (pending.n, pending.t) = (n, t);
        pending.scale = 1.0 + self.volume.beta.map_or(0.0, |beta| beta * last_weight);
        Ok(())
    }

    /// What is made of a new matrix on Γ3.
    fn prepare(&mut self, anew: bool, load: &dyn Load) {
        let Some(side) = self.side.as_mut().filter(|_| anew) else { return };
        side.level.set_schur(&self.volume.last_triangle(self.cut));
        if let Some(basis) = load.basis().filter(|_| self.volume.beta.is_some()) {
            let (volume, frames, cut) = (&mut self.volume, &self.space.frames, self.cut);
            let sweep = |vector: &Vec<f64>| {
                let mut rotated = vector.clone();
                frames.force_on_unknowns(&mut rotated);
                let of_order = |&dof: &u32| rotated[dof as usize];
                let mut swept: Vec<f64> = volume.order.iter().map(of_order).collect();
                volume.forward(cut, 1, &mut swept);
                swept
            };
            self.basis = Some(basis.iter().map(sweep).collect());
            self.factors = vec![0.0; basis.len()];
        }
    }

    /// The right sides with the volume eliminated; `again` after what the last pass left was added to one.
    fn eliminate(&mut self, ready: usize, load: &dyn Load, again: bool) {
        let width = self.pending.len();
        for at in 0..ready {
            if !again {
                self.add_up(at, load);
            }
            let rows = self.swept.iter_mut().skip(at).step_by(width);
            match &self.basis {
                Some(_) => rows.zip(&self.right).for_each(|(row, value)| *row = *value),
                None => {
                    let in_order = |&dof: &u32| self.right[dof as usize];
                    rows.zip(self.volume.order.iter().map(in_order))
                        .for_each(|(row, value)| *row = value);
                }
            }
        }
        if self.basis.is_none() {
            self.volume.forward(self.cut, width, &mut self.swept);
        }
    }

    /// The right side of a pending level, eliminated where the load has a basis.
    fn add_up(&mut self, at: usize, load: &dyn Load) {
        let right = &mut self.right;
        if let Some(basis) = &self.basis {
            load.factors(self.pending[at].t, &mut self.factors);
            right.fill(0.0);
            for (vector, factor) in basis.iter().zip(&self.factors) {
                axpy(*factor, vector, right);
            }
            return;
        }
        right.copy_from_slice(&self.pending[at].force);
        if self.side.is_some() {
            self.space.frames.force_on_unknowns(right);
        }
        self.volume.subtract_memory(&self.histories.sums, right);
        if self.volume.is_behind() {
            self.volume.subtract_behind(&self.guess.u, right);
        }
    }

    /// Solves Γ3 of a pending level; without contact nothing is left to solve.
    fn condensed(&mut self, at: usize, newton: &Newton, again: bool) -> Result<(), StepError> {
        let start = Instant::now();
        let (width, pending) = (self.pending.len(), &mut self.pending[at]);
        if pending.scale.is_nan() || pending.scale <= 0.0 {
            return Err(refused(FactorError::NotPositiveDefinite { dof: 0 }));
        }
        let Some(side) = &mut self.side else {
            self.info.newton_iterations += 1;
            return Ok(());
        };
        if !again {
            side.start(pending.t);
        }
        // Without unknowns on Γ3 nothing is behind the cut.
        let rows = self.swept.get_mut(self.cut * width + at..).unwrap_or_default();
        let info = side.solve(self.model, self.grid, newton, pending, (rows, width))?;
        if !self.volume.is_behind() {
            side.keep(self.grid, pending.t);
        }
        self.info.newton_iterations += info.iterations;
        self.info.damped_iterations += info.damped;
        self.info.active_set_changes += info.active_set_changes;
        self.info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        Ok(())
    }
}
