//! Linear scenes without memory or with ℬ₀ = β𝒜 whose load separates in time, F(t) = Σ a_i(t) F_i: one solve for each
//! F_i, and no volume operation a step beyond sums of a few vectors, see [`Combination`].

use std::time::Instant;

use super::case::{CaseError, CaseInfo, KKT_ALLOWED, Observer, failed};
use super::combination::Combination;
use super::kkt::kkt_residual_in;
use super::shown::Shown;
use super::taken::of_memory;
use super::volume::Volume;
use super::{Discretization, LinearSolver, Load, Model, Unknowns};
use algebra::linalg::{FactorError, axpy, norm};
use vhi::history::{Accumulated, Memory, TimeGrid, TimeRule};
use vhi::law::{Convolution, MemoryKernel};

/// Solves all steps of a linear case, whose load has a basis, and shows each to `observe`.
///
/// # Errors
/// As [`super::march`]; 1 + β w b(0) ≤ 0 is reported as a tangent that is not positive definite.
pub fn march(
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
    load: &mut dyn Load,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let mut info = CaseInfo::default();
    let rule = model.time_rule.as_ref();
    let solved = solutions(space, model, grid, load.basis().unwrap_or_default());
    let (mut volume, solutions) = solved.map_err(|source| failed(0, grid.time(0), source))?;
    let combination = Combination::new(space, model, &solutions);
    let few = solutions.len();
    let [mut factors, mut coefficients, mut past] = [(); 3].map(|()| vec![0.0; few]);
    let mut memory = Remembered::new(model, volume.beta.unwrap_or(0.0), grid, few);
    if let Some(remembered) = &memory {
        info.paths.insert(of_memory(&remembered.memory, grid));
    }
    let (mut force, mut shown) = (vec![0.0; space.dofs()], Shown::new(space, model));
    let mut history = vec![vec![0.0; space.nodes.len()]; model.memory.len()];
    let mut accumulated = Accumulated::default();
    let mut seconds = 0.0;
    for n in 0..=grid.steps() {
        let t = grid.time(n);
        let start = Instant::now();
        load.factors(t, &mut factors);
        coefficients.copy_from_slice(&factors);
        if let Some(remembered) = &mut memory {
            let solved = remembered.solve(rule, grid, n, [&mut coefficients, &mut past]);
            solved.map_err(|source| failed(n, t, source))?;
            info.peak_history_bytes = info.peak_history_bytes.max(remembered.memory.bytes());
        }
        combination.combine(&coefficients, &mut shown.nodal);
        history.iter_mut().for_each(|history| combination.combine(&past, history));
        let strain_norm = combination.strain_norm(space, &coefficients, &shown.nodal);
        accumulated.commit(grid, strain_norm);
        seconds += start.elapsed().as_secs_f64();
        info.newton_iterations += 1;
        let zeta = accumulated.value(rule, grid);
        let view = shown.view((n, t), &history, [zeta, strain_norm]);
        let parts = load.basis().unwrap_or_default();
        let mut residual = combination.kkt_residual(space, [&coefficients, &past], &factors, parts);
        // The last level is balanced by the load itself; one that is no number is said first, and one that would be refused
        // is looked at again.
        if n == grid.steps() || residual.is_nan() || residual > KKT_ALLOWED {
            let start = Instant::now();
            load.assemble(t, &mut force)?;
            info.seconds_load += start.elapsed().as_secs_f64();
            residual = kkt_residual_in(space, model, &view, &force, &mut Vec::new());
        }
        info.accept(&view, residual)?;
        observe(&view)?;
    }
    let size = norm(&force);
    info.floors =
        volume.floors(force, (size, 0.0), [&shown.nodal, &shown.nodal], &history, (0, None));
    info.work = volume.work();
    info.work.linear.seconds_solve += seconds;
    Ok(info)
}

/// K⁻¹F_i of all parts of the load, and what solved them.
fn solutions<'a>(
    space: &'a Discretization,
    model: &'a Model,
    grid: &TimeGrid,
    parts: &[Vec<f64>],
) -> Result<(Volume<'a>, Vec<Vec<f64>>), FactorError> {
    let solver = LinearSolver::of(space, model, grid.steps());
    let mut volume = Volume::new(space, model, solver, Unknowns::Displacements, grid.is_uniform())?;
    volume.set(&[])?;
    let mut solutions = parts.to_vec();
    for vector in &mut solutions {
        volume.solve(vector)?;
    }
    Ok((volume, solutions))
}

/// The memory of the coefficients: that of a multiple β of the elasticity.
struct Remembered<'a> {
    kernel: &'a dyn MemoryKernel,
    beta: f64,
    memory: Memory,
}

impl<'a> Remembered<'a> {
    /// For `few` coefficients; nothing where the model has no memory, which has one term else.
    fn new(model: &'a Model, beta: f64, grid: &TimeGrid, few: usize) -> Option<Self> {
        let kernel = &*model.memory.first()?.kernel;
        let memory = Memory::new(kernel, model.time_rule.as_ref(), grid, few);
        Some(Self { kernel, beta, memory })
    }

    /// Turns the factors of the load at level n into coefficients c_n, (1 + β w_nn b(0)) c_n = a_n − β Σ_{j<n} …, and
    /// gives the history with c_n in it.
    fn solve(
        &mut self,
        rule: &dyn TimeRule,
        grid: &TimeGrid,
        n: usize,
        [coefficients, history]: [&mut Vec<f64>; 2],
    ) -> Result<(), FactorError> {
        let last_weight = rule.kernel_weight(&Convolution(self.kernel), grid, n, n);
        let scale = 1.0 + self.beta * last_weight;
        if scale.is_nan() || scale <= 0.0 {
            return Err(FactorError::NotPositiveDefinite { dof: 0 });
        }
        self.memory.past(self.kernel, rule, grid, history);
        for (value, past) in coefficients.iter_mut().zip(&*history) {
            *value = (*value - self.beta * past) / scale;
        }
        self.memory.commit(grid, coefficients);
        axpy(last_weight, coefficients, history);
        Ok(())
    }
}
