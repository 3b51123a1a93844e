//! Predicted cost of cases. Bytes are counted from the symbolic factor, the formulas and the number of levels; they
//! decide what runs in parallel and what is refused. Seconds are coarse: unknowns, cells and levels times rates of one
//! core. They decide the order of cases, the bundling into jobs, and what fits a budget.

mod truth;

use std::collections::{BTreeMap, BTreeSet};

use truth::{TruthCost, load_bytes, truth};

use super::plan::{CasePlan, TIME_REFERENCE};
use fem::contact::{Discretization, Plan};
use scene::setup::{AbstractSetup, Setup, SetupError};
use scene::{Norm, Reference, TimeRule};

/// Newton iterations per level, if solved in the volume.
const ITERATIONS: f64 = 5.0;
/// Seconds per cell and iteration in assembly and vectors, and per cell and level in residuals and errors.
const CELL: f64 = 70e-9;
/// Cost of the 12 × 12 matrices of a tetrahedron over the 6 × 6 ones of a triangle, in assembly.
const TETRAHEDRON: f64 = 4.0;
/// Seconds per entry of the factor in triangular solves.
const SOLVE: f64 = 2e-9;
/// Seconds of a factorization per entry of the factor and per multiplication.
const FACTOR: [f64; 2] = [2.8e-9, 1.5e-11];

/// Seconds per weight in the direct sum over the past, by values of the kernel and by its integrals; and per unknown of
/// the vector.
const WEIGHT: [f64; 2] = [0.2e-6, 1.5e-6];
const TERM: f64 = 1e-9;

/// Bytes of the program itself with its report.
pub(super) const PROGRAM: f64 = 16e6;
/// Bytes per entry of the matrix in mesh, pattern and analysis, shared by the cases on a mesh.
const SPACE: f64 = 16.0;

/// The prediction for one case or reference run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    pub dofs: usize,
    /// How levels are solved on this mesh.
    pub plan: Plan,
    /// Factorizations and solves of the march; None if unknown in advance.
    pub work: Option<[u32; 2]>,
    /// CPU seconds in a separate process, without the reference run.
    pub seconds: f64,
    /// Peak memory of a separate process, with its reference run if it has one. In a sweep the cases of a mesh share
    /// mesh and exact solution, and the meshes of a scene are held together.
    pub memory_bytes: f64,
    /// What remains at its end for other cases on the mesh; of a reference run, for the cases of its scene.
    pub kept_bytes: f64,
    /// What longer cases of a sweep leave on the mesh beyond that: the exact solution at times that this case lacks.
    pub left_bytes: f64,
}

impl Cost {
    /// For a mesh that cannot be made; running the case reports why.
    pub(crate) const UNKNOWN: Self = Self {
        dofs: 0,
        plan: Plan::Newton,
        work: None,
        seconds: 0.0,
        memory_bytes: 0.0,
        kept_bytes: 0.0,
        left_bytes: 0.0,
    };
}

/// The costs of a plan.
pub struct PlanCost {
    /// One per case, in the plan's order.
    pub cases: Vec<Cost>,
    pub reference: Option<Cost>,
}

impl PlanCost {
    pub(crate) fn reference_seconds(&self) -> f64 {
        self.reference.map_or(0.0, |cost| cost.seconds)
    }
}

/// Bytes that all meshes keep when the last case of each runs.
pub fn kept_by_meshes<'a, K: Ord>(cases: impl Iterator<Item = (K, &'a Cost)>) -> f64 {
    let mut kept = BTreeMap::new();
    for (mesh, cost) in cases {
        let known: &mut f64 = kept.entry(mesh).or_default();
        *known = known.max(cost.kept_bytes + cost.left_bytes);
    }
    kept.into_values().sum()
}

/// Predicts cases of a body; one mesh at a time is made and analysed, nothing is solved. Every `kept_steps`-th part of
/// the reference run is kept.
pub(super) fn contact_costs(
    setup: &Setup,
    cases: &[CasePlan],
    reference: Option<Reference>,
    kept_steps: u32,
) -> Result<PlanCost, SetupError> {
    let reference = reference.map(|run| reference_cost(setup, run, kept_steps)).transpose()?;
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by_key(|&c| cases[c].n);
    let mut costs = vec![Cost::UNKNOWN; cases.len()];
    for of_mesh in order.chunk_by(|&a, &b| cases[a].n == cases[b].n) {
        let space = setup.space(cases[of_mesh[0]].n.unwrap_or_default())?;
        let truth = truth(setup, &space);
        for &c in of_mesh {
            let mut cost = case_cost(setup, &space, &truth, &cases[c]);
            cost.memory_bytes += reference.map_or(0.0, |run| run.memory_bytes - PROGRAM);
            costs[c] = cost;
        }
        leave(setup, truth.a_time, of_mesh, cases, &mut costs);
    }
    Ok(PlanCost { cases: costs, reference })
}

/// Seconds per level of an abstract scene, and per pair of levels and kernel in its direct sums.
const LEVEL: [f64; 2] = [2e-4, 5e-8];

pub(super) fn abstract_costs(setup: &AbstractSetup, cases: &[CasePlan]) -> PlanCost {
    let dofs = setup.model.dimension();
    let kernels = setup.problem.kernels.len() as f64;
    let cost = |case: &CasePlan| {
        let levels = f64::from(case.steps) + 1.0;
        Cost {
            dofs,
            seconds: LEVEL[0] * levels + LEVEL[1] * levels * levels * kernels,
            // All states are kept; a kernel value is computed for each pair of times.
            memory_bytes: PROGRAM + 8.0 * 4.0 * levels * dofs as f64,
            ..Cost::UNKNOWN
        }
    };
    PlanCost { cases: cases.iter().map(cost).collect(), reference: None }
}

/// Adds what cases find on their mesh from longer ones, which begin first: `a_time` bytes for each time of those alone.
/// A case with only time errors keeps more, about as much as it leaves.
fn leave(setup: &Setup, a_time: f64, of_mesh: &[usize], cases: &[CasePlan], costs: &mut [Cost]) {
    let mut longest_first = of_mesh.to_vec();
    longest_first.sort_by(|&a, &b| costs[b].seconds.total_cmp(&costs[a].seconds));
    let mut known = BTreeSet::new();
    for c in longest_first {
        let grid = setup.grid(cases[c].steps);
        known.extend(grid.times().iter().map(|time| time.to_bits()));
        costs[c].left_bytes = a_time * (known.len() - grid.times().len()) as f64;
    }
}

fn case_cost(setup: &Setup, space: &Discretization, truth: &TruthCost, case: &CasePlan) -> Cost {
    let dofs = space.dofs() as f64;
    let levels = f64::from(case.steps) + 1.0;
    let mut cost = march(setup, space, case.steps);
    let mut kept = truth.once + truth.a_time * levels;
    if case.norms.contains(&Norm::VTimeMax) {
        let finer = march(setup, space, TIME_REFERENCE * case.steps);
        // The marches are consecutive; displacements and exact loads of the finer one remain.
        cost.seconds += finer.seconds;
        cost.memory_bytes = cost.memory_bytes.max(finer.memory_bytes);
        kept += 8.0 * dofs * levels;
        if setup.exact.is_some() {
            kept += truth.a_time.min(8.0 * dofs) * f64::from((TIME_REFERENCE - 1) * case.steps);
        }
    }
    cost.seconds += truth.seconds(levels);
    cost.memory_bytes += PROGRAM + kept + truth.checked;
    // Including the factor that serves all grids in time.
    cost.kept_bytes += kept + SPACE * space.pattern.entries() as f64;
    cost
}

fn reference_cost(
    setup: &Setup,
    reference: Reference,
    kept_steps: u32,
) -> Result<Cost, SetupError> {
    let space = setup.space(reference.n)?;
    let run = march(setup, &space, reference.steps);
    // u and σ of the levels that cases use.
    let tensors = truth::tensor_numbers(&space) * space.mesh.cell_count();
    let kept = f64::from(kept_steps.min(reference.steps)) + 1.0;
    let levels = 8.0 * kept * (space.dofs() + tensors) as f64;
    let kept_bytes = levels + SPACE * space.pattern.entries() as f64;
    Ok(Cost { memory_bytes: PROGRAM + run.memory_bytes + levels, kept_bytes, ..run })
}

/// One march without its exact solution.
fn march(setup: &Setup, space: &Discretization, steps: u32) -> Cost {
    let model = &setup.model;
    let plan = Plan::of(space, model);
    let newton = plan == Plan::Newton;
    let levels = f64::from(steps) + 1.0;
    let matrices = plan.matrices(model, &setup.grid(steps));
    let factorizations = matrices.map_or(levels, f64::from);
    let iterations = if newton { ITERATIONS } else { 1.0 };
    // Equivalent number of linear cells, which have one point and only corner nodes.
    let nodes = space.nodes.a_cell as f64 / (space.mesh.dimension + 1) as f64;
    let (cells, dofs) = (space.geometry.points() as f64 * nodes.powi(2), space.dofs());
    let pattern = space.pattern.entries() as f64;
    let [factor, multiplications] = space.factor_size();
    let shape = if space.mesh.dimension == 2 { 1.0 } else { TETRAHEDRON };
    let one_factor = !newton && !Plan::changes_factor(model);
    Cost {
        dofs,
        plan,
        work: matrices.map(|matrices| [matrices, steps + 1]),
        seconds: levels * iterations * (shape * CELL * cells + SOLVE * factor)
            + factorizations * (FACTOR[0] * factor + FACTOR[1] * multiplications)
            + past_seconds(setup, dofs, steps),
        // The factor, and scratch of half its size; five matrices with their index; some thirty vectors.
        memory_bytes: 12.0 * factor
            + 52.0 * pattern
            + 240.0 * dofs as f64
            + history_bytes(setup, dofs, steps),
        kept_bytes: if one_factor { 8.0 * (factor + pattern) } else { 0.0 },
        left_bytes: 0.0,
    }
}

fn history_bytes(setup: &Setup, dofs: usize, steps: u32) -> f64 {
    (setup.history_vectors(steps) * dofs * 8) as f64
}

/// Direct sums over the past; recursions and interpolated kernels have few vectors.
fn past_seconds(setup: &Setup, dofs: usize, steps: u32) -> f64 {
    let levels = f64::from(steps) + 1.0;
    let sums = (setup.history_vectors(steps) as f64 / levels).floor();
    let weight = WEIGHT[usize::from(setup.scene.time.rule == TimeRule::ProductIntegration)];
    sums * 0.5 * levels.powi(2) * (weight + TERM * dofs as f64)
}

/// The cost of one run without measuring its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunCost {
    /// CPU seconds of loads and march, without mesh and analysis.
    pub seconds: f64,
    /// Peak memory of a process with this run alone.
    pub memory_bytes: f64,
    /// Factor, matrices, vectors and history.
    pub march_bytes: f64,
    /// The history's share of that.
    pub history_bytes: f64,
    pub load_bytes: f64,
}

/// The cost of mesh, loads and march of one run, as `sweep solve` does it.
pub fn run_cost(setup: &Setup, space: &Discretization, steps: u32) -> RunCost {
    let run = march(setup, space, steps);
    let load_bytes = load_bytes(setup, space);
    RunCost {
        seconds: run.seconds + truth(setup, space).load_seconds(f64::from(steps) + 1.0),
        memory_bytes: PROGRAM + run.memory_bytes + load_bytes,
        march_bytes: run.memory_bytes,
        history_bytes: history_bytes(setup, space.dofs(), steps),
        load_bytes,
    }
}

/// Vectors kept by an eigenvalue iteration: all iterates and images. The limit is reached on long domains, where many
/// eigenvalues are close to the largest.
const ITERATES: f64 = 1200.0;

/// Memory for computing a trace constant on a mesh: stiffness matrix, factor in double precision, and iterates.
pub(super) fn eigenvalue_bytes(space: &Discretization) -> f64 {
    let (entries, [factor, _]) = (space.pattern.entries() as f64, space.factor_size());
    PROGRAM + 12.0 * factor + 40.0 * entries + 8.0 * ITERATES * space.dofs() as f64
}

#[cfg(test)]
mod tests;
