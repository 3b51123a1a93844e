//! Values of a scene file by dotted name: `contact.law.stiffness`, `predicts.0.order`.

use std::collections::BTreeMap;
use std::ops::Range;

use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use toml::Spanned;
use toml::de::{DeValue, ValueDeserializer};

use super::diagnostic::Result;
use super::reading::{Reading, last};
use super::spans::join;
use super::wording::{missing_key, unknown_key, wrong_type};

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

    /// The value at a key, if there is one.
    ///
    /// # Errors
    /// A value of another type.
    pub(super) fn optional<T: DeserializeOwned>(&self, key: &str) -> Result<Option<T>> {
        let read = |value: &Spanned<DeValue<'_>>| {
            T::deserialize(ValueDeserializer::from(value.clone()))
                .map_err(|error| wrong_type(self.source, self.spans, &error))
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

    /// The numbers of the entries of a list that must have so many.
    pub(super) fn entries_of(&self, key: &str, count: usize, hint: &str) -> Result<Range<usize>> {
        let found = self.required::<Vec<IgnoredAny>>(key)?.len();
        let message = format!("`{}` has {found} entries, but {count} are expected", last(key));
        self.refuse_if(found != count, key, message, hint).map(|()| 0..count)
    }

    /// So many finite numbers.
    pub(super) fn numbers(&self, key: &str, count: usize, hint: &str) -> Result<Vec<f64>> {
        self.entries_of(key, count, hint)?.map(|i| self.finite(&format!("{key}.{i}"))).collect()
    }

    /// Two finite numbers.
    pub(super) fn pair(&self, key: &str, hint: &str) -> Result<[f64; 2]> {
        let numbers = self.numbers(key, 2, hint)?;
        Ok([numbers[0], numbers[1]])
    }

    /// A square matrix, row by row.
    pub(super) fn matrix(&self, key: &str, order: usize, hint: &str) -> Result<Vec<Vec<f64>>> {
        let row = |i| self.numbers(&format!("{key}.{i}"), order, hint);
        self.entries_of(key, order, hint)?.map(row).collect()
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

    /// Refuses keys of a table, if it is there, other than the known ones; spaces separate them.
    pub(super) fn keys(&self, table: &str, known: &str) -> Result<()> {
        let given: BTreeMap<String, IgnoredAny> = match table {
            "" => self.table.keys().map(|key| (key.to_string(), IgnoredAny)).collect(),
            _ => self.optional(table)?.unwrap_or_default(),
        };
        match given.keys().find(|key| !known.split(' ').any(|name| name == *key)) {
            Some(key) => Err(unknown_key(self, table, key, &known.replace(' ', ", "))),
            None => Ok(()),
        }
    }

    /// The kind of a table, one of those known. Each comes with its keys, separated by spaces; keys of other kinds are
    /// refused.
    pub(super) fn kind(&self, table: &str, kinds: Kinds) -> Result<&'static str> {
        self.keys(table, &of_any(kinds))?;
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
        let mut parts = key.split('.');
        let first = self.table.get(parts.next()?)?;
        parts.try_fold(first, |value, part| match value.get_ref() {
            DeValue::Table(table) => table.get(part),
            DeValue::Array(list) => list.get(part.parse::<usize>().ok()?),
            _ => None,
        })
    }
}

/// The kinds of a table with their keys.
pub(super) type Kinds<'a> = &'a [(&'static str, &'static str)];

/// The keys that a table of some kind may have.
pub(super) fn of_any(kinds: Kinds) -> String {
    let mut all = vec!["kind"];
    for key in kinds.iter().flat_map(|(_, keys)| keys.split_whitespace()) {
        if !all.contains(&key) {
            all.push(key);
        }
    }
    all.join(" ")
}

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
