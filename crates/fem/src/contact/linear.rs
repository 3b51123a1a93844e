//! Linear scenes without memory or with ℬ₀ = β𝒜: one factorization, and no volume operation a step
//! beyond vector sums where the load separates in time.
//!
//! K u_n + β K (past_n + w b(0) u_n) = F_n, so u_n = (K⁻¹F_n - β past_n)/(1 + β w b(0)).

use std::time::Instant;

use super::combination::Combination;
use super::floor::Accepted;
use super::inverse::Inverse;
use super::kkt::kkt_residual_in;
use super::march::{CaseError, CaseInfo, Observer, StepView};
use super::path::of_storage;
use super::{Discretization, Floors, LinearSolver, Load, Model};
use crate::space::strain_of;
use algebra::linalg::{FactorError, axpy, is_sound_sum, root_of_squares};
use algebra::tensor::contract;
use vhi::history::{Accumulated, Memory, TimeGrid};
use vhi::law::{Convolution, Projection};
use vhi::{FailedStep, Newton, StepError};

/// K⁻¹F(t): a solve a step, or a sum of few solutions.
struct Response<'a> {
    inverse: Inverse<'a>,
    /// K⁻¹F_i where F = Σ a_i(t) F_i.
    basis: Option<Vec<Vec<f64>>>,
}

/// Solves all steps of a linear case and shows each to `observe`.
///
/// # Errors
/// As [`super::march`]; 1 + β w b(0) ≤ 0 is reported as a tangent that is not positive definite.
pub fn march<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    grid: &TimeGrid,
    load: &mut dyn Load,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let mut info = CaseInfo::default();
    let rule = model.time_rule.as_ref();
    let dofs = space.dofs();
    let beta = multiple(model);
    // One term at most: `march` sends no other scene here.
    let kernel = model.memory.first().map(|term| &*term.kernel);
    let solver = LinearSolver::of(space, model, grid.steps());
    let mut response = Response::new(space, model, solver, load)?;
    let seconds_basis = response.inverse.work().linear.seconds_solve;
    // The solutions that all levels are combinations of, where the load separates.
    let combination = response.basis.as_ref().map(|basis| Combination::new(space, model, basis));
    let few = response.basis.as_ref().map_or(0, Vec::len);
    let (mut past, mut coefficients) = (vec![0.0; few], vec![0.0; few]);
    let mut factors = vec![0.0; few];
    let length = if combination.is_some() { few } else { dofs };
    let mut memory = kernel.map(|kernel| Memory::new(kernel, rule, grid, length));
    if let Some(memory) = &memory {
        info.paths.insert(of_storage(memory.storage(), grid));
    }
    let (mut force, mut u) = (vec![0.0; dofs], vec![0.0; space.nodes.len()]);
    let mut history = vec![vec![0.0; space.nodes.len()]; model.memory.len()];
    let mut balance = Vec::new();
    let mut accumulated = Accumulated::default();
    let nothing = vec![0.0; space.trace.points.len()];
    for n in 0..=grid.steps() {
        let t = grid.time(n);
        let start = Instant::now();
        // A load that separates is summed for the last level alone: the others are balanced by its parts.
        let whole = combination.is_none() || n == grid.steps();
        if whole {
            load.assemble(t, &mut force)?;
        }
        load.factors(t, &mut factors);
        info.seconds_load += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let implicit =
            kernel.map_or(0.0, |kernel| rule.kernel_weight(&Convolution(kernel), grid, n, n));
        let scale = 1.0 + beta * implicit;
        if scale.is_nan() || scale <= 0.0 {
            return Err(failed(n, t, FactorError::NotPositiveDefinite { dof: 0 }).into());
        }
        match &combination {
            Some(_) => coefficients.copy_from_slice(&factors),
            None => {
                u[..dofs].copy_from_slice(&force);
                let solved = response.inverse.solve(&mut u[..dofs]);
                solved.map_err(|source| failed(n, t, source))?;
            }
        }
        if let (Some(memory), Some(kernel), Some(history)) =
            (&mut memory, kernel, history.first_mut())
        {
            let (past, now) = match &combination {
                Some(_) => (&mut past[..], &mut coefficients[..]),
                None => (&mut history[..dofs], &mut u[..dofs]),
            };
            memory.past(kernel, rule, grid, past);
            for (value, past) in now.iter_mut().zip(past.iter()) {
                *value = (*value - beta * past) / scale;
            }
            memory.commit(grid, now);
            axpy(implicit, now, past);
            info.peak_history_bytes = info.peak_history_bytes.max(memory.bytes());
        }
        let strain_norm = match &combination {
            Some(combination) => {
                combination.combine(&coefficients, &mut u);
                if let Some(history) = history.first_mut() {
                    combination.combine(&past, history);
                }
                combination.strain_norm(space, &coefficients, &u)
            }
            None => strain_norm(space, &u),
        };
        accumulated.commit(grid, strain_norm);
        info.work.linear.seconds_solve += start.elapsed().as_secs_f64();
        info.newton_iterations += 1;
        let view = StepView {
            n,
            t,
            u: &u,
            history: &history,
            zeta: accumulated.value(),
            kappa: f64::INFINITY,
            strain_norm,
            compliance: &nothing,
            multiplier: &nothing,
        };
        let residual = match &combination {
            Some(combination) if !whole => {
                let parts = load.basis().unwrap_or_default();
                combination.kkt_residual(space, [&coefficients, &past], &factors, parts)
            }
            _ => kkt_residual_in(space, model, &view, &force, &mut balance),
        };
        if !residual.is_finite() {
            // A load that is no number is said first.
            load.assemble(t, &mut force)?;
        }
        info.accept(&view, residual)?;
        observe(&view)?;
    }
    info.floors = response.floors(space, model, &force, &u, &history);
    let seconds_solve = seconds_basis + info.work.linear.seconds_solve;
    info.work = response.inverse.work();
    info.work.linear.seconds_solve = seconds_solve;
    Ok(info)
}

/// β; `march` sends no scene here that has none.
fn multiple<P: Projection>(model: &Model<P>) -> f64 {
    model.memory_multiple().expect("the memory of a recursion is a multiple")
}

fn failed(n: usize, t: f64, source: FactorError) -> FailedStep {
    FailedStep { n, t, source: StepError::Factor { iteration: 0, source } }
}

impl<'a> Response<'a> {
    fn new<P: Projection>(
        space: &'a Discretization,
        model: &Model<P>,
        solver: LinearSolver,
        load: &dyn Load,
    ) -> Result<Self, CaseError> {
        let at_start = |source| failed(0, 0.0, source);
        let mut inverse = Inverse::new(space, solver, &model.elasticity).map_err(at_start)?;
        let mut basis = load.basis().map(<[Vec<f64>]>::to_vec);
        for vector in basis.iter_mut().flatten() {
            inverse.solve(vector).map_err(at_start)?;
        }
        Ok(Self { inverse, basis })
    }

    /// Floors from the correction that one more solve at the last step would make.
    fn floors<P: Projection>(
        &mut self,
        space: &Discretization,
        model: &Model<P>,
        force: &[f64],
        u: &[f64],
        history: &[Vec<f64>],
    ) -> Floors {
        let beta = multiple(model);
        let mut combined = u[..space.dofs()].to_vec();
        if let Some(history) = history.first() {
            axpy(beta, &history[..space.dofs()], &mut combined);
        }
        let mut delta = vec![0.0; space.nodes.len()];
        let stiffness = self.inverse.values();
        space.pattern.multiply(stiffness, &combined, &mut delta[..space.dofs()]);
        for (target, force) in delta.iter_mut().zip(force) {
            *target = force - *target;
        }
        // What the tolerance of Newton's method would be: this solve meets it without being asked.
        let diagonal =
            (0..space.dofs()).map(|i| stiffness[space.pattern.diagonal(i)] * combined[i]);
        let scale =
            algebra::linalg::norm(&diagonal.collect::<Vec<f64>>()) + algebra::linalg::norm(force);
        let tolerance = Newton::default().rounding_units * f64::EPSILON * scale;
        let accepted = Accepted { residual: algebra::linalg::norm(&delta), tolerance };
        self.inverse.estimate(&mut delta[..space.dofs()]);
        let largest = model.elasticity.eigenvalues(space.mesh.dimension).1;
        Floors::new(space, &delta, u, accepted, largest)
    }
}

/// ‖ε(v)‖ of a nodal vector.
pub fn strain_norm(space: &Discretization, v: &[f64]) -> f64 {
    fn sum<const S: usize>(space: &Discretization, v: &[f64], scale: f64) -> f64 {
        let cell = |c| {
            let strain = strain_of::<S>(space.geometry.gradients(c), space.cell_nodes(c), v);
            let scaled = strain.map(|e| scale * e);
            space.geometry.measure[c] * contract(&scaled, &scaled)
        };
        (0..space.mesh.cell_count()).map(cell).sum()
    }
    root_of_squares(|scale| match space.mesh.dimension {
        2 => sum::<3>(space, v, scale),
        _ => sum::<6>(space, v, scale),
    })
}

/// ‖ε(v)‖ from its square, or anew where squares of these strains leave the range of doubles.
pub(super) fn strain_norm_from(square: f64, space: &Discretization, v: &[f64]) -> f64 {
    if is_sound_sum(square) { square.sqrt() } else { strain_norm(space, v) }
}
