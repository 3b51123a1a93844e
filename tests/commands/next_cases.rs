//! Source: verdicts on tables whose truth is known; the balanced path k = √h as a design of a sweep.
//! Goal: the case that an open verdict names decides it, a floor is lowered where it comes from (which cases are named:
//!   crates/judge/src/verdict/next.rs); along the path one line shows both orders, which k = h does not; a path is what its scene says.
//! Data: tables by hand; viscoelastic on pairs.

use crate::program::{Folder, code, command, ends, json, refuses, stderr, stdout, sweep};
use crate::shipped::{edited, text};
use judge::record::{CaseRecord, Key, NormError, Status, V_MAX};
use judge::verdict::{
    Decision, FloorSource, Foreseen, LeadingLine, LeadingPoint, MeshAndSteps, Prediction, Variable,
    Verdict, judge, judge_foreseen,
};
use report::{AnnotationPlace, annotations, step_summary};
use scene::{Scene, Source};

/// A case of h = 1/n and k = 1/N, without an error where it is missing.
pub(crate) fn case(n: u32, steps: u32, error: Option<f64>, floor: f64) -> CaseRecord {
    CaseRecord {
        status: Status::Converged,
        errors: vec![NormError { norm: V_MAX.into(), error, floor: Some(floor) }],
        ..CaseRecord::without_work("block", Some(n), steps, 1.0 / f64::from(steps))
    }
}

/// Cases of pairs (n, N) with the error of (h, k).
fn table(pairs: &[(u32, u32)], floor: f64, error: impl Fn(f64, f64) -> f64) -> Vec<CaseRecord> {
    let one = |&(n, steps): &(u32, u32)| {
        case(n, steps, Some(error(1.0 / f64::from(n), 1.0 / f64::from(steps))), floor)
    };
    pairs.iter().map(one).collect()
}

pub(crate) fn predict(variable: Variable, order: f64) -> Prediction {
    Prediction { why: "(5.26)".into(), ..Prediction::new(V_MAX, variable, order) }
}

pub(crate) fn judged(records: &[CaseRecord], prediction: &Prediction) -> Verdict {
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    judge("block", records, &keys, prediction, Decision::Pass)
}

fn next(n: u32, steps: u32) -> MeshAndSteps {
    MeshAndSteps { n: Some(n), steps }
}

/// The way out names what the floor comes from.
#[test]
fn a_floor_is_lowered_where_it_comes_from() {
    let lost = table(&[(8, 4), (16, 4), (32, 4), (64, 4)], 1.0, |h, _| h);
    for (floor, said, other) in [
        (FloorSource::Unknown, "a stronger quadrature", "load quadrature"),
        (FloorSource::Solver, "it comes from the solver", "quadrature"),
        (FloorSource::Quadrature, "it is the quadrature of loads and errors", "solver"),
        (FloorSource::LoadQuadrature, "it is the load quadrature of form = \"strong\"", "solver"),
        (FloorSource::Reference, "the reference run, a finer one", "quadrature"),
    ] {
        let prediction = Prediction { floor, ..predict(Variable::H, 1.0) };
        let Verdict { reason, next, .. } = judged(&lost, &prediction);
        assert!(reason.contains(said) && !reason.contains(other), "{floor:?}: {reason}");
        assert!(next.is_empty());
    }
}

/// Where several solutions may exist a constant that is off may be that of another one; else it is a factor.
#[test]
fn a_constant_of_another_solution_is_no_factor() {
    let ns = [8, 16, 32, 64];
    let records = table(&ns.map(|n| (n, 4)), 0.0, |h, _| 2.0 * h);
    let keys: Vec<Key> = records.iter().map(CaseRecord::key).collect();
    let point = |n: u32| {
        let h = 1.0 / f64::from(n);
        LeadingPoint { n: Some(n), steps: 4, h: Some(h), k: 0.25, error: h }
    };
    let line = LeadingLine { points: ns.map(point).into(), limit: None, tolerance: 0.01 };
    for (unique, blames) in [(true, false), (false, true)] {
        let prediction = Prediction { unique, ..predict(Variable::H, 1.0) };
        let foreseen = Foreseen::Leading(line.clone());
        let found =
            judge_foreseen("block", &records, &keys, &prediction, Some(&foreseen), Decision::Pass);
        assert_eq!(found.decision, Decision::Fail, "{}", found.reason);
        let another = found.reason.contains("another solution may have been followed");
        assert!(another == blames && found.reason.contains("off by a factor"), "{}", found.reason);
    }
}

/// Errors that stand at the predicted error of what is not refined do not refute an order and ask for more of that; where
/// the predicted error is small, they are those of a wrong program.
#[test]
fn what_is_in_the_way_is_asked_for() {
    let ns = [(2, 8), (4, 8), (8, 8), (16, 8)];
    let steps = ns.map(|(n, steps)| (steps, n));
    let in_h = ("time term is 100 % of the error at n = 16, steps = 8", "more steps", "run n =");
    let in_k =
        ("space term is 100 % of the error at n = 8, steps = 16", "more cells n", "run steps");
    for (variable, places, (said, cure, other)) in
        [(Variable::H, ns, in_h), (Variable::K, steps, in_k)]
    {
        let records = table(&places, 0.0, |_, _| 0.01);
        let judged_with = |other_error: Option<f64>| {
            judged(&records, &Prediction { other_error, ..predict(variable, 2.0) })
        };
        let hidden = judged_with(Some(0.01));
        let wanted = places.map(|(n, steps)| match variable {
            Variable::H => next(n, 4 * steps),
            _ => next(2 * n, steps),
        });
        assert_eq!((hidden.decision, &hidden.next[..]), (Decision::Unresolved, &wanted[..]));
        let reason = hidden.reason;
        assert!(
            reason.contains(&format!("{said}, as predicted")) && reason.contains(cure),
            "{reason}"
        );
        assert!(!reason.contains(other), "{reason}");
        for small in [None, Some(1e-4)] {
            let wrong = judged_with(small);
            assert_eq!((wrong.decision, wrong.next.len()), (Decision::Fail, 0), "{}", wrong.reason);
        }
    }
}

/// A run predicts what stands in the way: few steps beside quadratic elements, few cells where k is judged on the whole error.
#[test]
fn a_run_says_what_is_in_the_way() {
    let folder = Folder::new("in-the-way");
    let on_all = edited(&text("pure-mild"), "V_time_max", "V_max");
    let window = "window_n = [32, 32] ";
    let on_all = folder.file("whole.toml", &edited(&on_all, window, "window_n = [4, 4] "));
    for (scene, n, steps, variable, cure, other) in [
        ("quadratic-memory", "2,4,8", "2", "h", "more steps", "more cells"),
        (&on_all, "4", "2,4,8", "k", "more cells n", "more steps"),
    ] {
        let out = folder.argument(variable);
        let run = sweep(&["run", scene, "--n", n, "--steps", steps, "--out", &out]);
        let written = std::fs::read_to_string(folder.at(variable).join("verdict.json"));
        let verdicts: serde_json::Value =
            serde_json::from_str(&written.expect("verdict.json")).expect("JSON");
        let found = verdicts["verdicts"].as_array().expect("verdicts").iter();
        let found = found.filter(|one| one["variable"] == variable && one["norm"] == V_MAX);
        let reasons: Vec<String> = found.map(|one| one["reason"].to_string()).collect();
        assert_eq!(reasons.len(), 1, "{}", stdout(&run));
        let reason = &reasons[0];
        assert!(reason.contains("as predicted") && reason.contains(cure), "{reason}");
        assert!(!reason.contains(other), "{reason}");
    }
}

/// h + k² with both terms of one size: on k = √h the order in h is 1 only if both orders hold; on k = h a lost time
/// order hides behind the space order.
#[test]
fn a_balanced_path_shows_both_orders_and_k_equal_h_does_not() {
    let balanced = [(4, 4), (8, 6), (16, 8), (32, 11), (64, 16), (128, 23), (256, 32)];
    let diagonal: Vec<(u32, u32)> = balanced.iter().map(|&(n, _)| (n, n)).collect();
    let along = predict(Variable::Path, 1.0);
    let verdict = |pairs: &[(u32, u32)], q: f64| {
        judged(&table(pairs, 0.0, |h, k| 0.3 * h + 4.0 * k.powf(q)), &along)
    };
    let sound = verdict(&balanced, 2.0);
    assert_eq!(sound.decision, Decision::Pass, "{}", sound.reason);
    let lost = verdict(&balanced, 1.0);
    assert_eq!(lost.decision, Decision::Fail, "{}", lost.reason);
    let hidden = verdict(&diagonal, 1.0);
    assert_eq!(hidden.decision, Decision::Pass, "{}", hidden.reason);
    // Too short a path is continued in both steps.
    let short = verdict(&balanced[2..4], 2.0);
    assert_eq!(short.next, [next(64, 15)], "{}", short.reason);
    // A grid is no path.
    let grid = [(8, 4), (8, 8), (16, 4), (16, 8)];
    assert_eq!(verdict(&grid, 2.0).decision, Decision::Unresolved);
}

fn on_pairs(pairs: &str) -> String {
    let scene = edited(&text("viscoelastic"), "n = [8, 16, 32, 64]\nsteps = [16]", pairs);
    edited(&scene, "variable = \"h\"", "variable = \"path\"")
}

#[test]
fn a_scene_runs_its_pairs_and_no_grid() {
    let folder = Folder::new("pairs");
    let text = on_pairs("pairs = [[4, 4], [8, 6], [16, 8], [32, 11]]");
    let path = folder.file("viscoelastic.toml", &text);
    let output = ends(0, &["run", &path, "--out", &folder.argument("out")]);
    assert!(stdout(&output).contains("path") && stdout(&output).contains("4 cases"));
    let picture = folder.read("out/viscoelastic-h.svg");
    assert!(picture.contains("N grows with n"), "the curve is that of the path");
    refuses(&["run", &path, "--n", "8,16", "--out", &folder.argument("out")], &["path of pairs"]);
    for (pairs, words) in [
        ("pairs = [[4, 4], [8, 6]]", "an order needs three"),
        ("pairs = [[4, 4], [8, 6], [8, 8]]", "does not refine"),
        ("pairs = [[4, 4], [8, 6], [16, 5]]", "does not refine"),
        ("pairs = [[4, 4], [8, 6, 1], [16, 5]]", "3 entries, but 2 are expected"),
        ("pairs = [[4, 4], [8, 6], [16, 8]]\nn = [4]", "both pairs and a grid"),
    ] {
        let scene = Scene::from_source(Source::from_text("p.toml", on_pairs(pairs)));
        let error = scene.expect_err(pairs).to_string();
        assert!(error.contains(words), "{pairs}: {error}");
    }
    let odd = edited(&text, "variable = \"path\"", "variable = \"h\"");
    let error = Scene::from_source(Source::from_text("p.toml", odd)).expect_err("h on a path");
    assert!(error.to_string().contains("hold h and k together"), "{error}");
    let odd =
        edited(&crate::shipped::text("viscoelastic"), "variable = \"h\"", "variable = \"path\"");
    let error = Scene::from_source(Source::from_text("p.toml", odd)).expect_err("a path on a grid");
    assert!(error.to_string().contains("a path needs pairs"), "{error}");
}

/// The first verdict of a run that is not as expected.
fn first_open(folder: &Folder, scene: &str) -> serde_json::Value {
    let output = ends(1, &["run", scene, "--json", "--out", &folder.argument("out")]);
    json(&output)["verdicts"][0].clone()
}

#[test]
fn the_case_that_an_open_verdict_names_decides_it() {
    let folder = Folder::new("next");
    // No order has an interval on two meshes.
    let scene = edited(&text("viscoelastic"), "n = [8, 16, 32, 64]", "n = [4, 8]");
    let scene = folder.file("viscoelastic.toml", &edited(&scene, "steps = [16]", "steps = [4]"));
    let open = first_open(&folder, &scene);
    assert_eq!(open["verdict"], "unresolved", "{open:#}");
    let next = &open["next"][0];
    assert_eq!(next["steps"], 4, "{open:#}");
    let n = format!("4,8,{}", next["n"]);
    let output = ends(0, &["run", &scene, "--n", &n, "--json", "--out", &folder.argument("out")]);
    assert!(json(&output)["verdicts"][0].get("next").is_none(), "a pass asks for nothing");
}

/// f0 grows without bound towards x = 1/3: it is its quadrature that hides the errors, and not the solver.
#[test]
fn errors_below_the_floor_of_strong_loads_name_the_load_quadrature() {
    let folder = Folder::new("strong-floor");
    let scene = edited(&text("viscoelastic"), "[exact]", "[exact]\nform = \"strong\"");
    let scene = edited(&scene, "sin(pi*x)*(1 - y^2)", "abs(x - 1/3)^1.55*(1 - y^2)");
    let scene = edited(&scene, "n = [8, 16, 32, 64]", "n = [4, 8, 16]");
    let scene = folder.file("viscoelastic.toml", &edited(&scene, "steps = [16]", "steps = [4]"));
    let found = first_open(&folder, &scene);
    let reason = found["reason"].as_str().expect("a reason");
    assert!(
        reason.contains("load quadrature") && reason.contains("sweep check --floors"),
        "{found:#}"
    );
    assert!(!reason.contains("solver"), "{reason}");
    // The scene alone knows it: from the records the reason is the same.
    ends(1, &["report", &folder.argument("out")]);
    let document = folder.json("out/verdict.json");
    assert_eq!(document["verdicts"][0]["reason"], found["reason"]);
}

#[test]
fn annotations_name_file_line_and_reason() {
    let four = [(8, 4), (16, 4), (32, 4), (64, 4)];
    let passed = judged(&table(&four, 0.0, |h, _| h), &predict(Variable::H, 1.0));
    let failed = judged(&table(&four, 0.0, |h, _| h.sqrt()), &predict(Variable::H, 1.0));
    let open = judged(&table(&four[..2], 0.0, |h, _| h), &predict(Variable::H, 1.0));
    let expected = Verdict { expect: Decision::Fail, ..failed.clone() };
    let missed = Verdict { expect: Decision::Fail, ..passed.clone() };
    let place = |scene: &str, verdict: Option<&Verdict>| {
        let line = if verdict.is_some() { 33 } else { 7 };
        Some(AnnotationPlace { file: format!("manufactured/{scene}.toml"), line })
    };
    let mut records = table(&four, 0.0, |h, _| h);
    let verdicts = [passed, failed, open, expected, missed];
    let text = annotations(&records, &verdicts, place);
    let lines: Vec<&str> = text.lines().collect();
    let head = "file=manufactured/block.toml,line=33,title=block%3A V_max in h%3A ";
    for (line, start) in lines.iter().zip([
        format!("::error {head}fail::predicted 1 by (5.26), observed 0.50 "),
        format!("::error {head}unresolved::predicted 1 by (5.26), observed -: 2 points"),
        format!("::warning {head}fail%2C as expected::"),
        format!("::error {head}pass%2C expected fail::"),
        "::notice title=orders of convergence::2 of 5 verdicts as expected; 4 cases, 0 ".to_owned(),
    ]) {
        assert!(line.starts_with(&start), "{line}\n{start}");
    }
    assert_eq!(lines.len(), 5);
    assert_eq!(text, annotations(&records, &verdicts, place), "deterministic");
    records[0].status = Status::Failed { reason: "no\ndescent: 100 %".into() };
    let text = annotations(&records, &[], place);
    let line = "::error file=manufactured/block.toml,line=7,title=block%3A n = 8%2C steps = 4 failed::no%0Adescent: 100 %25";
    assert_eq!(text.lines().next(), Some(line));
    let summary = step_summary(&records, &verdicts);
    assert_eq!(summary.lines().filter(|line| line.starts_with("| block |")).count(), 5);
    assert!(summary.contains("| **fail** |") && summary.contains("| fail, as expected |"));
    assert!(summary.lines().all(|line| !line.starts_with('|') || line.ends_with('|')));
}

#[test]
fn a_gate_annotates_and_appends_to_the_summary() {
    let folder = Folder::new("github");
    let short = edited(&text("viscoelastic"), "n = [8, 16, 32, 64]", "n = [4, 8]");
    let path = folder.file("viscoelastic.toml", &short);
    let out = folder.argument("out");
    let summary = folder.file("summary.md", "before\n");
    let gate = |arguments: &[&str], variables: &[(&str, &str)]| {
        let mut command = command(&[&["gate", &path, "--out", &out], arguments].concat());
        command.envs(variables.iter().copied());
        let output = command.output().expect("the binary runs");
        assert_eq!(code(&output), 1, "{}", stderr(&output));
        stdout(&output)
    };
    assert!(!gate(&[], &[]).contains("::error"), "nothing outside Actions");
    let order = 1 + short[..short.find("order = 1.0").expect("an order")].matches('\n').count();
    let wanted =
        format!("viscoelastic.toml,line={order},title=viscoelastic%3A V_max in h%3A unresolved::");
    for (arguments, variables) in [
        (&["--github"][..], &[("GITHUB_STEP_SUMMARY", summary.as_str())][..]),
        (&[], &[("GITHUB_ACTIONS", "true")]),
    ] {
        let text = gate(arguments, variables);
        assert!(text.contains("::error file=") && text.contains(&wanted), "{text}");
        assert!(text.contains("::notice title=orders of convergence::0 of 1 verdict as"), "{text}");
    }
    let text = folder.read("summary.md");
    assert!(text.starts_with("before\n### Orders of convergence\n"), "{text}");
    assert_eq!(text.matches("| viscoelastic |").count(), 1, "appended once");
}
