//! Errors of the TOML reader, in the words of a scene.

use std::ops::Range;

use super::diagnostic::SceneError;
use super::examples::example;
use super::nearest::nearest;
use super::source::Source;
use super::spans::Spans;

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
        return SceneError::at(
            source,
            span,
            message,
            "a part holds each key once: remove one of the two",
        );
    }
    let message = format!("not TOML: {}", error.message());
    let hint = "one `key = value` per line, strings in quotes, lists in [ ], parts under [name]";
    SceneError::at(source, span, message, hint)
}

/// The text is TOML, but not a scene.
pub(super) fn structure(source: &Source, spans: &Spans, error: &toml::de::Error) -> SceneError {
    let span = error.span().unwrap_or_default();
    let message = error.message();
    let quoted = in_backticks(message);
    if message.starts_with("unknown field")
        && let Some((key, known)) = quoted.split_first()
    {
        return unknown_key(source, spans, span, key, known);
    }
    if message.starts_with("missing field")
        && let Some(key) = quoted.first()
    {
        return missing_key(source, spans, span, key);
    }
    wrong_type(source, spans, span, message)
}

fn unknown_key(
    source: &Source,
    spans: &Spans,
    span: Range<usize>,
    key: &str,
    known: &[&str],
) -> SceneError {
    let part = spans
        .name_of_key_at(span.start)
        .and_then(|name| name.rsplit_once('.'))
        .map(|(part, _)| part);
    let message = match part {
        Some(part) => format!("unknown key `{key}` in {}", heading(part)),
        None => format!("unknown part [{key}]"),
    };
    let list = known.join(", ");
    let hint = match nearest(key, known.iter().copied()) {
        Some(meant) => format!("did you mean `{meant}`? known here: {list}"),
        None => format!("known here: {list}"),
    };
    SceneError::at(source, span, message, hint)
}

fn missing_key(source: &Source, spans: &Spans, span: Range<usize>, key: &str) -> SceneError {
    match spans.name_at(&span) {
        Some(part) => {
            let hint = example(&format!("{part}.{key}"))
                .map_or_else(|| format!("add `{key} = …`"), |line| format!("for instance: {line}"));
            SceneError::at(source, span, format!("{} lacks the key `{key}`", heading(part)), hint)
        }
        None => {
            let end = source.text.trim_end().len();
            let hint = example(key).unwrap_or("add it");
            SceneError::at(source, end..end, format!("the part [{key}] is missing"), hint)
        }
    }
}

fn wrong_type(source: &Source, spans: &Spans, span: Range<usize>, message: &str) -> SceneError {
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
    if name.starts_with("struct ") {
        return "a table".to_string();
    }
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

/// The parts of a message between backticks.
fn in_backticks(message: &str) -> Vec<&str> {
    message.split('`').skip(1).step_by(2).collect()
}
