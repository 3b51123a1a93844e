//! Bytes of loads and exact fields: formulas at quadrature points, and values per time.

use fem::contact::Discretization;
use fem::space::quadrature::TruthRules;
use formula::Program;
use scene::setup::Setup;
use scene::{Data, LoadForm};

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
