//! The march in time: Problem 14 step after step, with the history committed after convergence.

use super::boundary::split_pressures;
use super::case::{CaseError, CaseInfo, KKT_ALLOWED, Observer, StepView};
use super::floor::Accepted;
use super::kkt::{accepted_residual, kkt_residual_in};
use super::{Discretization, Evolution, Floors, Load, Model, friction};
use algebra::linalg::norm;
use vhi::history::TimeGrid;
use vhi::law::Projection;
use vhi::{HistoryInequality, StepInequality, StepSolver, Stepper};

/// Fields of this size have squares, and squares of errors down to 1e-2 of ε, that are doubles.
const MEASURABLE: std::ops::RangeInclusive<f64> = 1e-152..=1e152;

/// Whether a solution with this largest ‖ε(u_n)‖ can be measured; one that is zero throughout can.
fn measurable(space: &Discretization, model: &Model, largest: f64) -> Result<(), CaseError> {
    let volume: f64 = space.geometry.measure.iter().sum();
    let strain = largest / volume.sqrt();
    let stress = strain * model.elasticity.eigenvalues(space.mesh.dimension).1;
    if largest == 0.0 || (MEASURABLE.contains(&strain) && MEASURABLE.contains(&stress)) {
        return Ok(());
    }
    Err(CaseError::OutOfRange { strain, stress })
}

/// Solves all steps of a case and shows each to `observe`.
///
/// # Errors
/// A step that does not converge, a load that is not finite, a KKT residual above [`super::KKT_ALLOWED`].
pub fn march(
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
    load: &mut dyn Load,
    solver: &dyn StepSolver,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    March::new(Evolution::new(space, model, grid, load)?, solver).run(observe)
}

struct March<'a> {
    space: &'a Discretization,
    model: &'a Model,
    evolution: Evolution<'a>,
    stepper: Stepper<'a>,
    /// u_n of all nodes.
    nodal: Vec<f64>,
    /// ξ, λ and s at the points of the trace.
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
    friction: Vec<f64>,
    /// Room for the balance of forces.
    balance: Vec<f64>,
    /// The largest residual that was accepted so far, and the floors it and rounding make.
    worst_residual: f64,
    /// The largest load whose level has set the floors; of condensed levels, which have no residual in the volume.
    largest_load: f64,
    info: CaseInfo,
}

impl<'a> March<'a> {
    fn new(evolution: Evolution<'a>, solver: &'a dyn StepSolver) -> Self {
        let (space, model) = (evolution.space, evolution.model);
        let points = space.trace.points.len();
        let tangents = model.friction.as_ref().map_or(0, |_| space.mesh.dimension - 1);
        Self {
            stepper: Stepper::new(&evolution, solver),
            evolution,
            nodal: vec![0.0; space.nodes.len()],
            compliance: vec![0.0; points],
            multiplier: vec![0.0; points],
            friction: vec![0.0; tangents * points],
            balance: Vec::new(),
            worst_residual: 0.0,
            largest_load: 0.0,
            info: CaseInfo::default(),
            space,
            model,
        }
    }

    fn run(mut self, observe: &mut Observer<'_>) -> Result<CaseInfo, CaseError> {
        for n in 0..=self.evolution.grid().steps() {
            self.step(n, observe)?;
        }
        self.finish()
    }

    fn step(&mut self, n: usize, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        let info = self.stepper.step(&mut self.evolution)?;
        self.info.newton_iterations += info.iterations;
        self.info.damped_iterations += info.damped;
        self.info.fixed_point_iterations += info.fixed_point_iterations;
        self.info.active_set_changes += info.active_set_changes;
        self.info.convex_problems += info.convex_problems;
        self.info.contraction = self.info.contraction.max(info.contraction);
        self.show(n, self.evolution.grid().time(n), observe)?;
        // Floors belong to the level that was solved worst. Records are few, about log N of them.
        if self.evolution.problem.by_condensation {
            let size = norm(self.evolution.load());
            if size > 2.0 * self.largest_load {
                self.largest_load = size;
                self.raise_floors_of_condensed();
            }
        } else if info.residual > self.worst_residual {
            self.worst_residual = info.residual;
            self.raise_floors_of_last(info.residual, info.tolerance);
        }
        Ok(())
    }

    fn raise_floors_of_last(&mut self, residual: f64, tolerance: f64) {
        let mut delta = Vec::with_capacity(self.space.nodes.len());
        delta.extend_from_slice(self.stepper.scratch.unbalanced());
        self.raise_floors(delta, Accepted { residual, tolerance });
    }

    fn raise_floors_of_condensed(&mut self) {
        let state = &self.stepper.state;
        let unbalanced = self.evolution.problem.unbalanced(state);
        let mut rounding = vec![0.0; state.u.len()];
        self.evolution.add_rounding(state, &mut rounding);
        let size = self.evolution.force_scale(&state.u) + norm(&rounding);
        let tolerance = accepted_residual(size);
        let accepted = Accepted { residual: norm(&unbalanced), tolerance };
        self.raise_floors(unbalanced, accepted);
    }

    /// Raises the floors to those of the correction that one more solve of the last level would make.
    fn raise_floors(&mut self, mut delta: Vec<f64>, accepted: Accepted) {
        self.evolution.problem.solve_with_last_factor(&mut delta);
        delta.resize(self.space.nodes.len(), 0.0);
        self.space.frames.to_cartesian(&mut delta);
        let largest = self.model.elasticity.eigenvalues(self.space.mesh.dimension).1;
        let floors = Floors::new(self.space, &delta, &self.nodal, accepted, largest);
        self.info.floors = self.info.floors.max(floors);
    }

    /// Counters, and floors that hold the rounding of the last level at least.
    fn finish(mut self) -> Result<CaseInfo, CaseError> {
        if self.evolution.problem.by_condensation {
            self.raise_floors_of_condensed();
        } else {
            self.raise_floors_of_last(0.0, 0.0);
        }
        self.info.work = self.evolution.problem.work();
        self.info.seconds_load = self.evolution.seconds_load;
        self.info.peak_history_bytes = self.evolution.peak_history_bytes;
        measurable(self.space, self.model, self.info.strain_norm)?;
        Ok(self.info)
    }

    /// Shows the level if a separate evaluation finds that it solves the discrete problem.
    fn show(&mut self, n: usize, t: f64, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        let (space, model) = (self.space, self.model);
        let (state, evolution) = (&self.stepper.state, &self.evolution);
        self.nodal[..state.u.len()].copy_from_slice(&state.u);
        space.frames.to_cartesian(&mut self.nodal);
        let pressures = [&mut self.compliance[..], &mut self.multiplier];
        split_pressures(space, model, evolution.graph(), state, pressures);
        friction::show(space, &state.pressure, &mut self.friction);
        let (zeta, strain_norm) = (evolution.zeta(), evolution.problem.strain_norm());
        let view = StepView {
            n,
            t,
            u: &self.nodal,
            history: evolution.history(),
            zeta,
            kappa: model.projection.limit().map_or(f64::INFINITY, |limit| limit.value(zeta)),
            strain_norm,
            compliance: &self.compliance,
            multiplier: &self.multiplier,
            friction: &self.friction,
        };
        let residual = kkt_residual_in(space, model, &view, evolution.load(), &mut self.balance);
        if residual.is_nan() || residual > KKT_ALLOWED {
            return Err(CaseError::Kkt { n, t, residual, allowed: KKT_ALLOWED });
        }
        self.info.kkt_residual = self.info.kkt_residual.max(residual);
        self.info.strain_norm = self.info.strain_norm.max(strain_norm);
        observe(&view)
    }
}

#[cfg(test)]
mod tests;
