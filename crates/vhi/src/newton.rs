//! Semismooth Newton method with primal-dual active set for one time level.

use super::line::SlipLine;
use super::{GraphPiece, StepInequality, StepState};
use algebra::linalg::{FactorError, root_of_squares};

/// Parameters of the iteration.
#[derive(Debug, Clone, Copy)]
pub struct Newton {
    /// Iterations after which the step is given up.
    pub max_iterations: usize,
    /// The residual is accepted below this many units of rounding, ε·force_scale, in single forces beyond as many of their
    /// own.
    pub rounding_units: f64,
    /// Relative residual of the linear solves. A Newton step gains about four digits near the solution, so more would
    /// be lost to linearization.
    pub linear_tolerance: f64,
}

impl Default for Newton {
    fn default() -> Self {
        Self::standard()
    }
}

/// What one step took.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepInfo {
    /// Newton iterations (linear solves).
    pub iterations: u32,
    /// Changes of piece, summed over coordinates and iterations.
    pub active_set_changes: u32,
    /// Number of halved steps.
    pub damped: u32,
    /// Final norm of residual and graph defects (a force).
    pub residual: f64,
    /// The tolerance for `residual`.
    pub tolerance: f64,
    /// Applications of Λ; 0 if the last slot of the history was implicit.
    pub fixed_point_iterations: u32,
    /// Convex problems of the decomposition; 0 for other solvers.
    pub convex_problems: u32,
    /// The largest quotient of successive changes of the decomposition; 0 if none was measured.
    pub contraction: f64,
}

/// Why a time level has no computed solution.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    #[error("{source} in Newton iteration {iteration}{}", way_out(source))]
    Factor { iteration: u32, source: FactorError },
    #[error("the residual became {value} in Newton iteration {iteration}")]
    NotFinite { iteration: u32, value: f64 },
    #[error(
        "no convergence in {iterations} Newton iterations: residual {residual:.3e}, wanted {tolerance:.3e}"
    )]
    NotConverged { iterations: u32, residual: f64, tolerance: f64 },
    #[error(
        "Λ does not contract: after {iterations} iterations it still changes by {change:.3e}, {factor:.3} times the change before; a smaller time step makes it contract (3.4), and Newton's method does not need it to"
    )]
    NotContracting { iterations: u32, change: f64, factor: f64 },
    #[error(
        "the decomposition of Remark 3 does not contract: after {problems} convex problems it still changes by {change:.3e}, {factor:.3} times the change before; it contracts where alpha_nu c_j^2 is below the constant of monotonicity (2.9), and Newton's method does not need that"
    )]
    Expanding { problems: u32, change: f64, factor: f64 },
}

fn way_out(error: &FactorError) -> &'static str {
    match error {
        FactorError::NotPositiveDefinite { .. } => {
            "; a smaller time step restores it if memory at lag 0 is negative, a smaller descent slope of the contact law otherwise"
        }
        FactorError::SingularInZeta { .. } => "; a smaller time step restores it",
        _ => "",
    }
}

/// Iterations without a new best residual after which steps are halved, which breaks cycles of the active set.
const PATIENCE: u32 = 8;

/// Factor of the linear tolerance in the first iteration: from an extrapolated start, with moved fronts, it reduces the
/// residual by 1/50 to 1/500 only. `punch`, n = N = 128: 1,379 passes over a factor and 66 factorizations, against
/// 1,548 and 81 with all four digits (and start values of three levels).
const FIRST: f64 = 30.0;
/// In the last iteration the linear residual stays below this share of the tolerance.
const FORCING_SHARE: f64 = 0.3;

impl Newton {
    /// 60 iterations are ten times the usual number. The computed residual has a floor of 1 to 4 units of rounding on
    /// meshes of n = 4…256 (sums of up to 7 cells and 3 strain terms); 16 is safely above it without losing digits.
    pub const fn standard() -> Self {
        Self { max_iterations: 60, rounding_units: 16.0, linear_tolerance: 1e-4 }
    }

    /// Solves one time level from the start value in `state`.
    ///
    /// # Errors
    /// See [`StepError`]; `state` is then the last iterate.
    pub fn solve<P: StepInequality + ?Sized>(
        &self,
        problem: &mut P,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        scratch.resize(problem);
        // Without forces the solution is 0, and no residual is small relative to forces that vanish with it: other
        // start values would shrink for ever.
        scratch.increment.fill(0.0);
        if problem.force_scale(&scratch.increment) == 0.0 {
            state.u.fill(0.0);
        }
        let mut info = StepInfo::default();
        problem.residual(&state.u, &mut scratch.force);
        scratch.select_pieces(problem, state);
        let (mut best, mut since_best) = (f64::INFINITY, 0);
        loop {
            info.residual = scratch.balance(problem, state);
            let unit = self.rounding_units * f64::EPSILON;
            let strict = unit * problem.force_scale(&state.u);
            let (allowed, beyond) = scratch.beyond_rounding(problem, state, unit);
            info.tolerance = strict + allowed;
            if !info.residual.is_finite() {
                let value = info.residual;
                return Err(StepError::NotFinite { iteration: info.iterations, value });
            }
            if beyond <= strict {
                return Ok(info);
            }
            if info.iterations as usize >= self.max_iterations {
                let StepInfo { iterations, residual, tolerance, .. } = info;
                return Err(StepError::NotConverged { iterations, residual, tolerance });
            }
            if info.residual < best {
                (best, since_best) = (info.residual, 0);
            } else {
                since_best += 1;
            }
            let damping = if since_best > PATIENCE { 0.5 } else { 1.0 };
            if info.iterations > 0 {
                info.active_set_changes += scratch.select_pieces(problem, state);
            }
            let wanted = match info.iterations {
                // Rounding of stiff laws is most of the residual: what else is in it has no other chance.
                _ if info.residual <= info.tolerance => 0.0,
                0 => FIRST * self.linear_tolerance,
                _ => self.linear_tolerance,
            };
            let forcing = (FORCING_SHARE * strict / info.residual).max(wanted);
            scratch
                .advance(problem, state, damping, forcing)
                .map_err(|source| StepError::Factor { iteration: info.iterations, source })?;
            info.iterations += 1;
            info.damped += u32::from(damping < 1.0);
            problem.residual(&state.u, &mut scratch.force);
        }
    }
}

/// Vectors of the iteration, kept between steps.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    pub(crate) force: Vec<f64>,
    increment: Vec<f64>,
    pieces: Vec<PieceKey>,
    lines: Vec<SlipLine>,
    slopes: Vec<f64>,
    pressures: Vec<f64>,
    defects: Vec<f64>,
    rounding: Vec<f64>,
    prescribed: Vec<Option<f64>>,
}

/// The piece of a coordinate, None before the first choice.
type PieceKey = Option<Chosen>;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Chosen {
    /// Above so many jumps.
    Free(usize),
    /// At this value.
    Pinned(f64),
}

impl Scratch {
    /// Minus the unbalanced force of the last iterate.
    pub fn unbalanced(&self) -> &[f64] {
        &self.increment
    }

    fn resize<P: StepInequality + ?Sized>(&mut self, problem: &P) {
        let graphs = problem.graph().coordinates.len();
        self.force.resize(problem.dofs(), 0.0);
        self.increment.resize(problem.dofs(), 0.0);
        self.pieces.clear();
        self.pieces.resize(graphs, None);
        self.lines.resize(graphs, SlipLine::AXIS);
        self.slopes.resize(problem.graph().slopes(), 0.0);
        self.pressures.resize(graphs, 0.0);
        self.defects.resize(graphs, 0.0);
        self.rounding.resize(problem.dofs(), 0.0);
        self.prescribed.resize(graphs, None);
    }

    /// Chooses the piece of every coordinate from (u, c); returns how many changed.
    fn select_pieces<P: StepInequality + ?Sized>(&mut self, problem: &P, state: &StepState) -> u32 {
        let graph = problem.graph();
        let mut changes = 0;
        for i in graph.laws() {
            let (line, z) = graph.line(i, &state.u, &state.pressure);
            let turned =
                self.lines[i].along[0] * line.along[0] + self.lines[i].along[1] * line.along[1];
            let chosen = match (graph.piece(i, z), self.pieces[i]) {
                (GraphPiece::Pinned { value, .. }, _) => Chosen::Pinned(value),
                // A vector that would reverse stops at 0 first, as a number does.
                (GraphPiece::Free, Some(Chosen::Free(_))) if turned < 0.0 => Chosen::Pinned(0.0),
                // Crossing a jump stops at it first; otherwise iterates would alternate for ever if the solution is at
                // the jump.
                (GraphPiece::Free, Some(Chosen::Free(before))) => {
                    graph.jump_across(i, before, z).map_or(Chosen::Free(before), Chosen::Pinned)
                }
                (GraphPiece::Free, _) => Chosen::Free(graph.jumps_below(i, z)),
            };
            self.lines[i] = line;
            if self.pieces[i] != Some(chosen) {
                changes += u32::from(self.pieces[i].is_some());
                self.pieces[graph.span(i)].fill(Some(chosen));
            }
        }
        changes
    }

    /// Sets the pressures (in equilibrium with F(u) where pinned, on the graph of ∂j_ν where free) and the increment to
    /// minus the unbalanced force; returns the norm of that force and of the graph defects.
    fn balance<P: StepInequality + ?Sized>(&mut self, problem: &P, state: &mut StepState) -> f64 {
        let graph = problem.graph();
        for (target, force) in self.increment.iter_mut().zip(&self.force) {
            *target = -force;
        }
        for i in graph.laws() {
            match self.pieces[i] {
                Some(Chosen::Free(below)) => {
                    graph.set_pressures(i, (below, &self.lines[i]), &state.u, &mut state.pressure);
                }
                _ => graph.span(i).for_each(|j| {
                    let at = &graph.coordinates[j];
                    state.pressure[j] = -at.sign * self.force[at.dof as usize] / at.weight;
                }),
            }
            for j in graph.span(i) {
                let at = &graph.coordinates[j];
                self.increment[at.dof as usize] -= at.sign * at.weight * state.pressure[j];
                self.defects[j] = 0.0;
            }
            self.defects[i] = graph.defect(i, &state.u, &state.pressure);
        }
        let squares = |scale: f64| {
            let of = |values: &[f64]| values.iter().map(|v| (scale * v).powi(2)).sum::<f64>();
            of(&self.defects) + of(&self.increment)
        };
        root_of_squares(squares)
    }

    /// The norm of what rounding of stiff laws may be in single forces, and that of the residual of the last
    /// [`Self::balance`] beyond it.
    fn beyond_rounding<P: StepInequality + ?Sized>(
        &mut self,
        problem: &P,
        state: &StepState,
        unit: f64,
    ) -> (f64, f64) {
        self.rounding.fill(0.0);
        problem.add_rounding(state, &mut self.rounding);
        let graph = problem.graph();
        let allowed = root_of_squares(|scale| {
            self.rounding.iter().map(|size| (scale * unit * size).powi(2)).sum()
        });
        let beyond = root_of_squares(|scale| {
            // A NaN stays.
            let less = |value: f64, size: f64| match value.abs() - unit * size {
                less if less < 0.0 => 0.0,
                less => (scale * less).powi(2),
            };
            let forces = self.increment.iter().zip(&self.rounding);
            let defects = graph.coordinates.iter().zip(&self.defects);
            forces.map(|(&force, &size)| less(force, size)).sum::<f64>()
                + defects
                    .map(|(at, &defect)| less(defect, self.rounding[at.dof as usize]))
                    .sum::<f64>()
        });
        (allowed, beyond)
    }

    /// One Newton step of length `damping` on the chosen pieces.
    fn advance<P: StepInequality + ?Sized>(
        &mut self,
        problem: &mut P,
        state: &mut StepState,
        damping: f64,
        forcing: f64,
    ) -> Result<(), FactorError> {
        let graph = problem.graph();
        self.pressures.copy_from_slice(&state.pressure);
        self.slopes.fill(0.0);
        let mut mixed = graph.coordinates.len();
        for i in graph.laws() {
            if let Some(Chosen::Free(below)) = self.pieces[i] {
                let line = self.lines[i];
                graph.set_pressures(i, (below, &line), &state.u, &mut self.pressures);
                graph.set_slopes(i, (below, line), &state.u, (&mut self.slopes, mixed));
            }
            mixed += usize::from(graph.coordinates[i].span > 1);
        }
        for (i, at) in graph.coordinates.iter().enumerate() {
            let (dof, normal) = (at.dof as usize, graph.normal(i, &state.u));
            self.prescribed[i] = match self.pieces[i] {
                Some(Chosen::Free(_)) => {
                    self.increment[dof] =
                        -self.force[dof] - at.sign * at.weight * self.pressures[i];
                    None
                }
                Some(Chosen::Pinned(value)) => Some(at.sign * (value - normal)),
                None => Some(0.0),
            };
        }
        problem.take_pressures(&self.pressures);
        problem.linearize(&self.slopes, &self.prescribed)?;
        problem.solve(&mut self.increment, forcing)?;
        for (u, increment) in state.u.iter_mut().zip(&self.increment) {
            *u += damping * increment;
        }
        let graph = problem.graph();
        if damping == 1.0 {
            // u + (g - u) rounds: put pinned coordinates exactly on their value.
            for (i, at) in graph.coordinates.iter().enumerate() {
                if let Some(Chosen::Pinned(value)) = self.pieces[i] {
                    state.u[at.dof as usize] = at.sign * value;
                }
            }
        }
        Ok(())
    }
}
