//! Rows as CSV, JSON and a map.

use super::judge::{RungRow, Standing};
use super::rung::{Expected, Ladder};
use crate::table;
use report::{Cell, Map, Shade};

/// The table of `extremes.csv`.
///
/// # Errors
/// The writer's.
pub fn csv(rows: &[RungRow]) -> Result<Vec<u8>, csv::Error> {
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:e}"));
    let digits = |value: Option<f64>, digits: usize| {
        value.map_or_else(String::new, |value| format!("{value:.digits$}"))
    };
    let row = |row: &RungRow| {
        [
            ("ladder", row.ladder.to_owned()),
            ("at", row.at.clone()),
            ("quantity", row.quantity.to_owned()),
            ("expected", row.expected.clone()),
            ("measured", number(row.measured)),
            ("digits_lost", digits(row.digits_lost, 1)),
            ("iterations", digits(row.iterations, 2)),
            ("kkt", number(row.kkt)),
            ("standing", row.standing.words().to_owned()),
            ("note", row.note.clone()),
            ("seconds", digits(Some(row.seconds), 3)),
        ]
    };
    table::csv(rows.iter().map(row))
}

/// The map of all rows: one line a ladder, one cell a rung, shaded by how far the measured number is within
/// what is allowed: the lightest at six decades or more, the darkest at the bound.
pub(super) fn map(ladders: &[Ladder], rows: &[RungRow]) -> String {
    let of_ladder = |ladder: &Ladder| -> Vec<Cell> {
        let rows = rows.iter().filter(|row| row.ladder == ladder.name);
        rows.map(|row| {
            let rung = ladder.rungs.iter().find(|rung| rung.at == row.at);
            (row.at.clone(), shade(row, rung.map(|rung| rung.expected)))
        })
        .collect()
    };
    let wrong = rows.iter().filter(|row| !row.standing.as_expected()).count();
    let refused = rows.iter().filter(|row| row.standing == Standing::RefusedAsExpected).count();
    Map {
        title: format!("{} rungs of {} ladders", rows.len(), ladders.len()),
        subtitle: format!("{refused} refused as expected, {wrong} not as expected"),
        rows: ladders.iter().map(|ladder| (ladder.name.to_owned(), of_ladder(ladder))).collect(),
        legend: [
            (Shade::Within(0.3), "as expected, darker nearer the bound"),
            (Shade::Outside, "refused as expected"),
            (Shade::Wrong, "not as expected"),
        ],
        heads: Vec::new(),
        notes: Vec::new(),
    }
    .svg()
}

/// Decades over which the shade goes from the darkest to the lightest.
const DECADES: f64 = 6.0;

fn shade(row: &RungRow, expected: Option<Expected>) -> Shade {
    match (row.standing, expected, row.measured) {
        (Standing::RefusedAsExpected, ..) => Shade::Outside,
        (Standing::AsExpected, Some(Expected::AtMost(most)), Some(value)) => {
            let decades = (most.max(f64::MIN_POSITIVE) / value.max(f64::MIN_POSITIVE)).log10();
            Shade::Within(1.0 - decades / DECADES)
        }
        (Standing::AsExpected, ..) => Shade::Within(0.5),
        _ => Shade::Wrong,
    }
}
