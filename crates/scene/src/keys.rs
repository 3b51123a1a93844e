//! The keys of scene files: `keys.toml` says each of them once, for the check of unknown ones, for the examples in messages
//! and for the tables of docs/SCENE-FILES.md.
//!
//! Values are read key by key, not into types by serde: a table whose keys depend on its kind would be an enumeration tagged
//! by `kind`, and serde buffers what follows a tag, so that the places of values in the file are lost.

use std::sync::LazyLock;

use serde::Deserialize;

/// What a scene is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum SceneKind {
    /// Problem 12: a body in contact.
    Contact,
    /// Problem 1 in ℝ^m.
    Abstract,
}

static PARTS: LazyLock<Vec<Part>> = LazyLock::new(|| {
    #[derive(Deserialize)]
    struct File {
        part: Vec<Part>,
    }
    let file: File = toml::from_str(include_str!("keys.toml")).expect("the keys are TOML");
    file.part
});

/// A table of a scene file, wherever it may stand.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Dotted names; `.*` is each entry of a list.
    pub(super) tables: Vec<String>,
    /// The kind of scene that has it; both if none is said.
    scenes: Option<SceneKind>,
    /// Keys that abstract scenes lack.
    #[serde(default)]
    contact_only: String,
    /// What to add where the part is missing.
    holds: Option<String>,
    rows: Vec<Row>,
}

/// Keys of one meaning.
#[derive(Debug, Deserialize)]
#[serde(from = "Vec<String>")]
struct Row {
    keys: String,
    /// Type, default, meaning.
    means: [String; 3],
    /// Lines of an example; an arrow for that of the row above.
    example: Vec<String>,
}

impl From<Vec<String>> for Row {
    fn from(cells: Vec<String>) -> Self {
        let mut cells = cells.into_iter();
        let mut next = || cells.next().unwrap_or_default();
        let (keys, means) = (next(), [next(), next(), next()]);
        Self { keys, means, example: cells.collect() }
    }
}

impl Part {
    /// All of them, in the order of the page.
    pub fn every() -> &'static [Part] {
        &PARTS
    }

    /// As in a file: `[time.grid]`, `[[predicts]]`.
    pub fn heading(&self) -> String {
        match self.tables[0].strip_suffix(".*") {
            Some(list) => format!("[[{list}]]"),
            None => format!("[{}]", self.tables[0]),
        }
    }

    /// Rows of a Markdown table: key, type, default, meaning, example.
    pub fn markdown(&self) -> Vec<String> {
        let quoted = |words: &mut dyn Iterator<Item = &str>, between: &str| {
            words.map(|word| format!("`{word}`")).collect::<Vec<_>>().join(between)
        };
        let row = |Row { keys, means, example }: &Row| {
            let example = match &example[..] {
                [above] if above == "↑" => above.clone(),
                lines => quoted(&mut lines.iter().map(String::as_str), " "),
            };
            let cells = [&[quoted(&mut keys.split(' '), ", ")], &means[..], &[example]].concat();
            let cells = cells.iter().map(|cell| match cell.is_empty() {
                true => " |".to_owned(),
                false => format!(" {cell} |"),
            });
            format!("|{}", cells.collect::<String>())
        };
        self.rows.iter().map(row).collect()
    }

    /// Whether scenes of the kind have it.
    pub(super) fn is_of(&self, kind: SceneKind) -> bool {
        self.scenes.is_none_or(|scenes| scenes == kind)
    }

    /// What it may hold in scenes of the kind.
    pub(super) fn keys(&self, kind: SceneKind) -> Vec<&str> {
        let lacks = |key: &&str| {
            kind == SceneKind::Abstract && self.contact_only.split(' ').any(|k| k == *key)
        };
        self.rows.iter().flat_map(|row| row.keys.split(' ')).filter(|key| !lacks(key)).collect()
    }

    /// Whether it is a table of this name without numbers of entries.
    fn is_named(&self, name: &str) -> bool {
        self.tables.iter().any(|table| table.replace(".*", "") == name)
    }

    /// Whether its keys depend on its kind: a formula or a word may stand in its place.
    pub(super) fn has_kinds(&self) -> bool {
        self.rows[0].keys == "kind"
    }
}

/// What to add for a part, or the line of an example for a key such as `predicts.0.order`.
pub(super) fn example(name: &str) -> Option<&'static str> {
    let is_word = |part: &&str| part.parse::<usize>().is_err();
    let name = name.split('.').filter(is_word).collect::<Vec<_>>().join(".");
    let Some((table, key)) = name.rsplit_once('.') else {
        return PARTS.iter().find(|part| part.is_named(&name))?.holds.as_deref();
    };
    let part = PARTS.iter().find(|part| part.is_named(table))?;
    let mut lines = part.rows.iter().flat_map(|row| &row.example);
    let (first, within) = (format!("{key} = "), format!(" {key} = "));
    let shows = |line: &&String| line.starts_with(&first) || line.contains(&within);
    lines.find(shows).map(String::as_str)
}
