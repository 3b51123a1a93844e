//! Source: the contract of `sweep trade` and `sweep solve --estimate`; errors of single runs as `sweep run` measures them.
//! Goal: the command measures the errors of a sweep, loses no row, answers a target
//!   with a run that has the error it predicts, and refuses nonsense with one message; the bound of a quantity contains its
//!   limit. No clock is compared.
//! Data: compliance, affine, signorini, pure-mild, in-space, pure-box, punch without its reference.

use crate::judged::errors;
use crate::program::{Folder, ends, json, refuses, stderr, stdout, sweep};
use crate::shipped::{edited, on_mesh, run, setup, setup_of, text};
use fem::norms::{step_errors, strain_error};
use fem::space::quadrature::TruthRules;
use scene::Norm;
use scene::setup::{MeshData, Setup};
use serde_json::Value;
use studies::trade::estimate::{Alignment, Part, companions};

/// Errors closer than this part of them are one in a trade.
const TIE: f64 = 0.01;

fn v_error(setup: &Setup, n: u32, steps: u32) -> f64 {
    errors(setup, &on_mesh(setup, n), n, steps, &[Norm::VMax])[0]
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

#[test]
fn a_trade_measures_what_a_sweep_measures_and_answers_a_target() {
    let folder = Folder::new("trade");
    let out = folder.argument("out");
    let grid = ["--n", "4,8,16", "--steps", "2,4,8", "--out", &out];
    let target = ["--target", "0.03", "--confirm", "--json"];
    let output = ends(0, &[&["trade", "compliance"][..], &grid, &target].concat());
    let document = json(&output);
    let trials = document["trials"].as_array().expect("trials");
    let named = |change: &'static str| trials.iter().filter(move |row| row["change"] == change);
    assert_eq!(named("as written").count(), 9);
    assert_eq!(document["holds"], true, "{}", document["claims"]);
    let lines = |line| {
        document["claims"].as_array().expect("claims").iter().filter(move |c| c["line"] == line)
    };
    assert_eq!(
        [lines("error").count(), lines("error model").count(), lines("target").count()],
        [trials.len(), 9, 1]
    );
    // The numbers of `sweep run`, bit by bit.
    let compliance = setup("compliance");
    for (n, steps) in [(4, 2), (16, 8)] {
        let row = named("as written").find(|row| row["n"] == n && row["steps"] == steps);
        let error = number(&row.expect("a row")["error"]);
        assert_eq!(error, v_error(&compliance, n, steps));
    }
    // Each setting on the same grid, with what it does to the largest run.
    let prices = document["prices"].as_array().expect("prices");
    for setting in ["strong loads", "contact by Gauss points", "contact exact"] {
        let places = |rows: &mut dyn Iterator<Item = &Value>| -> Vec<[Value; 2]> {
            rows.map(|row| [row["n"].clone(), row["steps"].clone()]).collect()
        };
        let both = ["as written", setting].map(|change| places(&mut named(change)));
        assert_eq!(both[0], both[1], "{setting}");
        let of = |change| named(change).next_back().expect("the largest run");
        let price = prices.iter().find(|price| price["what"] == setting).expect("a price");
        let ratio = |key| number(&of(setting)[key]) / number(&of("as written")[key]);
        // Roundings of two quotients.
        assert!((number(&price["speed"]) * ratio("cpu_seconds") - 1.0).abs() < 1e-14);
        assert!((number(&price["error"]) + 1.0 - ratio("error")).abs() < 1e-14, "{price}");
    }
    // Every row is in the table, in the order of the runs.
    let table = folder.read("out/compliance-trade.csv");
    assert_eq!(table.lines().count(), 1 + trials.len());
    for (line, row) in table.lines().skip(1).zip(trials) {
        for key in ["change", "error", "cpu_seconds"] {
            let cell = row[key].as_str().map_or_else(|| row[key].to_string(), str::to_owned);
            assert!(line.split(',').any(|part| part == cell), "{key} {cell}: {line}");
        }
    }
    let svg = folder.read("out/compliance-trade.svg");
    assert!(svg.contains("Pareto front") && svg.contains("CPU time in seconds"));
    let saved = folder.json("out/compliance-trade.json");
    assert_eq!(saved["answer"], document["answer"]);
    let points: Vec<(f64, f64, bool)> = trials
        .iter()
        .map(|row| (number(&row["cpu_seconds"]), number(&row["error"]), row["front"] == true))
        .collect();
    // Whoever is not on the front has a run on it that costs no more and is as good, but for a tie; nobody on it has.
    for (i, &(seconds, error, is_on)) in points.iter().enumerate() {
        let mut others = points.iter().enumerate().filter(|(j, other)| *j != i && other.2);
        let beaten = others.any(|(_, other)| other.0 <= seconds && (1.0 - TIE) * other.1 <= error);
        assert!(beaten != is_on, "{i} {seconds} {error}");
    }
    // Space error of order 1, and an answer that has the error that was asked for. Which setting is the fastest is
    // the clock's; on the grid settings move the error by less than 5 %.
    let order = number(&document["models"][0]["error_model"]["space"]["order"]);
    assert!((0.85..1.15).contains(&order), "{order}");
    let answer = &document["answer"];
    let real = number(&document["confirmed"]["error"]);
    let predicted = number(&answer["error"]);
    assert!(predicted <= 0.03 && (0.75..1.25).contains(&(real / predicted)), "{real}");
    let steps = answer["steps"].as_u64().expect("steps") as u32;
    let n = answer["n"].as_u64().expect("cells") as u32;
    let chosen = match answer["change"] == "element P2" {
        true => setup_of(with_quadratics(&text("compliance"))),
        false => compliance,
    };
    assert!((v_error(&chosen, n, steps) / real - 1.0).abs() < 0.06);
}

fn with_quadratics(scene: &str) -> String {
    edited(scene, "[exact]\n", "[discretization]\nelement = \"P2\"\n[exact]\n")
}

/// The largest V error of a run, against the truth by the rules of the scene and by the next ones.
fn by_both_rules(setup: &Setup, n: u32, steps: u32) -> [f64; 2] {
    let next = TruthRules::stronger_for(setup.body.element, 2);
    let next = MeshData::with_rules(setup, n, None, &next).expect("a mesh").truth;
    let (data, mut worst) = (on_mesh(setup, n), [0.0f64; 2]);
    run(setup, &setup.model, &data, steps, |view| {
        for (worst, truth) in worst.iter_mut().zip([&data.truth, &next]) {
            let moments = truth.moments(view.t).expect("a truth");
            *worst = worst.max(step_errors(&data.space, &setup.model, view, &moments).v);
        }
    })
    .unwrap_or_else(|error| panic!("{error}"));
    worst
}

/// The other element has the errors of the scene that names it, on meshes with as many nodes, and P2 reaches the error of
/// P1 with a fraction of the unknowns: on a smooth body, and under a law with kinks that move.
#[test]
fn elements_are_compared_at_equal_error() {
    let elastic = text("quadratic-elastic");
    let linear = edited(&elastic, "element = \"P2\"", "element = \"P1\"");
    let compliance = text("compliance");
    let folder = Folder::new("trade-elements");
    let out = folder.argument("out");
    for (name, [p1, p2], written) in [
        ("quadratic-elastic", [linear, elastic], "P2"),
        ("compliance", [compliance.clone(), with_quadratics(&compliance)], "P1"),
    ] {
        let [p1, p2] = [p1, p2].map(setup_of);
        let (n, other, meshes) = if written == "P1" {
            ("8,16,32", "P2", [4, 8, 16])
        } else {
            ("4,8,16", "P1", [8, 16, 32])
        };
        let grid = ["--n", n, "--steps", "2,4,8", "--target", "2%", "--out", &out, "--json"];
        let output = ends(0, &[&["trade", name][..], &grid].concat());
        let document = json(&output);
        let trials = document["trials"].as_array().expect("trials");
        let row = |element: &str, n: u32, steps: u32| {
            let change = format!("element {element}");
            let change = if element == written { "as written" } else { &change };
            let found =
                |row: &&Value| row["change"] == *change && row["n"] == n && row["steps"] == steps;
            trials.iter().find(found).unwrap_or_else(|| panic!("{name}: {change} {n} {steps}"))
        };
        let of = |element: &str| if element == "P1" { &p1 } else { &p2 };
        for (n, steps) in [(meshes[0], 2), (meshes[2], 8)] {
            assert_eq!(number(&row(other, n, steps)["error"]), v_error(of(other), n, steps));
        }
        // Half the cells have the same nodes, and 8 cells of quadratics are better than 32 of linear functions, with a
        // sixteenth of the nodes but for those on the sides.
        let (fine, coarse) = (row("P1", 32, 8), row("P2", 4, 8));
        assert_eq!(row("P1", 16, 8)["dofs"], row("P2", 8, 8)["dofs"]);
        assert!(number(&row("P2", 8, 8)["error"]) < 0.5 * number(&fine["error"]), "{name}");
        assert!(7.0 * number(&row("P2", 8, 8)["dofs"]) < 2.0 * number(&fine["dofs"]));
        assert!(number(&coarse["error"]) < number(&row("P1", 16, 8)["error"]), "{name}");
        // Who wins does not depend on the rule by which errors are integrated, nor on whether σ was by the same.
        for (element, n) in [("P1", 32), ("P2", 8)] {
            let [by_rule, by_next] = by_both_rules(of(element), n, 8);
            assert_eq!(by_rule, v_error(of(element), n, 8));
            assert!(
                (by_next / by_rule - 1.0).abs() < 0.01,
                "{name} {element}: {by_rule:e} {by_next:e}"
            );
        }
        // Each element has a run with the error that is wanted, the answer is the cheapest, or the scene as written where
        // that saves less than a fifth.
        let models = document["models"].as_array().expect("models");
        assert_eq!(models.last().expect("a model")["change"], format!("element {other}"));
        let candidates = document["candidates"].as_array().expect("candidates");
        let seconds = candidates.iter().map(|found| number(&found["cpu_seconds"]));
        let least = seconds.fold(f64::INFINITY, f64::min);
        let answer = &document["answer"];
        let most = if answer["change"] == "as written" { least / 0.8 } else { least };
        assert!(number(&answer["cpu_seconds"]) <= most, "{candidates:?}");
        for (change, element) in [("as written", written), (&format!("element {other}"), other)] {
            let found = candidates.iter().find(|found| found["change"] == *change);
            let found = found.unwrap_or_else(|| panic!("{name} {change}: {candidates:?}"));
            let [n, steps] = ["n", "steps"].map(|key| found[key].as_u64().expect("a count") as u32);
            let real = v_error(of(element), n, steps);
            let most = 1.25 * number(&found["target"]);
            assert!(real <= most, "{name} n = {n}, N = {steps}: {real:e} {most:e}");
        }
    }
}

#[test]
fn nonsense_ends_in_one_message() {
    let folder = Folder::new("trade-refused");
    let punch = text("punch");
    let blind = punch.split("[sweep]").next().expect("a scene");
    let blind = folder.file("punch.toml", blind);
    let out = folder.argument("out");
    let small = ["--n", "4,8,16", "--steps", "2,4,8", "--out", &out];
    for (arguments, message) in [
        (vec!["trade", "affine", "--target", "0"], "must be positive"),
        (vec!["trade", "affine", "--target=-1"], "must be positive"),
        (vec!["trade", "affine", "--target", "inf"], "must be positive"),
        (vec!["trade", "affine", "--target", "one"], "not a number"),
        (vec!["trade", "affine", "--norm", "L2_max", "--target", "1%"], "V_max alone"),
        (vec!["trade", "affine", "--norm", "energy"], "choose one of V_max"),
        (vec!["trade", "affine", "--confirm"], "--target"),
        (vec!["trade", "affine", "--budget", "0"], "number of seconds"),
        (vec!["trade", "abstract-smooth"], "no mesh to trade"),
        (vec!["trade", "linear-punch", "--norm", "trace_L2_max"], "Γ3"),
        (vec!["trade", &blind], "no error can be measured"),
        (vec!["trade", "nowhere"], "nowhere"),
    ] {
        refuses(&arguments, &[message]);
    }
    // Out of reach: what was measured is kept, and the message says what the least is.
    for (scene, target, words) in
        [("affine", "1e-30", "cannot be reached"), ("compliance", "1e-6", "out of reach")]
    {
        let output = ends(2, &[&["trade", scene, "--target", target][..], &small].concat());
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    assert!(folder.at("out/affine-trade.csv").exists());
}

#[test]
fn the_bound_of_a_quantity_contains_its_limit() {
    for (name, n, steps) in [("compliance", 16, 8), ("viscoelastic", 16, 8), ("signorini", 32, 8)] {
        let setup = setup(name);
        let data = on_mesh(&setup, n);
        let truth = data.truth.moments(setup.scene.time.horizon).expect("the truth is finite");
        let exact = strain_error(&data.space, &vec![0.0; data.space.nodes.len()], &truth);
        let found = companions(&setup, n, steps, &mut |_, _| ());
        let found = found.unwrap_or_else(|error| panic!("{error}"));
        let estimate =
            found.quantities.iter().find(|found| found.name == "strain_norm").expect("a quantity");
        let bound = estimate.uncertainty.unwrap_or_else(|| panic!("{name}: {estimate:?}"));
        let away = (estimate.value - exact).abs();
        println!("{name}: |eps(u)| is {away:.2e} from its limit, bound {bound:.2e}");
        // The quadrature of the norm of the truth is good to 1e-6 here.
        assert!(away <= bound + 1e-6 * exact, "{name}: {away:e} {estimate:?}");
        let better = (estimate.extrapolated.expect("a limit") - exact).abs();
        assert!(better < 0.5 * away, "{name}: {better:e} {away:e}");
        // Bounds that are far wider would hold anything.
        assert!(bound < 20.0 * away, "{name}: {bound:e} {away:e}");
    }
}

#[test]
fn what_has_no_companions_is_unknown_with_its_reason() {
    let output = ends(0, &["solve", "compliance", "--n", "6", "--steps", "8", "--estimate"]);
    assert!(stdout(&output).contains("h: n = 6 is no multiple of 4"), "{}", stdout(&output));
    let arguments = ["solve", "compliance", "--n", "8", "--steps", "6", "--estimate", "--json"];
    let document = json(&sweep(&arguments));
    let v = &document["norms"][0];
    assert_eq!((&v["norm"], &v["value"]), (&"V_max".into(), &Value::Null));
    assert_eq!(v["time"]["reason"], "N = 6 is no multiple of 4");
    assert!(v["space"]["interval"].is_array());
    // An abstract scene has no mesh; other solvers have no companions.
    for arguments in [
        vec!["solve", "abstract-smooth", "--steps", "8", "--estimate"],
        vec![
            "solve",
            "affine",
            "--n",
            "4",
            "--steps",
            "8",
            "--estimate",
            "--solver",
            "fixed-point",
        ],
    ] {
        ends(2, &arguments);
    }
    // Differences that do not fall, whatever the norm.
    let part = Part::of([1.0, 1.1], 0.0, Some(1.0), Alignment::Orthogonal);
    assert!(part.is_err_and(|reason| reason.contains("pre-asymptotic")));
}
