//! Records of runs, what is foreseen of them, and their verdicts.

use judge::record::{CaseRecord, Key};
use judge::verdict::{LeadingLine, Verdict};
use run::leading_error::{Case, InTime, leading_errors};
use run::sweep::{CasePlan, foresee, judge_scene, run_contact_case};
use scene::setup::{MeshData, Setup, Subject};
use scene::{Direction, Norm};

use crate::shipped::on_mesh;

/// The record of a run on a mesh n.
pub fn record(setup: &Setup, data: &MeshData, n: u32, steps: u32, norms: &[Norm]) -> CaseRecord {
    run_contact_case(setup, data, &CasePlan { n: Some(n), steps, norms: norms.to_vec() })
}

/// Its errors.
pub fn errors(setup: &Setup, data: &MeshData, n: u32, steps: u32, norms: &[Norm]) -> Vec<f64> {
    let record = record(setup, data, n, steps, norms);
    let error = |norm: &Norm| record.norm(norm.name()).and_then(|entry| entry.error);
    norms.iter().map(|norm| error(norm).expect("a run that converges")).collect()
}

/// The records of a grid.
pub fn records(setup: &Setup, ns: &[u32], steps: &[u32], norm: Norm) -> Vec<CaseRecord> {
    let mut records = Vec::new();
    for &n in ns {
        let data = on_mesh(setup, n);
        records.extend(steps.iter().map(|&steps| record(setup, &data, n, steps, &[norm])));
    }
    records
}

/// The verdicts of records, with the constants that are foreseen.
pub fn verdicts(subject: &Subject, records: &[CaseRecord]) -> Vec<Verdict> {
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    judge_scene(subject.scene(), records, &keys, &foresee(subject, records))
}

/// The first verdict of a scene on the grid of its file.
pub fn verdict(setup: Setup) -> Verdict {
    let sweep = setup.scene.sweep.clone().expect("a sweep");
    let records = records(&setup, &sweep.n, &sweep.steps, setup.scene.predicts[0].norm);
    verdicts(&Subject::Contact(Box::new(setup)), &records).remove(0)
}

/// What is foreseen of an error of this order on one mesh, or without one.
pub fn foreseen(
    subject: &Subject,
    line: (Norm, Direction, f64),
    n: Option<u32>,
    steps: &[u32],
) -> LeadingLine {
    let cases: Vec<Case> = steps.iter().map(|&steps| Case { n, steps }).collect();
    leading_errors(subject, line, &cases, &mut InTime::default())
        .unwrap_or_else(|error| panic!("{error}"))
}
