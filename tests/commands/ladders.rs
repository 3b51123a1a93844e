//! Source: the catalogue of `sweep extremes`.
//! Goal: docs/LADDERS.md lists the ladders as the program climbs them, and docs/EXTREMES.md counts them right.
//! Data: the catalogue, the long ladders with it. `LADDERS_WRITE=1 cargo test --release --test commands ladders` writes the
//!   page anew.

use crate::program::{repository, unwrapped};
use std::path::Path;

use judge::claim::Relation;
use studies::extremes::{Ladder, catalogue};

fn page(ladders: &[Ladder]) -> String {
    let mut page = String::from(
        "# Ladders\n\nFor readers of a row of `sweep extremes`: what each ladder turns, from where to where, what it measures, and why that is expected.\nThe tests write and compare this page.\n\n| ladder | parameter | from | to | rungs | refused | measured | expected because |\n|---|---|---|---|---:|---:|---|---|\n",
    );
    for ladder in ladders {
        let ends = [ladder.rungs.first(), ladder.rungs.last()];
        let [from, to] = ends.map(|rung| rung.map_or("–", |rung| rung.at.as_str()).to_owned());
        let (rungs, refused) = (ladder.rungs.len().to_string(), refusals(ladder).to_string());
        let Ladder { name, parameter, quantity, why, .. } = ladder;
        let cells = [*name, *parameter, &from, &to, &rungs, &refused, *quantity, *why];
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        page += &format!("| {} |\n", cells.join(" | "));
    }
    page
}

fn refusals(ladder: &Ladder) -> usize {
    ladder.rungs.iter().filter(|rung| matches!(rung.expected, Relation::Refused(_))).count()
}

/// What the page of extremes has to say of these ladders.
fn counts(ladders: &[Ladder]) -> String {
    let rungs: usize = ladders.iter().map(|ladder| ladder.rungs.len()).sum();
    let refused: usize = ladders.iter().map(refusals).sum();
    format!("{rungs} rungs of {} ladders, {refused} of them refusals", ladders.len())
}

#[test]
fn the_page_of_ladders_is_the_catalogue() {
    let ladders = catalogue(true);
    let written = page(&ladders);
    if std::env::var_os("LADDERS_WRITE").is_some() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/LADDERS.md");
        std::fs::write(path, &written).expect("a written page");
    }
    assert!(
        repository("docs/LADDERS.md") == written,
        "docs/LADDERS.md is stale: LADDERS_WRITE=1 writes it anew"
    );
    assert!(page(&ladders[1..]) != written, "a ladder that is gone is seen");
}

#[test]
fn the_page_of_extremes_counts_the_ladders() {
    let (ladders, said) = (catalogue(true), repository("docs/EXTREMES.md"));
    let said = unwrapped(&said);
    assert!(
        said.contains(&counts(&ladders)),
        "docs/EXTREMES.md does not say: {}",
        counts(&ladders)
    );
    assert!(!said.contains(&counts(&ladders[1..])));
}
