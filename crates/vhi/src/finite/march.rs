//! The march in time in ℝ^m.

use nalgebra::DVector;

use super::{FiniteError, FiniteEvolution, FiniteLoad, FiniteModel};
use crate::history::TimeGrid;
use crate::law::graph_distance;
use crate::{Newton, OpenInequality, StepInequality, StepSolver, StepState, Stepper};
use algebra::linalg::{larger, largest};

/// One level as an observer sees it.
pub struct FiniteView<'a> {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// u_n.
    pub u: &'a DVector<f64>,
    /// S_n^k u.
    pub history: &'a DVector<f64>,
    /// ξ_i + λ_i per functional.
    pub pressure: &'a [f64],
}

/// What one case took.
#[derive(Debug, Clone, Copy, Default)]
pub struct FiniteInfo {
    /// Newton iterations over all steps; each is a factorization.
    pub newton_iterations: u32,
    /// Applications of Λ; 0 for other solvers.
    pub fixed_point_iterations: u32,
    /// Convex problems of the decomposition; 0 for other solvers.
    pub convex_problems: u32,
    /// Largest quotient of successive changes of the decomposition.
    pub contraction: f64,
    /// Changes of the active set over all steps.
    pub active_set_changes: u32,
    /// Contribution of unresolved residual and rounding to ‖u_n - u_n^k‖_X.
    pub floor: f64,
    /// The same of (Σ w_i p_i²)^½ of the pressures p.
    pub pressure_floor: f64,
    /// Largest relative residual of the independent evaluation.
    pub kkt_residual: f64,
    pub peak_history_bytes: usize,
}

/// Largest accepted relative residual: solves end at 16 units of rounding of the forces.
const ALLOWED: f64 = 1e-12;

/// The history sums the rounding of all levels; the correction is that of one.
const SAFETY: f64 = 4.0;

/// Solves all steps and passes each to `observe`.
///
/// # Errors
/// A step that does not converge, a load that is not finite, a residual above 1e-12.
pub fn march(
    model: &FiniteModel,
    grid: &TimeGrid,
    load: &mut dyn FiniteLoad,
    solver: &dyn StepSolver,
    observe: &mut dyn FnMut(&FiniteView<'_>),
) -> Result<FiniteInfo, FiniteError> {
    let mut evolution = FiniteEvolution::new(model, grid, load)?;
    let mut stepper = Stepper::new(&evolution, solver);
    let mut info = FiniteInfo::default();
    let (mut size, mut correction, mut worst) = (0f64, 0f64, 0f64);
    // w_i p_i balances the forces on a functional, which are known to the tolerance of the step.
    let by_force = model.functionals.iter().map(|f| 1.0 / f.weight).sum::<f64>().sqrt();
    for n in 0..=grid.steps() {
        let step = stepper.step(&mut evolution)?;
        info.newton_iterations += step.iterations;
        info.fixed_point_iterations += step.fixed_point_iterations;
        info.convex_problems += step.convex_problems;
        info.contraction = info.contraction.max(step.contraction);
        info.active_set_changes += step.active_set_changes;
        let u = evolution.displacement(&stepper.state.u);
        let history = evolution.history();
        let t = grid.time(n);
        let residual = residual(&mut evolution, &stepper.state.u, &stepper.state.pressure);
        if residual.is_nan() || residual > ALLOWED {
            return Err(FiniteError::Kkt { n, t, residual, allowed: ALLOWED });
        }
        info.kkt_residual = info.kkt_residual.max(residual);
        size = size.max(model.norm(&u));
        info.pressure_floor = info.pressure_floor.max(SAFETY * step.tolerance * by_force);
        // The worst level, and the change that one more solve would make there.
        if step.residual > worst {
            worst = step.residual;
            let one_more = evolution.correction(stepper.scratch.unbalanced());
            let change = one_more.map_or(0.0, |w| evolution.norm(w.as_slice()));
            // A residual far below its tolerance is rounding that cancels.
            let allowed = SAFETY * (step.tolerance / step.residual).max(1.0);
            correction = correction.max(allowed * change);
        }
        let pressure = &stepper.state.pressure;
        observe(&FiniteView { n, t, u: &u, history: &history, pressure });
    }
    info.floor = correction + f64::EPSILON * size;
    let histories = 1 + model.kernels.iter().filter(|term| term.inner.is_some()).count();
    info.peak_history_bytes = (grid.steps() + 1) * histories * model.dimension() * size_of::<f64>();
    Ok(info)
}

/// Force balance with the pressures, and their distance from the graphs, relative to the forces.
fn residual(evolution: &mut FiniteEvolution<'_>, w: &[f64], pressure: &[f64]) -> f64 {
    let mut balance = vec![0.0; w.len()];
    evolution.residual(w, &mut balance);
    let graph = evolution.graph();
    let mut worst = 0f64;
    for (i, at) in graph.coordinates.iter().enumerate() {
        balance[at.dof as usize] += at.weight * pressure[i];
        let value = graph.normal(i, w);
        let potential = &*graph.potentials[i];
        let stiffness = at.weight / at.gamma;
        let missed = graph_distance(potential, [value, pressure[i]], at.weight, stiffness);
        // Pressure beyond the law's needs a bound: the violation is the smaller of the excess and of the distance to
        // the bound, the latter as the force the stiffness answers with.
        let above = pressure[i] > potential.subdifferential(value).1;
        let bound = if above { at.gap } else { at.floor };
        worst = worst.max(missed.min((bound - value).abs() * stiffness));
        let outside = (value - at.gap).max(at.floor - value).max(0.0);
        worst = worst.max(outside * stiffness);
    }
    // What rounding leaves of stiff graphs is none of it.
    let (state, mut sizes) =
        (StepState { u: w.to_vec(), pressure: pressure.to_vec() }, vec![0.0; w.len()]);
    evolution.add_rounding(&state, &mut sizes);
    let unit = Newton::standard().rounding_units * f64::EPSILON;
    for (force, size) in balance.iter_mut().zip(sizes) {
        let beyond = force.abs() - unit * size;
        *force = if beyond < 0.0 { 0.0 } else { beyond };
    }
    // Every unknown and pressure enters the balance, so any NaN shows in it.
    let worst = larger(worst, largest(&balance));
    let scale = evolution.force_scale(w);
    if scale > 0.0 { worst / scale } else { worst }
}
