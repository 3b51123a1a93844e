//! Cost of loads and exact fields: formulas at quadrature points, per time, or once per mesh if they separate.

use fem::contact::Discretization;
use fem::space::quadrature::TruthRules;
use scene::setup::Setup;
use scene::{Data, LoadForm};

/// Seconds per point and time for the formulas of 8 fields: u, ε and its memory in the plane. In space there are 15.
const POINT: f64 = 0.09e-6;
/// Seconds per integral over the past for a non-exponential kernel.
const FROM_ZERO: f64 = 20e-6;
/// Rules are compared at two times, by one of about twice the points.
const COMPARED: f64 = 4.0;
/// Bytes per facet of Γ3 and time of unsummed values, if fields separate.
const FACET: f64 = 128.0;

/// Points of mesh and rule from which values of formulas are not stored.
const MOST_STORED: f64 = 2_097_152.0;

/// Cost of the exact solution on a mesh.
#[derive(Default)]
pub(super) struct TruthCost {
    /// Bytes independent of the times: formulas bound to points, or the parts of separated fields.
    pub once: f64,
    /// Bytes per time, of loads and moments.
    pub a_time: f64,
    /// Bytes of formulas at the points of the next rules, during their comparison.
    pub checked: f64,
    /// Seconds of the moments at one time, and of the load.
    moment: f64,
    load: f64,
    /// Seconds per time of integrals from 0, whether fields separate or not.
    past: f64,
    /// Number of parts, if fields separate: moments and loads are then computed per part, not per time.
    parts: Option<f64>,
}

impl TruthCost {
    pub(super) fn seconds(&self, times: f64) -> f64 {
        (self.moment + self.load) * (self.parts.unwrap_or(times) + COMPARED) + self.past * times
    }

    pub(super) fn load_seconds(&self, times: f64) -> f64 {
        // The weak form takes its loads from the moments.
        let load = if self.load > 0.0 { self.load } else { self.moment };
        load * self.parts.unwrap_or(times) + self.past * times
    }
}

pub(super) fn truth(setup: &Setup, space: &Discretization) -> TruthCost {
    let d = space.mesh.dimension;
    let (count, dofs) = (space.mesh.cell_count() as f64, space.dofs() as f64);
    // ε and σ at the strain points, and u at the nodes of each cell.
    let moments = 2 * tensor_numbers(space) * space.geometry.points() + d * space.nodes.cells.len();
    let a_time = 8.0 * (moments as f64 + dofs);
    let exact = setup.exact.as_ref().filter(|_| !setup.body.data.is_interpolated());
    let Some(exact) = exact else { return TruthCost { a_time, ..TruthCost::default() } };
    let [load, error] = points(setup, &TruthRules::for_element(space.element, d));
    let [next_load, next_error] = points(setup, &TruthRules::stronger_for(space.element, d));
    let of_moments = |points: f64| formulas(setup, points * count);
    let beside = |of_loads: f64| if is_shared(setup) { 0.0 } else { of_loads };
    let checked = formulas(setup, beside(next_load) * count).max(of_moments(next_error));
    let seconds = POINT * (d + d * (d + 1)) as f64 / 8.0 * count;
    let parts = exact.separation.as_ref().map(|separation| separation.factors.parts as f64);
    let (once, a_time) = match parts {
        Some(parts) => (a_time * (1.0 + parts), FACET * space.trace.measure.len() as f64),
        None => (formulas(setup, beside(load) * count) + of_moments(error), a_time),
    };
    let (moment, load) = (error * seconds, beside(load) * seconds);
    let past = FROM_ZERO * exact.interior.integrals_from_zero(error * count, d);
    TruthCost { once, a_time, checked, moment, load, past, parts }
}

pub(super) fn load_bytes(setup: &Setup, space: &Discretization) -> f64 {
    let exact = setup.exact.as_ref();
    if let Some(separation) = exact.and_then(|exact| exact.separation.as_ref()) {
        return 8.0 * (separation.factors.parts * space.dofs()) as f64;
    }
    let [load, _] = points(setup, &TruthRules::for_element(space.element, setup.scene.dimension));
    formulas(setup, load * space.mesh.cell_count() as f64)
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
