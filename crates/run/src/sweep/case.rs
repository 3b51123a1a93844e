//! One case: march, errors at every step, their maxima over time.

use super::plan::CasePlan;
use algebra::linalg::larger;
use fem::contact::{CaseError, CaseInfo, Floors, LoadError, StepView, strain_distance};
use fem::norms::{ContactState, ElasticProjection, StepErrors, state_errors, step_errors};
use judge::record::{CaseRecord, NormError, Status};
use leading_error::TIME_REFERENCE;
use scene::setup::{AbstractLoad, AbstractRun, AbstractSetup, MeshData, Setup};
use scene::{Norm, Reference};
use std::collections::BTreeMap;
use std::time::Instant;
use vhi::Newton;
use vhi::finite::FiniteLoad;

/// Runs a case; a failure is recorded with its reason and without errors.
pub fn run_contact_case(setup: &Setup, data: &MeshData, case: &CasePlan) -> CaseRecord {
    let start = Instant::now();
    let mut maxima = Maxima::default();
    let outcome = measure(setup, data, case, &mut maxima);
    let grid = setup.grid(case.steps);
    let (info, quadrature) = outcome.as_ref().copied().unwrap_or_default();
    let floors = CaseFloors {
        solver: info.floors,
        quadrature,
        share: scene_reference(setup)
            .zip(case.n)
            .map_or(0.0, |(reference, n)| reference_share(reference, n, case.steps)),
    };
    let status = match &outcome {
        Ok(_) => Status::Converged,
        Err(error) => Status::Failed { reason: error.to_string() },
    };
    CaseRecord {
        dimension: setup.scene.dimension as u32,
        h: Some(data.space.mesh.h()),
        dofs: data.space.dofs() as u64,
        elements: data.space.mesh.cell_count() as u64,
        errors: maxima.errors(&case.norms, status == Status::Converged, &floors),
        status,
        newton_iterations: info.newton_iterations.into(),
        active_set_changes: info.active_set_changes.into(),
        factorizations: info.work.linear.factorizations.into(),
        seconds_load: info.seconds_load,
        seconds_assemble: info.work.seconds_assemble,
        seconds_factor: info.work.linear.seconds_factor,
        seconds_solve: info.work.linear.seconds_solve,
        seconds_total: start.elapsed().as_secs_f64(),
        peak_history_bytes: info.peak_history_bytes as u64,
        ..CaseRecord::without_work(&setup.scene.name, case.n, case.steps, grid.largest_step())
    }
}

fn measure(
    setup: &Setup,
    data: &MeshData,
    case: &CasePlan,
    maxima: &mut Maxima,
) -> Result<(CaseInfo, Floors), CaseError> {
    let wants = |norm| case.norms.contains(&norm);
    // Before loads are asked for, here or by the finer run.
    data.truth.expect(setup.grid(case.steps).times())?;
    let finer = || data.trajectory(setup, TIME_REFERENCE * case.steps, case.steps);
    let finer = wants(Norm::VTimeMax).then(finer).transpose()?;
    let (elastic, mu) = (&setup.model.elasticity, setup.projection_mu());
    let projection = || ElasticProjection::new(&data.space, elastic, mu, true);
    let projection = wants(Norm::VProjectionMax).then(projection).transpose();
    let mut projection =
        projection.map_err(|error| LoadError::Reference { reason: error.to_string() })?;
    let by_state = case.norms.iter().any(|norm| norm.by_state());
    let mut by_rule = Floors::default();
    let mut observe = |view: &StepView<'_>| {
        let moments = data.truth.moments(view.t)?;
        let errors = step_errors(&data.space, &setup.model, view, &moments);
        if let Some(stronger) = data.rule_check(setup)?.moments(view.t) {
            let other = step_errors(&data.space, &setup.model, view, stronger);
            by_rule = by_rule.max(as_floors(&errors).minus(as_floors(&other)));
        }
        for (norm, value) in [
            (Norm::VMax, errors.v),
            (Norm::L2Max, errors.l2),
            (Norm::StressL2Max, errors.stress),
            (Norm::TraceL2Max, errors.trace),
            (Norm::PressureL2Max, errors.pressure),
            (Norm::ContactSetMax, errors.contact_set),
        ] {
            maxima.raise(norm, value);
        }
        if by_state && let Some(samples) = data.truth.contact_samples(view.t)? {
            let errors = state_errors(&data.space, view, &samples);
            for (i, state) in ContactState::ALL.into_iter().enumerate() {
                if errors.measure[i] > 0.0 {
                    maxima.raise(Norm::TraceMax(state), errors.trace[i]);
                    maxima.raise(Norm::PressureMax(state), errors.pressure[i]);
                }
            }
            maxima.raise(Norm::ContactMeasureMax, errors.set_difference);
        }
        if let Some(finer) = &finer {
            let reason = || format!("the finer run has no step at t = {}", view.t);
            let missing = || LoadError::Reference { reason: reason() };
            let reference = finer.at(view.t).ok_or_else(missing)?;
            maxima.raise(Norm::VTimeMax, strain_distance(&data.space, view.u, reference));
        }
        if let Some(projection) = &mut projection {
            maxima.raise(Norm::VProjectionMax, projection.distance(&moments, view.u));
        }
        Ok(())
    };
    let info = setup.scheme.march(setup, data, case.steps, &mut observe)?;
    Ok((info, data.rule_check(setup)?.floors.plus(by_rule.times(ERROR_RULE))))
}

/// Factor for error quadrature, which is compared at a few levels only.
pub(super) const ERROR_RULE: f64 = 2.0;

/// The norms of one level that have a floor.
pub fn as_floors(errors: &StepErrors) -> Floors {
    let StepErrors { v, l2, stress, trace, pressure, .. } = *errors;
    Floors { v, l2, stress, trace, pressure }
}

/// Maxima over time; NaN is kept, a norm that was never raised is absent.
#[derive(Default)]
struct Maxima(BTreeMap<Norm, f64>);

impl Maxima {
    fn raise(&mut self, norm: Norm, value: f64) {
        let known = self.0.entry(norm).or_insert(value);
        *known = larger(*known, value);
    }

    fn errors(&self, norms: &[Norm], converged: bool, floors: &CaseFloors) -> Vec<NormError> {
        let one = |norm: &Norm| {
            let error = self.0.get(norm).copied().filter(|_| converged);
            let floor = error.map(|error| floors.of(*norm, error));
            NormError { norm: norm.name().to_string(), error, floor }
        };
        norms.iter().map(one).collect()
    }
}

/// The part of the errors of a case that is not discretisation.
struct CaseFloors {
    /// Accepted residuals and rounding.
    solver: Floors,
    /// Quadrature of loads and errors.
    quadrature: Floors,
    /// Share of an error that the reference run may hide.
    share: f64,
}

impl CaseFloors {
    fn of(&self, norm: Norm, error: f64) -> f64 {
        match norm {
            // Two runs on one mesh under equal loads: no quadrature, and no finer mesh.
            Norm::VTimeMax => 2.0 * self.solver.v + time_reference_floor(error),
            Norm::ContactSetMax | Norm::ContactMeasureMax => 0.0,
            _ => {
                floor_in(&self.solver, norm) + floor_in(&self.quadrature, norm) + self.share * error
            }
        }
    }
}

/// The floor of a norm; unknown for contact sets.
pub fn floor_in(floors: &Floors, norm: Norm) -> f64 {
    match norm {
        Norm::VMax | Norm::VTimeMax | Norm::DisplacementMax | Norm::VProjectionMax => floors.v,
        Norm::L2Max => floors.l2,
        Norm::StressL2Max => floors.stress,
        Norm::TraceL2Max | Norm::TraceMax(_) => floors.trace,
        Norm::PressureL2Max | Norm::PressureMax(_) => floors.pressure,
        Norm::ContactSetMax | Norm::ContactMeasureMax => 0.0,
    }
}

/// The reference run that errors are measured against; none where there is an exact solution.
pub fn scene_reference(setup: &Setup) -> Option<Reference> {
    let sweep = setup.scene.sweep.as_ref().filter(|_| setup.exact.is_none());
    sweep.and_then(|sweep| sweep.reference)
}

/// Error of the run with 8N steps, from an error against it: 1/64 of the time error of the case at order 2 (3.17), so
/// 1/63 of what is measured. It is the same share at every point of a line: it moves C_k, not the order.
pub(super) fn time_reference_floor(error: f64) -> f64 {
    let ratio = f64::from(TIME_REFERENCE * TIME_REFERENCE);
    error / (ratio - 1.0)
}

/// Least order in h of a reference run: where conditions change on a straight side or a convex corner, u behaves like
/// r^(1/2) at worst.
const REFERENCE_ORDER: f64 = 0.5;

/// Share of a measured error that the reference's error may hide, for a reference of the given mesh and steps. In space
/// the discrete solutions of nested meshes are nearly orthogonal, e² = C²(h^2p - h_ref^2p); in time the error is C(k² -
/// k_ref²). What both have in common (equal n, or equal N) does not show in e.
pub(super) fn reference_share(reference: Reference, n: u32, steps: u32) -> f64 {
    let (cells, times) =
        (f64::from(reference.n) / f64::from(n), f64::from(reference.steps) / f64::from(steps));
    let in_space = match cells > 1.0 {
        true => (1.0 + 1.0 / (cells.powf(2.0 * REFERENCE_ORDER) - 1.0)).sqrt() - 1.0,
        false => 0.0,
    };
    let in_time = if times > 1.0 { 1.0 / (times * times - 1.0) } else { 0.0 };
    in_space.max(in_time)
}

// One case of an abstract scene: ‖u(t_n) - u_n^k‖_X and the error of the pressures at every step, their maxima over
// time.

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
            // The weights of a sum add up to T at most.
            Norm::DisplacementMax => {
                (run.displacement_error, setup.scene.time.horizon * run.info.floor)
            }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Solver and quadrature have floors that tell the norms apart; a reference hides a tenth of an error.
    #[test]
    fn each_norm_has_its_own_floor() {
        let solver = Floors { v: 1.0, l2: 2.0, stress: 3.0, trace: 4.0, pressure: 5.0 };
        let quadrature = Floors { v: 10.0, l2: 20.0, stress: 30.0, trace: 40.0, pressure: 50.0 };
        let floors = CaseFloors { solver, quadrature, share: 0.1 };
        for norm in Norm::all() {
            let expected = match norm.name() {
                "V_max" | "displacement_max" | "V_projection_max" => 12.0,
                "L2_max" => 23.0,
                "stress_L2_max" => 34.0,
                name if name.starts_with("trace_") => 45.0,
                name if name.starts_with("pressure_") => 56.0,
                // Two runs on one mesh: both solver floors, and 1/63 of the error, 10.
                "V_time_max" => 2.0 + 10.0 / 63.0,
                "contact_set_max" | "contact_measure_max" => 0.0,
                other => panic!("{other}"),
            };
            let found = floors.of(norm, 10.0);
            assert!((found - expected).abs() < 1e-12, "{}: {found}", norm.name());
        }
    }
}
