//! Errors of the TOML reader, in the words of a scene.

use super::diagnostic::SceneError;
use super::examples::example;
use super::nearest::nearest;
use super::reading::Reading;
use super::source::Source;
use super::spans::{Spans, join};

/// Types in the words of the TOML reader and of a scene.
const TYPES: [(&str, &str); 11] = [
    ("i64", "a whole number"),
    ("f64", "a number"),
    ("a boolean", "true or false"),
    ("a sequence", "a list in [ ]"),
    ("a map", "a table"),
    ("map", "a table"),
    ("sequence", "a list"),
    ("floating point", "the number"),
    ("integer", "the number"),
    ("string", "the string"),
    ("boolean ", ""),
];

/// The text is not TOML.
pub(super) fn syntax(source: &Source, error: &toml::de::Error) -> SceneError {
    let span = error.span().unwrap_or_default();
    if error.message() == "duplicate key" {
        let key = source.text.get(span.clone()).unwrap_or_default();
        let message = format!("duplicate key `{key}`");
        let hint = "a part holds each key once: remove one of the two";
        return SceneError::at(source, span, message, hint);
    }
    let message = format!("not TOML: {}", error.message());
    let hint = "one `key = value` per line, strings in quotes, lists in [ ], parts under [name]";
    SceneError::at(source, span, message, hint)
}

/// A key that its table does not have; `table` is empty for a part of the file.
pub(super) fn unknown_key(reading: &Reading, table: &str, key: &str, known: &str) -> SceneError {
    let message = match table {
        "" => format!("unknown part [{key}]"),
        _ => format!("unknown key `{key}` in {}", heading(table)),
    };
    let hint = match nearest(key, known.split(", ")) {
        Some(meant) => format!("did you mean `{meant}`? known here: {known}"),
        None => format!("known here: {known}"),
    };
    reading.key_error(&join(table, key), message, hint)
}

/// A key that must be there.
pub(super) fn missing_key(reading: &Reading, key: &str) -> SceneError {
    let part = key.split('.').next().unwrap_or(key);
    if !reading.has(part) {
        let message = format!("the part [{part}] is missing");
        return reading.error_at_the_end(message, example(part).unwrap_or("add it"));
    }
    let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
    let hint = example(key)
        .map_or_else(|| format!("add `{name} = …`"), |line| format!("for instance: {line}"));
    // `scene.kind` decides which parts a file has, not which keys [scene] has.
    let words = [join(table, "kind"), join(table, "shape"), table.to_string()];
    let mut words = words.iter().filter(|word| *word != "scene.kind");
    let kind = words.find_map(|word| Some((word, reading.optional::<String>(word).ok()??)));
    let message = match kind {
        Some((word, kind)) if word == "domain.shape" => {
            format!("shape `{kind}` needs the key `{name}`")
        }
        Some((_, kind)) => format!("kind `{kind}` needs the key `{name}`"),
        None => format!("{} lacks the key `{name}`", heading(table)),
    };
    reading.error(table, message, hint)
}

/// A value of another type than that of its key.
pub(super) fn wrong_type(source: &Source, spans: &Spans, error: &toml::de::Error) -> SceneError {
    let (span, message) = (error.span().unwrap_or_default(), error.message());
    let name = spans.name_at(&span);
    let hint = name.and_then(example).map_or_else(
        || "numbers stand bare, formulas and names in quotes".to_string(),
        |line| format!("for instance: {line}"),
    );
    let message = match message
        .strip_prefix("invalid type: ")
        .and_then(|text| text.split_once(", expected "))
    {
        Some((found, expected)) => {
            let subject = name.map(|name| format!("`{name}`: ")).unwrap_or_default();
            format!("{subject}expected {}, found {}", plain_type(expected), plain_type(found))
        }
        None => message.to_string(),
    };
    SceneError::at(source, span, message, hint)
}

fn plain_type(name: &str) -> String {
    let name = name.trim_end_matches(" as i128");
    let renamed = TYPES
        .iter()
        .find_map(|(theirs, ours)| name.strip_prefix(theirs).map(|rest| format!("{ours}{rest}")));
    renamed.unwrap_or_else(|| name.to_string())
}

/// A dotted name of a table as in a message: `[material.memory]`, `[[predicts]]`.
pub(super) fn heading(part: &str) -> String {
    match part.rsplit_once('.') {
        Some((list, index)) if index.parse::<usize>().is_ok() => format!("[[{list}]]"),
        _ => format!("[{part}]"),
    }
}
