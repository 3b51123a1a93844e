//! The march in time: Problem 14 step after step, with the history committed after convergence.

use super::floor::Accepted;
use super::kkt::kkt_residual_in;
use super::path::{self, Path, Paths};
use super::plan::Plan;
use super::work::Work;
use super::{
    Discretization, Evolution, Floors, Load, LoadError, Model, friction, linear, one_matrix,
};
use vhi::history::TimeGrid;
use vhi::law::{Potential, Projection};
use vhi::{BoundaryGraph, FailedStep, GraphPiece, StepInequality, StepSolver, StepState, Stepper};

/// The solution at one time level, as an observer sees it.
pub struct StepView<'a> {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// u_n as a nodal vector, clamped nodes included.
    pub u: &'a [f64],
    /// Σ'_{j ≤ n} b(t_n - t_j) u_j as nodal vectors, one per term of the memory.
    pub history: &'a [Vec<f64>],
    /// ζ_n, also for scenes without projection.
    pub zeta: f64,
    /// κ(ζ_n); infinite without projection.
    pub kappa: f64,
    /// ‖ε(u_n)‖.
    pub strain_norm: f64,
    /// ξ_n at the points of the trace (a pressure).
    pub compliance: &'a [f64],
    /// λ_n at the points of the trace (a pressure).
    pub multiplier: &'a [f64],
    /// s_n = -σ_τ along [`super::TracePoint::tangents`] at the points of the trace, d - 1 numbers each; empty without friction.
    pub friction: &'a [f64],
}

/// Called with every time level; an error that it returns ends the march.
pub type Observer<'a> = dyn FnMut(&StepView<'_>) -> Result<(), CaseError> + 'a;

/// Why a case has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CaseError {
    /// A step failed.
    #[error(transparent)]
    Step(#[from] FailedStep),
    /// A load failed.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The separate evaluation of the KKT system disagrees with the solver.
    #[error(
        "step {n} (t = {t}): KKT residual {residual:.3e} by separate evaluation exceeds {allowed:.1e}"
    )]
    Kkt {
        /// n.
        n: usize,
        /// t_n.
        t: f64,
        /// The relative residual.
        residual: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// A solver outside this program gave no answer.
    #[error("{0}")]
    Outside(String),
    /// Errors are sums of squares, which leave the range of doubles.
    #[error(
        "‖ε(u_n)‖ is {strain:.1e} and stresses are {stress:.1e} at most: outside 1e-152 to 1e152 errors cannot be measured, since their squares leave the range of doubles; state the scene in other units"
    )]
    OutOfRange {
        /// max ‖ε(u_n)‖ over the root of |Ω|.
        strain: f64,
        /// `strain` times the stiffest modulus.
        stress: f64,
    },
}

/// Fields of this size have squares, and squares of errors down to 1e-2 of ε, that are doubles.
const MEASURABLE: std::ops::RangeInclusive<f64> = 1e-152..=1e152;

/// Whether a solution with this largest ‖ε(u_n)‖ can be measured; one that is zero throughout can.
fn measurable<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    largest: f64,
) -> Result<(), CaseError> {
    let volume: f64 = space.geometry.measure.iter().sum();
    let strain = largest / volume.sqrt();
    let stress = strain * model.elasticity.eigenvalues(space.mesh.dimension).1;
    if largest == 0.0 || (MEASURABLE.contains(&strain) && MEASURABLE.contains(&stress)) {
        return Ok(());
    }
    Err(CaseError::OutOfRange { strain, stress })
}

/// What one case took.
#[derive(Debug, Clone, Copy, Default)]
pub struct CaseInfo {
    /// Newton iterations over all steps.
    pub newton_iterations: u32,
    /// Applications of Λ over all steps, 0 for other solvers.
    pub fixed_point_iterations: u32,
    /// Convex problems of the decomposition over all steps, 0 for other solvers.
    pub convex_problems: u32,
    /// Largest quotient of successive changes of the decomposition.
    pub contraction: f64,
    /// Changes of the active set over all steps.
    pub active_set_changes: u32,
    /// Largest relative KKT residual over all steps (separate evaluation).
    pub kkt_residual: f64,
    /// max ‖ε(u_n)‖.
    pub strain_norm: f64,
    /// Factorizations, solves and their times.
    pub work: Work,
    /// Seconds in loads.
    pub seconds_load: f64,
    /// Largest memory held by the history.
    pub peak_history_bytes: usize,
    /// Halved Newton steps over all levels.
    pub damped_iterations: u32,
    /// The ways that the run took.
    pub paths: Paths,
    /// What solver and rounding contribute to each error.
    pub floors: Floors,
}

/// A relative KKT residual above this is a failure. Rounding of nodal forces against the largest of
/// them is n·1e-16 at worst on the meshes of this project; 1e-9 is the accuracy promised for results.
pub const KKT_ALLOWED: f64 = 1e-9;

impl CaseInfo {
    /// Takes a level with the KKT residual that a separate evaluation found.
    ///
    /// # Errors
    /// [`CaseError::Kkt`] if that is more than [`KKT_ALLOWED`], or no number.
    pub(super) fn accept(&mut self, level: &StepView<'_>, residual: f64) -> Result<(), CaseError> {
        if residual.is_nan() || residual > KKT_ALLOWED {
            let (n, t) = (level.n, level.t);
            return Err(CaseError::Kkt { n, t, residual, allowed: KKT_ALLOWED });
        }
        self.kkt_residual = self.kkt_residual.max(residual);
        self.strain_norm = self.strain_norm.max(level.strain_norm);
        Ok(())
    }
}

/// Solves all steps of a case and shows each to `observe`.
///
/// # Errors
/// A step that does not converge, a load that is not finite, a KKT residual above [`KKT_ALLOWED`].
pub fn march<P: Projection, S: StepSolver>(
    space: &Discretization,
    model: &Model<P>,
    grid: &TimeGrid,
    load: &mut dyn Load,
    solver: &S,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let plan = Plan::of(space, model, grid.steps(), solver.newton().is_some());
    march_by(plan, space, model, grid, load, solver, observe)
}

/// [`march`], level by level in the volume, even where there is a shorter way.
///
/// # Errors
/// As [`march`].
pub fn march_in_volume<P: Projection, S: StepSolver>(
    space: &Discretization,
    model: &Model<P>,
    grid: &TimeGrid,
    load: &mut dyn Load,
    solver: &S,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    march_by(Plan::Newton, space, model, grid, load, solver, observe)
}

fn march_by<P: Projection, S: StepSolver>(
    plan: Plan,
    space: &Discretization,
    model: &Model<P>,
    grid: &TimeGrid,
    load: &mut dyn Load,
    solver: &S,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let mut paths = path::foreseen(plan, space, model, grid);
    let mut see = |view: &StepView<'_>| {
        if view.n == grid.steps() {
            paths = paths.union(path::of_level(space, model, view));
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

struct March<'a, P, S> {
    space: &'a Discretization,
    model: &'a Model<P>,
    evolution: Evolution<'a, P>,
    stepper: Stepper<'a, S>,
    nodal: Vec<f64>,
    balance: Vec<f64>,
    compliance: Vec<f64>,
    multiplier: Vec<f64>,
    friction: Vec<f64>,
    /// The largest residual that was accepted so far, and the floors it and rounding make.
    worst_residual: f64,
    info: CaseInfo,
}

impl<'a, P: Projection, S: StepSolver> March<'a, P, S> {
    fn new(
        space: &'a Discretization,
        model: &'a Model<P>,
        grid: &'a TimeGrid,
        load: &'a mut dyn Load,
        solver: &'a S,
    ) -> Result<Self, CaseError> {
        let evolution = Evolution::new(space, model, grid, load)?;
        Ok(Self {
            stepper: Stepper::new(&evolution, solver),
            evolution,
            nodal: vec![0.0; space.nodes.len()],
            balance: Vec::new(),
            compliance: vec![0.0; space.trace.points.len()],
            multiplier: vec![0.0; space.trace.points.len()],
            friction: vec![
                0.0;
                if model.friction.is_some() {
                    (space.mesh.dimension - 1) * space.trace.points.len()
                } else {
                    0
                }
            ],
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
        let floors = Floors::new(self.space, &delta, &self.nodal, accepted, largest);
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
        let state = &self.stepper.state;
        self.nodal[..state.u.len()].copy_from_slice(&state.u);
        self.space.frames.to_cartesian(&mut self.nodal);
        split_pressures(
            self.space,
            self.model,
            self.evolution.graph(),
            state,
            [&mut self.compliance, &mut self.multiplier],
        );
        friction::show(self.space, &state.pressure, &mut self.friction);
        let zeta = self.evolution.zeta();
        let history = self.evolution.history();
        let view = StepView {
            n,
            t,
            u: &self.nodal,
            history,
            zeta,
            kappa: self.model.projection.limit().map_or(f64::INFINITY, |l| l.value(zeta)),
            strain_norm: self.evolution.problem().strain_norm(),
            compliance: &self.compliance,
            multiplier: &self.multiplier,
            friction: &self.friction,
        };
        let residual = kkt_residual_in(
            self.space,
            self.model,
            &view,
            self.evolution.load(),
            &mut self.balance,
        );
        self.info.accept(&view, residual)?;
        observe(&view)
    }
}

/// c = ξ + λ: at the bound ξ is the least element of ∂j_ν(g) and λ the rest, elsewhere ξ is all.
pub(super) fn split_pressures<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    graph: &BoundaryGraph,
    state: &StepState,
    [compliance, multiplier]: [&mut [f64]; 2],
) {
    let Some(boundary) = &model.boundary else { return };
    let mut next = 0;
    for (i, point) in space.trace.points.iter().enumerate() {
        if !point.carries() {
            continue;
        }
        let pressure = state.pressure[next];
        let at = &graph.coordinates[next];
        let normal = graph.normal(next, &state.u);
        let piece = graph.piece(next, normal + at.gamma * pressure);
        next += 1;
        if boundary.rule == super::BoundaryRule::Vertex {
            compliance[i] = match piece {
                GraphPiece::Pinned { value, lo, .. } if value == at.gap => lo,
                _ => pressure,
            };
            multiplier[i] = pressure - compliance[i];
        } else {
            let x = space.mesh.point(&[point.vertex], &[1.0]);
            let law = boundary.potential_at(x);
            compliance[i] = law.subdifferential(normal - at.shift).0;
            multiplier[i] = pressure;
        }
    }
    space.trace.extend(compliance);
    space.trace.extend(multiplier);
}
