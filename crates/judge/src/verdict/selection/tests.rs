//! Lines with missing, unmeasured, broken and outside cases.

use super::*;
use crate::record::{NormError, V_MAX};

fn case(n: u32, steps: u32) -> CaseRecord {
    let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
    CaseRecord {
        h: Some(h),
        status: Status::Converged,
        errors: vec![NormError { norm: V_MAX.into(), error: Some(h + k), floor: Some(0.0) }],
        ..CaseRecord::without_work("block", Some(n), steps, k)
    }
}

fn grid(ns: &[u32], steps: &[u32]) -> Vec<CaseRecord> {
    ns.iter().flat_map(|&n| steps.iter().map(move |&steps| case(n, steps))).collect()
}

fn predict(variable: Variable) -> Prediction {
    Prediction::new(V_MAX, variable, 1.0)
}

fn selected(records: &[CaseRecord], prediction: &Prediction) -> Selection {
    Cases::new("block", records, &[]).select(prediction)
}

fn used(selection: &Selection) -> Vec<(Option<u32>, u32)> {
    selection.used.iter().map(|used| (used.place.n, used.place.steps)).collect()
}

#[test]
fn a_line_is_the_fullest_and_of_equals_the_finest() {
    let full = grid(&[8, 16, 32], &[4, 8]);
    let line = selected(&full, &predict(Variable::H));
    assert_eq!(used(&line), [(Some(8), 8), (Some(16), 8), (Some(32), 8)]);
    assert_eq!(used(&selected(&full, &predict(Variable::K))), [(Some(32), 4), (Some(32), 8)]);
    // One more case in time is not a line.
    let spare = [full[..].to_vec(), vec![case(32, 16)]].concat();
    assert_eq!(used(&selected(&spare, &predict(Variable::H))).len(), 3);
    assert!(used(&selected(&spare, &predict(Variable::H))).iter().all(|&(_, steps)| steps == 8));
    assert_eq!(used(&selected(&spare, &predict(Variable::Joint))).len(), 7);
}

#[test]
fn a_level_without_the_norm_is_no_line_and_no_gap() {
    let mut records = grid(&[8, 16, 32], &[4, 8]);
    for record in records.iter_mut().filter(|record| record.steps == 8) {
        record.errors[0].norm = "L2_max".into();
    }
    let line = selected(&records, &predict(Variable::H));
    assert_eq!(used(&line), [(Some(8), 4), (Some(16), 4), (Some(32), 4)]);
    assert_eq!(line.gaps, Vec::<String>::new());
    // Beside the line a case may lack the norm, on the line none may.
    let mut records = grid(&[8, 16, 32], &[4, 8]);
    records[0].errors.clear();
    assert!(selected(&records, &predict(Variable::H)).gaps.is_empty());
    records[1].errors.clear();
    let gaps = selected(&records, &predict(Variable::H)).gaps;
    assert_eq!(gaps, [format!("{} has no row for {V_MAX}", records[1].key())]);
}

#[test]
fn broken_cases_say_what_is_known() {
    let mut records = grid(&[8, 16, 32], &[4]);
    let gap = |records: &[CaseRecord]| selected(records, &predict(Variable::H)).gaps.join("; ");
    records[0].status = Status::Failed { reason: String::new() };
    assert!(gap(&records).ends_with(" failed"), "{}", gap(&records));
    records[0].status = Status::Failed { reason: "no descent".into() };
    assert!(gap(&records).ends_with(" failed: no descent"), "{}", gap(&records));
    records[0].status = Status::Skipped;
    assert!(gap(&records).ends_with(" was skipped"), "{}", gap(&records));
    assert_eq!(gap(&[]), "the scene has no case");
}

#[test]
fn windows_hold_their_ends_and_steps_are_positive_numbers() {
    let records = grid(&[8, 16, 32, 64, 128], &[4]);
    let window = Prediction { window_n: Some([16, 64]), ..predict(Variable::H) };
    let inside = selected(&records, &window);
    assert_eq!(used(&inside), [(Some(16), 4), (Some(32), 4), (Some(64), 4)]);
    assert!(inside.left_out.iter().all(|out| out.reason.as_deref() == Some("outside window")));
    assert_eq!(inside.left_out.len(), 2);
    // A step that is none is a gap in either direction.
    for h in [None, Some(0.0), Some(-0.1), Some(f64::INFINITY)] {
        let mut records = records.clone();
        records[2].h = h;
        for variable in [Variable::H, Variable::K] {
            let gaps = selected(&records, &predict(variable)).gaps;
            assert!(gaps.len() == 1 && gaps[0].contains("no step size"), "{h:?} {gaps:?}");
        }
    }
    for k in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let mut records = records.clone();
        records[2].k = k;
        assert_eq!(selected(&records, &predict(Variable::H)).gaps.len(), 1, "{k}");
    }
}

#[test]
fn pictures_and_constants_take_the_same_line() {
    let mut records = grid(&[8, 16, 32], &[4, 8]);
    records[5].errors[0].floor = Some(1.0);
    let points = line_points("block", &records, V_MAX, Variable::H);
    assert_eq!(
        points.iter().map(|judged| judged.point.h).collect::<Vec<_>>(),
        [0.125, 0.0625, 0.03125]
    );
    let keys = line_keys("block", &records, &predict(Variable::H));
    assert_eq!(keys, [records[1].key(), records[3].key()]);
}
