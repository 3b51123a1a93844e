//! Source: the contract of cases.csv: every column but `seconds_*` is bit-identical for any number of threads.
//! Goal: one and two jobs, and two runs, give the same records, verdicts and pictures; a comparison that a last digit
//!   escapes is caught.
//! Data: pure-mild (all terms; time error against a run of 8 N steps), signorini, punch with a small reference run.

use std::path::Path;

use crate::program::{Folder, code, lasting, stderr, sweep, timeless};
use crate::shipped::{edited, text};

/// Three scenes with small grids: every kind of job of a sweep.
fn scenes(folder: &Folder) -> [String; 3] {
    let mild = edited(&text("pure-mild"), "window_n = [32, 32]", "window_n = [8, 8]");
    let mild = edited(&mild, "n = [16, 32, 64, 96]", "n = [4, 8]");
    let mild = edited(&mild, "steps = [2, 4, 8, 16]", "steps = [2, 4, 8]");
    let signorini = edited(&text("signorini"), "n = [8, 16, 32, 64]", "n = [4, 8, 16]");
    let signorini = edited(&signorini, "steps = [16]", "steps = [4]");
    let punch = edited(&text("punch"), "n = [8, 16, 32]", "n = [4, 8]");
    let punch = edited(&punch, "steps = [8, 16, 32]", "steps = [4, 8]");
    let punch = edited(&punch, "{ n = 128, steps = 64 }", "{ n = 16, steps = 16 }");
    [("pure-mild", mild), ("signorini", signorini), ("punch", punch)]
        .map(|(name, text)| folder.file(&format!("{name}.toml"), &text))
}

fn run(folder: &Folder, scenes: &[String; 3], out: &str, jobs: &str) {
    let out = folder.argument(out);
    let [a, b, c] = scenes;
    let output = sweep(&["run", a, b, c, "--out", &out, "--jobs", jobs]);
    // The grids are too small for verdicts: unresolved is 1, a failed case would be 2.
    assert_eq!(code(&output), 1, "{}", stderr(&output));
}

/// The first difference of two tables.
fn difference(a: &[Vec<String>], b: &[Vec<String>]) -> Option<String> {
    if a.len() != b.len() {
        return Some(format!("{} and {} rows", a.len(), b.len()));
    }
    let pair = a.iter().zip(b).find(|(a, b)| a != b)?;
    Some(format!("{:?}\n{:?}", pair.0, pair.1))
}

fn same_file(a: &Path, b: &Path) -> bool {
    let read = |path: &Path| {
        std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    read(a) == read(b)
}

#[test]
fn one_job_two_jobs_and_again() {
    let folder = Folder::new("reproducible");
    let scenes = scenes(&folder);
    for (out, jobs) in [("one", "1"), ("two", "2"), ("again", "2")] {
        run(&folder, &scenes, out, jobs);
    }
    let one = timeless(&folder.at("one/cases.csv"));
    // 6 cases of pure-mild (3 with the time error), 3 of signorini, 4 of punch, 6 norms each, and the header.
    assert_eq!(one.len(), 1 + 6 * 13 + 3);
    let column = |name: &str| one[0].iter().position(|key| key == name).expect("a column");
    let (error, status) = (column("error"), column("status"));
    for row in &one[1..] {
        let value: f64 = row[error].parse().expect("a number");
        assert!(row[status] == "converged" && value.is_finite(), "{row:?}");
    }
    for other in ["two", "again"] {
        let table = timeless(&folder.at(&format!("{other}/cases.csv")));
        assert_eq!(difference(&one, &table), None, "one against {other}");
        for file in ["verdict.json", "provenance.json"] {
            let [a, b] = ["one", other].map(|run| lasting(&folder.at(&format!("{run}/{file}"))));
            assert_eq!(a, b, "{file} of {other}");
        }
        for file in ["pure-mild-h.svg", "signorini-h.svg"] {
            let (a, b) = (folder.at(&format!("one/{file}")), folder.at(&format!("{other}/{file}")));
            assert!(same_file(&a, &b), "{file} of {other} differs");
        }
    }
    // The comparison sees a last digit, a lost row and a swapped pair.
    let mut digit = one.clone();
    digit[5][error].push('1');
    assert!(difference(&one, &digit).is_some());
    assert!(difference(&one, &one[..one.len() - 1]).is_some());
    let mut swapped = one.clone();
    swapped.swap(2, 3);
    assert!(difference(&one, &swapped).is_some());
}
