//! Tables as people paste them.
//! Source: `tests/pasted`; the numbers are those of programs and pages, and what a person reads in them stands beside each.
//! Goal: what is read, and what is left out, is said word for word; the finest level of each table has the size and the error that a person
//! reads; what has two readings is refused, with the line and what to do.

use std::path::Path;

use gronwall_judge::table::{Group, Reading, read};
use serde::Deserialize;

#[derive(Deserialize)]
struct Document {
    table: Vec<Table>,
}

#[derive(Deserialize)]
struct Table {
    name: String,
    /// Where a table of the public stands.
    #[allow(dead_code)]
    source: Option<String>,
    text: String,
    dimension: Option<u32>,
    ratio: Option<f64>,
    #[serde(default)]
    by: Vec<String>,
    #[serde(default)]
    runs: bool,
    #[serde(default)]
    errors: Vec<String>,
    read: Option<String>,
    refused: Option<String>,
    /// Size and error of the finest level, a pair for each group.
    finest: Option<Vec<[f64; 2]>>,
}

/// The last row with its size, h or k.
fn finest(group: &Group) -> [f64; 2] {
    let size = |row: &gronwall_judge::table::Row| {
        if row.point.h.is_nan() { row.point.k } else { row.point.h }
    };
    let least = group.rows.iter().min_by(|a, b| size(a).total_cmp(&size(b))).expect("a row");
    [size(least), least.point.error]
}

#[test]
fn tables_are_read_as_a_person_reads_them() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/pasted");
    let mut wrong = Vec::new();
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the tables") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a document");
        let document: Document =
            toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        for table in document.table {
            count += 1;
            let reading = Reading {
                dimension: table.dimension,
                ratio: table.ratio,
                in_time: false,
                by: table.by,
                runs: table.runs,
                errors: table.errors,
            };
            let found = read(table.text.as_bytes(), &reading);
            let said = match &found {
                Ok(tables) => tables.said.join("\n"),
                Err(error) => format!("refused {error}"),
            };
            let sound = match (&table.read, &table.refused) {
                (Some(read), None) => said == *read,
                (None, Some(words)) => said.starts_with(&format!("refused {words}")),
                _ => panic!("{}: read or refused", table.name),
            };
            if !sound {
                let wanted = table.read.or(table.refused).unwrap_or_default();
                wrong.push(format!("{}:\n    {said}\n    {wanted}", table.name));
            }
            if let (Ok(tables), Some(wanted)) = (&found, &table.finest) {
                let groups: Vec<[f64; 2]> = tables.groups.iter().map(finest).collect();
                // Sizes follow from counts by a power: a rounding or two.
                let near = |a: f64, b: f64| (a - b).abs() <= 4.0 * f64::EPSILON * b.abs();
                let same = groups.len() == wanted.len()
                    && groups.iter().zip(wanted).all(|(a, b)| near(a[0], b[0]) && near(a[1], b[1]));
                if !same {
                    wrong.push(format!("{}: {groups:?}, not {wanted:?}", table.name));
                }
            }
        }
    }
    assert!(count >= 28, "{count} tables");
    assert!(wrong.is_empty(), "{} of {count} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
