//! Predicted size of cases. Bytes are counted from the symbolic factor, the formulas and the number of levels; they
//! decide what runs in parallel and what is refused. Unknowns times steps decide the order of cases.

use super::plan::CasePlan;
use fem::contact::{Discretization, Plan};
use fem::space::quadrature::TruthRules;
use formula::Program;
use leading_error::TIME_REFERENCE;
use scene::setup::{AbstractSetup, Setup, SetupError};
use scene::{Data, LoadForm, Norm, Reference};
use std::collections::{BTreeMap, BTreeSet};

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
    /// Unknowns times steps of its runs on its mesh: what takes longer has more of them.
    pub work: f64,
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
        work: 0.0,
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
    let of_reference = |reference: Reference| -> Result<Cost, SetupError> {
        let space = setup.space(reference.n)?;
        let run = march(setup, &space, reference.steps);
        // u and σ of the levels that cases use.
        let tensors = tensor_numbers(&space) * space.mesh.cell_count();
        let kept = f64::from(kept_steps.min(reference.steps)) + 1.0;
        let levels = 8.0 * kept * (space.dofs() + tensors) as f64;
        let kept_bytes = levels + SPACE * space.pattern.entries() as f64;
        Ok(Cost { memory_bytes: PROGRAM + run.memory_bytes + levels, kept_bytes, ..run })
    };
    let reference = reference.map(of_reference).transpose()?;
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
        // What they find there from longer ones, which begin first: exact fields at times of those alone. A case with only time
        // errors keeps more, about as much as it leaves.
        let mut longest_first = of_mesh.to_vec();
        longest_first.sort_by(|&a, &b| costs[b].work.total_cmp(&costs[a].work));
        let mut known = BTreeSet::new();
        for c in longest_first {
            let grid = setup.grid(cases[c].steps);
            known.extend(grid.times().iter().map(|time| time.to_bits()));
            costs[c].left_bytes = truth.a_time * (known.len() - grid.times().len()) as f64;
        }
    }
    Ok(PlanCost { cases: costs, reference })
}

pub(super) fn abstract_costs(setup: &AbstractSetup, cases: &[CasePlan]) -> PlanCost {
    let dofs = setup.model.dimension();
    let cost = |case: &CasePlan| {
        let levels = f64::from(case.steps) + 1.0;
        Cost {
            dofs,
            work: dofs as f64 * f64::from(case.steps),
            // All states are kept.
            memory_bytes: PROGRAM + 8.0 * 4.0 * levels * dofs as f64,
            ..Cost::UNKNOWN
        }
    };
    PlanCost { cases: cases.iter().map(cost).collect(), reference: None }
}

fn case_cost(setup: &Setup, space: &Discretization, truth: &TruthCost, case: &CasePlan) -> Cost {
    let dofs = space.dofs() as f64;
    let levels = f64::from(case.steps) + 1.0;
    let mut cost = march(setup, space, case.steps);
    let mut kept = truth.once + truth.a_time * levels;
    if case.norms.contains(&Norm::VTimeMax) {
        let finer = march(setup, space, TIME_REFERENCE * case.steps);
        // The marches are consecutive; displacements and exact loads of the finer one remain.
        cost.work += finer.work;
        cost.memory_bytes = cost.memory_bytes.max(finer.memory_bytes);
        kept += 8.0 * dofs * levels;
        if setup.exact.is_some() {
            kept += truth.a_time.min(8.0 * dofs) * f64::from((TIME_REFERENCE - 1) * case.steps);
        }
    }
    cost.memory_bytes += PROGRAM + kept + truth.checked;
    // Including the factor that serves all grids in time.
    cost.kept_bytes += kept + SPACE * space.pattern.entries() as f64;
    cost
}

/// One march without its exact solution.
fn march(setup: &Setup, space: &Discretization, steps: u32) -> Cost {
    let model = &setup.model;
    let plan = Plan::of(space, model);
    let (dofs, pattern) = (space.dofs(), space.pattern.entries() as f64);
    let [factor, _] = space.factor_size();
    // One matrix serves all levels.
    let one_factor = plan != Plan::Newton && !Plan::changes_factor(model);
    Cost {
        dofs,
        plan,
        work: dofs as f64 * f64::from(steps),
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

/// The bytes of one run without measuring its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunCost {
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
        memory_bytes: PROGRAM + run.memory_bytes + load_bytes,
        march_bytes: run.memory_bytes,
        history_bytes: history_bytes(setup, space.dofs(), steps),
        load_bytes,
    }
}

#[cfg(test)]
mod tests;

// Bytes of loads and exact fields: formulas at quadrature points, and values per time.

/// Points of mesh and rule from which values of formulas are not stored.
const MOST_STORED: f64 = 2_097_152.0;

/// What the exact solution keeps on a mesh.
#[derive(Default)]
pub(super) struct TruthCost {
    /// Bytes independent of the times: formulas bound to points.
    pub once: f64,
    /// Bytes per time, of loads and moments.
    pub a_time: f64,
    /// Bytes of formulas at the points of the next rules, during their comparison.
    pub checked: f64,
}

pub(super) fn truth(setup: &Setup, space: &Discretization) -> TruthCost {
    let d = space.mesh.dimension;
    let (count, dofs) = (space.mesh.cell_count() as f64, space.dofs() as f64);
    // ε and σ at the strain points, and u at the nodes of each cell.
    let moments = 2 * tensor_numbers(space) * space.geometry.points() + d * space.nodes.cells.len();
    let a_time = 8.0 * (moments as f64 + dofs);
    if setup.exact.is_none() || setup.body.data.is_interpolated() {
        return TruthCost { once: load_bytes(setup, space), a_time, ..TruthCost::default() };
    }
    let [load, error] = points(setup, &TruthRules::for_element(space.element, d));
    let [next_load, next_error] = points(setup, &TruthRules::stronger_for(space.element, d));
    let of_moments = |points: f64| formulas(setup, points * count);
    let beside = |of_loads: f64| if is_shared(setup) { 0.0 } else { of_loads };
    let checked = formulas(setup, beside(next_load) * count).max(of_moments(next_error));
    let once = formulas(setup, beside(load) * count) + of_moments(error);
    TruthCost { once, a_time, checked }
}

pub(super) fn load_bytes(setup: &Setup, space: &Discretization) -> f64 {
    let [load, _] = points(setup, &TruthRules::for_element(space.element, setup.scene.dimension));
    let points = load * space.mesh.cell_count() as f64;
    let Data::Loads { body, .. } = &setup.body.data else { return formulas(setup, points) };
    let graph = &setup.scene.formulas;
    if body.iter().all(|&formula| graph.value_of_constant(formula) == Some(0.0)) {
        return 0.0;
    }
    // Formulas at the points, their values, and the nodes of each cell.
    let (d, horizon) = (setup.scene.dimension, setup.scene.time.horizon);
    let nodes = 4 * space.nodes.cells.len();
    Program::compile(graph, body, horizon).bytes(points, d, horizon)
        + 8.0 * (body.len() as f64 * points)
        + nodes as f64
}

/// Bytes that the formulas of an exact solution keep at so many points.
fn formulas(setup: &Setup, points: f64) -> f64 {
    match &setup.exact {
        Some(exact) if !setup.body.data.is_interpolated() && points <= MOST_STORED => {
            exact.interior.bytes(points, setup.scene.dimension, setup.scene.time.horizon)
        }
        _ => 0.0,
    }
}

pub(super) fn tensor_numbers(space: &Discretization) -> usize {
    let d = space.mesh.dimension;
    d * (d + 1) / 2
}

/// Points per cell of the rules of loads and errors.
fn points(setup: &Setup, rules: &TruthRules) -> [f64; 2] {
    let load = if is_shared(setup) { &rules.stress } else { &rules.load };
    [load, &rules.error].map(|rule| rule.weights.len() as f64)
}

/// Whether loads follow from the moments.
fn is_shared(setup: &Setup) -> bool {
    matches!(setup.body.data, Data::Exact { form: LoadForm::Weak, .. })
}
