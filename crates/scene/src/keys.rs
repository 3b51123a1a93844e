//! The keys of scene files: `keys.toml` says each of them once, for the check of unknown ones and for the examples in messages;
//! the tables of docs/SCENE-FILES.md are made of it.
//!
//! Values are read key by key, not into types by serde: a table whose keys depend on its kind would be an enumeration tagged
//! by `kind`, and serde buffers what follows a tag, so that the places of values in the file are lost.

use std::sync::LazyLock;

use serde::Deserialize;

/// What a scene is about.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum SceneKind {
    /// Problem 12: a body in contact.
    Contact,
    /// Problem 1 in ℝ^m.
    Abstract,
}

#[derive(Deserialize)]
struct File {
    part: Vec<Part>,
}

static FILE: LazyLock<File> =
    LazyLock::new(|| toml::from_str(include_str!("keys.toml")).expect("the keys are TOML"));

/// A table of a scene file, wherever it may stand.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    /// Dotted names; `.*` is each entry of a list.
    pub tables: Vec<String>,
    /// The kind of scene that has it; both if none is said.
    scenes: Option<SceneKind>,
    /// Keys that abstract scenes lack.
    #[serde(default)]
    contact_only: String,
    /// What to add where the part is missing.
    holds: Option<String>,
    /// Keys of one meaning; type, default, meaning; lines of an example.
    rows: Vec<Vec<String>>,
}

impl Part {
    /// Those of scenes of the kind.
    pub fn of(kind: SceneKind) -> impl Iterator<Item = &'static Part> {
        FILE.part.iter().filter(move |part| part.scenes.is_none_or(|scenes| scenes == kind))
    }

    /// What it may hold in scenes of the kind.
    pub fn keys(&self, kind: SceneKind) -> Vec<&str> {
        let lacks = |key: &&str| {
            kind == SceneKind::Abstract && self.contact_only.split(' ').any(|k| k == *key)
        };
        self.rows.iter().flat_map(|row| row[0].split(' ')).filter(|key| !lacks(key)).collect()
    }

    /// Whether its keys depend on its kind: a formula or a word may stand in its place.
    pub fn has_kinds(&self) -> bool {
        self.rows[0][0] == "kind"
    }
}

/// The way out where a part or a key such as `predicts.0.order` is missing or does not fit: what the part holds, or the line of
/// an example.
pub(super) fn example(name: &str) -> String {
    let is_word = |part: &&str| part.parse::<usize>().is_err();
    let name = name.split('.').filter(is_word).collect::<Vec<_>>().join(".");
    let part = |name: &str| {
        let is_named = |table: &String| table.replace(".*", "") == name;
        FILE.part.iter().find(|part| part.tables.iter().any(is_named))
    };
    let Some((table, key)) = name.rsplit_once('.') else {
        let holds = part(&name).and_then(|part| part.holds.clone());
        return holds.unwrap_or_else(|| format!("write [{name}] with its keys"));
    };
    let (first, within) = (format!("{key} = "), format!(" {key} = "));
    let shows = |line: &&String| line.starts_with(&first) || line.contains(&within);
    let rows = part(table).into_iter().flat_map(|part| &part.rows);
    match rows.flat_map(|row| row.iter().skip(4)).find(shows) {
        Some(line) => format!("for instance: {line}"),
        None => format!("write `{key} = …`, numbers bare, formulas and names in quotes"),
    }
}
