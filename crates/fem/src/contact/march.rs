//! The march in time: Problem 14 step after step, with the history committed after convergence.

use super::case::{CaseError, CaseInfo, Observer, StepView};
use super::floor::Accepted;
use super::plan::Plan;
use super::shown::Shown;
use super::{Discretization, Evolution, Floors, Load, Model, Path, linear, one_matrix, taken};
use vhi::history::TimeGrid;
use vhi::{StepInequality, StepSolver, Stepper};

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
    let plan = Plan::of(space, model, grid.steps(), solver.newton().is_some());
    march_by(plan, space, model, grid, load, solver, observe)
}

/// [`march`], level by level in the volume, even where there is a shorter way.
///
/// # Errors
/// As [`march`].
pub fn march_in_volume(
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
    load: &mut dyn Load,
    solver: &dyn StepSolver,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    march_by(Plan::Newton, space, model, grid, load, solver, observe)
}

fn march_by(
    plan: Plan,
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
    load: &mut dyn Load,
    solver: &dyn StepSolver,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let mut paths = taken::foreseen(plan, space, model, grid);
    let mut see = |view: &StepView<'_>| {
        if view.n == grid.steps() {
            paths = paths.union(taken::of_level(space, model, view));
        }
        observe(view)
    };
    let separates = load.basis().is_some();
    let mut info = match (plan, solver.newton()) {
        (Plan::Newton, _) | (_, None) => {
            March::new(space, model, grid, load, solver)?.run(grid, &mut see)
        }
        (Plan::Recursion, _) if separates => linear::march(space, model, grid, load, &mut see),
        (_, Some(newton)) => one_matrix::march(space, model, grid, load, newton, &mut see),
    }?;
    if info.damped_iterations > 0 {
        paths.insert(Path::Damped);
    }
    info.paths = info.paths.union(paths);
    measurable(space, model, info.strain_norm)?;
    Ok(info)
}

struct March<'a> {
    space: &'a Discretization,
    model: &'a Model,
    evolution: Evolution<'a>,
    stepper: Stepper<'a>,
    shown: Shown<'a>,
    /// The largest residual that was accepted so far, and the floors it and rounding make.
    worst_residual: f64,
    info: CaseInfo,
}

impl<'a> March<'a> {
    fn new(
        space: &'a Discretization,
        model: &'a Model,
        grid: &'a TimeGrid,
        load: &'a mut dyn Load,
        solver: &'a dyn StepSolver,
    ) -> Result<Self, CaseError> {
        let evolution = Evolution::new(space, model, grid, load)?;
        Ok(Self {
            stepper: Stepper::new(&evolution, solver),
            evolution,
            shown: Shown::new(space, model),
            worst_residual: 0.0,
            info: CaseInfo::default(),
            space,
            model,
        })
    }

    fn run(mut self, grid: &TimeGrid, observe: &mut Observer<'_>) -> Result<CaseInfo, CaseError> {
        for n in 0..=grid.steps() {
            self.step(n, grid.time(n), observe)?;
        }
        Ok(self.finish())
    }

    fn step(&mut self, n: usize, t: f64, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        let info = self.stepper.step(&mut self.evolution)?;
        self.info.newton_iterations += info.iterations;
        self.info.damped_iterations += info.damped;
        self.info.fixed_point_iterations += info.fixed_point_iterations;
        self.info.active_set_changes += info.active_set_changes;
        self.info.convex_problems += info.convex_problems;
        self.info.contraction = self.info.contraction.max(info.contraction);
        self.show(n, t, observe)?;
        // Floors belong to the level that was solved worst. Records are few, about log N of them.
        if info.residual > self.worst_residual {
            self.worst_residual = info.residual;
            self.raise_floors(info.residual, info.tolerance);
        }
        Ok(())
    }

    /// Raises the floors to those of the correction that one more solve of the last level would make.
    fn raise_floors(&mut self, residual: f64, tolerance: f64) {
        let mut delta = vec![0.0; self.space.nodes.len()];
        let unbalanced = self.stepper.scratch.unbalanced();
        delta[..unbalanced.len()].copy_from_slice(unbalanced);
        let problem = self.evolution.problem_mut();
        problem.solve_with_last_factor(&mut delta[..self.space.dofs()]);
        self.space.frames.to_cartesian(&mut delta);
        let largest = self.model.elasticity.eigenvalues(self.space.mesh.dimension).1;
        let accepted = Accepted { residual, tolerance };
        let floors = Floors::new(self.space, &delta, &self.shown.nodal, accepted, largest);
        self.info.floors = self.info.floors.max(floors);
    }

    /// Counters, and floors that hold the rounding of the last level at least.
    fn finish(mut self) -> CaseInfo {
        self.raise_floors(0.0, 0.0);
        self.info.work = self.evolution.problem().work();
        self.info.seconds_load = self.evolution.seconds_load;
        self.info.peak_history_bytes = self.evolution.peak_history_bytes;
        self.info.paths = self.evolution.paths();
        self.info
    }

    fn show(&mut self, n: usize, t: f64, observe: &mut Observer<'_>) -> Result<(), CaseError> {
        let (state, evolution) = (&self.stepper.state, &self.evolution);
        self.shown.take(&state.u, Some((evolution.graph(), state)));
        let sizes = [evolution.zeta(), evolution.problem().strain_norm()];
        let to = (&mut self.info, observe);
        self.shown.show((n, t), evolution.history(), sizes, evolution.load(), to)
    }
}

#[cfg(test)]
mod tests;
