//! One case of an abstract scene: ‖u(t_n) - u_n^k‖_X at every step, its maximum over time.

use std::time::Instant;

use super::plan::CasePlan;
use judge::record::{CaseRecord, NormError, Status};
use scene::Norm;
use scene::setup::AbstractSetup;
use vhi::Newton;

/// Runs a case; a failure is recorded with its reason and without errors.
pub fn run_abstract_case(setup: &AbstractSetup, case: &CasePlan) -> CaseRecord {
    let start = Instant::now();
    let grid = setup.grid(case.steps);
    let (run, status) = match setup.run(case.steps, &Newton::default()) {
        Ok(run) => (Some(run), Status::Converged),
        Err(error) => (None, Status::Failed { reason: error.to_string() }),
    };
    let info = run.as_ref().map_or_else(Default::default, |run| run.info);
    CaseRecord {
        dimension: setup.scene.dimension as u32,
        dofs: setup.scene.dimension as u64,
        status,
        newton_iterations: info.newton_iterations.into(),
        active_set_changes: info.active_set_changes.into(),
        factorizations: info.newton_iterations.into(),
        seconds_load: run.as_ref().map_or(0.0, |run| run.seconds_truth),
        seconds_total: start.elapsed().as_secs_f64(),
        peak_history_bytes: info.peak_history_bytes as u64,
        errors: vec![NormError {
            norm: Norm::VMax.name().to_string(),
            error: run.as_ref().map(|run| run.error),
            floor: run.as_ref().map(|run| run.info.floor),
        }],
        ..CaseRecord::without_work(&setup.scene.name, None, case.steps, grid.largest_step())
    }
}
