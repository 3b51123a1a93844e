//! The document of a study: text of its command, a file beside its numbers, and a section of a report.

use std::fs;
use std::path::Path;

use crate::ReportError;
use crate::document::{Block, Figure, Run, Table, Tone, terminal};
use files::{FileError, counted, digits, read_text, replace_file};
use judge::claim::{Claim, Relation, Standing};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

/// The chapter of a study; they stand in this order in a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Chapter {
    /// The step-size bound (3.4).
    Bound,
    /// Gronwall's inequality (3.24).
    Gronwall,
    /// The proofs of Theorems 10 and 11.
    Audit,
    /// Estimated and bounded errors beside true ones.
    Estimators,
    Trade,
    /// Which term is at fault.
    Diagnose,
    /// Ladders of extreme parameters.
    Extremes,
}

// The last one tells how many there are: a chapter that is not in the list does not compile.
const _: () = assert!(Chapter::ALL.len() == Chapter::Extremes as usize + 1);

impl Chapter {
    pub(crate) const ALL: [Self; 7] = [
        Self::Bound,
        Self::Gronwall,
        Self::Audit,
        Self::Estimators,
        Self::Trade,
        Self::Diagnose,
        Self::Extremes,
    ];

    /// Its name in files and links.
    pub(crate) fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }

    /// Its command, and what may fail in it.
    fn about(self) -> [&'static str; 2] {
        match self {
            Self::Bound => ["bound SCENE", "(3.4)"],
            Self::Gronwall => ["gronwall SCENE", "Gronwall's inequality"],
            Self::Audit => ["audit SCENE", "the inequalities of the proof"],
            Self::Estimators => {
                ["estimators SCENE", "reliability and efficiency of the estimators"]
            }
            Self::Trade => ["trade SCENE", "trade"],
            Self::Diagnose => ["diagnose SCENE", "which term is at fault"],
            Self::Extremes => ["extremes", "extremes"],
        }
    }

    pub(crate) fn command(self) -> &'static str {
        self.about()[0]
    }

    /// What may fail in it, for a sentence.
    pub(crate) fn subject(self) -> &'static str {
        self.about()[1]
    }

    /// The chapter of a file, by its name.
    fn of_file(name: &str) -> Option<Self> {
        let stem = name.strip_suffix(ENDING)?;
        serde_json::from_value(stem.rsplit('-').next()?.into()).ok()
    }
}

/// Longer tables count as evidence; the study's files have the numbers.
const MOST_ROWS: usize = 40;

/// Ending of document files.
const ENDING: &str = ".document.json";

/// What a study says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyDocument {
    pub chapter: Chapter,
    /// None if it concerns no single scene.
    pub scene: Option<String>,
    /// Fingerprint of the scene's text.
    pub fingerprint: Option<String>,
    pub title: String,
    /// Whether everything is as it should be.
    pub holds: bool,
    /// The k at which Λ stops contracting, for the table of all scenes.
    pub threshold: Option<String>,
    pub(crate) blocks: Vec<Block>,
}

impl StudyDocument {
    /// A study that has said nothing yet.
    pub fn new(chapter: Chapter, title: impl Into<String>) -> Self {
        Self {
            chapter,
            scene: None,
            fingerprint: None,
            title: title.into(),
            holds: true,
            threshold: None,
            blocks: Vec::new(),
        }
    }

    /// For a scene whose text has this fingerprint.
    pub fn of_scene(self, scene: &str, fingerprint: &str) -> Self {
        Self { scene: Some(scene.into()), fingerprint: Some(fingerprint.into()), ..self }
    }

    /// Prefix of file names: SCENE-bound, or extremes.
    pub fn stem(&self) -> String {
        let chapter = self.chapter.name();
        match &self.scene {
            Some(scene) => format!("{scene}-{chapter}"),
            None => chapter,
        }
    }

    /// A paragraph.
    pub fn words(&mut self, text: impl Into<String>) {
        self.blocks.push(Block::Text(vec![Run::plain(text)]));
    }

    /// The first paragraph: the answer to the question.
    pub fn answer(&mut self, text: impl Into<String>) {
        self.blocks.insert(0, Block::Text(vec![Run::plain(text)]));
    }

    /// A table of rows of JSON, see [`json_table`].
    pub fn rows(&mut self, caption: impl Into<String>, rows: &Value, columns: &str) {
        self.push(Table::of_json(caption, rows, columns));
    }

    fn push(&mut self, table: Table) {
        if !table.rows.is_empty() {
            let evidence = table.rows.len() > MOST_ROWS;
            self.blocks.push(Block::Table(Table { evidence, ..table }));
        }
    }

    /// A picture, if any; `rest` is its file name without `SCENE-` and ending.
    pub fn figure(&mut self, rest: &str, caption: &str, svg: Option<String>) {
        let Some(svg) = svg else { return };
        let scene = self.scene.as_ref();
        let file = scene.map_or(format!("{rest}.svg"), |scene| format!("{scene}-{rest}.svg"));
        let caption = scene.map_or(caption.into(), |scene| format!("{scene}: {caption}"));
        self.blocks.push(Block::Figure(Figure::new(file, caption, svg)));
    }

    /// Lines to be typed.
    pub fn code(&mut self, lines: String) {
        self.blocks.push(Block::Code(lines));
    }

    /// The verdict: `all` if it holds, else each failure.
    pub fn verdict(&mut self, holds: bool, all: &str, failures: Vec<String>) {
        self.holds &= holds;
        if holds {
            return self.blocks.push(Block::Text(vec![Run::of(all, Tone::Pass)]));
        }
        let silent = vec!["nothing was compared".to_owned()];
        for failure in if failures.is_empty() { silent } else { failures } {
            let head = Run::of("Does not hold: ", Tone::Miss);
            self.blocks.push(Block::Text(vec![head, Run::plain(failure)]));
        }
    }

    /// Default width.
    pub const WIDTH: u16 = 132;

    /// The study on a terminal of so many columns.
    pub fn text(&self, width: u16) -> String {
        terminal::text(&self.title, &self.blocks, width)
    }

    /// Writes the document and its pictures into a directory.
    pub fn write(&self, dir: &Path) -> Result<(), ReportError> {
        let put = |name: String, text: &str| replace_file(&dir.join(name), text.as_bytes());
        for block in &self.blocks {
            if let Block::Figure(figure) = block {
                put(figure.file.clone(), &figure.svg)?;
            }
        }
        let text = serde_json::json!(self);
        Ok(put(format!("{}{ENDING}", self.stem()), &format!("{text:#}\n"))?)
    }

    /// The studies in a directory, in the order of file names.
    ///
    /// # Errors
    /// A file that cannot be read, or is not the document of a study.
    pub(crate) fn read_all(dir: &Path) -> Result<Vec<Self>, ReportError> {
        let names = names(dir)?;
        let mut found = Vec::new();
        for name in &names {
            let Some(chapter) = Chapter::of_file(name) else { continue };
            let path = dir.join(name);
            let text = read_text(&path)?;
            let refused = |line: usize, reason: String| ReportError::Study {
                path: path.clone(),
                line,
                reason,
                command: chapter.command().into(),
            };
            let mut study: Self = serde_json::from_str(&text).map_err(|error| {
                // Without " at line … column …", which precedes it.
                let said = error.to_string();
                let what = said.rsplit_once(" at line ").map_or(&*said, |(what, _)| what);
                refused(error.line(), what.to_owned())
            })?;
            // Every row has the columns of the head.
            let torn = |block: &Block| match block {
                Block::Table(Table { head, numeric, rows, .. }) => {
                    numeric.len() != head.len() || rows.iter().any(|row| row.len() != head.len())
                }
                _ => false,
            };
            if study.chapter != chapter || study.blocks.iter().any(torn) {
                let reason = "not what its name says, or a table with rows of several lengths";
                return Err(refused(1, reason.into()));
            }
            // A picture that is missing, or none, is not shown; only names within the directory are followed.
            study.blocks.retain_mut(|block| {
                let Block::Figure(Figure { file, svg, .. }) = block else { return true };
                *svg = read_text(&dir.join(&*file)).unwrap_or_default();
                let name = Path::new(&*file).file_name();
                name.is_some_and(|name| name == &**file) && svg.trim_start().starts_with("<svg")
            });
            found.push(study);
        }
        Ok(found)
    }
}

/// Rows of JSON as a table of characters. A column is its head, the place of its value in a row, and its digits if they are
/// not five, MB for a number of bytes, or formula: `head = a/b 3; …`.
pub fn json_table(rows: &Value, columns: &str, width: u16) -> String {
    terminal::table(&Table::of_json("", rows, columns), width)
}

impl Table {
    fn of_json(caption: impl Into<String>, rows: &Value, columns: &str) -> Self {
        let column = |column: &'_ str| -> (String, String, String) {
            let (head, place) = column.split_once(" = ").unwrap_or((column, ""));
            let (place, form) = place.trim().split_once(' ').unwrap_or((place.trim(), ""));
            (head.trim().into(), format!("/{place}"), form.into())
        };
        let columns: Vec<_> = columns.split(';').map(column).collect();
        let heads: Vec<&str> = columns.iter().map(|(head, ..)| &**head).collect();
        let cell = |value: Option<&Value>, form: &str| match value {
            Some(Value::String(name)) if form == "formula" => Run::formula(name),
            Some(value @ (Value::String(_) | Value::Bool(_))) => Run::plain(text(value)),
            Some(value) if value.is_u64() && form != "MB" => Run::plain(text(value)),
            value => match (value.and_then(Value::as_f64), form) {
                (Some(bytes), "MB") => Run::plain(format!("{:.0} MB", bytes / 1e6)),
                (value, digits) => precise(value, digits.parse().unwrap_or(5)),
            },
        };
        let row = |row: &Value| -> Vec<Run> {
            columns.iter().map(|(_, place, form)| cell(row.pointer(place), form)).collect()
        };
        let rows = rows.as_array().into_iter().flatten().map(row).collect();
        Self::new(caption, &heads, rows)
    }
}

// Pictures of single cases that `sweep solve --pictures` left in the directory of a report.

/// Endings of file names, and what the files show.
const ENDINGS: [(&str, &str); 2] = [
    ("-contact.svg", "contact state of Γ3 over time, exact and discrete"),
    ("-body.svg", "deformed body at the last time level"),
];

/// The names of the files in a directory, sorted.
fn names(dir: &Path) -> Result<Vec<String>, ReportError> {
    let mut names: Vec<String> = Vec::new();
    for entry in fs::read_dir(dir).map_err(FileError::at(dir))? {
        let name = entry.map_err(FileError::at(dir))?.file_name();
        names.extend(name.into_string().ok());
    }
    names.sort();
    Ok(names)
}

/// The pictures in a directory, by kind, then by file name.
pub(crate) fn of_cases(dir: &Path) -> Result<Vec<Figure>, ReportError> {
    let names = names(dir)?;
    let mut found = Vec::new();
    for (ending, shows) in ENDINGS {
        for name in &names {
            let Some(case) = name.strip_suffix(ending) else { continue };
            let svg = read_text(&dir.join(name))?;
            // Foreign files with such a name are ignored.
            if svg.trim_start().starts_with("<svg") {
                let case = if case.is_empty() { String::new() } else { format!("{case}: ") };
                let caption = format!("{case}{shows} (sweep solve --pictures).");
                found.push(Figure::new(name, caption, svg));
            }
        }
    }
    Ok(found)
}

// What a study found, in the same form for all: claims, its own numbers, and what it says in words and pictures.

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
        let (caption, rows): (_, Vec<_>) = if statements.len() == 1 {
            let caption = "The claims: both sides, what rounding allows, and left/right.";
            (caption, claims.iter().map(|claim| (claim, 1)).collect())
        } else {
            let mut rows: Vec<_> = statements.into_iter().collect();
            rows.sort_by(|(a, _), (b, _)| b.is_worse_than(a).cmp(&a.is_worse_than(b)));
            let caption = "The claims, the tightest first: each where it is tightest of so many places, both sides there, what rounding allows, \
                           and the tightness, left/right.";
            (caption, rows)
        };
        let rows = rows.into_iter().map(|(claim, count)| row(claim, count)).collect();
        self.push(Table::new(caption, &HEADS, rows));
    }
}

const HEADS: [&str; 9] =
    ["claim", "says", "at", ">left", "", ">right", ">accuracy", ">tightness", ""];

fn row(claim: &Claim, count: usize) -> Vec<Run> {
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
    let accuracy = match claim.accuracy {
        0.0 => "–".to_owned(),
        accuracy => format!("{accuracy:.1e}"),
    };
    vec![
        Run::plain(claim.statement.source),
        // The signs of sums and integrals; the rest is letters.
        Run::formula(&claim.statement.says.replace("sum_j", "Σ_j").replace("Au", "A u")),
        Run::plain(place),
        number(finite(claim.left)),
        relation,
        right,
        Run::plain(accuracy),
        precise(claim.tightness().and_then(finite), 3),
        is,
    ]
}

// Numbers in sentences and cells.

/// A cell with a number of five digits.
pub fn number(value: impl Into<Option<f64>>) -> Run {
    precise(value, 5)
}

/// A cell with a number of at most so many digits.
pub fn precise(value: impl Into<Option<f64>>, significant: usize) -> Run {
    Run::plain(value.into().map_or_else(|| "–".to_owned(), |value| digits(value, significant)))
}

/// A cell of JSON; that of nothing is empty.
pub(super) fn text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => String::new(),
        Value::Bool(true) => "yes".into(),
        Value::Bool(false) => "no".into(),
        number => number.to_string(),
    }
}
