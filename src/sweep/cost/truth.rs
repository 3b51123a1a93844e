//! What loads and exact fields cost: formulas at quadrature points once a time, or once a mesh where they separate.

use super::tensor_numbers;
use crate::contact::Discretization;
use crate::formula::Variable;
use crate::scene::Data;
use crate::setup::Setup;
use crate::space::quadrature::TruthRules;

/// Seconds a point and time in formulas, for a load and for the moments of the truth in the plane, where u, ε and its
/// memory are 8 fields; in space they are 15.
pub(super) const LOAD: f64 = 0.55e-6 / 6.0;
pub(super) const MOMENTS: f64 = 1.1e-6 / 12.0;
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
    /// Seconds a time for the load and for the moments.
    pub load: f64,
    pub moment: f64,
    /// The same where both are evaluated at each time.
    pub direct: [f64; 2],
    /// Seconds, and bytes held, for the parts of fields that separate.
    pub parts_seconds: f64,
    pub parts_bytes: f64,
    /// Bytes held by formulas bound to points, and by loads and moments a time.
    pub formulas: f64,
    pub bytes_a_time: f64,
}

pub(super) fn truth(
    setup: &Setup,
    reference_cells: Option<usize>,
    space: &Discretization,
) -> TruthCost {
    let [load, error] = points(&TruthRules::of(setup.scene.dimension));
    let (count, dofs) = (space.mesh.cell_count() as f64, space.dofs() as f64);
    let numbers = moment_numbers(space) as f64 * count + dofs;
    let bytes_a_time = 8.0 * numbers;
    match (&setup.body.data, &setup.exact) {
        (Data::Exact { interpolated: true, .. }, _) | (Data::Exact { .. }, None) => {
            TruthCost { load: INTERPOLATED, bytes_a_time, ..TruthCost::default() }
        }
        (Data::Exact { .. }, Some(exact)) => {
            let d = setup.scene.dimension;
            let cost = (d + d * (d + 1)) as f64 / 8.0 * count;
            let direct = [LOAD * load * cost, MOMENTS * error * cost];
            if let Some(separation) = &exact.separation {
                let parts = separation.parts as f64;
                return TruthCost {
                    load: PART * parts * dofs,
                    moment: PART * parts * numbers,
                    direct,
                    parts_seconds: parts * (direct[0] + direct[1]),
                    parts_bytes: bytes_a_time * (1.0 + parts),
                    formulas: 0.0,
                    bytes_a_time: FACET * space.trace.measure.len() as f64,
                };
            }
            let formulas = formulas(setup, load * count) + formulas(setup, error * count);
            let [load, moment] = direct;
            TruthCost { load, moment, direct, formulas, bytes_a_time, ..TruthCost::default() }
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
        Some(separation) => 8.0 * (separation.parts * space.dofs()) as f64,
        None => {
            let [load, _] = points(&TruthRules::of(setup.scene.dimension));
            formulas(setup, load * space.mesh.cell_count() as f64)
        }
    }
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
fn points(rules: &TruthRules) -> [f64; 2] {
    [&rules.load, &rules.error].map(|rule| rule.weights.len() as f64)
}

/// What the next rules have over the usual ones: points for loads, for errors, and those for errors over all usual ones.
pub(super) struct RuleRatios {
    pub load: f64,
    pub error: f64,
    pub formulas: f64,
}

impl RuleRatios {
    pub fn of(dimension: usize) -> Self {
        let ([load, error], [next_load, next_error]) =
            (points(&TruthRules::of(dimension)), points(&TruthRules::stronger(dimension)));
        let formulas = next_error / (load + error);
        Self { load: next_load / load, error: next_error / error, formulas }
    }
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
