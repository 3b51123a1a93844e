use super::*;
use crate::record::{Key, NormError, Status, V_MAX};
use crate::verdict::{
    Failure, ForeseenConstant, LeadingPoint, MeshAndSteps, cell_texts, exit_code, failures,
    read_earlier, restore_reasons, write_json,
};
use fit::{Claim, Correction, Point};

fn record(point: Point) -> CaseRecord {
    let (n, steps) = ((1.0 / point.h).round() as u32, (1.0 / point.k).round() as u32);
    CaseRecord {
        h: Some(point.h),
        status: Status::Converged,
        errors: vec![NormError {
            norm: V_MAX.into(),
            error: Some(point.error),
            floor: Some(point.floor),
        }],
        ..CaseRecord::without_work("block", Some(n), steps, point.k)
    }
}

fn table(ns: &[u32], steps: &[u32], error: impl Fn(f64, f64) -> f64) -> Vec<CaseRecord> {
    let floor = 1e-12;
    let step = |level: &u32| 1.0 / f64::from(*level);
    ns.iter()
        .flat_map(|n| steps.iter().map(move |s| (step(n), step(s))))
        .map(|(h, k)| record(Point { h, k, error: error(h, k), floor }))
        .collect()
}
fn predict(variable: Variable, order: f64) -> Prediction {
    Prediction { why: "(5.26)".into(), ..Prediction::new(V_MAX, variable, order) }
}
fn keys(records: &[CaseRecord]) -> Vec<Key> {
    records.iter().map(CaseRecord::key).collect()
}
/// The verdict on `records` beside a line of leading errors.
fn beside(
    records: &[CaseRecord],
    prediction: &Prediction,
    tolerance: f64,
    leading: impl Fn(&CaseRecord) -> f64,
) -> Verdict {
    let point = |record: &CaseRecord| {
        let (n, steps, h, k) = (record.n, record.steps, record.h, record.k);
        LeadingPoint { n, steps, h, k, error: leading(record) }
    };
    let points = records.iter().map(point).collect();
    let line = Foreseen::Leading(LeadingLine { points, limit: None, tolerance });
    judge_foreseen("block", records, &[], prediction, Some(&line), Decision::Pass)
}
fn verdict(records: &[CaseRecord], prediction: &Prediction) -> Verdict {
    judge("block", records, &keys(records), prediction, Decision::Pass)
}
const DOUBLING: [u32; 6] = [8, 16, 32, 64, 128, 256];

/// The finest error set to 0, with its floor and without; the three finest, as a writer that was cut off leaves them; all
/// floors taken away. Nothing of it passes, and nothing of it is as expected.
#[test]
fn zeros_and_missing_floors_confirm_nothing() {
    let sound = table(&DOUBLING, &[4], |h, _| h);
    let prediction = predict(Variable::H, 1.0);
    assert_eq!(verdict(&sound, &prediction).decision, Decision::Pass);
    let damaged = |last: usize, error: Option<f64>, floor: Option<f64>| {
        let mut records = sound.clone();
        let count = records.len();
        records.iter_mut().skip(count - last).for_each(|record| {
            let entry = &mut record.errors[0];
            (entry.error, entry.floor) = (error.or(entry.error), floor);
        });
        records
    };
    for (records, expected, words) in [
        (
            damaged(1, Some(0.0), Some(0.0)),
            Decision::Unresolved,
            "exactly 0, and no floor is stated",
        ),
        (
            damaged(3, Some(0.0), Some(0.0)),
            Decision::Unresolved,
            "exactly 0, and no floor is stated",
        ),
        (damaged(1, Some(0.0), Some(1e-12)), Decision::Unresolved, "where the others predict"),
        (damaged(3, Some(1e-13), Some(1e-12)), Decision::Unresolved, "where the others predict"),
        (damaged(1, None, None), Decision::Fail, "has no floor"),
        (damaged(6, None, None), Decision::Fail, "has no floor"),
        (damaged(6, None, Some(f64::NAN)), Decision::Fail, "no floor"),
        (damaged(6, None, Some(f64::INFINITY)), Decision::Fail, "no floor"),
        (damaged(6, Some(0.0), Some(0.0)), Decision::Unresolved, "6 errors exactly 0"),
    ] {
        let found = judge("block", &records, &keys(&records), &prediction, expected);
        assert_eq!(found.decision, expected, "{}", found.reason);
        assert!(found.reason.contains(words), "{words}: {}", found.reason);
        assert!(!found.as_expected() || words.starts_with('6'), "{words}");
        let bound = Prediction { at_least: true, ..prediction.clone() };
        assert_ne!(verdict(&records, &bound).decision, Decision::Pass, "{words}");
    }
    // Levels that sink into a floor which the others explain leave as before.
    let sinking = table(&DOUBLING, &[4], |h, _| 1e-7 * h.powi(2) + 1e-12);
    let found = verdict(&sinking, &predict(Variable::H, 2.0));
    assert_eq!(found.decision, Decision::Pass, "{}", found.reason);
    assert!(!found.points_left_out.is_empty());
    // A constant that agrees does not stand in for the order.
    let zero = damaged(1, Some(0.0), Some(1e-12));
    let found = beside(&zero, &prediction, 0.03, |record| record.h.expect("a mesh"));
    assert_eq!(found.decision, Decision::Unresolved, "{}", found.reason);
    // On a grid as on a line.
    let levels = [8, 16, 32, 64];
    let joint = Prediction { order_k: Some(2.0), ..predict(Variable::Joint, 1.0) };
    for floor in [0.0, 1e-12] {
        let mut grid = table(&levels, &levels, |h, k| 0.3 * h + 4.0 * k * k);
        assert_eq!(verdict(&grid, &joint).decision, Decision::Pass);
        let finest = &mut grid.last_mut().expect("a case").errors[0];
        (finest.error, finest.floor) = (Some(0.0), Some(floor));
        let found = verdict(&grid, &joint);
        assert_eq!((found.decision, found.complete), (Decision::Unresolved, false), "{floor}");
    }
}

/// A lower bound passes where the order is not below it, fails where it is, and is open where the table does not tell.
#[test]
fn a_lower_bound_has_three_answers() {
    let bound = |order: f64, error: &dyn Fn(f64) -> f64| {
        let prediction = Prediction { at_least: true, ..predict(Variable::H, order) };
        verdict(&table(&DOUBLING, &[4], |h, _| error(h)), &prediction).decision
    };
    assert_eq!(bound(1.0, &|h| h), Decision::Pass);
    assert_eq!(bound(1.0, &|h| h * h), Decision::Pass);
    assert_eq!(bound(1.0, &f64::sqrt), Decision::Fail);
    assert_eq!(bound(1.0, &|h| h.powi(-2)), Decision::Fail);
    // Errors that scatter by a fifth; two levels; an order that sinks from 2 towards 0.
    let scatter = |h: f64| if ((1.0 / h).log2() as u32).is_multiple_of(2) { 1.2 } else { 0.8 };
    assert_eq!(bound(1.0, &|h| h * scatter(h)), Decision::Unresolved);
    assert_eq!(bound(2.0, &|h| (1e-3 * h * h).max(1e-7)), Decision::Unresolved);
    let two = table(&DOUBLING[..2], &[4], |h, _| h);
    let prediction = Prediction { at_least: true, ..predict(Variable::H, 1.0) };
    assert_eq!(verdict(&two, &prediction).decision, Decision::Unresolved);
}

#[test]
fn a_missing_a_failed_and_a_broken_case_fail_even_where_failure_is_expected() {
    let good = table(&DOUBLING, &[4, 8], |h, _| h);
    let wanted = keys(&good);
    let prediction = predict(Variable::H, 1.0);
    let mut missing = good.clone();
    missing.remove(4);
    let mut failed = good.clone();
    failed[3].status = Status::Failed { reason: "no descent at t = 0.5".into() };
    let mut broken = good.clone();
    broken[0].errors[0].error = Some(f64::NAN);
    let mut absent = good.clone();
    absent[1].errors[0].error = None;
    let mut unmeasured = good.clone();
    unmeasured[1].errors.clear();
    let words = ["n = 32, steps = 4 is missing", "no descent", "NaN", "has no error", "no row"];
    for (records, word) in [&missing, &failed, &broken, &absent, &unmeasured].into_iter().zip(words)
    {
        let verdict = judge("block", records, &wanted, &prediction, Decision::Fail);
        assert_eq!(verdict.decision, Decision::Fail);
        assert!(verdict.reason.contains(word), "{}", verdict.reason);
        assert!(!verdict.as_expected());
        assert_eq!(exit_code(records, &[verdict]), if word == "no descent" { 2 } else { 1 });
    }
    assert_eq!(
        judge("other", &good, &wanted, &prediction, Decision::Pass).decision,
        Decision::Fail
    );
}

#[test]
fn the_grid_gives_both_orders_and_the_path_gives_none() {
    let joint = Prediction { order_k: Some(2.0), ..predict(Variable::Joint, 1.0) };
    let levels = [8, 16, 32, 64];
    let grid = table(&levels, &levels, |h, k| 0.3 * h + 4.0 * k * k);
    let both = verdict(&grid, &joint);
    assert_eq!(both.decision, Decision::Pass, "{}", both.reason);
    assert!((both.constants["C_k"].value - 4.0).abs() < 1e-6);
    assert_eq!((both.predicted_k, both.next.len()), (Some(2.0), 0));
    assert!(both.reason.contains("in h: within 0.15 of 1"), "{}", both.reason);
    assert!(both.reason.contains("in k: within 0.15 of 2"), "{}", both.reason);
    let wrong = verdict(&grid, &Prediction { order_k: Some(3.0), ..joint.clone() });
    assert_eq!((wrong.decision, wrong.next.len()), (Decision::Fail, 0));
    let high = verdict(&grid, &Prediction { order: 0.5, ..joint.clone() });
    assert_eq!(high.decision, Decision::Unresolved);
    assert!(high.reason.contains("order too high"), "{}", high.reason);
    assert!(!high.reason.contains("run n") && high.next.is_empty(), "{}", high.reason);
    // A line cannot use an order in k.
    let line = verdict(&grid, &Prediction { order_k: Some(2.0), ..predict(Variable::H, 1.0) });
    assert_eq!(line.predicted_k, None);
    let path: Vec<CaseRecord> =
        grid.into_iter().filter(|case| case.n == Some(case.steps)).collect();
    let path = verdict(&path, &joint);
    assert_eq!(path.decision, Decision::Unresolved);
    assert!(path.reason.starts_with("not identifiable"), "{}", path.reason);
    assert!(path.next.contains(&MeshAndSteps { n: Some(128), steps: 64 }));
    assert!(path.next.contains(&MeshAndSteps { n: Some(64), steps: 128 }));
}

#[test]
fn a_slope_bent_by_the_other_term_says_so() {
    let levels = [8, 16, 32, 64];
    let grid = table(&levels, &levels, |h, k| 0.3 * h + 4.0 * k * k);
    let time = verdict(&grid, &predict(Variable::K, 2.0));
    assert_ne!(time.decision, Decision::Pass);
    // On the finest grid: 0.3/64 of 0.3/64 + 4/64² is 83 %.
    let words = "the space term is 83 % of the error at n = 64, steps = 64";
    assert!(time.reason.contains(words), "{}", time.reason);
}

#[test]
fn even_terms_alone_are_expected_of_order_two_in_time() {
    let of = |order, direction| correction(&predict(Variable::K, order), direction);
    assert_eq!(of(2.0, Direction::Time), Correction::Quadratic);
    assert_eq!(of(1.0, Direction::Time), Correction::Linear);
    assert_eq!(of(2.0, Direction::Space), Correction::Linear);
}

/// e = h^½ − h_r^½ on 8 … 128 cells against a run of 512, and the same in time.
#[test]
fn errors_against_a_run_are_read_with_its_step() {
    let against = |step: f64| step.sqrt() - (1.0f64 / 512.0).sqrt();
    let levels = [8, 16, 32, 64, 128];
    let run = MeshAndSteps { n: Some(512), steps: 512 };
    for variable in [Variable::H, Variable::K] {
        let records = match variable {
            Variable::H => table(&levels, &[512], |h, _| against(h)),
            _ => table(&[512], &levels, |_, k| against(k)),
        };
        // What the run does not refine says nothing of this direction.
        let as_coarse = MeshAndSteps { n: Some(128), steps: 128 };
        for (order, reference, expected) in [
            (0.5, Some(run), Decision::Pass),
            (0.75, Some(run), Decision::Fail),
            (0.5, None, Decision::Unresolved),
            (0.5, Some(as_coarse), Decision::Unresolved),
        ] {
            let floor = FloorSource::Reference;
            let prediction = Prediction { floor, reference, ..predict(variable, order) };
            let found = verdict(&records, &prediction);
            assert_eq!(found.order, expected, "{order} {reference:?}: {}", found.reason);
            assert!(found.observed.is_some(), "{}", found.reason);
        }
    }
}

/// Slopes that a person would fail or pass, with claimed orders.
#[test]
fn tables_of_slopes_get_what_a_person_says() {
    let judged = |slopes: &[f64], order: f64| {
        let mut errors = vec![1.0];
        slopes.iter().for_each(|slope| errors.push(errors[errors.len() - 1] * 0.5f64.powf(*slope)));
        let table: Vec<(f64, f64)> =
            (0..).zip(&errors).map(|(i, error)| (0.5f64.powi(i), *error)).collect();
        let posterior = fit::order(&table).expect("an order");
        posterior.decide(&Claim::new(order).expect("a claim")).decision
    };
    let falling = [1.07, 0.98, 0.92, 0.89, 0.88, 0.87, 0.864];
    assert_eq!(judged(&falling, 1.0), Decision::Fail);
    let below_two = [2.05, 1.95, 1.90, 1.88, 1.87, 1.86, 1.854];
    assert_eq!(judged(&below_two, 2.0), Decision::Fail);
    assert_ne!(judged(&[1.05, 1.00, 0.95, 0.90], 1.0), Decision::Pass);
    // What does not fall at all has no order: a solver of another problem.
    assert_eq!(judged(&[0.001, 0.0002], 4.0), Decision::Fail);
    assert_eq!(judged(&[-0.003, 0.001, 0.002], 2.0), Decision::Fail);
    // Coarse levels are dropped: a wild first slope before thirty sound ones, and a slow start.
    let mut wild = vec![0.1];
    wild.extend([1.0; 30]);
    assert_eq!(judged(&wild, 1.0), Decision::Pass);
    assert_eq!(judged(&[1.2, 1.7, 1.9, 1.97, 1.99, 2.0, 2.0], 2.0), Decision::Pass);
    // An added coarser mesh keeps a pass.
    for (fine, order, coarser) in [
        (&[1.0; 3][..], 1.0, &[0.4, 1.6][..]),
        (&[1.97, 1.99, 2.0, 2.0], 2.0, &[0.2, 0.8, 1.5, 2.6]),
    ] {
        assert_eq!(judged(fine, order), Decision::Pass);
        for slope in coarser {
            assert_eq!(judged(&[&[*slope], fine].concat(), order), Decision::Pass, "{slope}");
        }
    }
}

/// Errors 5 k² (1 + 600 k²) beside leading errors 5 k², 0.3 % allowed: the order is certain while the constant still drifts.
#[test]
fn order_and_constant_are_two_claims() {
    let records = table(&[4], &DOUBLING, |_, k| 5.0 * k * k * (1.0 + 600.0 * k * k));
    let judged = |constant: f64, owed: bool| {
        let prediction = Prediction { constant_owed: owed, ..predict(Variable::K, 2.0) };
        beside(&records, &prediction, 0.003, |record| constant * record.k.powi(2))
    };
    use Decision::{Fail, Pass, Unresolved};
    for (constant, owed, claims, outcome) in [
        (5.0, false, [Pass, Unresolved], Pass),
        (5.0, true, [Pass, Unresolved], Unresolved),
        (4.0, false, [Pass, Fail], Fail),
    ] {
        let verdict = judged(constant, owed);
        let of_constant = verdict.constant.as_ref().expect("a claim");
        assert_eq!([verdict.order, of_constant.decision], claims, "{}", verdict.reason);
        assert_eq!((verdict.decision, verdict.as_expected()), (outcome, outcome == Pass));
        let row = serde_json::json!(verdict);
        let said = [&row["order"], &row["constant"]["standing"], &row["verdict"]];
        let names = [claims[0], claims[1], outcome].map(|decision| decision.name().into());
        assert_eq!((said, &row["constant"]["owed"]), (names.each_ref(), &owed.into()));
    }
}

/// Errors 5 k² beside leading errors of 5 k² or 4 k².
#[test]
fn a_constant_that_is_off_fails_whatever_the_order() {
    let records = table(&[4], &DOUBLING, |_, k| 5.0 * k * k);
    let prediction = predict(Variable::K, 2.0);
    let judged = |constant: f64, prediction: &Prediction| {
        beside(&records, prediction, 0.03, |record| constant * record.k.powi(2))
    };
    let sound = judged(5.0, &prediction);
    assert_eq!(sound.decision, Decision::Pass, "{}", sound.reason);
    // A wrong claimed order with matching constants: the prediction is suspect.
    let wrong = judged(5.0, &Prediction { exact: true, ..predict(Variable::K, 1.5) });
    assert_eq!(wrong.decision, Decision::Fail);
    // The slope of 5 k² to rounding.
    assert!(wrong.contradicted_by.is_some_and(|order| (order - 2.0).abs() < 1e-12));
    assert_eq!(sound.contradicted_by, None);
    assert!(
        wrong.reason.contains("the prediction 1.5 is wrong, not the program"),
        "{}",
        wrong.reason
    );
    let off = judged(4.0, &prediction);
    assert_eq!(off.decision, Decision::Fail);
    assert!(off.reason.contains("C_k is 1.2500 times the predicted one"), "{}", off.reason);
    assert_eq!((off.constants["C_k"].ratio, off.contradicted_by), (Some(1.25), None));
    let path = std::env::temp_dir().join(format!("gronwall-foreseen-{}.json", std::process::id()));
    write_json(&path, &serde_json::json!({}), std::slice::from_ref(&off), &records, None, None)
        .unwrap();
    let known = read_earlier(&path).unwrap().foreseen;
    std::fs::remove_file(&path).unwrap();
    let expected = ForeseenConstant {
        scene: "block".into(),
        norm: V_MAX.into(),
        variable: Variable::K,
        foreseen: off.foreseen.expect("a line"),
        other_error: None,
    };
    assert_eq!(known, [expected]);
}

/// Errors that jump from level to level and follow the predicted ones, which jump likewise: the constant shows the order, and
/// the verdict says so.
#[test]
fn an_order_that_its_constant_shows_says_so() {
    let finest = *DOUBLING.last().expect("levels");
    // Up and down, but for the last two.
    let jump = |k: f64| match (f64::from(finest) * k).log2() as u32 {
        0 | 1 => 1.0,
        level if level % 2 == 0 => 3.0,
        _ => 0.4,
    };
    let records = table(&[4], &DOUBLING, |_, k| k * k * jump(k));
    let prediction = predict(Variable::K, 2.0);
    let open = judge("block", &records, &[], &prediction, Decision::Pass);
    assert_eq!(open.decision, Decision::Unresolved, "{}", open.reason);
    let judged = beside(&records, &prediction, 1e-4, |record| record.k.powi(2) * jump(record.k));
    assert_eq!(judged.decision, Decision::Pass, "{}", judged.reason);
    assert!(judged.constant.as_ref().is_some_and(|constant| constant.decides));
    assert_eq!(cell_texts(&judged)[5], "pass, by C_k");
    assert!(judged.reason.contains("the slopes alone leave it open"), "{}", judged.reason);
}

#[test]
fn failures_are_listed_by_key_and_reasons_go_back_to_their_cases() {
    let mut records = table(&[8, 16], &[4, 8], |h, _| h);
    for (at, reason) in [(3, "c"), (0, "a"), (1, "b")] {
        records[at].status = Status::Failed { reason: reason.into() };
    }
    let failure = |n, steps, reason: &str| Failure {
        key: Key { scene: "block".into(), n: Some(n), steps },
        reason: reason.into(),
    };
    let listed = [failure(8, 4, "a"), failure(8, 8, "b"), failure(16, 8, "c")];
    records.reverse();
    assert_eq!(failures(&records), listed);
    let mut read = records.clone();
    for record in &mut read {
        if let Status::Failed { reason } = &mut record.status {
            reason.clear();
        }
    }
    let of_other = |Failure { key, .. }: &Failure| Failure {
        key: Key { scene: "other".into(), ..key.clone() },
        reason: "x".into(),
    };
    let others: Vec<Failure> = listed.iter().map(of_other).collect();
    restore_reasons(&mut read, &[&others[..], &listed].concat());
    assert_eq!(read, records);
}

#[test]
fn a_row_names_what_is_refined() {
    let one = verdict(&table(&DOUBLING, &[4], |h, _| h), &predict(Variable::H, 1.0));
    let cells = |verdict: &Verdict| {
        let [_, _, _, predicted, observed, decision, why] = cell_texts(verdict);
        [predicted, observed, decision, why]
    };
    assert_eq!(cells(&one), ["1", "1.00 [0.99, 1.01]", "pass", "(5.26)"]);
    let bound = Verdict { at_least: true, expect: Decision::Fail, ..one.clone() };
    assert_eq!(cells(&bound)[..3], ["≥ 1", "1.00 [0.99, 1.01]", "pass, expected fail"]);
    let both = Verdict { predicted_k: Some(2.0), interval: None, ..one.clone() };
    assert_eq!(cells(&both)[..2], ["1, 2", "-"]);
    let failed = Verdict {
        decision: Decision::Fail,
        expect: Decision::Fail,
        reason: "because".into(),
        ..one.clone()
    };
    assert_eq!(cells(&failed)[2], "fail, as expected");
    let names = [
        (Variable::H, "h"),
        (Variable::K, "k"),
        (Variable::Joint, "joint"),
        (Variable::Path, "path"),
    ];
    for (variable, name) in names {
        let row = cell_texts(&Verdict { variable, ..one.clone() });
        assert_eq!([&*row[0], &*row[1], &*row[2]], ["block", V_MAX, name]);
    }
}

#[test]
fn the_document_has_its_keys_and_no_infinite_number() {
    let mut records = table(&[8, 16, 32, 64], &[4], |h, _| h);
    // Without a mesh: left out of a line in h.
    records.push(CaseRecord { n: None, h: None, ..records[0].clone() });
    let passed = verdict(&records, &predict(Variable::H, 1.0));
    records[1].status = Status::Failed { reason: "no descent".into() };
    let path = std::env::temp_dir().join(format!("gronwall-verdict-{}.json", std::process::id()));
    write_json(&path, &serde_json::json!({"seed": 1}), &[passed], &records, None, None).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let entry = &json["verdicts"][0];
    assert_eq!((&entry["variable"], &entry["verdict"]), (&"h".into(), &"pass".into()));
    assert!(entry["points_left_out"][0]["h"].is_null());
    for key in ["scene", "norm", "predicted", "why", "observed", "interval", "constants", "reason"]
    {
        assert!(!entry[key].is_null(), "{key}");
    }
    let kept = read_earlier(&path).unwrap().failures;
    assert_eq!(kept, failures(&records));
    records[1].status = Status::Failed { reason: String::new() };
    restore_reasons(&mut records, &kept);
    assert_eq!(failures(&records), kept);
    std::fs::remove_file(&path).unwrap();
}
