//! Source: the numbered equations of the paper.
//! Goal: every formula of the paper that the code computes is found by its number; a number in a comment that the paper
//!   does not have is a mistake; docs/EQUATIONS.md is what the comments say today.
//! Data: the comments under crates/ and src/. `EQUATIONS_WRITE=1 cargo test --release --test commands equations` writes
//!   the page anew.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::program::files_below;

/// What the paper states where, for the numbers that the code names.
const STATED: &[(&str, &str)] = &[
    ("2.1", "history-dependent operators"),
    ("2.2", "the variational-hemivariational inequality, Problem 1"),
    ("2.3", "the spaces X, X_j and the set K"),
    ("2.4", "the trace γ_j and its constant c_j"),
    ("2.5", "A is pseudomonotone and strongly monotone, m_A"),
    ("2.6", "S is history-dependent"),
    ("2.7", "convexity of φ, constants α_φ and β_φ"),
    ("2.8", "growth of ∂j and relaxed monotonicity, α_j"),
    ("2.9", "smallness: α_φ + α_j c_j² < m_A"),
    ("2.10", "regularity of f"),
    ("2.11", "the history operator S by a kernel q"),
    ("3.1", "trapezoidal rule"),
    ("3.2", "discrete history operator in time"),
    ("3.3", "semidiscrete inequality, Problem 5"),
    ("3.4", "bound on the step size"),
    ("3.7", "the map Λ whose fixed point is the solution of a step"),
    ("3.15", "contraction factor of Λ"),
    ("3.17", "error of the semidiscrete solution, order k²"),
    ("3.19", "the exact inequality tested with the discrete solution"),
    ("3.20", "the discrete inequality tested with the exact solution"),
    ("3.21", "the two inequalities added"),
    ("3.22", "error of the rule on the exact history"),
    ("3.23", "error of the history operator"),
    ("3.24", "recurrence of the errors in time, before Gronwall's inequality"),
    ("4.1", "the condition on φ for problems without constraint"),
    ("4.2", "discrete history operator in time and space"),
    ("4.3", "fully discrete inequality, Problem 9"),
    ("4.4", "Céa's inequality with constraint, Theorem 10"),
    ("4.5", "the residual term E_n"),
    ("4.6", "the exact inequality tested with the fully discrete solution"),
    ("4.7", "strong monotonicity at the two solutions"),
    ("4.8", "the splitting of ⟨Au − Au^kh, u − u^kh⟩"),
    ("4.9", "the sum of E_φ1, E_φ2, E_j, E_A and E_n"),
    ("4.10", "E_φ1"),
    ("4.11", "E_φ2"),
    ("4.12", "E_j"),
    ("4.13", "E_A"),
    ("4.14", "bound of E_φ1"),
    ("4.15", "bound of E_φ2"),
    ("4.16", "bound of E_j"),
    ("4.17", "bound of E_A"),
    ("4.18", "the error by approximation, residual and history"),
    ("4.19", "error of the history operator, fully discrete"),
    ("4.20", "recurrence of the errors, fully discrete"),
    ("4.21", "Céa's inequality without constraint, Theorem 11"),
    ("4.26", "the sum of the terms without constraint"),
    ("4.27", "E_φ3"),
    ("4.28", "E_j without constraint"),
    ("4.29", "bound of E_φ3"),
    ("4.30", "bound of E_j without constraint"),
    ("4.31", "the error by approximation and history, without constraint"),
    ("5.1", "the constitutive law"),
    ("5.2", "equilibrium"),
    ("5.4", "tractions"),
    ("5.5", "contact conditions"),
    ("5.6", "no friction"),
    ("5.8", "the operator A of the contact problem"),
    ("5.9", "the norm of Y"),
    ("5.10", "φ of the contact problem"),
    ("5.11", "S of the contact problem"),
    ("5.12", "j as an integral over Γ3"),
    ("5.14", "the scheme, Problem 14"),
    ("5.15", "regularity of u in time"),
    ("5.16", "Céa's inequality of the contact problem"),
    ("5.17", "the residual term of the contact problem"),
    ("5.18", "regularity of the stress"),
    ("5.23", "bound of the residual term"),
    ("5.24", "the error by approximation alone"),
    ("5.25", "regularity of u in space"),
    ("5.26", "the error estimate, order h + k²"),
];

/// Numbers in parentheses in the comments of a text, sections 2 to 5; decimals like (2.05) are none.
fn numbers(text: &str) -> BTreeSet<String> {
    let comments = text.lines().filter(|line| line.trim_start().starts_with("//"));
    let mut found = BTreeSet::new();
    for piece in comments.flat_map(|line| line.split('(').skip(1)) {
        let Some((inside, _)) = piece.split_once(')') else { continue };
        let Some((section, number)) = inside.split_once('.') else { continue };
        let plain = !number.starts_with('0') && number.parse::<u8>().is_ok_and(|n| n < 32);
        if matches!(section, "2" | "3" | "4" | "5") && plain {
            found.insert(inside.to_owned());
        }
    }
    found
}

/// Files by number, without those of tests.
fn places() -> BTreeMap<String, BTreeSet<String>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut places: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in ["crates", "src"].iter().flat_map(|folder| files_below(&root.join(folder), "rs")) {
        let name = file.strip_prefix(root).expect("below the root").display().to_string();
        if name.contains("tests") {
            continue;
        }
        for number in numbers(&std::fs::read_to_string(&file).expect("a text")) {
            places.entry(number).or_default().insert(name.clone());
        }
    }
    places
}

/// The page, in the order of the paper.
fn page(places: &BTreeMap<String, BTreeSet<String>>) -> String {
    let mut page = String::from(
        "# Where an equation of the paper is in the code\n\n\
         For readers of the paper who look for a formula. The files whose comments name each number; the tests of this\n\
         repository write and compare this page.\n\n\
         | equation | states | files |\n|---|---|---|\n",
    );
    for (number, stated) in STATED {
        let Some(files) = places.get(*number) else { continue };
        let link = |file: &String| {
            let short = file.trim_start_matches("crates/").replacen("/src/", "/", 1);
            format!("[{}](../{file})", short.trim_end_matches(".rs"))
        };
        let links: Vec<String> = files.iter().map(link).collect();
        page += &format!("| ({number}) | {stated} | {} |\n", links.join(", "));
    }
    page
}

#[test]
fn the_index_of_equations_is_what_the_comments_say() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/EQUATIONS.md");
    let page = page(&places());
    if std::env::var_os("EQUATIONS_WRITE").is_some() {
        std::fs::write(&path, &page).expect("a written page");
    }
    let kept = std::fs::read_to_string(&path).expect("docs/EQUATIONS.md");
    assert!(kept == page, "docs/EQUATIONS.md is stale: EQUATIONS_WRITE=1 writes it anew");
}

#[test]
fn comments_name_equations_that_the_paper_has() {
    let places = places();
    for (number, files) in &places {
        assert!(STATED.iter().any(|(known, _)| known == number), "({number}) in {files:?}");
    }
    // What a stranger looks for first is there.
    for number in ["2.9", "3.4", "3.24", "4.16", "5.1", "5.5", "5.14", "5.26"] {
        assert!(places.contains_key(number), "nothing names ({number})");
    }
}

#[test]
fn numbers_of_the_paper_are_told_from_others() {
    let found = |text: &str| numbers(text).into_iter().collect::<Vec<_>>();
    assert_eq!(
        found("/// By (3.4) and (4.16), not (2.05), (6.1), (3.028), (2.99).\n"),
        ["3.4", "4.16"]
    );
    assert_eq!(found("let a = f(3.4);"), [""; 0]);
}
