//! docs/SABOTAGE.md: the matrix, two scores, survivors with reasons.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

use crate::catalogue::Term;
use crate::matrix::{Effect, Gate, Line};
use crate::reasons::reason;

/// Where the committed matrix lies.
pub fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/SABOTAGE.md")
}

const MARK: &str = "●";

/// Shares of caught defects.
pub struct Scores {
    pub defects: usize,
    /// Without any number of an earlier run or another program.
    pub theory: usize,
    /// `theory` without the tables, which see the judge alone.
    pub without_tables: usize,
    /// With baseline and fixtures.
    pub all: usize,
    /// Defects in solver, truth, norms, meshes and records, and how many of them `theory` has.
    pub numbers: [usize; 2],
    /// Defects that move an order, and how many of them `theory` has.
    pub orders: [usize; 2],
}

impl Scores {
    pub fn of(lines: &[Line]) -> Self {
        let count = |keep: &dyn Fn(&&Line) -> bool| lines.iter().filter(keep).count();
        let moves = |line: &&Line| line.effect == Effect::Order;
        let counts =
            |line: &&Line| !matches!(line.defect.term, Term::Judging | Term::Answer | Term::Report);
        Self {
            defects: lines.len(),
            theory: count(&|line| line.by_theory()),
            without_tables: count(&|line| {
                line.caught.iter().any(|(gate, _)| gate.is_of_theory() && *gate != Gate::Tables)
            }),
            all: count(&|line| line.is_caught()),
            numbers: [count(&|line| counts(line)), count(&|line| counts(line) && line.by_theory())],
            orders: [count(&|line| moves(line)), count(&|line| moves(line) && line.by_theory())],
        }
    }

    /// Shares of the first and the second score.
    pub fn shares(&self) -> [f64; 2] {
        [self.theory, self.all].map(|caught| caught as f64 / self.defects as f64)
    }
}

/// The text of the document.
pub fn render(lines: &[Line]) -> String {
    let mut text = String::from(HEAD);
    let scores = Scores::of(lines);
    let [first, second] = scores.shares().map(|share| 100.0 * share);
    let ([moved, of_them], [numbers, seen]) = (scores.orders, scores.numbers);
    let _ = writeln!(
        text,
        "| | caught | of | share |\n|---|---|---|---|\n\
         | orders, predicted constants, bounds, identities, tables | {} | {} | {first:.0} % |\n\
         | the same without the tables | {} | {} | {:.0} % |\n\
         | the first, of defects that move an order | {of_them} | {moved} | {:.0} % |\n\
         | the first, of defects in solver, truth, norms, meshes and records | {seen} | {numbers} | {:.0} % |\n\
         | with fixtures and baseline | {} | {} | {second:.0} % |\n",
        scores.theory,
        scores.defects,
        scores.without_tables,
        scores.defects,
        100.0 * scores.without_tables as f64 / scores.defects as f64,
        100.0 * of_them as f64 / moved.max(1) as f64,
        100.0 * seen as f64 / numbers.max(1) as f64,
        scores.all,
        scores.defects,
    );
    text.push_str("| gate | catches | alone |\n|---|---|---|\n");
    for gate in Gate::ALL {
        let caught = lines.iter().filter(|line| line.by(gate)).count();
        let alone = lines.iter().filter(|line| line.by(gate) && line.caught.len() == 1).count();
        let _ = writeln!(text, "| {} | {caught} | {alone} |", gate.name());
    }
    text.push_str(MATRIX);
    let names = Gate::ALL.map(Gate::name).join(" | ");
    let _ = writeln!(text, "| defect | term | touches | order | constant | {names} |");
    let _ = writeln!(text, "|---|---|---|---|---|{}", "---|".repeat(Gate::ALL.len()));
    for line in lines {
        let _ = writeln!(text, "{}", row(line));
    }
    text.push_str("\n## Survivors\n\n");
    text.push_str("Of the first score; those that the second leaves too are marked.\n\n");
    for line in lines.iter().filter(|line| !line.by_theory()) {
        let left = if line.is_caught() { "" } else { " **(of both)**" };
        let why = reason(line.defect.name).unwrap_or("no reason is known");
        let _ = writeln!(text, "- *{}*{left}: {why}", line.defect.name);
    }
    text
}

/// The row of a defect.
pub fn row(line: &Line) -> String {
    let marks = Gate::ALL.map(|gate| if line.by(gate) { MARK } else { "" }).join(" | ");
    let number = |value: Option<f64>| match value {
        Some(value) if value.abs() < 0.005 => "0".to_owned(),
        Some(value) => format!("{value:+.2}"),
        None => "-".to_owned(),
    };
    let ratio = match &line.ratio {
        Some((ratio, _)) if (ratio - 1.0).abs() < 5e-4 => "1".to_owned(),
        Some((ratio, _)) if *ratio >= 100.0 || *ratio < 0.01 => format!("{ratio:.0e}"),
        Some((ratio, _)) => format!("{ratio:.3}"),
        None => "-".to_owned(),
    };
    format!(
        "| {} | {} | {} | {} | {ratio} | {marks} |",
        line.defect.name,
        line.defect.term.name(),
        line.effect.name(),
        number(line.shift.as_ref().map(|(shift, _)| *shift)),
    )
}

/// Which gates catch what, by the rows of a document: the names with a mark.
pub fn marks(text: &str) -> BTreeMap<String, Vec<&'static str>> {
    let columns = 5 + Gate::ALL.len();
    text.lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.strip_prefix('|')?.strip_suffix('|')?.split('|').collect();
            if cells.len() != columns || cells[0].trim() == "defect" || cells[0].contains("---") {
                return None;
            }
            let caught = Gate::ALL.iter().zip(&cells[5..]);
            let caught =
                caught.filter(|(_, cell)| cell.trim() == MARK).map(|(gate, _)| gate.name());
            Some((cells[0].trim().to_owned(), caught.collect()))
        })
        .collect()
}

const HEAD: &str = "# Sabotage: which gate catches which defect

For readers who ask what each check is worth. Written by `make sabotage`; `make ci` fails if a gate catches something else than this table says. A defect is a wrong
component passed in at a seam of the library (model, scheme, truth, record, judge, answers, report), by `tests/sabotage/catalogue`; the
sound program has no switch for it, and passes every gate. Each runs on small grids of the
scenes in `tests/sabotage/suite.rs`, chosen so that every term acts. *Unresolved* counts as caught where the sound
program passes, but not where the sound program is unresolved too.

Two of the scenes are shipped ones with other numbers: where λ and μ_L are equal, *Lamé numbers exchanged* would pass (in the
main job `layered`, `prony` and `bulk-shear` tell them apart); and few reach beyond the last point of the law, or have a
shift whose loss moves an order.

`make sabotage` also runs `sweep diagnose` on each defect of the solver that spoils a verdict, on the first scene where it
does, and fails if fewer than four of five have their term named.

A defect *touches* an order if a fitted order moves by more than 0.1 somewhere; else a constant if an error changes by more
than 1e-6 of itself; else the cost. *Order* is the largest shift of a fitted order, *constant* the ratio of constants
under the predicted order that is farthest from one, over all verdicts.

- **orders**: a verdict is not as expected. **constants**: a fitted constant is not the one predicted from the exact side.
- **complete**: a case failed, is missing, or is no number. **KKT**: the separate evaluation after each step refuses.
- **audit**: an inequality of the proofs (`sweep audit`) fails. **history**: the history and ζ shown are not the direct sums of
  the displacements shown. **Gronwall**: e_n above the weighted envelope. **bound**: ‖DΛ‖ above the sharpened bound.
  **check**: weak and strong loads differ (`sweep check`). **norms**: a norm of the record is not that of a second integral, or
  errors against a finer run and against the truth differ by more than the error of the run.
- **tables**: a table of errors with a verdict that is known beforehand is misjudged (tests/sabotage/tables.rs).
- **owed**: a verdict or a compared constant that the sound run has is not there, or another one is.
- **answers**: an answer of another solver has other errors than the run it is of, or one that is wrong in a single place the same.
  **report**: a table or figure, read back from its file, does not show the records.
- **fixtures**: values of an independent implementation (tests/fixtures). **baseline**: errors of the sound run, to 1e-6,
  and its work.

## Scores

";

const MATRIX: &str = "
*Alone*: defects that no other gate catches.

## Matrix

";
