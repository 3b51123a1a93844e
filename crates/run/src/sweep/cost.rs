//! What a case costs before it is run: CPU seconds and memory from the symbolic factorization, the number of levels
//! and the kind of scene.
//!
//! The iterations of a level grow with n k, the cells that a front passes in a step. Rates are seconds of one core (an
//! x86-64 server, release build): each is `seconds_*` of `cases.csv` over the work in question, in one run of all
//! shipped scenes with `--jobs 1`. Predicted over measured `seconds_total` of that run is 0.49 to 1.65 (92 cases, 0.1 ms
//! to 5.3 s); on grids that had no part in the rates it is 0.7 to 1.4 of the
//! CPU time of a process that runs one case (9 cases, 0.6 s to 5.7 s). Another machine moves all of them
//! together. Predicted over measured memory, the peak resident size of a process that runs a single case, is 0.81 to
//! 1.31 (9 cases, 26 to 297 MiB). The rates were taken before contact was condensed onto Γ3 and before factors served
//! several levels; the counts of either are those of today.

mod alone;
mod linear;
mod truth;

use std::collections::HashSet;

pub use alone::{RunCost, run_cost, run_seconds};
pub(super) use alone::{eigenvalue_bytes, march_bytes};
use linear::linear;
use truth::{TruthCost, truth, zeta};

use super::plan::{CasePlan, ScenePlan, TIME_REFERENCE};
use fem::contact::{Discretization, LinearSolver, Plan};
use scene::setup::{AbstractSetup, Setup, SetupError};
use scene::{Norm, Reference};

/// How a level of a scene is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// One factor for all levels; loads that separate are solved once.
    LinearMultiple,
    /// One factor for all levels, one solve a level.
    Linear,
    /// Active set on Γ3 alone, one factor where memory is a multiple of the elasticity.
    Condensed,
    /// Active set without projection, in the volume.
    Contact,
    /// Active set and projection.
    Projection,
}

impl Kind {
    /// The kind of a scene that is solved by `plan`.
    pub fn of(setup: &Setup, plan: Plan) -> Self {
        let model = &setup.model;
        match plan {
            Plan::Recursion => Self::LinearMultiple,
            Plan::Condensed => Self::Condensed,
            Plan::Newton if model.is_linear() => Self::Linear,
            Plan::Newton if model.projection.is_none() => Self::Contact,
            Plan::Newton => Self::Projection,
        }
    }

    /// Newton iterations and factorizations a level, for cells = n k.
    fn work(self, cells: f64, steps: f64) -> [f64; 2] {
        match self {
            Self::LinearMultiple | Self::Linear => [1.0, 1.0 / (steps + 1.0)],
            Self::Condensed => [(2.0 * cells.powf(0.35)).max(0.1), 1.0 / (steps + 1.0)],
            Self::Contact => [2.0 * cells.powf(0.35), 0.95 * cells.powf(0.4)].map(|w| w.max(0.1)),
            Self::Projection => [4.3 * cells.powf(0.18), 0.95 * cells.powf(0.33)],
        }
    }

    /// Seconds a cell and iteration in residuals and tangents.
    fn assembly(self) -> f64 {
        match self {
            Self::LinearMultiple | Self::Linear | Self::Condensed => 2e-9,
            Self::Contact => 15e-9,
            Self::Projection => 58e-9,
        }
    }

    /// Iterations of conjugate gradients in one of Newton's method: four digits, for two right sides with a rank-one
    /// piece; all digits of a linear scene, of few right sides where loads separate.
    fn cycles(self) -> f64 {
        match self {
            Self::LinearMultiple => 4.0,
            Self::Linear => 30.0,
            Self::Condensed | Self::Contact => 8.0,
            Self::Projection => 11.0,
        }
    }

    /// Seconds an entry of the factor and iteration: one direct solve, or two to three with GMRES.
    fn solve(self) -> f64 {
        match self {
            Self::LinearMultiple => 0.15e-9,
            Self::Linear | Self::Condensed => 1.2e-9,
            Self::Contact | Self::Projection => 2.2e-9,
        }
    }
}

/// Seconds a cell and iteration in vectors, and a cell and level in KKT residual and errors.
const VECTORS: f64 = 50e-9;
const MEASURING: f64 = 50e-9;
/// What the 12 × 12 matrices of a tetrahedron take over the 6 × 6 ones of a triangle, in assembly.
const TETRAHEDRON: f64 = 4.0;
/// Seconds a level of an abstract scene, and a pair of levels and kernel in its direct sums.
const ABSTRACT: [f64; 2] = [2e-4, 5e-8];
/// Bytes of the program itself with its report.
pub(super) const PROGRAM: f64 = 16e6;
/// Bytes an entry of the matrix in mesh, pattern and analysis, which the cases on a mesh share.
const SPACE: f64 = 16.0;
/// The prediction for one case or reference run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Unknowns.
    pub dofs: usize,
    /// How the levels are solved on this mesh.
    pub plan: Plan,
    /// The solver of the linear systems.
    pub linear_solver: LinearSolver,
    /// Newton iterations over all levels, without finer runs for the time error.
    pub iterations: f64,
    /// Factorizations, likewise.
    pub factorizations: f64,
    /// CPU seconds, in a sweep that runs the cases of a mesh longest first: loads and moments of a time are computed
    /// once a mesh, and belong to the case that needs them first.
    pub seconds: f64,
    /// CPU seconds in a process that runs this case alone, without its reference run; of them those for loads and
    /// moments at its times.
    pub alone: [f64; 2],
    /// Peak memory of a process that runs this case alone, with its reference run if it has one. In a sweep the cases
    /// of a mesh share mesh and truth, and the meshes of a scene are held together.
    pub memory_bytes: f64,
    /// What stays of them at its end for the other cases on the mesh; of a reference run, for the cases of its scene.
    pub kept_bytes: f64,
    /// The part of it that does not grow with the number of times.
    pub kept_once: f64,
    /// What in a sweep the longer cases on the mesh have left there before this one, beyond what it keeps itself: truth
    /// at times that are not its own.
    pub left_bytes: f64,
}

/// The costs of a plan.
pub struct PlanCost {
    /// One a case, in the plan's order.
    pub cases: Vec<Cost>,
    /// The reference run.
    pub reference: Option<Cost>,
}

/// Predicts all cases of `plan`, the plan of `setup`; analyses each of its meshes once, solves nothing.
///
/// # Errors
/// [`SetupError::Mesh`].
pub fn predict(setup: &Setup, plan: &ScenePlan) -> Result<PlanCost, SetupError> {
    predict_some(setup, plan, &plan.cases, plan.reference)
}

/// The same for some cases of the plan, as if there were no others; one mesh at a time is in memory.
pub(super) fn predict_some(
    setup: &Setup,
    plan: &ScenePlan,
    cases: &[CasePlan],
    reference: Option<Reference>,
) -> Result<PlanCost, SetupError> {
    let reference = reference.map(|own| reference_cost(setup, plan, own)).transpose()?;
    let (reference, reference_cells) = reference.unzip();
    let zeta = zeta(setup);
    let timed = |c: usize| cases[c].norms.contains(&Norm::VTimeMax);
    let finest = |c: usize| cases[c].steps * if timed(c) { 1 + TIME_REFERENCE } else { 1 };
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by_key(|&c| (mesh_of(&cases[c]), std::cmp::Reverse(finest(c))));
    let mut costs: Vec<Option<Cost>> = vec![None; cases.len()];
    for of_mesh in order.chunk_by(|&a, &b| mesh_of(&cases[a]) == mesh_of(&cases[b])) {
        let n = mesh_of(&cases[of_mesh[0]]);
        let space = setup.space(n)?;
        let own = truth(setup, reference_cells, &space);
        let TruthCost { moment, load, load_beside, formulas, .. } = own;
        let dofs = space.dofs() as f64;
        let mut known: [HashSet<u64>; 2] = Default::default();
        let mut trajectories = 0.0;
        for (place, &c) in of_mesh.iter().enumerate() {
            let case = &cases[c];
            let mut cost = march(setup, &space, n, case.steps);
            let mut loads = times(setup, case.steps);
            let moments = loads.clone();
            let once = formulas + own.parts_bytes;
            let mut kept = once + own.bytes_a_time * moments.len() as f64;
            if timed(c) {
                let finer = march(setup, &space, n, TIME_REFERENCE * case.steps);
                cost.seconds += finer.seconds;
                loads.extend(times(setup, TIME_REFERENCE * case.steps));
                // One march after the other; displacements and exact loads of the finer one stay.
                cost.memory_bytes = cost.memory_bytes.max(finer.memory_bytes);
                kept += 8.0 * dofs * moments.len() as f64;
                trajectories += 8.0 * dofs * moments.len() as f64;
                if setup.exact.is_some() {
                    let more = (loads.len() - moments.len()) as f64;
                    kept += own.bytes_a_time.min(8.0 * dofs) * more;
                }
            }
            cost.memory_bytes += PROGRAM + kept + own.next_formulas;
            cost.memory_bytes += reference.map_or(0.0, |run: Cost| run.memory_bytes - PROGRAM);
            // With the factor that serves all grids in time.
            let mesh = SPACE * space.pattern.entries() as f64 + cost.kept_bytes;
            (cost.kept_bytes, cost.kept_once) = (kept + mesh, once + mesh);
            // The rules are compared once a mesh, at two times: loads by both, moments by the next.
            let compared = 2.0 * own.next;
            let (measured, finer) = (moments.len() as f64, (loads.len() - moments.len()) as f64);
            let truth = own.parts_seconds + (moment + load_beside) * measured + load * finer;
            cost.alone = [cost.seconds + compared + truth + zeta, truth];
            if place == 0 {
                cost.seconds += compared + own.parts_seconds;
            }
            let [known_loads, known_moments] = &mut known;
            let fresh = |set: &mut HashSet<u64>, times: HashSet<u64>| {
                times.into_iter().filter(|&t| set.insert(t)).count() as f64
            };
            let measured = fresh(known_loads, moments.clone());
            cost.seconds += load_beside * measured + load * fresh(known_loads, loads);
            cost.seconds += moment * fresh(known_moments, moments);
            // All that the mesh keeps by now, as that of a case is counted above.
            let [loads, moments] = [known_loads.len(), known_moments.len()].map(|n| n as f64);
            let mut all = cost.kept_once + trajectories + own.bytes_a_time * moments;
            if setup.exact.is_some() {
                all += own.bytes_a_time.min(8.0 * dofs) * (loads - moments);
            }
            cost.left_bytes = (all - cost.kept_bytes).max(0.0);
            costs[c] = Some(cost);
        }
    }
    let longest = |&(c, _): &(usize, &mut Option<Cost>)| {
        u64::from(mesh_of(&cases[c])).pow(3) * u64::from(finest(c) + 1)
    };
    if let Some((_, Some(cost))) = costs.iter_mut().enumerate().max_by_key(longest) {
        cost.seconds += zeta;
    }
    Ok(PlanCost { cases: costs.into_iter().flatten().collect(), reference })
}

/// The reference run of a plan, and the cells of its mesh.
fn reference_cost(
    setup: &Setup,
    plan: &ScenePlan,
    reference: Reference,
) -> Result<(Cost, usize), SetupError> {
    let (n, steps) = (reference.n as u32, reference.steps as u32);
    let space = setup.space(n)?;
    let run = march(setup, &space, n, steps);
    let kept = f64::from(plan.kept_steps().min(steps)) + 1.0;
    // u and σ of the levels that cases look at.
    let tensors = tensor_numbers(&space) * space.mesh.cell_count();
    let levels = 8.0 * kept * (space.dofs() + tensors) as f64;
    let kept_bytes = levels + SPACE * space.pattern.entries() as f64;
    let memory_bytes = PROGRAM + run.memory_bytes + levels;
    Ok((Cost { memory_bytes, kept_bytes, ..run }, space.mesh.cell_count()))
}

/// Numbers of a tensor.
fn tensor_numbers(space: &Discretization) -> usize {
    let d = space.mesh.dimension;
    d * (d + 1) / 2
}

/// Predicted CPU seconds of a case of an abstract scene: N exact states and solves, and direct sums
/// over N²/2 levels.
pub fn predict_abstract(setup: &AbstractSetup, steps: u32) -> f64 {
    let levels = f64::from(steps) + 1.0;
    ABSTRACT[0] * levels + ABSTRACT[1] * levels * levels * setup.problem.kernels.len() as f64
}

/// n of a case of a body, which always has one.
fn mesh_of(case: &CasePlan) -> u32 {
    case.n.unwrap_or_default()
}

/// Times of a grid, as bits: what is computed once a time is shared by equal numbers alone.
fn times(setup: &Setup, steps: u32) -> HashSet<u64> {
    let grid = setup.grid(steps);
    (0..=grid.steps()).map(|n| grid.time(n).to_bits()).collect()
}

/// One march without its truth.
fn march(setup: &Setup, space: &Discretization, n: u32, steps: u32) -> Cost {
    let linear_solver = LinearSolver::of(space, &setup.model, steps as usize);
    let plan = Plan::of(space, &setup.model, steps as usize, true);
    let kind = Kind::of(setup, plan);
    let levels = f64::from(steps) + 1.0;
    let crossed = f64::from(n) * setup.scene.time.horizon / f64::from(steps);
    let [iterations, mut factorizations] = kind.work(crossed, f64::from(steps)).map(|w| w * levels);
    if kind == Kind::Condensed && Plan::changes_factor(&setup.model) {
        // The weight of the last slot is zero at first, then that of the step.
        let uniform = matches!(setup.scene.time.grid, scene::TimeGrid::Uniform);
        factorizations = if uniform { levels.min(2.0) } else { levels };
    }
    // A condensed level passes the factor once, whatever its iterations on Γ3 are.
    let passes = if kind == Kind::Condensed { levels } else { iterations };
    let (cells, dofs) = (space.mesh.cell_count() as f64, space.dofs());
    let (linear, linear_bytes) = linear(kind, linear_solver, space, [passes, factorizations]);
    let vectors = match kind {
        Kind::LinearMultiple | Kind::Linear | Kind::Condensed => 0.0,
        Kind::Contact | Kind::Projection => VECTORS,
    };
    let shape = if space.mesh.dimension == 2 { 1.0 } else { TETRAHEDRON };
    let per_iteration = (shape * kind.assembly() + vectors) * cells;
    let history = setup.history_vectors(steps) * dofs * 8;
    // Five matrices with their index; some thirty vectors, and three for each of the eight levels that are expanded
    // together where condensation has one factor.
    let together = kind == Kind::Condensed && !Plan::changes_factor(&setup.model);
    let vectors_bytes = if together { 240.0 + 192.0 } else { 240.0 } * dofs as f64;
    let one_factor =
        together || (kind == Kind::LinearMultiple && linear_solver == LinearSolver::Direct);
    let memory_bytes =
        linear_bytes + 52.0 * space.pattern.entries() as f64 + vectors_bytes + history as f64;
    Cost {
        dofs,
        plan,
        linear_solver,
        iterations,
        factorizations,
        seconds: passes * per_iteration + linear + MEASURING * cells * levels,
        alone: [0.0; 2],
        memory_bytes,
        kept_bytes: if one_factor { held_bytes(space) } else { 0.0 },
        kept_once: 0.0,
        left_bytes: 0.0,
    }
}

/// A stiffness matrix with its factor, which serves all runs on a mesh.
fn held_bytes(space: &Discretization) -> f64 {
    8.0 * (space.analysis.factor_entries() + space.pattern.entries()) as f64
}

#[cfg(test)]
mod tests;
