//! One reading of a scene file: the text, its positions, its numbers, and the formulas compiled so far.

use super::data::AXES;
use super::keys::example;
use super::source::{Result, SceneError, Source};
use super::validated::Hypothesis;
use formula::{EvaluationPoint, Graph, Node, Scope, Variable};
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use strsim::osa_distance;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

pub(super) struct Reading<'a> {
    pub source: &'a Source,
    pub table: &'a DeTable<'a>,
    pub violates: Vec<Hypothesis>,
    pub formulas: Graph,
    /// Named constants of `[exact.parameters]`, in file order.
    pub parameters: Vec<(String, Node)>,
}

impl Reading<'_> {
    /// An error that underlines the value at `key`, or the part that should contain it.
    pub fn error(&self, key: &str, message: impl ToString, hint: impl ToString) -> SceneError {
        SceneError::at(self.source, placed(self.table, key).value, message, hint)
    }

    /// Refuses what [`Self::error`] underlines if it is at fault.
    pub(crate) fn refuse_if(
        &self,
        fault: bool,
        key: &str,
        message: impl ToString,
        hint: impl ToString,
    ) -> Result<()> {
        if fault { Err(self.error(key, message, hint)) } else { Ok(()) }
    }

    /// An error that underlines the key itself.
    pub fn key_error(&self, key: &str, message: impl ToString, hint: impl ToString) -> SceneError {
        SceneError::at(self.source, placed(self.table, key).key, message, hint)
    }

    /// An error of something that is missing in the file.
    pub fn error_at_the_end(&self, message: impl ToString, hint: impl ToString) -> SceneError {
        let end = self.source.text.trim_end().len();
        SceneError::at(self.source, end..end, message, hint)
    }

    /// The number at a key.
    pub(crate) fn finite(&self, key: &str) -> Result<f64> {
        self.number(key, f64::is_finite, ["is not finite", "give a finite number"])
    }

    /// The number at a key, above 0.
    pub(crate) fn positive(&self, key: &str) -> Result<f64> {
        let value = self.finite(key)?;
        let message = format!("`{}` = {value} is not positive", last(key));
        self.refuse_if(value <= 0.0, key, message, "give a number above 0").map(|()| value)
    }

    /// The number at a key, if it fits; `fault` says what is wrong with another one.
    pub(crate) fn number(
        &self,
        key: &str,
        fits: impl Fn(f64) -> bool,
        [fault, hint]: [&str; 2],
    ) -> Result<f64> {
        let value = self.required(key)?;
        let message = format!("`{}` = {value} {fault}", last(key));
        self.refuse_if(!fits(value), key, message, hint).map(|()| value)
    }

    /// The number at a key, between 0 and 1.
    pub(crate) fn share(&self, key: &str, hint: &str) -> Result<f64> {
        self.number(key, |share| share > 0.0 && share < 1.0, ["is not between 0 and 1", hint])
    }

    /// The whole number at a key, if it is in a range; `fault` says what is wrong with another one.
    pub(crate) fn whole<T: TryFrom<i64>>(
        &self,
        key: &str,
        range: RangeInclusive<i64>,
        fault: &str,
    ) -> Result<T> {
        let value: i64 = self.required(key)?;
        let fitting = T::try_from(value).ok().filter(|_| range.contains(&value));
        fitting.ok_or_else(|| self.error(key, format!("{value} {fault}"), example(key)))
    }

    /// A whole number from 1 to 2³¹ - 1.
    pub(crate) fn count(&self, key: &str) -> Result<u32> {
        let fault = "is not a whole number from 1 to 2147483647";
        self.whole(key, 1..=i64::from(i32::MAX), fault)
    }

    pub(crate) fn seed(&self, key: &str) -> Result<u64> {
        self.whole(key, 0..=i64::MAX, "is negative, and a seed is a whole number from 0 on")
    }

    /// The text at a key, which says something.
    pub(crate) fn text(&self, key: &str) -> Result<String> {
        let text: String = self.required(key)?;
        let message = format!("`{}` is empty", last(key));
        self.refuse_if(text.trim().is_empty(), key, message, example(key)).map(|()| text)
    }

    /// An increasing pair of counts, if it is there: the window of an order.
    pub(crate) fn window(&self, key: &str) -> Result<Option<[u32; 2]>> {
        match self.optional::<Vec<i64>>(key)?.as_deref() {
            None => Ok(None),
            Some([first, last]) if first <= last => {
                Ok(Some([self.count(&format!("{key}.0"))?, self.count(&format!("{key}.1"))?]))
            }
            Some(values) => {
                let hint = "a window is [from, to] with from <= to, as in [32, 128]";
                Err(self.error(key, format!("{values:?} is not a window"), hint))
            }
        }
    }

    /// The points of a graph or a polygon, one at least.
    pub(crate) fn points(&self, key: &str) -> Result<Vec<[f64; 2]>> {
        self.some_entries(key)?.map(|index| self.pair(&format!("{key}.{index}"))).collect()
    }

    /// The given variables and the parameters of the scene.
    pub(crate) fn scope(&self, variables: &[Variable]) -> Scope {
        let mut scope = Scope::new(variables);
        for (name, node) in &self.parameters {
            scope.define(name, *node);
        }
        scope
    }

    /// The axes of the space, t, and the parameters of the scene.
    pub(crate) fn space_and_time(&self, dimension: usize) -> Scope {
        self.scope(&[&AXES[..dimension], &[Variable::T]].concat())
    }

    /// Compiles a formula; an error points into its text.
    pub(crate) fn compiled(&mut self, key: &str, formula: &Formula, scope: &Scope) -> Result<Node> {
        self.formulas.parse(&formula.0, scope).map_err(|error| {
            let hint = error.hint.unwrap_or_else(|| "correct the formula".to_string());
            let span = self.inside(key, &formula.0, error.span);
            SceneError::at(self.source, span, error.message, hint)
        })
    }

    /// The formula at a key.
    pub(crate) fn formula(&mut self, key: &str, scope: &Scope) -> Result<Node> {
        self.compiled(key, &self.required(key)?, scope)
    }

    /// The formulas of a list, one per component; there must be `dimension` of them.
    pub(crate) fn vector(
        &mut self,
        key: &str,
        dimension: usize,
        scope: &Scope,
    ) -> Result<Vec<Node>> {
        self.components(key, &self.required::<Vec<Formula>>(key)?, dimension, scope)
    }

    /// Compiles one formula per component; there must be `dimension` of them.
    pub(crate) fn components(
        &mut self,
        key: &str,
        formulas: &[Formula],
        dimension: usize,
        scope: &Scope,
    ) -> Result<Vec<Node>> {
        let (name, count) = (last(key), formulas.len());
        let message = format!("`{name}` has {count} components in dimension {dimension}");
        let hint = format!("give {dimension} formulas, one a component");
        self.refuse_if(count != dimension, key, message, hint)?;
        formulas
            .iter()
            .enumerate()
            .map(|(index, formula)| self.compiled(&format!("{key}.{index}"), formula, scope))
            .collect()
    }

    /// What `read` makes of a key, if it is there.
    pub(crate) fn if_given<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&mut Self, &str) -> Result<T>,
    ) -> Result<Option<T>> {
        if self.has(key) { read(self, key).map(Some) } else { Ok(None) }
    }

    /// Refuses a formula whose value at one of the points does not fit, with the message and the hint for the first.
    pub(crate) fn everywhere<H: ToString>(
        &self,
        (key, node): (&str, Node),
        points: impl IntoIterator<Item = EvaluationPoint>,
        fits: impl Fn(f64) -> bool,
        refusal: impl Fn(&EvaluationPoint, f64) -> (String, H),
    ) -> Result<()> {
        let mut values = points.into_iter().map(|at| (at, self.formulas.evaluate(node, &at)));
        let odd = values.find(|(_, value)| !fits(*value));
        let Some((at, value)) = odd else { return Ok(()) };
        let (message, hint) = refusal(&at, value);
        Err(self.error(key, message, hint))
    }

    /// Bytes of a part of a string value; the whole value if it contains escapes.
    fn inside(&self, key: &str, content: &str, part: Range<usize>) -> Range<usize> {
        let value = placed(self.table, key).value;
        match self.source.text[value.clone()].find(content) {
            Some(offset) if !content.is_empty() => {
                let start = value.start + offset;
                start + part.start..start + part.end
            }
            _ => value,
        }
    }
}

/// Places at evenly spaced times from 0 to the horizon.
pub(super) fn in_time(
    places: &[[f64; 3]],
    horizon: f64,
    intervals: u32,
) -> impl Iterator<Item = EvaluationPoint> {
    let at = |t| places.iter().map(move |&place| EvaluationPoint { t, ..place.into() });
    evenly(0.0, horizon, intervals).flat_map(at)
}

/// Evenly spaced numbers, both ends included.
pub(super) fn evenly(from: f64, to: f64, intervals: u32) -> impl Iterator<Item = f64> + Clone {
    (0..=intervals).map(move |i| from + (to - from) * f64::from(i) / f64::from(intervals.max(1)))
}

pub(super) fn last(key: &str) -> &str {
    key.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(key)
}

// Enumerated words, with suggestions for unknown ones.

impl Reading<'_> {
    /// The value that the word at a key names.
    ///
    /// # Errors
    /// No word, or an unknown one; the message lists the known ones, nearest first.
    pub(super) fn choice<T: Copy>(&self, key: &str, known: &[(&str, T)]) -> Result<T> {
        self.named(key, &self.required::<String>(key)?, known)
    }

    /// The value that the word at a key names, or that without the key.
    ///
    /// # Errors
    /// An unknown word.
    pub(super) fn choice_or<T: Copy>(
        &self,
        key: &str,
        known: &[(&str, T)],
        without: T,
    ) -> Result<T> {
        if self.has(key) { self.choice(key, known) } else { Ok(without) }
    }

    /// The value that a word at a key names.
    ///
    /// # Errors
    /// An unknown word.
    pub(super) fn named<T: Copy>(&self, key: &str, word: &str, known: &[(&str, T)]) -> Result<T> {
        if let Some((_, value)) = known.iter().find(|(name, _)| *name == word) {
            return Ok(*value);
        }
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        let message = format!("unknown value `{word}` of `{}`", last(key));
        Err(self.error(key, message, suggestion(word, "known", &names)))
    }
}

// Values of a scene file by dotted name: `contact.law.stiffness`, `predicts.0.order`.

impl Reading<'_> {
    /// Whether the file has the key.
    pub(super) fn has(&self, key: &str) -> bool {
        self.at(key).is_some()
    }

    /// Whether the value at a key is a table or a list, in place of a text or a number.
    pub(super) fn has_parts(&self, key: &str) -> bool {
        self.at(key)
            .is_some_and(|value| matches!(value.get_ref(), DeValue::Table(_) | DeValue::Array(_)))
    }

    /// Whether the value at a key is a list.
    pub(super) fn is_list(&self, key: &str) -> bool {
        self.at(key).is_some_and(|value| matches!(value.get_ref(), DeValue::Array(_)))
    }

    /// The value at a key, if there is one.
    ///
    /// # Errors
    /// A value of another type.
    pub(super) fn optional<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>> {
        let read = |value: &Spanned<DeValue<'_>>| {
            T::deserialize(ValueDeserializer::from(value.clone()))
                .map_err(|error| wrong_type(self, key, &error))
        };
        self.at(key).map(read).transpose()
    }

    /// The value of a key that must be there.
    ///
    /// # Errors
    /// No value, or one of another type.
    pub(super) fn required<T: DeserializeOwned>(&self, key: &str) -> Result<T> {
        self.optional(key)?.ok_or_else(|| missing_key(self, key))
    }

    /// The numbers of the entries of a list; none without the key.
    pub(super) fn entries(&self, key: &str) -> Result<Range<usize>> {
        let list: Vec<IgnoredAny> = self.optional(key)?.unwrap_or_default();
        Ok(0..list.len())
    }

    /// The numbers of the entries of a list that must have some.
    pub(super) fn some_entries(&self, key: &str) -> Result<Range<usize>> {
        let count = self.required::<Vec<IgnoredAny>>(key)?.len();
        let message = format!("the list `{}` is empty", last(key));
        self.refuse_if(count == 0, key, message, example(key)).map(|()| 0..count)
    }

    /// The numbers of the entries of a list that must have so many.
    pub(super) fn entries_of(&self, key: &str, count: usize) -> Result<Range<usize>> {
        let found = self.required::<Vec<IgnoredAny>>(key)?.len();
        let message = format!("{found} entries, but {count} are expected");
        self.refuse_if(found != count, key, message, example(key)).map(|()| 0..count)
    }

    /// So many finite numbers.
    pub(super) fn numbers(&self, key: &str, count: usize) -> Result<Vec<f64>> {
        self.entries_of(key, count)?.map(|i| self.finite(&format!("{key}.{i}"))).collect()
    }

    /// Two finite numbers.
    pub(super) fn pair(&self, key: &str) -> Result<[f64; 2]> {
        let numbers = self.numbers(key, 2)?;
        Ok([numbers[0], numbers[1]])
    }

    /// A square matrix, row by row.
    pub(super) fn matrix(&self, key: &str, order: usize) -> Result<Vec<Vec<f64>>> {
        let row = |i| self.numbers(&format!("{key}.{i}"), order);
        self.entries_of(key, order)?.map(row).collect()
    }

    /// Refuses a matrix that is not symmetric.
    pub(super) fn symmetric(&self, key: &str, rows: &[Vec<f64>]) -> Result<()> {
        for (i, row) in rows.iter().enumerate() {
            if let Some(j) = (0..i).find(|&j| row[j] != rows[j][i]) {
                let (above, below, i, j) = (rows[j][i], row[j], i + 1, j + 1);
                let message = format!(
                    "not symmetric: entry ({j}, {i}) is {above}, entry ({i}, {j}) is {below}"
                );
                return Err(self.error(key, message, "give both entries the same number"));
            }
        }
        Ok(())
    }

    /// Refuses keys of a table, if it is there, other than the known ones.
    pub(super) fn keys(&self, table: &str, known: &[&str]) -> Result<()> {
        let given: BTreeMap<String, IgnoredAny> = match table {
            "" => self.table.keys().map(|key| (key.to_string(), IgnoredAny)).collect(),
            _ => self.optional(table)?.unwrap_or_default(),
        };
        let unknown = given.keys().find(|key| !known.contains(&key.as_str()));
        let Some(key) = unknown else { return Ok(()) };
        let message = match table {
            "" => format!("unknown part [{key}]"),
            _ => format!("unknown key `{key}` in {}", heading(table)),
        };
        Err(self.key_error(&join(table, key), message, suggestion(key, "known here", known)))
    }

    /// The kind of a table, one of those known. Each comes with its keys, separated by spaces; keys of other kinds are
    /// refused.
    pub(super) fn kind(&self, table: &str, kinds: Kinds) -> Result<&'static str> {
        let known: Vec<_> = kinds.iter().map(|(kind, _)| (*kind, *kind)).collect();
        let kind = self.choice(&join(table, "kind"), &known)?;
        self.only(table, ("kind", kind), kinds)?;
        Ok(kind)
    }

    /// Refuses keys of a table that other kinds have, and this one has not.
    pub(super) fn only(
        &self,
        table: &str,
        (word, kind): (&str, &str),
        kinds: &[(&str, &str)],
    ) -> Result<()> {
        let has = |keys: &str, key: &str| keys.split(' ').any(|known| known == key);
        let own = |key: &str| kinds.iter().any(|(name, keys)| *name == kind && has(keys, key));
        for (owner, keys) in kinds {
            let mut given = keys.split_whitespace().filter(|key| self.has(&join(table, key)));
            if let Some(key) = given.find(|key| !own(key)) {
                let hint = format!("remove `{key}`, or write {word} = \"{owner}\"");
                let message = format!("{word} `{kind}` takes no `{key}`");
                return Err(self.key_error(&join(table, key), message, hint));
            }
        }
        Ok(())
    }

    fn at(&self, key: &str) -> Option<&Spanned<DeValue<'_>>> {
        placed(self.table, key).found
    }
}

/// The kinds of a table with their keys.
pub(super) type Kinds<'a> = &'a [(&'static str, &'static str)];

/// A formula as text; a bare TOML number is a formula too.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "toml::Value")]
pub(crate) struct Formula(pub String);

impl TryFrom<toml::Value> for Formula {
    type Error = String;

    fn try_from(value: toml::Value) -> Result<Self, String> {
        match value {
            toml::Value::String(text) => Ok(Self(text)),
            toml::Value::Float(number) => Ok(Self(number.to_string())),
            toml::Value::Integer(number) => Ok(Self(number.to_string())),
            other => Err(format!(
                "invalid type: {}, expected a formula in quotes or a number",
                other.type_str()
            )),
        }
    }
}

// Positions of the keys of a scene file.

/// Where a dotted name is in a file: `exact.multiplier`, `predicts.0.order`, `sweep.n.2`.
#[derive(Default)]
pub(super) struct Placed<'a> {
    /// Bytes of the key and of its value, of a `[table]` its name and its header; for an absent key those of the nearest part
    /// that would contain it.
    pub key: Range<usize>,
    pub value: Range<usize>,
    found: Option<&'a Spanned<DeValue<'a>>>,
}

pub(super) fn placed<'a>(table: &'a DeTable<'a>, key: &str) -> Placed<'a> {
    let in_table = |table: &'a DeTable<'a>, part: &str| {
        table.get_key_value(part).map(|(key, value)| (key.span(), value))
    };
    let mut placed = Placed::default();
    for (depth, part) in key.split('.').enumerate() {
        let next = match placed.found.take().map(Spanned::get_ref) {
            None if depth == 0 => in_table(table, part),
            Some(DeValue::Table(table)) => in_table(table, part),
            Some(DeValue::Array(list)) => {
                part.parse().ok().and_then(|index: usize| list.get(index)).map(|v| (v.span(), v))
            }
            _ => None,
        };
        let Some((key, value)) = next else { break };
        placed = Placed { key, value: value.span(), found: Some(value) };
    }
    placed
}

pub(super) fn join(parent: &str, key: &str) -> String {
    if parent.is_empty() { key.to_string() } else { format!("{parent}.{key}") }
}

// Errors of the TOML reader, in the words of a scene.

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

/// A key that must be there.
pub(super) fn missing_key(reading: &Reading, key: &str) -> SceneError {
    let part = key.split('.').next().unwrap_or(key);
    if !reading.has(part) {
        let message = format!("the part [{part}] is missing");
        return reading.error_at_the_end(message, example(part));
    }
    let (table, name) = key.rsplit_once('.').unwrap_or(("", key));
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
    reading.error(table, message, example(key))
}

/// A value of another type than that of its key.
fn wrong_type(reading: &Reading, key: &str, error: &toml::de::Error) -> SceneError {
    let (span, message) = (error.span().unwrap_or_default(), error.message());
    // The value at the key, or an entry of it.
    let entries = (0..).map(|i| format!("{key}.{i}")).take_while(|name| reading.has(name));
    let mut names = std::iter::once(key.to_owned()).chain(entries);
    let name = names.find(|name| placed(reading.table, name).value == span);
    let hint = example(name.as_deref().unwrap_or(key));
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
    SceneError::at(reading.source, span, message, hint)
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

// Suggestions for misspelt names.

/// The way out of an unknown word.
fn suggestion(word: &str, list: &str, known: &[&str]) -> String {
    let meant = nearest(word, known.iter().copied());
    let meant = meant.map_or_else(String::new, |meant| format!("did you mean `{meant}`? "));
    format!("{meant}{list}: {}", known.join(", "))
}

/// The nearest candidate, if near enough.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    by_distance(name, candidates).into_iter().next()
}

/// All candidates near enough, nearest first.
pub(super) fn by_distance<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let mut near: Vec<(usize, &str)> = candidates
        .into_iter()
        .filter_map(|candidate| Some((closeness(&name, &candidate.to_lowercase())?, candidate)))
        .collect();
    near.sort();
    near.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Number of edits between the names (insertions, deletions, substitutions, swaps of neighbours); None if more than a third of the letters differ. A prefix of two letters or
/// more counts as one edit.
fn closeness(name: &str, candidate: &str) -> Option<usize> {
    let shorter = name.len().min(candidate.len());
    if shorter >= 2 && (name.starts_with(candidate) || candidate.starts_with(name)) {
        return Some(1);
    }
    let edits = osa_distance(name, candidate);
    let longer = name.chars().count().max(candidate.chars().count());
    (edits <= longer.div_ceil(3)).then_some(edits).filter(|&edits| edits < longer)
}
