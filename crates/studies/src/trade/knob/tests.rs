//! Which knobs scenes offer, and what turned knobs leave as it is.

use super::*;

fn scene(name: &str) -> Scene {
    let path = format!("{}/../../manufactured/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    Scene::read(path.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn offered(name: &str) -> Vec<String> {
    let setup = Setup::new(scene(name)).unwrap_or_else(|error| panic!("{error}"));
    knobs(&setup).into_iter().map(Knob::name).collect()
}

#[test]
fn a_scene_offers_what_it_has() {
    assert_eq!(
        offered("pure-mild"),
        [
            "tolerance 1e-12",
            "tolerance 1e-10",
            "tolerance 1e-8",
            "linear tolerance 1e-2",
            "linear tolerance 1e-8",
            "loads of degree 1",
            "loads of degree 2",
            "loads of degree 4",
            "strong loads",
            "contact by Gauss points",
            "contact exact",
            "history direct",
            "element P2",
        ]
    );
    // Quadratic elements have one rule on Γ3, loads of two degrees more and no fewer points than strains.
    let quadratic = offered("quadratic-compliance");
    assert!(!quadratic.iter().any(|knob| knob.starts_with("contact")), "{quadratic:?}");
    let loads: Vec<&String> = quadratic.iter().filter(|knob| knob.contains("loads")).collect();
    assert_eq!(
        loads,
        ["loads of degree 2", "loads of degree 4", "loads of degree 6", "strong loads"]
    );
    assert_eq!(quadratic.last().map(String::as_str), Some("element P1"));
    // No law, no rule for it; loads given as formulas are what they are.
    assert!(!offered("signorini").iter().any(|knob| knob.starts_with("contact")));
    assert_eq!(offered("linear-punch"), ["history direct", "element P2"]);
    let general =
        ["history direct", "history to 1e-9", "history to 1e-6", "history to 1e-3", "element P2"];
    assert!(offered("power-law").ends_with(&general.map(String::from)));
    // Nothing is integrated where u lives in V^h, and the plane alone cuts edges.
    assert!(!offered("in-space").iter().any(|knob| knob.contains("loads")));
    assert!(!offered("pure-box").iter().any(|knob| knob == "contact exact"));
}

/// Sums over a short past are direct whatever is asked for; a recursion is another sum from the first step on.
#[test]
fn history_knobs_are_turned_where_they_change_the_sum() {
    let setup = |name| Setup::new(scene(name)).unwrap_or_else(|error| panic!("{error}"));
    let from = |knob: Knob, name| {
        let setup = setup(name);
        (1..2000).find(|&steps| knob.matters(&setup, steps))
    };
    assert_eq!(from(Knob::DirectHistory, "linear-punch"), Some(1));
    // 21 steps a node: 4 nodes for 1e-3, 8 for 1e-6, 12 for 1e-9, 16 for 1e-13.
    let errors = [1e-3, 1e-6, 1e-9].map(Knob::HistoryTolerance);
    let found = errors.map(|knob| from(knob, "power-law"));
    assert_eq!(found, [Some(84), Some(168), Some(252)]);
    assert_eq!(from(Knob::DirectHistory, "power-law"), Some(336));
}

/// A tolerance is one for general kernels: sums of exponentials keep their recursion, in what is predicted as well.
#[test]
fn a_history_tolerance_leaves_recursions_alone() {
    let vectors = |name, interpolated_to: Option<Option<f64>>| {
        let setup = Setup::new(scene(name)).unwrap_or_else(|error| panic!("{error}"));
        let setup = match interpolated_to {
            Some(error) => setup.with_history(error),
            None => setup,
        };
        setup.history_vectors(1000)
    };
    let [written, loose, direct] =
        [None, Some(Some(1e-3)), Some(None)].map(|to| vectors("linear-punch", to));
    // One state and the last level; all levels.
    assert_eq!([written, loose, direct], [2, 2, 1001]);
    let [written, loose, direct] =
        [None, Some(Some(1e-3)), Some(None)].map(|to| vectors("power-law", to));
    assert!(loose < written && written < direct && direct == 1001, "{loose} {written}");
}

/// Looser sums are other sums, by no more than what they are allowed, and hold less.
#[test]
fn looser_histories_move_the_solution_by_what_they_say() {
    let run = |knob: Knob| {
        let variant = Variant::new(&scene("power-law"), knob).unwrap();
        let data = variant.on_mesh(4).unwrap();
        let mut all = Vec::new();
        let mut observe = |view: &fem::contact::StepView<'_>| {
            all.extend_from_slice(view.u);
            Ok(())
        };
        let info = variant.march(&data, 700, &mut observe).unwrap();
        (all, info.peak_history_bytes)
    };
    let (direct, all) = run(Knob::DirectHistory);
    let largest = direct.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    let mut bytes = all;
    for (knob, error) in [
        (Knob::AsWritten, INTERPOLATED_TO),
        (Knob::HistoryTolerance(1e-9), 1e-9),
        (Knob::HistoryTolerance(1e-6), 1e-6),
        (Knob::HistoryTolerance(1e-3), 1e-3),
    ] {
        let (u, held) = run(knob);
        let off = u.iter().zip(&direct).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        // ∫b is below 1/2 and the resolvent of this kernel below 2; rounding of 700 terms.
        assert!(off <= (error + 1e-13) * largest, "{}: {off:e}", knob.name());
        // So smooth a kernel has rounding by the nodes of 1e-9.
        assert!(error < 1e-8 || off > 1e-13 * largest, "{}: {off:e}", knob.name());
        assert!(held < bytes, "{}: {held} and {bytes} bytes", knob.name());
        bytes = held;
    }
}

/// The last displacements of a short run with one knob turned, and its passes over factors.
fn run(knob: Knob) -> (Vec<f64>, u32) {
    let variant = Variant::new(&scene("pure-strong"), knob).unwrap();
    let data = variant.on_mesh(8).unwrap();
    let mut last = Vec::new();
    let mut observe = |view: &fem::contact::StepView<'_>| {
        last = view.u.to_vec();
        Ok(())
    };
    let info = variant.march(&data, 8, &mut observe).unwrap();
    (last, info.work.linear.solves)
}

#[test]
fn linear_solves_of_any_kind_have_the_same_solution_and_are_really_others() {
    let (as_written, _) = run(Knob::AsWritten);
    let largest = as_written.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    let solves = [Knob::LinearTolerance(1e-2), Knob::LinearTolerance(1e-8)].map(|knob| {
        let (u, solves) = run(knob);
        // 16 units of rounding of the forces, times a condition number below 1e4.
        let off = u.iter().zip(&as_written).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(off < 1e-10 * largest, "{}: {off:e}", knob.name());
        solves
    });
    let [loose, strict] = solves;
    assert!(loose < strict, "{loose} and {strict} solves");
}

/// Mean of a polynomial over the simplex: ∏ α_i! d!/(d + Σα)!.
#[test]
fn rules_have_their_degree_and_no_more() {
    let mean = |rule: &Rule, powers: [i32; 2]| -> f64 {
        let value = |p: &Vec<f64>| p[0].powi(powers[0]) * p[1].powi(powers[1]);
        rule.points.iter().zip(&rule.weights).map(|(p, w)| w * value(p)).sum()
    };
    for d in [2usize, 3] {
        let exact = |powers: [i32; 2]| {
            let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
            let d = d as i32;
            let top = factorial(powers[0]) * factorial(powers[1]) * factorial(d);
            top / factorial(d + powers[0] + powers[1])
        };
        let off = |degree: u32, powers: [i32; 2]| {
            (mean(&load_rule(d, degree), powers) - exact(powers)).abs()
        };
        // A few roundings of numbers below 1; a missed degree is 1e-3 and more.
        assert!(off(1, [1, 0]) < 1e-15 && off(1, [2, 0]) > 1e-3);
        assert!(off(2, [2, 0]) < 1e-15 && off(2, [1, 1]) < 1e-15 && off(2, [3, 0]) > 1e-4);
        assert!(off(6, [5, 1]) < 1e-14);
    }
}
