//! One case of an abstract scene: ‖u(t_n) - u_n^k‖_X and the error of the pressures at every step, their maxima over time.

use std::time::Instant;

use super::plan::CasePlan;
use judge::record::{CaseRecord, NormError, Status};
use scene::Norm;
use scene::setup::{AbstractLoad, AbstractRun, AbstractSetup};
use vhi::Newton;
use vhi::finite::FiniteLoad;

/// Runs a case; a failure is recorded with its reason and without errors.
pub fn run_abstract_case(setup: &AbstractSetup, case: &CasePlan) -> CaseRecord {
    run_abstract_under(&mut AbstractLoad(setup), setup, case)
}

/// The same under another load than that of the exact solution.
pub fn run_abstract_under(
    load: &mut dyn FiniteLoad,
    setup: &AbstractSetup,
    case: &CasePlan,
) -> CaseRecord {
    let start = Instant::now();
    let grid = setup.grid(case.steps);
    let (run, status) = match setup.run_under(load, case.steps, &Newton::default()) {
        Ok(run) => (Some(run), Status::Converged),
        Err(error) => (None, Status::Failed { reason: error.to_string() }),
    };
    let measured = |norm: &Norm| {
        let of_run = |run: &AbstractRun| match norm {
            Norm::PressureL2Max => (run.pressure_error, run.info.pressure_floor),
            _ => (run.error, run.info.floor),
        };
        let (error, floor) = run.as_ref().map(of_run).unzip();
        NormError { norm: norm.name().to_string(), error, floor }
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
        errors: case.norms.iter().map(measured).collect(),
        ..CaseRecord::without_work(&setup.scene.name, None, case.steps, grid.largest_step())
    }
}
