//! Published tables and the verdict that an expert gives.
//! Source: `tests/corpus`, one file a document, each with its source; the numbers are those of the document.
//! Goal: every table is read as printed; no verdict contradicts the expert's; of the claims that the expert decides at
//! most 15 % stay open.

use std::path::Path;

use gronwall_judge::fit::{Claim, Direction, Known, LineReading};
use gronwall_judge::table::{Group, Reading, read};
use gronwall_judge::verdict::Decision;
use serde::Deserialize;

#[derive(Deserialize)]
struct Document {
    title: String,
    project: String,
    source: String,
    table: Vec<Table>,
}

#[derive(Deserialize)]
struct Table {
    section: Option<String>,
    dimension: Option<u32>,
    text: String,
    claim: Vec<Claimed>,
}

#[derive(Deserialize)]
struct Claimed {
    norm: String,
    order: f64,
    #[serde(default)]
    at_least: bool,
    #[serde(default)]
    exact: bool,
    expert: Expert,
    why: String,
    /// A known defect of the judge.
    finding: Option<String>,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "lowercase")]
enum Expert {
    Pass,
    Fail,
    Unresolved,
}

fn documents() -> Vec<Document> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/corpus");
    let entries = std::fs::read_dir(folder).expect("the corpus");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        let text = std::fs::read_to_string(path).expect("a document");
        toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    paths.iter().map(read).collect()
}

/// As `sweep fit`: a broken row is a failure; fewer than three levels say nothing.
fn decided(group: &Group, claimed: &Claimed) -> (Decision, String) {
    if let Some(gaps) = group.gaps_in_words() {
        return (Decision::Fail, gaps);
    }
    let direction = if group.refined(Direction::Time) { Direction::Time } else { Direction::Space };
    let claim = Claim {
        at_least: claimed.at_least,
        exact: claimed.exact,
        ..Claim::new(claimed.order).expect("a finite order")
    };
    match LineReading::of(&group.line(direction), direction, &Known::default()) {
        Ok(LineReading { posterior, .. }) => {
            let ruling = posterior.decide(&claim);
            (ruling.decision, format!("{} in {}", ruling.reason, posterior.interval))
        }
        Err(error) => (Decision::Unresolved, error.to_string()),
    }
}

#[test]
fn no_verdict_contradicts_the_expert_and_few_stay_open() {
    let (mut wrong, mut open, mut sure, mut columns) = (Vec::new(), Vec::new(), 0, 0);
    let (mut findings, mut known) = (0, 0);
    for document in documents() {
        assert!(document.source.len() > 20, "{}: no source", document.title);
        for table in &document.table {
            let section = table.section.as_deref().unwrap_or("-");
            let name = format!("{}, {section}", document.title);
            let reading = Reading { dimension: table.dimension, ..Reading::default() };
            let tables = read(table.text.as_bytes(), &reading)
                .unwrap_or_else(|error| panic!("{name}: {error}\n{}", table.text));
            let mut norms: Vec<&str> =
                table.claim.iter().map(|claim| claim.norm.as_str()).collect();
            norms.dedup();
            columns += norms.len();
            for claimed in &table.claim {
                let measures_norm =
                    |group: &&Group| group.norm.as_deref().unwrap_or("error") == claimed.norm;
                let found = tables.groups.iter().find(measures_norm);
                let group = found.unwrap_or_else(|| panic!("{name}: no column {}", claimed.norm));
                let (decision, reason) = decided(group, claimed);
                let line = format!(
                    "{name}, {} against {}: {} ({reason}); the expert: {:?}, {}",
                    claimed.norm,
                    claimed.order,
                    decision.name(),
                    claimed.expert,
                    claimed.why
                );
                sure += usize::from(claimed.expert != Expert::Unresolved);
                match (claimed.expert, decision) {
                    (Expert::Pass, Decision::Pass)
                    | (Expert::Fail, Decision::Fail)
                    | (Expert::Unresolved, Decision::Unresolved) => {}
                    (_, Decision::Unresolved) => open.push(line),
                    // A known defect that no longer occurs has to be removed from the list.
                    _ if claimed.finding.is_some() => findings += 1,
                    _ => wrong.push(line),
                }
                known += usize::from(claimed.finding.is_some());
            }
        }
    }
    println!("{columns} columns, {sure} claims decided by the expert, {} open", open.len());
    println!("{}", open.join("\n"));
    assert_eq!(findings, known, "a finding that the judge has right: take it out of the corpus");
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    assert!(open.len() * 100 <= 15 * sure, "{} of {sure} open", open.len());
}

#[test]
fn the_corpus_is_as_broad_as_it_says() {
    let documents = documents();
    let mut projects: Vec<&str> =
        documents.iter().map(|document| document.project.as_str()).collect();
    projects.sort_unstable();
    projects.dedup();
    let tables: usize = documents.iter().map(|document| document.table.len()).sum();
    assert!(documents.len() >= 12, "{} documents", documents.len());
    assert!(tables >= 60, "{tables} tables");
    assert!(projects.len() >= 8, "{projects:?}");
    for table in documents.iter().flat_map(|document| &document.table) {
        assert!(!table.claim.is_empty() && table.claim.iter().all(|claim| !claim.why.is_empty()));
    }
}
