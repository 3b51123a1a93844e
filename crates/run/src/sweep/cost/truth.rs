//! What loads and exact fields cost: formulas at quadrature points once a time, or once a mesh where they separate.

use super::tensor_numbers;
use exact::{Exact, Products};
use fem::contact::Discretization;
use fem::space::quadrature::TruthRules;
use formula::Variable;
use scene::setup::Setup;
use scene::{Data, LoadForm};

/// Seconds a point and time in formulas, for a load and for the moments of the truth in the plane, where u, ε and its
/// memory are 8 fields; in space they are 15.
pub(super) const LOAD: f64 = 0.55e-6 / 6.0;
pub(super) const MOMENTS: f64 = 1.1e-6 / 12.0;
/// Seconds a cell and time where fields are products along the rows of a mesh, and where their strain is uniform.
const ROWS: f64 = 0.13e-6;
const UNIFORM: f64 = 0.4e-6;
/// Seconds a number and part in the sum of parts, and bytes a facet of Γ3 and time of what is not summed.
const PART: f64 = 0.6e-9;
const FACET: f64 = 128.0;
/// Seconds for ζ of the exact solution, once a scene whose κ depends on it: adaptive quadrature in time and space.
pub(super) const ZETA: f64 = 0.3;
/// Seconds a time where u lives in V^h: ζ by adaptive quadrature, on small meshes.
const INTERPOLATED: f64 = 1e-4;
/// Seconds a cell of the reference mesh and time in moments of a reference run.
const REFERENCE: f64 = 43e-9;

/// The points of a mesh and rule from which on values of formulas are not stored.
const MOST_STORED: f64 = 2_097_152.0;

/// What the truth costs on a mesh.
#[derive(Default)]
pub(super) struct TruthCost {
    /// Seconds a time for the moments, for the load, and for the load where moments are taken at that time as well.
    pub moment: f64,
    pub load: f64,
    pub load_beside: f64,
    /// Seconds for moments and load at one time by the next rules, nothing being known.
    pub next: f64,
    /// Seconds, and bytes held, for the parts of fields that separate.
    pub parts_seconds: f64,
    pub parts_bytes: f64,
    /// Bytes held by formulas at the points of the next rules, while these are compared.
    pub next_formulas: f64,
    /// Bytes held by formulas bound to points, and by loads and moments a time.
    pub formulas: f64,
    pub bytes_a_time: f64,
}

pub(super) fn truth(
    setup: &Setup,
    reference_cells: Option<usize>,
    space: &Discretization,
) -> TruthCost {
    let (count, dofs) = (space.mesh.cell_count() as f64, space.dofs() as f64);
    let numbers = moment_numbers(space) as f64 * count + dofs;
    let bytes_a_time = 8.0 * numbers;
    match (&setup.body.data, &setup.exact) {
        (Data::Exact { interpolated: true, .. }, _) | (Data::Exact { .. }, None) => {
            let load = INTERPOLATED;
            TruthCost { load, load_beside: load, bytes_a_time, ..TruthCost::default() }
        }
        (Data::Exact { .. }, Some(exact)) => {
            let d = setup.scene.dimension;
            let cost = (d + d * (d + 1)) as f64 / 8.0 * count;
            let [load, error] = points(setup, &TruthRules::of(d));
            let [next_load, next_error] = points(setup, &TruthRules::stronger(d));
            let shorter = shorter_way(setup, exact, space);
            let moments = |points: f64| match shorter {
                Some([seconds, _]) => seconds * points / error,
                None => MOMENTS * points * cost,
            };
            let of_moments = |points: f64| match shorter {
                Some([_, bytes]) => bytes * points / error,
                None => formulas(setup, points * count),
            };
            let next = beside(setup, LOAD * next_load * cost) + moments(next_error);
            let next_loads = formulas(setup, beside(setup, next_load) * count);
            let next_formulas = next_loads.max(of_moments(next_error));
            let moment = moments(error);
            let load_seconds = match shorter {
                Some(_) if is_shared(setup) => moment,
                _ => LOAD * load * cost,
            };
            let none = TruthCost::default();
            if let Some(separation) = &exact.separation {
                let parts = separation.factors.parts as f64;
                let a_part = match exact.rows(&space.mesh, &exact.cell_regions(&space.mesh)) {
                    Some(_) => ROWS * count,
                    None => MOMENTS * error * cost,
                };
                return TruthCost {
                    moment: PART * parts * numbers,
                    load: PART * parts * dofs,
                    load_beside: PART * parts * dofs,
                    next,
                    parts_seconds: parts * (beside(setup, load_seconds) + a_part),
                    parts_bytes: bytes_a_time * (1.0 + parts),
                    next_formulas,
                    bytes_a_time: FACET * space.trace.measure.len() as f64,
                    ..none
                };
            }
            let formulas = formulas(setup, beside(setup, load) * count) + of_moments(error);
            let (load, load_beside) = (load_seconds, beside(setup, load_seconds));
            let seconds = TruthCost { moment, load, load_beside, next, ..none };
            TruthCost { next_formulas, formulas, bytes_a_time, ..seconds }
        }
        (Data::Loads { .. }, _) => {
            let moment = reference_cells.map_or(0.0, |cells| REFERENCE * cells as f64);
            TruthCost { moment, bytes_a_time, ..TruthCost::default() }
        }
    }
}

/// Bytes held for the loads of one run, beside those of its times.
pub(super) fn load_bytes(setup: &Setup, space: &Discretization) -> f64 {
    match setup.exact.as_ref().and_then(|exact| exact.separation.as_ref()) {
        Some(separation) => 8.0 * (separation.factors.parts * space.dofs()) as f64,
        None => {
            let [load, _] = points(setup, &TruthRules::of(setup.scene.dimension));
            let shorter = setup.exact.as_ref().filter(|_| is_shared(setup));
            shorter.and_then(|exact| shorter_way(setup, exact, space)).map_or_else(
                || formulas(setup, load * space.mesh.cell_count() as f64),
                |[_, bytes]| bytes,
            )
        }
    }
}

/// Seconds a time for the moments, and bytes held, where they take no points in the cells.
fn shorter_way(setup: &Setup, exact: &Exact, space: &Discretization) -> Option<[f64; 2]> {
    let (mesh, horizon) = (&space.mesh, setup.scene.time.horizon);
    let (cells, regions) = (mesh.cell_count() as f64, exact.cell_regions(mesh));
    if exact.is_uniform(&regions) {
        let bytes = exact.interior.bytes(mesh.vertices() as f64, mesh.dimension, horizon);
        return Some([UNIFORM * cells, bytes]);
    }
    let rows = exact.rows(mesh, &regions)?;
    // Gauss points of the columns, as many as the degree of the rule takes.
    let degree = TruthRules::of(mesh.dimension).error.degree();
    let abscissae = (degree / 2 + 1) as f64 * rows.columns as f64;
    let bytes = |products: &Products| products.along_x.bytes(abscissae, 1, horizon);
    Some([ROWS * cells, exact.products.as_ref().map_or(0.0, bytes)])
}

/// Bytes that the formulas of an exact solution keep for so many points.
fn formulas(setup: &Setup, points: f64) -> f64 {
    let interpolated = matches!(setup.body.data, Data::Exact { interpolated: true, .. });
    match &setup.exact {
        Some(exact) if !interpolated && points <= MOST_STORED => {
            exact.interior.bytes(points, setup.scene.dimension, setup.scene.time.horizon)
        }
        _ => 0.0,
    }
}

/// Numbers a cell of the moments at one time: means of ε and σ, u at the corners.
fn moment_numbers(space: &Discretization) -> usize {
    let d = space.mesh.dimension;
    2 * tensor_numbers(space) + d * (d + 1)
}

/// Points a cell of the rules of loads and errors.
fn points(setup: &Setup, rules: &TruthRules) -> [f64; 2] {
    let load = if is_shared(setup) { &rules.stress } else { &rules.load };
    [load, &rules.error].map(|rule| rule.weights.len() as f64)
}

/// Whether the moments have all that the loads need.
fn is_shared(setup: &Setup) -> bool {
    matches!(setup.body.data, Data::Exact { form: LoadForm::Weak, .. })
}

/// What is left of a number of the loads where moments are there.
fn beside(setup: &Setup, of_loads: f64) -> f64 {
    if is_shared(setup) { 0.0 } else { of_loads }
}

/// Seconds for ζ of the exact solution.
pub(super) fn zeta(setup: &Setup) -> f64 {
    let interpolated = matches!(setup.body.data, Data::Exact { interpolated: true, .. });
    let needed = setup.exact.as_ref().filter(|_| !interpolated).is_some_and(|exact| {
        let depends = |kappa| exact.data.graph.depends_on(kappa, Variable::Zeta);
        // Without a front the strain norm is smooth, and its integral costs next to nothing.
        let has_fronts = !exact.data.graph.guards(&exact.data.u).is_empty();
        has_fronts && exact.data.kappa.is_some_and(depends)
    });
    if needed { ZETA } else { 0.0 }
}
