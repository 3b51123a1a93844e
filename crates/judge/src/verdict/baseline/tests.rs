use super::tolerance::in_percent;
use super::*;
use crate::record::{Key, Status, V_MAX};
use fit::Decision;

fn record(steps: u32, error: f64) -> CaseRecord {
    CaseRecord {
        dofs: 144,
        elements: 128,
        status: Status::Converged,
        newton_iterations: 40,
        active_set_changes: 3,
        factorizations: 20,
        errors: vec![NormError { norm: V_MAX.into(), error: Some(error), floor: Some(1e-14) }],
        ..CaseRecord::without_work("block", Some(8), steps, 1.0 / f64::from(steps))
    }
}

fn records() -> Vec<CaseRecord> {
    vec![record(4, 1.23456789e-2), record(8, 3.1e-3)]
}

fn baseline() -> Baseline {
    Baseline::of(&records(), &[("block", "hash")])
}

fn compared(records: &[CaseRecord], hash: &str, own_grids: bool) -> Comparison {
    let key = |steps| Key { scene: "block".into(), n: Some(8), steps };
    let planned = if own_grids { vec![key(4), key(8)] } else { vec![key(4)] };
    let run = ComparedRun { scene: "block".into(), hash: hash.into(), planned, own_grids };
    baseline().compare(&[run], records, &[])
}

#[track_caller]
fn only(comparison: &Comparison) -> &Deviation {
    assert_eq!(comparison.deviations.len(), 1, "{:?}", comparison.deviations);
    &comparison.deviations[0]
}

#[test]
fn a_repeated_run_does_not_deviate() {
    let comparison = compared(&records(), "hash", true);
    assert!(comparison.deviations.is_empty() && comparison.compared == 2);
    assert_eq!(comparison.exit_code(), 0);
    // Another machine: other last digits, an iteration more.
    let mut other = records();
    other[0].errors[0].error = Some(1.23456789e-2 * (1.0 + 1e-8));
    other[1].newton_iterations = 42;
    assert!(compared(&other, "hash", true).deviations.is_empty());
}

#[test]
fn every_seeded_deviation_is_found() {
    let seeded = |seed: fn(&mut Vec<CaseRecord>)| {
        let mut wrong = records();
        seed(&mut wrong);
        let comparison = compared(&wrong, "hash", true);
        assert_eq!(comparison.exit_code(), 1);
        only(&comparison).clone()
    };
    let error = seeded(|records| records[0].errors[0].error = Some(1.01 * 1.23456789e-2));
    assert_eq!((error.kind, error.verdict), (DeviationKind::Error, Decision::Fail));
    assert!(
        error.reason.contains("block, n = 8, steps = 4: V_max") && error.reason.contains("+1.0 %"),
        "{}",
        error.reason
    );
    let smaller = seeded(|records| records[1].errors[0].error = Some(0.5 * 3.1e-3));
    assert_eq!(smaller.kind, DeviationKind::Error);
    assert!(smaller.reason.contains("-50.0 %"), "{}", smaller.reason);
    let nan = seeded(|records| records[0].errors[0].error = Some(f64::NAN));
    assert_eq!((nan.kind, nan.found), (DeviationKind::Error, None));
    let infinite = seeded(|records| records[0].errors[0].error = Some(f64::INFINITY));
    assert_eq!((infinite.kind, infinite.found), (DeviationKind::Error, None));
    let no_norm = seeded(|records| records[0].errors.clear());
    assert_eq!(no_norm.kind, DeviationKind::Missing);
    let no_case = seeded(|records| {
        records.pop();
    });
    assert_eq!((no_case.kind, no_case.steps), (DeviationKind::Missing, Some(8)));
    let failed = seeded(|records| {
        records[1].status = Status::Failed { reason: "no convergence".into() };
    });
    assert!(failed.kind == DeviationKind::Missing && failed.reason.contains("no convergence"));
    let costly = seeded(|records| records[0].newton_iterations = 60);
    assert_eq!(
        (costly.kind, costly.norm.as_deref()),
        (DeviationKind::Cost, Some("newton_iterations"))
    );
    let refactored = seeded(|records| records[0].factorizations = 40);
    assert_eq!((refactored.kind, refactored.verdict), (DeviationKind::Cost, Decision::Fail));
    let restless = seeded(|records| records[0].active_set_changes = 9);
    assert_eq!(
        (restless.kind, restless.norm.as_deref()),
        (DeviationKind::Cost, Some("active_set_changes"))
    );
    let hoarding = seeded(|records| records[0].peak_history_bytes = 1152);
    assert_eq!(
        (hoarding.kind, hoarding.norm.as_deref()),
        (DeviationKind::Cost, Some("peak_history_bytes"))
    );
}

/// Counters missing in an older baseline are not compared.
#[test]
fn a_baseline_without_the_newer_counters_is_read() {
    let text = r#"{"scenes": {"block": {"hash": "hash", "cases": [
        {"n": 8, "steps": 4, "newton_iterations": 40, "factorizations": 20, "errors": {"V_max": 0.0123456789}}]}}}"#;
    let old: Baseline = serde_json::from_str(text).expect("a baseline");
    let restless = CaseRecord { active_set_changes: 999, ..record(4, 1.23456789e-2) };
    let (scene, hash) = ("block".into(), "hash".into());
    let run = ComparedRun { scene, hash, planned: vec![restless.key()], own_grids: true };
    assert!(old.compare(&[run], &[restless], &[]).deviations.is_empty());
    assert!(
        old.changes(&Baseline::of(&[record(4, 1.23456789e-2)], &[("block", "hash")])).is_empty()
    );
}

#[test]
fn work_may_grow_a_little() {
    let grown = |recorded: u64, now: u64| {
        let counted = |count: u64| CaseRecord { factorizations: count, ..record(4, 1e-3) };
        let run = ComparedRun {
            scene: "block".into(),
            hash: "hash".into(),
            planned: vec![counted(now).key()],
            own_grids: true,
        };
        let baseline = Baseline::of(&[counted(recorded)], &[("block", "hash")]);
        let found = baseline.compare(&[run], &[counted(now)], &[]);
        !found.deviations.is_empty()
    };
    assert!(!grown(2, 4) && grown(2, 5));
    assert!(!grown(30, 33) && grown(30, 34));
    assert!(!grown(40, 43) && !grown(40, 10));
}

#[test]
fn changes_have_the_digits_that_show_them() {
    assert_eq!(in_percent(-0.5), "-50.0 %");
    assert_eq!(in_percent(1e-3), "+0.1 %");
    assert_eq!(in_percent(5e-4), "+5.0e-2 %");
}

#[test]
fn a_scene_that_is_not_recorded_is_said() {
    let run = ComparedRun {
        scene: "new".into(),
        hash: "hash".into(),
        planned: Vec::new(),
        own_grids: true,
    };
    let comparison = baseline().compare(&[run], &records(), &[]);
    assert_eq!((comparison.not_recorded.len(), comparison.exit_code()), (1, 0));
    assert!(comparison.lines()[0].contains("not recorded, hence not compared: new"));
}

/// 1e-6 of itself, whatever its floor; near rounding, which is 1e-12 of the scene's largest error or the floor below, 4 times
/// that; 0.5 % at most. Errors below 4 floors are not recorded.
#[test]
fn an_error_counts_from_its_tolerance_on() {
    let both = |largest: f64, error: f64, floor: f64| {
        let mut records = [record(4, largest), record(8, error)];
        records[1].errors[0].floor = Some(floor);
        records
    };
    let of_both = |records: &[CaseRecord]| Baseline::of(records, &[("block", "hash")]);
    for (largest, error, floor, tolerance) in [
        (1e-3, 1e-3, 1e-16, 1e-6),
        (1e-3, 1e-3, 2e-4, 1e-6),
        (1e-8, 1e-8, 1e-9, 4e-4),
        (1e-8, 1e-8, 1e-14, 4e-6),
        (1e-10, 1e-10, 1e-12, 5e-3),
        (1e-2, 1e-6, 1e-14, 1e-6),
        (1e-2, 1e-9, 1e-13, 4e-4),
        (1e-2, 1e-11, 1e-13, 5e-3),
        // Floors of quadrature, a thousandth and a tenth of the error; errors in another unit of length.
        (1e-2, 1e-3, 1e-6, 1e-6),
        (1e-2, 1e-7, 1e-8, 4e-5),
        (1e4, 1e-3, 1e-4, 4e-5),
    ] {
        let baseline = of_both(&both(largest, error, floor));
        let deviating = |factor: f64| {
            let now = both(largest, factor * error, floor);
            let planned = now.each_ref().map(CaseRecord::key).into();
            let (scene, hash) = ("block".into(), "hash".into());
            let run = ComparedRun { scene, hash, planned, own_grids: true };
            let found = baseline.compare(&[run], &now, &[]).deviations;
            found.iter().map(|deviation| deviation.kind).collect::<Vec<_>>()
        };
        for off in [-tolerance, tolerance] {
            let place = format!("{largest:e} {error:e} {floor:e} {off:e}");
            assert_eq!(deviating(1.0 + 0.9 * off), [], "{place}");
            assert_eq!(deviating(1.0 + 1.1 * off), [DeviationKind::Error], "{place}");
        }
    }
    let recorded =
        |records: &[CaseRecord], at: usize| of_both(records).scenes["block"].cases[at].clone();
    assert!(recorded(&both(1e-2, 1e-6, 3e-7), 1).errors.is_empty());
    // A zero error has no relative deviation.
    assert!(recorded(&both(1e-2, 0.0, 0.0), 1).errors.is_empty());
}

/// Distances and measures of contact sets are recorded, to a sample of a facet: an eighth of an edge.
#[test]
fn contact_sets_are_recorded_to_a_sample() {
    let with = |norm: &str, error: f64| {
        let mut one = record(4, 1e-2);
        one.h = Some(0.125);
        let (norm, error) = (norm.into(), Some(error));
        one.errors.push(NormError { norm, error, floor: Some(0.0) });
        one
    };
    for (norm, error) in [("contact_set_max", 1.0), ("contact_measure_max", 0.1)] {
        let baseline = Baseline::of(&[with(norm, error)], &[("block", "hash")]);
        let key = Key { scene: "block".into(), n: Some(8), steps: 4 };
        let (scene, hash) = ("block".into(), "hash".into());
        let run = ComparedRun { scene, hash, planned: vec![key], own_grids: true };
        let deviates = |found: f64| {
            let found = baseline.compare(std::slice::from_ref(&run), &[with(norm, found)], &[]);
            !found.deviations.is_empty()
        };
        let sample = 0.125 / 8.0;
        assert!(!deviates(error + 0.99 * sample) && !deviates(error - 0.99 * sample), "{norm}");
        // One set taken for empty, a measure halved, NaN.
        assert!(deviates(0.0) && deviates(0.5 * error) && deviates(f64::NAN), "{norm}");
    }
}

#[test]
fn a_baseline_holds_the_converged_cases_of_each_scene() {
    let mut records = records();
    records.push(CaseRecord { scene: "other".into(), ..record(16, 1e-3) });
    records.push(CaseRecord { status: Status::Skipped, ..record(32, 1e-3) });
    assert_eq!(Baseline::of(&records, &[("block", "hash")]), baseline());
}

#[test]
fn the_file_reads_back_and_keeps_its_order() {
    let path = std::env::temp_dir().join(format!("gronwall-baseline-{}.json", std::process::id()));
    baseline().write(&path).unwrap_or_else(|error| panic!("{error}"));
    let text = std::fs::read_to_string(&path).expect("the file");
    let read = Baseline::read(&path).unwrap_or_else(|error| panic!("{error}"));
    std::fs::write(&path, "{\"scenes\": 3}").expect("the file");
    let broken = Baseline::read(&path);
    std::fs::remove_file(&path).expect("the file");
    assert_eq!(read, Some(baseline()));
    assert!(broken.is_err());
    assert_eq!(Baseline::read(&path).ok(), Some(None));
    assert!(Baseline::read(&std::env::temp_dir()).is_err());
    assert_eq!(text.lines().count(), 6, "{text}");
}

#[test]
fn changes_are_listed() {
    let mut changed = records();
    changed[0].errors[0].error = Some(2.0 * 1.23456789e-2);
    changed[1].newton_iterations = 30;
    let new = Baseline::of(&changed, &[("block", "hash"), ("other", "hash")]);
    let lines = baseline().changes(&new);
    assert_eq!(lines.len(), 3, "{lines:?}");
    assert!(lines[0].contains("1.234568e-2 -> 2.469136e-2 (+100.0 %)"), "{lines:?}");
    assert!(lines[1].contains("Newton iterations 40 -> 30"), "{lines:?}");
    assert!(baseline().changes(&baseline()).is_empty());
    assert_eq!(new.changes(&baseline()).len(), 3);
}
