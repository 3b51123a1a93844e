//! One case of an abstract scene: ‖u(t_n) - u_n^k‖_X at every step, its maximum over time.

use std::time::Instant;

use nalgebra::DVector;

use super::plan::CasePlan;
use crate::finite::march;
use crate::record::{CaseRecord, NormError, Status};
use crate::scene::Norm;
use crate::setup::{AbstractLoad, AbstractSetup};
use crate::vhi::Newton;

/// Runs a case; a failure is recorded with its reason, and never carries an error.
pub fn run_abstract_case(setup: &AbstractSetup, case: &CasePlan) -> CaseRecord {
    let start = Instant::now();
    let grid = setup.grid(case.steps);
    let (mut largest, mut seconds_load) = (0f64, 0.0);
    let outcome =
        march(&setup.model, &grid, &mut AbstractLoad(setup), &Newton::default(), &mut |view| {
            let begin = Instant::now();
            let exact = DVector::from_column_slice(&setup.state(view.t).u);
            seconds_load += begin.elapsed().as_secs_f64();
            let error = setup.model.norm(&(exact - view.u));
            // A NaN stays.
            if error.is_nan() || error > largest {
                largest = error;
            }
        });
    let info = outcome.as_ref().copied().unwrap_or_default();
    let converged = outcome.is_ok();
    let status = match outcome {
        Ok(_) => Status::Converged,
        Err(error) => Status::Failed { reason: error.to_string() },
    };
    CaseRecord {
        scene: setup.scene.name.clone(),
        dimension: setup.scene.dimension as u32,
        n: None,
        steps: case.steps,
        h: None,
        k: grid.largest_step(),
        dofs: setup.scene.dimension as u64,
        elements: 0,
        status,
        newton_iterations: info.newton_iterations.into(),
        active_set_changes: info.active_set_changes.into(),
        factorizations: info.newton_iterations.into(),
        seconds_load,
        seconds_assemble: 0.0,
        seconds_factor: 0.0,
        seconds_solve: 0.0,
        seconds_total: start.elapsed().as_secs_f64(),
        peak_history_bytes: info.peak_history_bytes as u64,
        errors: vec![NormError {
            norm: Norm::VMax.name().to_string(),
            error: converged.then_some(largest),
            floor: converged.then_some(info.floor),
        }],
    }
}
