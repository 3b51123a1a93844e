//! Linear scenes without memory or with ℬ₀ = β𝒜: one factorization, and no volume operation a step
//! beyond vector sums where the load separates in time.
//!
//! K u_n + β K (past_n + w b(0) u_n) = F_n, so u_n = (K⁻¹F_n - β past_n)/(1 + β w b(0)).

use std::time::Instant;

use super::floor::Accepted;
use super::march::{CaseError, CaseInfo, KKT_ALLOWED, Observer, StepView, measurable};
use super::problem::Work;
use super::{Discretization, Floors, Load, Model, kkt_residual};
use crate::history::{Accumulated, Memory, TimeGrid};
use crate::law::{Convolution, Projection};
use crate::linalg::{Factor, FactorError, Workspace, axpy, is_sound_sum, root_of_squares};
use crate::space::strain_of;
use crate::tensor::contract;
use crate::vhi::{FailedStep, Newton, StepError};

/// K⁻¹F(t): a solve a step, or a sum of few solutions.
struct Response {
    factor: Factor,
    workspace: Workspace,
    /// K⁻¹F_i where F = Σ a_i(t) F_i.
    basis: Option<Vec<Vec<f64>>>,
    factors: Vec<f64>,
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
    let beta = model.memory_multiple().unwrap_or(0.0);
    // One term at most: `march` sends no other scene here.
    let kernel = model.memory.first().map(|term| &*term.kernel);
    let mut memory = kernel.map(|kernel| Memory::new(kernel, rule, dofs));
    let mut response = Response::new(space, model, load, &mut info.work)?;
    let (mut force, mut u) = (vec![0.0; dofs], vec![0.0; space.nodes.len()]);
    let mut history = vec![vec![0.0; space.nodes.len()]; model.memory.len()];
    let mut accumulated = Accumulated::default();
    let nothing = vec![0.0; space.trace.points.len()];
    let mut largest = 0.0f64;
    for n in 0..=grid.steps() {
        let t = grid.time(n);
        let start = Instant::now();
        load.assemble(t, &mut force)?;
        info.seconds_load += start.elapsed().as_secs_f64();
        let start = Instant::now();
        response.at(t, load, &force, space, &mut u[..dofs], &mut info.work);
        if let (Some(memory), Some(kernel), Some(history)) =
            (&mut memory, kernel, history.first_mut())
        {
            memory.past(kernel, rule, grid, &mut history[..dofs]);
            let implicit = rule.kernel_weight(&Convolution(kernel), grid, n, n);
            let scale = 1.0 + beta * implicit;
            if scale.is_nan() || scale <= 0.0 {
                let source = FactorError::NotPositiveDefinite { dof: 0 };
                let source = StepError::Factor { iteration: 0, source };
                return Err(FailedStep { n, t, source }.into());
            }
            for (value, past) in u[..dofs].iter_mut().zip(history.iter()) {
                *value = (*value - beta * past) / scale;
            }
            memory.commit(grid, &u[..dofs]);
            axpy(implicit, &u[..dofs], &mut history[..dofs]);
            info.peak_history_bytes = info.peak_history_bytes.max(memory.bytes());
        }
        let strain_norm = strain_norm(space, &u);
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
        let residual = kkt_residual(space, model, &view, &force);
        if residual.is_nan() || residual > KKT_ALLOWED {
            return Err(CaseError::Kkt { n, t, residual, allowed: KKT_ALLOWED });
        }
        info.kkt_residual = info.kkt_residual.max(residual);
        observe(&view)?;
        largest = largest.max(strain_norm);
    }
    measurable(space, model, largest)?;
    info.floors = response.floors(space, model, &force, &u, &history);
    Ok(info)
}

impl Response {
    fn new<P: Projection>(
        space: &Discretization,
        model: &Model<P>,
        load: &dyn Load,
        work: &mut Work,
    ) -> Result<Self, CaseError> {
        let start = Instant::now();
        let stiffness = space.stiffness(&model.elasticity);
        work.seconds_assemble += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (mut factor, mut workspace) = (space.analysis.factor(), space.analysis.workspace(1));
        space.analysis.factorize(&space.pattern, &stiffness, &mut factor, &mut workspace).map_err(
            |source| FailedStep {
                n: 0,
                t: 0.0,
                source: StepError::Factor { iteration: 0, source },
            },
        )?;
        work.linear.factorizations += 1;
        work.linear.seconds_factor += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let basis = load.basis().map(|basis| {
            let mut basis = basis.to_vec();
            for vector in &mut basis {
                space.analysis.solve(&factor, vector, &mut workspace);
                work.linear.solves += 1;
            }
            basis
        });
        work.linear.seconds_solve += start.elapsed().as_secs_f64();
        let factors = vec![0.0; basis.as_ref().map_or(0, Vec::len)];
        Ok(Self { factor, workspace, basis, factors })
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
        let beta = model.memory_multiple().unwrap_or(0.0);
        let mut combined = u[..space.dofs()].to_vec();
        if let Some(history) = history.first() {
            axpy(beta, &history[..space.dofs()], &mut combined);
        }
        let mut delta = vec![0.0; space.nodes.len()];
        let stiffness = space.stiffness(&model.elasticity);
        space.pattern.multiply(&stiffness, &combined, &mut delta[..space.dofs()]);
        for (target, force) in delta.iter_mut().zip(force) {
            *target = force - *target;
        }
        // What the tolerance of Newton's method would be: this solve meets it without being asked.
        let diagonal =
            (0..space.dofs()).map(|i| stiffness[space.pattern.diagonal(i)] * combined[i]);
        let scale =
            crate::linalg::norm(&diagonal.collect::<Vec<f64>>()) + crate::linalg::norm(force);
        let tolerance = Newton::default().rounding_units * f64::EPSILON * scale;
        let accepted = Accepted { residual: crate::linalg::norm(&delta), tolerance };
        space.analysis.solve(&self.factor, &mut delta[..space.dofs()], &mut self.workspace);
        let largest = model.elasticity.eigenvalues(space.mesh.dimension).1;
        Floors::new(space, &delta, u, accepted, largest)
    }

    /// `out` ← K⁻¹F(t), where `force` is F(t).
    fn at(
        &mut self,
        t: f64,
        load: &dyn Load,
        force: &[f64],
        space: &Discretization,
        out: &mut [f64],
        work: &mut Work,
    ) {
        match &self.basis {
            Some(basis) => {
                load.factors(t, &mut self.factors);
                out.fill(0.0);
                for (vector, factor) in basis.iter().zip(&self.factors) {
                    axpy(*factor, vector, out);
                }
            }
            None => {
                out.copy_from_slice(force);
                space.analysis.solve(&self.factor, out, &mut self.workspace);
                work.linear.solves += 1;
            }
        }
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
