//! What a study found, in the same form for all: claims, its own numbers, and what it says in words and pictures.

use std::path::Path;

use serde_json::{Map, Value, json};

use super::number::{number, precise, text};
use super::study::{Chapter, Row, StudyDocument};
use super::{Run, Tone};
use crate::ReportError;
use files::{counted, replace_file};
use judge::claim::{Claim, Relation, Standing};

/// A study that has run.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    pub claims: Vec<Claim>,
    /// Keys of its JSON beside those of every study: scene, fingerprint, holds, claims.
    pub numbers: Map<String, Value>,
    /// Rows of further tables: the end of the file's name, and the keys in order.
    pub tables: Vec<(&'static str, &'static str, Value)>,
    pub document: StudyDocument,
}

impl Findings {
    /// The findings of a scene, by its name and fingerprint, or of none: the document begins with what the claims say.
    pub fn new(
        (chapter, title): (Chapter, String),
        scene: Option<[&str; 2]>,
        claims: Vec<Claim>,
    ) -> Self {
        let mut document = StudyDocument::new(chapter, title);
        if let Some([name, fingerprint]) = scene {
            document = document.of_scene(name, fingerprint);
        }
        document.claims(&claims);
        Self { claims, numbers: Map::new(), tables: Vec::new(), document }
    }

    /// A key of its JSON. What cannot be written is null.
    pub fn number(&mut self, key: &str, value: impl serde::Serialize) {
        self.numbers.insert(key.into(), json!(value));
    }

    /// The keys of an object.
    pub fn numbers(&mut self, object: Value) {
        if let Value::Object(keys) = object {
            self.numbers.extend(keys);
        }
    }

    /// Rows under a key of its JSON and as a table, see [`StudyDocument::rows`].
    pub fn table(
        &mut self,
        key: &str,
        rows: impl serde::Serialize,
        caption: impl Into<String>,
        columns: &str,
    ) {
        let rows = json!(rows);
        self.document.rows(caption, &rows, columns);
        self.number(key, rows);
    }

    /// Whether every claim holds, and there is one.
    pub fn holds(&self) -> bool {
        self.document.holds
    }

    pub fn json(&self) -> Value {
        let mut all = json!({ "holds": self.holds(), "claims": self.claims });
        // Ladders have a name and no text.
        if let Some(fingerprint) = &self.document.fingerprint {
            (all["scene"], all["fingerprint"]) = (json!(self.document.scene), json!(fingerprint));
        }
        for (key, value) in &self.numbers {
            all[key] = value.clone();
        }
        all
    }

    /// Writes STEM.json, STEM-claims.csv, further tables, the document and its pictures into a directory.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, dir: &Path) -> Result<(), ReportError> {
        let stem = self.document.stem();
        let put = |name: String, bytes: &[u8]| replace_file(&dir.join(name), bytes);
        put(format!("{stem}.json"), format!("{:#}\n", self.json()).as_bytes())?;
        put(format!("{stem}-claims.csv"), &Claim::csv(&self.claims)?)?;
        for (end, keys, rows) in &self.tables {
            put(format!("{stem}{end}"), &csv(keys, rows)?)?;
        }
        self.document.write(dir)
    }
}

/// Rows of JSON as CSV, below these of their keys.
fn csv(keys: &str, rows: &Value) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(keys.split(','))?;
    for row in rows.as_array().into_iter().flatten() {
        writer.write_record(keys.split(',').map(|key| text(&row[key])))?;
    }
    writer.into_inner().map_err(|error| error.into_error().into())
}

impl StudyDocument {
    /// What claims say: whether all hold, else what does not, and a table of each statement where it is tightest, or of every
    /// claim if they have one statement.
    fn claims(&mut self, claims: &[Claim]) {
        let failures = claims.iter().filter_map(Claim::reason).collect();
        let statements = Claim::worst(claims);
        let all = format!("{}, and every one holds.", counted(claims.len(), "claim"));
        self.verdict(Claim::all_hold(claims), &all, failures);
        if statements.len() == 1 {
            let rows = claims.iter().map(|claim| row(claim, 1));
            self.table("The claims: both sides, what rounding allows, and left/right.", rows);
        } else {
            let mut rows: Vec<_> = statements.into_iter().collect();
            rows.sort_by(|(a, _), (b, _)| match a.is_worse_than(b) {
                true => std::cmp::Ordering::Less,
                false if b.is_worse_than(a) => std::cmp::Ordering::Greater,
                false => std::cmp::Ordering::Equal,
            });
            let rows = rows.into_iter().map(|(claim, count)| row(claim, count));
            self.table(
                "The claims, the tightest first: each where it is tightest of so many places, both sides there, what rounding allows, \
                 and the tightness, left/right.",
                rows,
            );
        }
    }
}

fn row(claim: &Claim, count: usize) -> Row<'_, 9> {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let [relation, right] = match claim.relation {
        Relation::AtMost(right) => [Run::plain("≤"), number(finite(right))],
        Relation::Within([low, high]) => {
            [Run::plain("in"), Run::plain(format!("[{low:.3}, {high:.3}]"))]
        }
        Relation::Order(order, _) => [Run::plain("for"), number(finite(order))],
        Relation::Refused(_) => [Run::plain("refused"), Run::plain("–")],
    };
    let is = match claim.standing() {
        Standing::Passes => Run::of("holds", Tone::Pass),
        Standing::Unresolved => Run::of("unresolved", Tone::Miss),
        Standing::Fails => Run::of("does not hold", Tone::Miss),
    };
    let place = match count {
        1 => claim.place.to_string(),
        _ => format!("{}, of {count}", claim.place),
    };
    [
        ("claim", Run::plain(claim.statement.source)),
        ("says", Run::formula(&signs(claim.statement.says))),
        ("at", Run::plain(place)),
        (">left", number(finite(claim.left))),
        ("", relation),
        (">right", right),
        (
            ">accuracy",
            Run::plain(if claim.accuracy == 0.0 {
                "–".into()
            } else {
                format!("{:.1e}", claim.accuracy)
            }),
        ),
        (">tightness", precise(claim.tightness().and_then(finite), 3)),
        ("", is),
    ]
}

/// The signs of sums and integrals; the rest is letters.
fn signs(says: &str) -> String {
    [("sum_j", "Σ_j"), ("Au", "A u")]
        .iter()
        .fold(says.to_owned(), |text, (from, to)| text.replace(from, to))
}
