//! What audited runs take of the memory.

use super::smooth::point_count;
use fem::contact::Discretization;
use run::sweep::{Runs, run_cost};
use scene::setup::Setup;

/// Numbers a point of the volume: place, area and cell, kept and copied, and u, ε, H, f0 of a time.
const A_POINT: f64 = 2.0 * 4.5 + 10.0;
/// Points a cell at which the truth remembers its strains, three numbers each, of all levels: formulas, or constants.
const REMEMBERED: [f64; 2] = [3.0, 1.0];

/// The runs of [`super::SceneAudit::new`], `jobs` of a mesh at a time.
pub fn audit_runs<'a>(setup: &'a Setup, ns: &[u32], steps: &[u32], jobs: usize) -> Runs<'a> {
    let grid = ns.iter().flat_map(|&n| steps.iter().map(move |&steps| (n, steps))).collect();
    let others = steps.len().min(jobs).saturating_sub(1) as f64;
    let beside = move |space: &Discretization, steps: u32| {
        // The others march and audit as well, with fewer steps or as many.
        let march = run_cost(setup, space, steps).march_bytes;
        others * march + (1.0 + others) * auditor(setup, space, steps)
    };
    Runs { setup, grid, beside: Box::new(beside) }
}

/// Bytes of the auditor of one run: formulas at the points of its rules, what they give at a time, and the past. Cells
/// that a front crosses have more points, and are few.
fn auditor(setup: &Setup, space: &Discretization, steps: u32) -> f64 {
    let interpolated = setup.body.data.is_interpolated();
    let formulas = setup.exact.as_ref().filter(|_| !interpolated);
    let cells = space.mesh.cell_count() as f64;
    let remembered = REMEMBERED[usize::from(formulas.is_none())] * cells;
    let past = match setup.body.material.memory.is_empty() {
        true => 0.0,
        false => 3.0 * 8.0 * remembered * (f64::from(steps) + 1.0),
    };
    let (d, horizon) = (setup.scene.dimension, setup.scene.time.horizon);
    let Some(exact) = formulas else { return past + 8.0 * A_POINT * cells };
    let points = point_count(space) as f64;
    let bound = exact.interior.bytes(points, d, horizon) + exact.forces.bytes(points, d, horizon);
    past + bound + exact.interior.bytes(remembered, d, horizon) + 8.0 * A_POINT * points
}
