//! Tables whose answer is known, judged both as records (`verdict::judge`) and as a file (`sweep fit`).
//! Source: every table is a formula in this file, so its order is known without fitting.
//! Goal: the expected verdict for each kind of table that a sweep can produce.

use std::path::Path;

use crate::next_cases::{self, case, predict};
use crate::program::{Folder, code, command, ends, json, refuses, stderr, stdout, sweep};
use judge::record::{CaseRecord, V_MAX};
use judge::verdict::{Decision, Prediction, Variable};
use serde_json::Value;

/// A row: n and N, of which h = 1/n and k = 1/N, and the error, absent for a missing case.
type Row = (u32, u32, Option<f64>);

/// A table in one direction with its prediction and the verdict it must get.
struct Table {
    name: &'static str,
    variable: Variable,
    rows: Vec<Row>,
    floor: f64,
    predicted: f64,
    expected: Decision,
    /// Words of both reasons.
    words: &'static str,
}

const DOUBLING: [u32; 6] = [8, 16, 32, 64, 128, 256];

/// A table in h at N = 4.
fn in_space(
    name: &'static str,
    ns: &[u32],
    predicted: f64,
    expected: Decision,
    words: &'static str,
    error: impl Fn(f64) -> f64,
) -> Table {
    let rows = ns.iter().map(|&n| (n, 4, Some(error(1.0 / f64::from(n))))).collect();
    Table { name, variable: Variable::H, rows, floor: 0.0, predicted, expected, words }
}

/// The table with k in the place of h, on one mesh.
fn in_time(table: Table) -> Table {
    let rows = table.rows.into_iter().map(|(n, steps, error)| (steps, n, error)).collect();
    Table { variable: Variable::K, rows, ..table }
}

fn edited(mut table: Table, edit: impl FnOnce(&mut Vec<Row>)) -> Table {
    edit(&mut table.rows);
    table
}

/// One percent up and down: of known sign, so that no generator is needed.
fn shaken(h: f64, by: f64) -> f64 {
    let level = (1.0 / h).log2().round() as usize;
    1.0 + by * [1.0, -0.4, -1.0, 0.7, 0.2, -0.9][level % 6]
}

fn fixtures() -> Vec<Table> {
    use Decision::{Fail, Pass, Unresolved};
    let ratio = |name, ns| in_space(name, ns, 1.0, Pass, "within 0.15 of 1", |h| 2.0 * h);
    vec![
        in_space("exact power law", &DOUBLING, 1.0, Pass, "probability above 99 %", |h| 3.0 * h),
        in_time(in_space("exact square in time", &DOUBLING, 2.0, Pass, "within 0.15 of 2", |k| {
            k * k
        })),
        in_space("curvature", &DOUBLING, 1.0, Pass, "within 0.15 of 1", |h| h + 4.0 * h * h),
        in_space("curvature downwards", &DOUBLING, 1.0, Pass, "within 0.15 of 1", |h| {
            h - 2.0 * h * h
        }),
        ratio("ratio 1.3", &[10, 13, 17, 22]),
        ratio("ratio 1.5", &[16, 24, 36, 54]),
        ratio("ratio 2", &[8, 16, 32, 64]),
        ratio("mixed ratios", &[8, 12, 30, 40, 100]),
        Table {
            floor: 1e-12,
            ..in_time(in_space("plateau", &DOUBLING, 2.0, Unresolved, "2 points", |k| {
                (1e-8 * k * k).max(5e-12)
            }))
        },
        // Without a measured floor the plateau is data: the order falls from 2 to 0 on the way.
        in_space("plateau without a floor", &DOUBLING, 2.0, Unresolved, "flatten", |h| {
            (1e-3 * h * h).max(1e-7)
        }),
        // Local orders 1/(1 + 20h): 0.29 … 0.93. The order is 1: coarse meshes that do not resolve.
        in_space("pre-asymptotic bend", &DOUBLING, 1.0, Pass, "within 0.15 of 1", |h| {
            h / (1.0 + 20.0 * h)
        }),
        in_space("divergence", &DOUBLING, 2.0, Fail, "lies below 2", |h| h.powi(-2)),
        in_space("no convergence", &DOUBLING, 1.0, Fail, "lies below 1", |_| 0.3),
        in_space("half an order less", &DOUBLING, 1.0, Fail, "lies below 1", f64::sqrt),
        in_space("noise of 1 %", &DOUBLING, 1.0, Pass, "within 0.15 of 1", |h| h * shaken(h, 0.01)),
        in_space("noise of 30 %", &DOUBLING, 1.0, Unresolved, "% only", |h| h * shaken(h, 0.3)),
        in_space("outlier", &DOUBLING, 1.0, Unresolved, "no reading that", |h| {
            if h == 1.0 / 64.0 { 3.0 * h } else { h }
        }),
        in_space("outlier at the end", &DOUBLING, 1.0, Unresolved, "flatten", |h| {
            if h == 1.0 / 256.0 { 3.0 * h } else { h }
        }),
        in_space("too high", &DOUBLING, 1.0, Unresolved, "order too high", |h| h.powf(1.7)),
        in_space(
            "two points",
            &DOUBLING[..2],
            1.0,
            Unresolved,
            "2 points, an order needs 3",
            |h| h,
        ),
        in_space("one point", &DOUBLING[..1], 1.0, Unresolved, "1 point, an order needs", |h| h),
        in_space("zero errors", &DOUBLING, 1.0, Unresolved, "0 points", |_| 0.0),
        // A writer that is cut off leaves zeros: without a floor, and with one that the other levels are far above.
        in_space("one zero error", &DOUBLING, 1.0, Unresolved, "is exactly 0", |h| {
            if h < 0.005 { 0.0 } else { h }
        }),
        in_space("three zero errors", &DOUBLING, 1.0, Unresolved, "is exactly 0", |h| {
            if h < 0.02 { 0.0 } else { h }
        }),
        Table {
            floor: 1e-12,
            ..in_space("zero above a floor", &DOUBLING, 1.0, Unresolved, "others predict", |h| {
                if h < 0.005 { 0.0 } else { h }
            })
        },
        Table {
            floor: 1e-3,
            ..in_space("zero near a floor", &DOUBLING, 2.0, Pass, "within 0.15 of 2", |h| {
                if h < 0.005 { 0.0 } else { 50.0 * h * h }
            })
        },
        in_time(in_space("zero in a wrong order", &DOUBLING, 2.0, Fail, "lies below 2", |k| {
            if k < 0.005 { 0.0 } else { k }
        })),
        in_space("NaN", &DOUBLING, 1.0, Fail, "NaN", |h| if h < 0.005 { f64::NAN } else { h }),
        in_space(
            "infinite",
            &DOUBLING,
            1.0,
            Fail,
            "inf",
            |h| if h > 0.1 { f64::INFINITY } else { h },
        ),
        in_space("negative", &DOUBLING, 1.0, Fail, "is no error", |h| if h > 0.1 { -h } else { h }),
        edited(in_space("missing case", &DOUBLING, 1.0, Fail, "no error", |h| h), |rows| {
            rows[3].2 = None;
        }),
        edited(in_space("unsorted", &DOUBLING, 1.0, Pass, "within 0.15 of 1", |h| h), |rows| {
            rows.swap(0, 4);
            rows.swap(1, 3);
        }),
        // A record is known by n and N, and the later counts; of a file two rows of one h are runs.
        edited(in_space("repeated", &DOUBLING, 1.0, Pass, "", |h| h), |rows| {
            rows.push((64, 4, Some(1.0 / 64.0)));
        }),
    ]
}

fn prediction(variable: Variable, order: f64, order_k: Option<f64>) -> Prediction {
    Prediction { order_k, ..predict(variable, order) }
}

fn judged(rows: &[Row], floor: f64, prediction: &Prediction) -> (Decision, String) {
    let record = |&(n, steps, error): &Row| case(n, steps, error, floor);
    let records: Vec<CaseRecord> = rows.iter().map(record).collect();
    let verdict = next_cases::judged(&records, prediction);
    (verdict.decision, verdict.reason)
}

fn file(rows: &[Row], floor: f64) -> String {
    let mut text = "h,k,error,floor\n".to_owned();
    for (n, steps, error) in rows {
        let (h, k) = (1.0 / f64::from(*n), 1.0 / f64::from(*steps));
        let error = error.map_or_else(String::new, |error| format!("{error:e}"));
        text += &format!("{h},{k},{error},{floor:e}\n");
    }
    text
}

/// The rows that `sweep fit` prints, and its exit code.
fn fitted(folder: &Folder, text: &str, aim: &[&str]) -> (i32, Vec<Value>) {
    let table = folder.file("table.csv", text);
    let output = sweep(&[&["fit", &table, "--json"], aim].concat());
    assert!(!stdout(&output).is_empty(), "{}", stderr(&output));
    let Value::Array(rows) = json(&output) else { panic!("{}", stdout(&output)) };
    (code(&output), rows)
}

fn row<'a>(rows: &'a [Value], variable: &str) -> &'a Value {
    let found = rows.iter().find(|row| row["variable"] == variable);
    found.unwrap_or_else(|| panic!("no {variable} in {rows:?}"))
}

#[test]
fn every_table_gets_its_verdict_from_records_and_from_a_file() {
    let folder = Folder::new("tables");
    for table in fixtures() {
        let Table { name, variable, rows, floor, predicted, expected, words } = table;
        let (decision, reason) = judged(&rows, floor, &prediction(variable, predicted, None));
        assert_eq!(decision, expected, "{name} as records: {reason}");
        assert!(reason.contains(words), "{name} as records: {reason}");
        // In a file a signed difference is as large as it is off zero.
        let (expected, words) = match name {
            "negative" => (Decision::Pass, "within 0.15 of 1"),
            _ => (expected, words),
        };
        let (flag, step) = if variable == Variable::H { ("--p", "h") } else { ("--q", "k") };
        let predicted = predicted.to_string();
        let runs: &[&str] = if name == "repeated" { &["--runs"] } else { &[] };
        let aim = [&[flag, &predicted], runs].concat();
        let (exit, found) = fitted(&folder, &file(&rows, floor), &aim);
        let found = row(&found, step);
        assert_eq!(found["verdict"], expected.name(), "{name} as a file: {found}");
        let reason = found["reason"].as_str().expect("a reason");
        assert!(reason.contains(words), "{name} as a file: {reason}");
        assert_eq!(exit, i32::from(expected != Decision::Pass), "{name}");
        // Without a prediction there is nothing to fail; of one row there is nothing to print.
        if rows.len() > 1 {
            assert_eq!(fitted(&folder, &file(&rows, floor), runs).0, 0, "{name}");
        }
    }
}

/// Bad rows do not vanish without a word: the counts add up.
#[test]
fn points_below_the_floor_are_listed() {
    let folder = Folder::new("floors");
    let rows: Vec<Row> = DOUBLING.iter().map(|&n| (n, 4, Some(1.0 / f64::from(n)))).collect();
    // 20 floors of 0.001 lie between 1/32 and 1/64.
    let (_, found) = fitted(&folder, &file(&rows, 1e-3), &[]);
    let found = row(&found, "h");
    assert_eq!(found["points_used"].as_array().map(Vec::len), Some(3));
    let left = found["points_left_out"].as_array().expect("points");
    assert_eq!(left.len(), 3);
    assert!(left[0]["reason"].as_str().is_some_and(|why| why.starts_with("below floor")));
}

fn grid(ns: &[u32], steps: &[u32], error: impl Fn(f64, f64) -> f64) -> Vec<Row> {
    let step = |level: u32| 1.0 / f64::from(level);
    ns.iter()
        .flat_map(|&n| steps.iter().map(move |&s| (n, s)))
        .map(|(n, s)| (n, s, Some(error(step(n), step(s)))))
        .collect()
}

/// On k = h order 2 in time looks like order 1: a table along it cannot pass for both.
#[test]
fn the_path_k_equals_h_says_what_it_cannot_tell() {
    let folder = Folder::new("diagonal");
    let rows: Vec<Row> = grid(&DOUBLING, &DOUBLING, |h, k| 0.3 * h + 0.5 * k * k)
        .into_iter()
        .filter(|(n, steps, _)| n == steps)
        .collect();
    let joint = prediction(Variable::Joint, 1.0, Some(2.0));
    let (decision, reason) = judged(&rows, 0.0, &joint);
    assert_eq!(decision, Decision::Unresolved);
    assert!(reason.contains("refined together"), "{reason}");
    let text = file(&rows, 0.0);
    let (exit, found) = fitted(&folder, &text, &["--p", "1", "--q", "2"]);
    let found = row(&found, "path");
    assert_eq!((exit, &found["verdict"]), (1, &"unresolved".into()));
    let reason = found["reason"].as_str().expect("a reason");
    assert!(reason.contains("cannot tell order 2 in k from 1.00"), "{reason}");
    assert!(reason.contains("k proportional to h^0.50"), "{reason}");
    assert!((found["exponent"].as_f64().expect("s") - 1.0).abs() < 1e-10);
    // What it can tell: order 1 in h at the least.
    assert_eq!(fitted(&folder, &text, &["--p", "1"]).0, 0);
    assert_eq!(fitted(&folder, &text, &["--q", "2"]).0, 1);
    assert_eq!(fitted(&folder, &text, &[]).0, 0);
}

/// On k = √h both terms of h + k² are of order 1 in h; a term in k alone would have ½.
#[test]
fn the_balanced_path_tests_both_orders() {
    let folder = Folder::new("balanced");
    let path = |error: &dyn Fn(f64, f64) -> f64| -> String {
        let rows: Vec<Row> = [4u32, 8, 16, 32]
            .iter()
            .map(|&s| (s * s, s, Some(error(1.0 / f64::from(s * s), 1.0 / f64::from(s)))))
            .collect();
        file(&rows, 0.0)
    };
    let both = ["--p", "1", "--q", "2"];
    let (exit, found) = fitted(&folder, &path(&|h, k| 0.3 * h + 4.0 * k * k), &both);
    let found = row(&found, "path");
    assert_eq!((exit, &found["verdict"]), (0, &"pass".into()));
    let reason = found["reason"].as_str().expect("a reason");
    assert!(reason.contains("at least 1 in h and 2 in k"), "{reason}");
    assert!((found["exponent"].as_f64().expect("s") - 0.5).abs() < 1e-10);
    // One order less in either term is seen.
    assert_eq!(fitted(&folder, &path(&|h, k| 0.3 * h + 4.0 * k), &both).0, 1);
    assert_eq!(fitted(&folder, &path(&|h, k| 0.3 * h.sqrt() + 4.0 * k * k), &both).0, 1);
    // A path that time dominates tells q from its slope and nothing of p = 2.
    let (exit, found) =
        fitted(&folder, &path(&|h, k| h * h + 4.0 * k * k), &["--p", "2", "--q", "2"]);
    assert_eq!(exit, 1);
    let reason = row(&found, "path")["reason"].as_str().expect("a reason");
    assert!(reason.contains("cannot tell order 2 in h from 1.00"), "{reason}");
}

#[test]
fn a_grid_gives_both_orders_constants_and_models() {
    let folder = Folder::new("grid");
    let levels = [8, 16, 32, 64];
    let both = ["--p", "1", "--q", "2"];
    for (m, better) in [(1.0, "sum"), (2.0, "root-sum-square")] {
        let mut rows = grid(&levels, &levels, |h, k| {
            ((0.3 * h).powf(m) + (4.0 * k * k).powf(m)).powf(1.0 / m)
        });
        // A grid with holes is still a grid.
        rows.remove(5);
        rows.remove(9);
        let (exit, found) = fitted(&folder, &file(&rows, 0.0), &both);
        assert_eq!(exit, 0, "{found:?}");
        let joint = row(&found, "joint");
        assert_eq!((&joint["verdict"], &joint["better"]), (&"pass".into(), &better.into()));
        let number = |value: &Value| value.as_f64().expect("a number");
        // Orders are inferred on multiples of 0.05; the minimisation of the fits stops at steps of 1e-10.
        assert!((number(&joint["observed"]) - 1.0).abs() < 0.025);
        assert!((number(&joint["observed_k"]) - 2.0).abs() < 0.025);
        assert!((number(&joint["models"][0]["order_h"]) - 1.0).abs() < 1e-7);
        let constants = &joint["constants"];
        assert!((number(&constants["C_h"]["value"]) - 0.3).abs() < 1e-7);
        assert!((number(&constants["C_k"]["value"]) - 4.0).abs() < 1e-6);
        let models = joint["models"].as_array().expect("models");
        // Both models, and those fits with a floor that end: of an exact table F → 0 has no end.
        assert!(models.len() >= 2 && models[0]["floor"].is_null(), "{models:?}");
        assert!(number(&models[1]["residual"]) > 100.0 * number(&models[0]["residual"]));
        // The line in k is bent by h, so that the grid is judged there.
        let time = row(&found, "k")["reason"].as_str().expect("a reason");
        assert!(time.contains("the grid is judged"), "{time}");
        // A wrong order fails on the grid and on the line.
        let (exit, found) = fitted(&folder, &file(&rows, 0.0), &["--p", "1", "--q", "3"]);
        assert_eq!((exit, &row(&found, "joint")["verdict"]), (1, &"fail".into()));
        assert_eq!(row(&found, "k")["verdict"], "fail");
    }
}

#[test]
fn a_floor_of_the_grid_is_found() {
    let folder = Folder::new("floor");
    let levels = [8, 16, 32, 64];
    let table = folder.file(
        "table.csv",
        &file(&grid(&levels, &levels, |h, k| 1e-3 + 0.3 * h + 4.0 * k * k), 0.0),
    );
    let text = stdout(&sweep(&["fit", &table]));
    assert!(text.contains("with a floor term (better): sum"), "{text}");
    assert!(text.contains("floor 1.00e-3"), "{text}");
    let plain = folder.file(
        "table.csv",
        &file(&grid(&levels, &levels, |h, k| shaken(h * k, 0.01) * (0.3 * h + 4.0 * k * k)), 0.0),
    );
    let text = stdout(&sweep(&["fit", &plain]));
    assert!(text.contains("(no better)"), "{text}");
}

/// A term of 0.1 % of the error cannot be seen, whatever its order: no verdict, and the cure.
#[test]
fn a_hidden_term_is_not_judged() {
    let folder = Folder::new("hidden");
    let levels = [8, 16, 32, 64];
    let rows = grid(&levels, &levels, |h, k| h + 1e-3 * k * k);
    let (exit, found) = fitted(&folder, &file(&rows, 0.0), &["--q", "2"]);
    let found = row(&found, "k");
    assert_eq!((exit, &found["verdict"]), (1, &"unresolved".into()));
    let reason = found["reason"].as_str().expect("a reason");
    assert!(reason.contains("the time term is at most"), "{reason}");
    assert_eq!(fitted(&folder, &file(&rows, 0.0), &["--p", "1"]).0, 0);
}

/// Several norms and scenes in one file, as a sweep writes them.
#[test]
fn norms_and_scenes_are_judged_one_by_one() {
    let folder = Folder::new("norms");
    let mut text = "scene,norm,h,k,error,floor,status\n".to_owned();
    for n in [8, 16, 32, 64] {
        let h = 1.0 / f64::from(n);
        text += &format!("a,V_max,{h},0.1,{h},1e-12,converged\n");
        text += &format!("a,L2_max,{h},0.1,{},1e-12,converged\n", h * h);
    }
    let (exit, rows) = fitted(&folder, &text, &["--p", "1"]);
    let verdicts: Vec<(&str, &str)> = rows
        .iter()
        .map(|row| (row["norm"].as_str().unwrap_or("-"), row["verdict"].as_str().unwrap_or("-")))
        .collect();
    assert_eq!(verdicts, [("V_max", "pass"), ("L2_max", "unresolved")]);
    assert!(rows.iter().all(|row| row["scene"] == "a"));
    assert_eq!(exit, 1);
    // A case that failed has no norm: it is missing in each.
    let failed = format!("{text}a,,0.0078125,0.1,,,failed\n");
    let (_, rows) = fitted(&folder, &failed, &["--p", "1"]);
    for row in &rows {
        assert_eq!(
            (&row["verdict"], &row["reason"]),
            (&"fail".into(), &"line 10: the case is failed".into())
        );
    }
    let printed = stdout(&sweep(&["fit", &folder.file("norms.csv", &text)]));
    assert!(printed.contains("a V_max, h: order 1.000"), "{printed}");
}

/// φ = 2 − 3 h^1.5 on five grids: the limit is 2.
#[test]
fn values_are_extrapolated() {
    let folder = Folder::new("values");
    let table = |value: &dyn Fn(f64) -> f64, steps: &[f64]| -> String {
        let rows: Vec<String> = steps.iter().map(|h| format!("{h},{:.17e}", value(*h))).collect();
        format!("h,value\n{}\n", rows.join("\n"))
    };
    let steps = [0.2, 0.1, 0.05, 0.04, 0.02];
    let smooth = table(&|h| 2.0 - 3.0 * h.powf(1.5), &steps);
    let (exit, rows) = fitted(&folder, &smooth, &["--p", "1.5"]);
    let found = row(&rows, "h");
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{value} in {found}"));
    assert_eq!((exit, &found["behaviour"]), (0, &"monotone".into()));
    // Sixteen digits of 2 in differences of 1e-2, and one more lost in the order.
    assert!((number(&found["extrapolated"]) - 2.0).abs() < 1e-11);
    assert!((number(&found["order_of_last_three"]) - 1.5).abs() < 1e-10);
    let error = 3.0 * 0.02f64.powf(1.5);
    assert!((number(&found["gci"]) / (1.25 * error) - 1.0).abs() < 1e-8);
    assert_eq!(fitted(&folder, &smooth, &["--p", "1"]).0, 1);
    // Unsorted rows are the same table.
    let mut reversed: Vec<f64> = steps.to_vec();
    reversed.reverse();
    assert_eq!(
        fitted(&folder, &table(&|h| 2.0 - 3.0 * h.powf(1.5), &reversed), &[]).1,
        rows_without_aim(rows)
    );
}

fn rows_without_aim(mut rows: Vec<Value>) -> Vec<Value> {
    for row in &mut rows {
        row["predicted"] = Value::Null;
        row["verdict"] = Value::Null;
        row["probability"] = Value::Null;
        row["reason"] = "".into();
    }
    rows
}

#[test]
fn values_without_a_limit_say_so() {
    let folder = Folder::new("no-limit");
    let table = |value: &dyn Fn(usize, f64) -> f64| -> String {
        let step = |level: usize| 0.5f64.powi(level as i32 + 2);
        let rows: Vec<String> = (0..5)
            .map(|level| format!("{},{:e}", step(level), value(level, step(level))))
            .collect();
        format!("k,value\n{}\n", rows.join("\n"))
    };
    let cases: [(&str, &str, String, &str); 4] = [
        ("divergent", "fail", table(&|_, h| 1.0 / h), "diverge, order -1.00"),
        ("divergent", "fail", table(&|level, _| level as f64), "diverge"),
        (
            "oscillating",
            "unresolved",
            table(&|level, h| 1.0 + h * [1.0, -1.0][level % 2]),
            "oscillate",
        ),
        ("stationary", "unresolved", table(&|_, _| 0.7), "equal"),
    ];
    for (behaviour, verdict, text, words) in cases {
        let (exit, rows) = fitted(&folder, &text, &["--q", "1"]);
        let found = row(&rows, "k");
        assert_eq!((&found["behaviour"], &found["verdict"]), (&behaviour.into(), &verdict.into()));
        assert!(found["reason"].as_str().is_some_and(|why| why.contains(words)), "{found}");
        assert!(found["extrapolated"].is_null() && exit == 1, "{found}");
        let printed = stdout(&sweep(&["fit", &folder.file("plain.csv", &text)]));
        assert!(!printed.contains("extrapolated value"), "{printed}");
    }
    // Oscillation that dies out still has a range.
    let range = fitted(&folder, &table(&|level, h| 1.0 + h * [1.0, -1.0][level % 2]), &[]).1;
    // Last three: ± h at 1/16, 1/32, 1/64, so 1 + 1/16 down to 1 − 1/32.
    assert_eq!(row(&range, "k")["half_range"].as_f64(), Some(0.5 * (1.0 / 16.0 + 1.0 / 32.0)));
    // A limit that nobody knows has no errors, of which these are words.
    for option in [["--floor", "1e-9"], ["--reference", "0"], ["--log", "1"]] {
        let output = sweep(&[
            "fit",
            &folder.file("values.csv", "h,value\n0.5,1\n0.25,2\n"),
            option[0],
            option[1],
        ]);
        let words = format!("{}: the table has values", option[0]);
        assert!(code(&output) == 2 && stderr(&output).contains(&words), "{}", stderr(&output));
    }
    // Too few, and with a hole.
    let (exit, rows) = fitted(&folder, "h,value\n0.5,1\n0.25,2\n", &["--p", "1"]);
    assert_eq!((exit, &row(&rows, "h")["verdict"]), (1, &"unresolved".into()));
    let four = "h,value\n0.5,2.5\n0.25,2.25\n0.125,2.125\n0.0625,2.0625\n";
    let three = &four[..four.rfind("0.0625").expect("a row")];
    let (exit, rows) = fitted(&folder, three, &["--p", "1"]);
    let reason = row(&rows, "h")["reason"].as_str().expect("a reason");
    assert!(exit == 1 && reason.contains("needs 4 different ones: run h = 0.0625"), "{reason}");
    // The index has three grids, and a verdict four.
    assert!(row(&rows, "h")["extrapolated"].as_f64().is_some_and(|l| (l - 2.0).abs() < 1e-6));
    assert_eq!(fitted(&folder, four, &["--p", "1"]).0, 0);
    let (exit, rows) = fitted(&folder, &format!("{four}0.03125,nan\n"), &["--p", "1"]);
    assert_eq!((exit, &row(&rows, "h")["verdict"]), (1, &"fail".into()));
}

/// A printed table of several norms, each with a claim, and what is wrong with a claim.
#[test]
fn printed_tables_are_judged_a_norm_at_a_time() {
    let folder = Folder::new("printed");
    let printed = folder.file(
        "deal.txt",
        "n cells         H1                   L2\n0   16 1.0 - - 0.1 - -\n1   64 0.5 2.0 1.0 0.025 4.0 2.0\n2  256 0.25 2.0 1.0 0.00625 4.0 2.0\n",
    );
    let fit = |aim: &[&str]| sweep(&[&["fit", &printed, "--dimension", "2"], aim].concat());
    assert_eq!(code(&fit(&["--p", "H1=1,L2=2"])), 0);
    assert_eq!(code(&fit(&["--p", "H1=1,L2=3"])), 1);
    // More than is claimed: unresolved, enough for a lower bound, too much for an exact order.
    let verdict = |aim: &[&str]| json(&fit(&[&["--json"], aim].concat()))[1]["verdict"].clone();
    assert_eq!(verdict(&["--p", "1"]), "unresolved");
    assert_eq!(verdict(&["--p", "1", "--at-least"]), "pass");
    assert_eq!(verdict(&["--p", "1", "--exact"]), "fail");
    let latex = stdout(&fit(&["--latex"]));
    assert!(
        latex.starts_with(
            "\\begin{tabular}{rrrrr}\n\\toprule\n$h$ & H1 & EOC & L2 & EOC \\\\\n\\midrule\n"
        ),
        "{latex}"
    );
    assert!(latex.contains("order & \\multicolumn{2}{r}{$1.00$ in $["), "{latex}");
    let picture = folder.argument("errors.svg");
    assert_eq!(code(&fit(&["--p", "H1=1", "--svg", &picture])), 0);
    let drawn = std::fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.starts_with("<svg") || drawn.starts_with("<?xml"), "{}", &drawn[..40]);
    for (aim, words) in [
        (["--p", "nan"], "no finite order"),
        (["--q", "inf"], "no finite order"),
        (["--p", "H2=1"], "nothing to judge: no `H2`; there is `H1`, `L2`"),
    ] {
        let output = fit(&aim);
        assert_eq!((code(&output), stderr(&output).contains(words)), (2, true), "{aim:?}");
    }
    // Without the dimension it follows from how the cells grow; what numbers the rows is no size.
    let output = stdout(&sweep(&["fit", &printed]));
    assert!(output.contains("h ~ cells^(-1/2)") && output.contains("left out: `n`"), "{output}");
}

/// What the published uncertainties are not made for is said beside them.
#[test]
fn unreliable_uncertainties_are_named() {
    let folder = Folder::new("caution");
    let caution = |value: &dyn Fn(f64) -> f64| {
        let rows = [0.4, 0.2, 0.1, 0.05].map(|h| format!("{h},{:e}\n", value(h)));
        let (_, found) = fitted(&folder, &format!("h,value\n{}", rows.concat()), &[]);
        row(&found, "h")["caution"].clone()
    };
    assert!(
        caution(&|h| 2.0 - h.sqrt()).as_str().is_some_and(|words| words.contains("below 0.75"))
    );
    let turns = caution(&|h| (h - 0.15).powi(2));
    assert!(turns.as_str().is_some_and(|words| words.contains("rise and fall")), "{turns}");
    assert!(caution(&|h| 2.0 - h).is_null());
}

/// Window, tolerance, factor |log h| and noise change what is judged, and say so.
#[test]
fn options_change_what_is_judged() {
    let folder = Folder::new("options");
    let rows = |levels: std::ops::Range<i32>, error: &dyn Fn(f64) -> f64| -> String {
        let row = |i: i32| format!("{},{:e}\n", 0.5f64.powi(i), error(0.5f64.powi(i)));
        format!("h,error\n{}", levels.map(row).collect::<String>())
    };
    let logarithm = rows(2..9, &|h| h * h.ln().abs());
    assert_eq!(fitted(&folder, &logarithm, &["--p", "1"]).0, 1);
    assert_eq!(fitted(&folder, &logarithm, &["--p", "1", "--log", "1"]).0, 0);
    // Order 2 on coarse meshes, 1 on fine ones.
    let turned = rows(2..12, &|h| h.powi(2).max(h / 64.0));
    assert_eq!(fitted(&folder, &turned, &["--p", "2"]).0, 1);
    let (exit, found) = fitted(&folder, &turned, &["--p", "2", "--window", "0.0156,0.3"]);
    let found = row(&found, "h");
    assert_eq!((exit, found["points_used"].as_array().map(Vec::len)), (0, Some(5)));
    let left = found["points_left_out"].as_array().expect("points");
    assert!(left.len() == 5 && left[0]["reason"] == "outside of the window", "{left:?}");
    // Of 18 levels the finest twelve are read, and the others are said to be none of them.
    let long = rows(1..19, &|h| h);
    let (exit, found) = fitted(&folder, &long, &["--p", "1"]);
    let found = row(&found, "h");
    assert_eq!((exit, &found["coarse_left_out"]), (0, &6.into()));
    let reason = found["reason"].as_str().expect("a reason");
    assert!(reason.ends_with(", without the 6 coarsest levels"), "{reason}");
    let printed = stdout(&sweep(&["fit", &folder.file("long.csv", &long)]));
    assert_eq!(printed.matches(", without the 6 coarsest levels\n").count(), 1, "{printed}");
    let high = rows(2..8, &|h| h.powf(1.3));
    assert_eq!(fitted(&folder, &high, &["--p", "1"]).0, 1);
    assert_eq!(fitted(&folder, &high, &["--p", "1", "--tolerance", "0.5"]).0, 0);
    // Four levels of a power law pass; with errors that are known to be off by 20 % they do not tell.
    let law = rows(2..6, &|h| h);
    let interval = |aim: &[&str]| {
        let (exit, found) = fitted(&folder, &law, aim);
        let ends = &row(&found, "h")["interval"];
        (exit, ends[1].as_f64().expect("an end") - ends[0].as_f64().expect("an end"))
    };
    let (plain, noisy) = (interval(&["--p", "1"]), interval(&["--p", "1", "--noise", "0.2"]));
    assert!(plain.0 == 0 && noisy.0 == 1 && noisy.1 > 2.0 * plain.1, "{plain:?} {noisy:?}");
    // Noise by a column, and by runs that scatter as much.
    let mut column = law.replace("error\n", "error,sigma\n");
    for i in 2..6 {
        let h = 0.5f64.powi(i);
        column = column.replace(&format!("{h},{h:e}\n"), &format!("{h},{h:e},{}\n", 0.2 * h));
    }
    let (exit, found) = fitted(&folder, &column, &["--p", "1"]);
    let ends = &row(&found, "h")["interval"];
    let width = ends[1].as_f64().expect("an end") - ends[0].as_f64().expect("an end");
    assert!(exit == 1 && (width / noisy.1 - 1.0).abs() < 1e-9, "{width} {noisy:?}");
    let runs = rows(2..6, &|h| 1.4 * h) + &rows(2..6, &|h| h / 1.4)["h,error\n".len()..];
    assert_eq!(fitted(&folder, &runs, &["--p", "1", "--runs"]).0, 1);
    for (option, value, words) in [
        ("--tolerance", "nan", "tolerance"),
        ("--tolerance", "-1", "tolerance"),
        ("--noise", "0", "--noise: the relative standard deviation 0.0 is none"),
        ("--noise", "1e308", "--noise: the relative standard deviation 1e308 is none"),
        ("--log", "inf", "the power inf of |log h| is none"),
        ("--log", "nan", "the power NaN of |log h| is none"),
        ("--window", "0", "no window"),
    ] {
        let table = folder.file("table.csv", &law);
        refuses(&["fit", &table, option, value], &[words]);
    }
}

/// Bound and tolerance of each norm, a table for each scheme with its own order, and sizes by a ratio; what was read is said.
#[test]
fn each_norm_and_each_scheme_has_its_own_claim() {
    let folder = Folder::new("own-claims");
    let verdicts = |text: &str, aim: &[&str]| -> Vec<String> {
        let (_, rows) = fitted(&folder, text, aim);
        rows.iter().map(|row| row["verdict"].as_str().unwrap_or("-").to_owned()).collect()
    };
    let levels = [1u32, 2, 3, 4, 5];
    let row = |level: &u32| {
        let h = 0.5f64.powi(*level as i32);
        format!("{h},{:e},{:e}\n", h.powf(2.5), h)
    };
    let two = format!("h,error_L2,H1\n{}", levels.iter().map(row).collect::<String>());
    assert_eq!(verdicts(&two, &["--p", "L2=2,H1=1"]), ["unresolved", "pass"]);
    assert_eq!(verdicts(&two, &["--p", "L2>=2,H1==1"]), ["pass", "pass"]);
    assert_eq!(verdicts(&two, &["--p", "L2==2,H1=1"]), ["fail", "pass"]);
    assert_eq!(verdicts(&two, &["--p", "L2=2:0.6,H1=1"]), ["pass", "pass"]);
    let scheme = |name: &str, order: i32| -> String {
        let row = |level: &u32| {
            format!("{name},{},{:e}\n", 2u32.pow(*level), 0.5f64.powi(*level as i32 * order))
        };
        levels.iter().map(row).collect()
    };
    let schemes = format!("scheme,n,error\n{}{}", scheme("euler", 1), scheme("heun", 2));
    let each = "scheme=euler=1,scheme=heun=2";
    assert_eq!(verdicts(&schemes, &["--p", each]), ["pass", "pass"]);
    assert_eq!(verdicts(&schemes, &["--p", "2"]), ["fail", "pass"]);
    let sizeless = "L2 H1\n1e-2 1e-1\n2.5e-3 5e-2\n6.25e-4 2.5e-2\n1.5625e-4 1.25e-2\n";
    assert_eq!(verdicts(sizeless, &["--p", "L2=2,H1=1", "--ratio", "2"]), ["pass", "pass"]);
    let table = folder.file("sizeless.txt", sizeless);
    let printed = stdout(&sweep(&["fit", &table, "--q", "1", "--ratio", "2"]));
    assert!(printed.ends_with("read 4 rows: k by --ratio 2, errors `L2`, `H1`\n"), "{printed}");
    let (_, rows) = fitted(&folder, &schemes, &[]);
    assert_eq!(
        rows[0]["read"],
        "read 10 rows: h from `n`, errors `error`; a table for each `scheme`"
    );
}

/// What the judge says of tables at the edges of what it knows; the numbers are those of programs, and what is wanted is what
/// an analyst says of each.
#[test]
fn tables_at_the_edges_get_what_an_analyst_says() {
    let folder = Folder::new("edges");
    let of = |errors: &[&str]| {
        let rows = errors.iter().enumerate().map(|(level, error)| format!("{level} {error}\n"));
        format!("level error\n{}", rows.collect::<String>())
    };
    let rounding = of(&["1.31e-16", "8.32e-17", "6.55e-17", "8.12e-17", "1.21e-16"]);
    let to_rounding = of(&[
        "9.4972e-7",
        "2.1208e-8",
        "3.7638e-10",
        "6.1020e-12",
        "9.5479e-14",
        "1.5543e-15",
        "1.1102e-15",
        "1.1102e-15",
        "4.4409e-16",
    ]);
    let blown_up = of(&["1e-3", "1e6", "2.4e5", "6e4", "1.5e4"]);
    let wobbling = of(&["1.01e-3", "9.41e-5", "6.60e-6", "3.30e-7", "1.98e-8"]);
    let low = of(&["5.700e-9", "1.545e-9", "4.470e-10", "1.256e-10", "3.501e-11"]);
    // e = h^½ − (1/512)^½ for h = 1/2 … 1/128: the slopes are .54 to .87.
    let against: Vec<f64> =
        (1..8).map(|i| 0.5f64.powi(i).sqrt() - (1.0f64 / 512.0).sqrt()).collect();
    let against: Vec<String> = against.iter().map(f64::to_string).collect();
    let against: String =
        (1..8).zip(&against).map(|(i, error)| format!("{} {error}\n", 0.5f64.powi(i))).collect();
    let against = format!("h error\n{against}");
    for (text, options, wanted) in [
        (&rounding, &["--p", "4"][..], "unresolved"),
        (&to_rounding, &["--p", "6"], "pass"),
        (&to_rounding, &["--p", "5"], "unresolved"),
        (&to_rounding, &["--p", "6", "--floor", "1e-15"], "pass"),
        (&to_rounding, &["--p", "7", "--floor", "1e-15"], "fail"),
        (&blown_up, &["--p", "2"], "unresolved"),
        (&blown_up, &["--p", "2", "--at-least"], "unresolved"),
        (&wobbling, &["--p", "4"], "pass"),
        (&low, &["--p", "2", "--tolerance", "0.3"], "pass"),
        (&against, &["--p", "1.5"], "unresolved"),
        (&against, &["--p", "0.5", "--reference", "0.001953125"], "pass"),
        (&against, &["--p", "0.75", "--reference", "0.001953125"], "fail"),
        (&against, &["--p", "0.5", "--reference", "0"], "unresolved"),
    ] {
        let (_, rows) = fitted(&folder, text, options);
        let found = row(&rows, "h");
        assert_eq!(found["verdict"], wanted, "{options:?} {found}");
        let reason = found["reason"].as_str().expect("a reason");
        let into_rounding = text == &rounding || text == &to_rounding;
        assert!(!into_rounding || !reason.contains("run h"), "{reason}");
    }
    for (options, what) in [
        (["--reference", "0.0078125"], "has to be finer"),
        (["--reference", "-1"], "has to be finer"),
        (["--floor", "-1"], "no floor"),
    ] {
        let path = folder.file("errors.txt", &against);
        refuses(&["fit", &path, options[0], options[1]], &[what]);
    }
}

/// On GitHub a table has verdicts and no cases; without a predicted order nothing is judged, and nothing is announced.
#[test]
fn github_is_told_of_tables_and_verdicts() {
    let folder = Folder::new("fit-github");
    let table = folder.file(
        "errors.csv",
        "h,L2,H1\n0.5,1,1\n0.25,0.25,0.5\n0.125,0.0625,0.25\n0.0625,0.015625,0.125\n",
    );
    let summary = folder.argument("summary.md");
    let fit = |aim: &[&str]| {
        let mut command = command(&[&["fit", &table, "--github"], aim].concat());
        stdout(&command.env("GITHUB_STEP_SUMMARY", &summary).output().expect("the binary"))
    };
    assert!(!fit(&[]).contains("::") && !Path::new(&summary).exists());
    let told = fit(&["--p", "L2=2,H1=2"]);
    let count = "1 of 2 verdicts as expected; 2 tables\n";
    assert!(told.contains(&format!("::notice title=orders of convergence::{count}")), "{told}");
    assert!(told.contains("errors.csv,line=2,title="), "{told}");
    let text = std::fs::read_to_string(&summary).expect("a summary");
    assert!(text.contains(count) && !text.contains("case"), "{text}");
}

/// Records are judged as `run` judged them: their errors are those against an exact solution, which a foreign table does
/// not say.
#[test]
fn records_have_the_interval_of_their_run() {
    let folder = Folder::new("fit-records");
    let (out, grid) = (folder.argument("out"), ["--n", "4", "--steps", "4,8,16,32"]);
    ends(0, &[&["run", "affine", "--out", &out][..], &grid].concat());
    let judged = folder.json("out/verdict.json");
    let interval = |path: &str| {
        let rows = json(&sweep(&["fit", path, "--q", "V_max=2", "--json"]));
        let rows = rows.as_array().expect("rows").clone();
        let of = |row: &&Value| row["norm"] == V_MAX && row["variable"] == "k";
        rows.iter().find(of).expect("a row")["interval"].clone()
    };
    assert_eq!(interval(&folder.argument("out/cases.csv")), judged["verdicts"][0]["interval"]);
    let text = folder.read("out/cases.csv");
    let foreign = folder.file("foreign.csv", &text);
    assert_ne!(interval(&foreign), judged["verdicts"][0]["interval"]);
}
