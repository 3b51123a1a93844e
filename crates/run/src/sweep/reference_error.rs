//! Error of the reference run of a scene with given loads, in V errors.

use super::plan::ScenePlan;
use judge::fit::{AgainstReference, against_reference};
use judge::record::{CaseRecord, V_MAX};

/// The order of `V_max` in h corrected for the reference, on the three finest meshes at the most steps. None for scenes
/// with an exact solution, or without three meshes of one ratio.
pub fn reference_error(plan: &ScenePlan, records: &[CaseRecord]) -> Option<AgainstReference> {
    let reference = plan.reference?;
    let steps = plan.cases.iter().map(|case| case.steps).max()?;
    let on_line = |record: &&CaseRecord| {
        record.scene == plan.scene().name
            && record.steps == steps
            && record.n.is_some_and(|n| n < reference.n)
    };
    let mut points: Vec<(f64, f64)> = records
        .iter()
        .filter(on_line)
        .filter_map(|record| {
            let entry = record.errors.iter().find(|entry| entry.norm == V_MAX)?;
            Some((1.0 / f64::from(record.n?), entry.error?))
        })
        .collect();
    points.sort_by(|a, b| b.0.total_cmp(&a.0));
    let last = points.last_chunk::<3>()?;
    against_reference(*last, 1.0 / f64::from(reference.n))
}

/// One line for the terminal.
pub fn reference_in_words(scene: &str, found: &AgainstReference) -> String {
    let AgainstReference { order, measured_order, reference_error, finest: [measured, whole] } =
        found;
    format!(
        "{scene}: V_max in h against its reference run: local order {measured_order:.2}, {order:.2} without the reference's own error of about {reference_error:.1e}; finest error {measured:.2e}, about {whole:.2e} with it"
    )
}
