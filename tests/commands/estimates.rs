//! Source: docs/estimates, whose statements are derived there.
//! Goal: the orders, intervals and constants of the pages on histories of histories and on short memory are those of a run;
//!   scenes that break a hypothesis are refused without a word of it.
//! Data: the scenes that the tables of both pages name, one run of all of them.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use serde_json::Value;

use crate::program::{Folder, code, refuses, repository, stderr, sweep};
use crate::shipped::{edited, text};

const PAGES: [&str; 2] = ["NESTED.md", "SHORT-MEMORY.md"];

fn page(name: &str) -> String {
    repository(&format!("docs/estimates/{name}"))
}

/// The cells of the rows that begin with a scene.
fn rows(page: &str) -> Vec<Vec<&str>> {
    let lines = page.lines().filter(|line| line.starts_with("| `"));
    lines.map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

fn scene<'t>(row: &[&'t str]) -> &'t str {
    row[0].trim_matches('`')
}

static RUN: LazyLock<(i32, Vec<Value>)> = LazyLock::new(|| {
    let folder = Folder::new("estimates");
    let out = folder.argument("out");
    let pages = PAGES.map(page);
    let scenes: BTreeSet<&str> =
        pages.iter().flat_map(|page| rows(page)).map(|row| scene(&row)).collect();
    let mut arguments = vec!["run", "damping-falls"];
    arguments.extend(scenes);
    arguments.extend(["--out", &out]);
    let output = sweep(&arguments);
    let document = folder.json("out/verdict.json");
    (code(&output), document["verdicts"].as_array().expect("verdicts").clone())
});

fn numbers(cell: &str) -> Vec<f64> {
    let kept = cell.replace(['[', ']', ','], " ");
    kept.split_whitespace().filter_map(|word| word.parse().ok()).collect()
}

/// Rows that do not say what a run gives; the last digit printed may round.
fn stale(page: &str) -> Vec<String> {
    let check = |row: Vec<&str>| {
        let norm = match () {
            () if row.contains(&"displacement") => "displacement_max",
            () if row.contains(&"stress") => "stress_L2_max",
            () => "V_max",
        };
        let of_row = |verdict: &&Value| verdict["scene"] == scene(&row) && verdict["norm"] == norm;
        let Some(verdict) = RUN.1.iter().find(of_row) else { return Some(format!("{row:?}")) };
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let interval = &verdict["interval"];
        let wanted = [&verdict["observed"], &interval[0], &interval[1]].map(number);
        let letter = verdict["variable"].as_str().unwrap_or_default();
        let constant = number(&verdict["constants"][format!("C_{letter}")]["value"]);
        let [.., order, observed, printed] = &row[..] else { return Some(format!("{row:?}")) };
        let (order, observed) = (numbers(order), numbers(observed));
        let printed = numbers(printed);
        let close = observed.len() == 3
            && observed.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.0101)
            // Three digits are printed.
            && printed.len() == 1
            && (printed[0] / constant - 1.0).abs() < 0.01
            && order.first().is_some_and(|order| *order == number(&verdict["predicted"]));
        (!close).then(|| format!("{row:?}, a run gives {wanted:?} {constant:.3e}"))
    };
    rows(page).into_iter().filter_map(check).collect()
}

#[test]
fn the_tables_of_the_pages_are_those_of_a_run() {
    assert_eq!(RUN.0, 0, "a verdict is not as expected");
    for (name, least) in PAGES.into_iter().zip([4, 6]) {
        let page = page(name);
        assert!(rows(&page).len() >= least, "{name}");
        let found = stale(&page);
        assert!(found.is_empty(), "{}", found.join("\n"));
        let line = page.lines().find(|line| line.starts_with("| `")).expect("a row");
        let wrong = line.replacen("| 1", "| 1.5", 1).replacen("[0.", "[0.4", 1);
        assert_eq!(stale(&page.replace(line, &wrong)).len(), 1, "{name}");
    }
    // No order is left where the response falls faster than the viscosity holds.
    let lost = RUN.1.iter().find(|verdict| verdict["scene"] == "damping-falls").expect("a verdict");
    assert_eq!(lost["verdict"], "fail");
    let ends = [0, 1].map(|end| lost["interval"][end].as_f64().expect("a number"));
    assert!(ends[0] > -0.05 && ends[1] < 0.05, "{ends:?}");
}

#[test]
fn broken_hypotheses_and_odd_histories_are_refused() {
    let folder = Folder::new("estimates-refused");
    let nested = text("nested-left");
    let body = text("nested-body");
    for (name, text, words) in [
        ("damping", edited(&text("damping-falls"), "\nviolates", "\n# "), "(2.9) fails: m0"),
        (
            "smooth",
            edited(&text("broken-nested"), "\"sqrt(s - tau)\"", "\"exp(tau - s)\""),
            "claims to violate (3.17), but nothing shows a violation",
        ),
        (
            "rule",
            edited(&nested, "rule = \"left\"", "rule = \"gregory\""),
            "no bounds are known of a history of a history by this rule: Gregory of order 3",
        ),
        (
            "start",
            edited(
                &edited(&nested, ", inner = \"1 + s*tau\"", ""),
                "[[trace]]",
                "start = [1.0, 0.0]\n[[trace]]",
            ),
            "`start` is where inner histories begin, and no kernel has one",
        ),
        ("pole", edited(&nested, "1 + s*tau", "1/(1 - s)"), "r(s, tau) is inf at tau = s = 1"),
        (
            "both",
            edited(
                &body,
                "[contact]",
                "[material.projection]\nmu = 1.0\nkappa = \"0.1\"\n[contact]",
            ),
            "no bound of zeta is proved beside a history of a history",
        ),
        (
            "beside",
            edited(&body, "terms = [", "kernel = \"1\"\nterms = ["),
            "`kernel` beside `terms`: each term has its own",
        ),
    ] {
        refuses(&["check", &folder.file(&format!("{name}.toml"), &text)], &[words]);
    }
    // Another program would need two kernels a term.
    let output = sweep(&["verify", "nested-body", "--solver", "true"]);
    assert_ne!(code(&output), 0);
    let said = stderr(&output);
    assert!(said.contains("history of a history"), "{said}");
}
