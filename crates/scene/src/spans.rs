//! Positions of the keys of a scene file.

use std::collections::BTreeMap;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Bytes of a key and of its value; for a `[table]`, of its name and its header.
#[derive(Debug, Clone, PartialEq)]
struct Place {
    key: Range<usize>,
    value: Range<usize>,
}

/// The position of every key, by dotted name: `exact.multiplier`, `predicts.0.order`, `sweep.n.2`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spans {
    places: BTreeMap<String, Place>,
}

impl Spans {
    pub(super) fn of(table: &DeTable<'_>) -> Spans {
        let mut spans = Spans::default();
        spans.enter_table("", table);
        spans
    }

    /// Bytes of the value at a dotted key; for an absent key, of the nearest containing part.
    pub fn value(&self, key: &str) -> Range<usize> {
        self.nearest_place(key).map_or(0..0, |place| place.value.clone())
    }

    /// Bytes of the key itself, or of the nearest containing part.
    pub(crate) fn key(&self, key: &str) -> Range<usize> {
        self.nearest_place(key).map_or(0..0, |place| place.key.clone())
    }

    /// The dotted name of the table whose header, or inline value, occupies exactly these bytes.
    pub(super) fn name_at(&self, value: &Range<usize>) -> Option<&str> {
        self.places
            .iter()
            .filter(|(_, place)| place.value == *value)
            .map(|(name, _)| name.as_str())
            .max_by_key(|name| name.len())
    }

    fn nearest_place(&self, key: &str) -> Option<&Place> {
        let mut name = key;
        loop {
            if let Some(place) = self.places.get(name) {
                return Some(place);
            }
            name = &name[..name.rfind('.')?];
        }
    }

    fn enter_table(&mut self, parent: &str, table: &DeTable<'_>) {
        for (key, value) in table {
            let name = join(parent, key.get_ref());
            self.enter_value(name, key.span(), value);
        }
    }

    fn enter_value(&mut self, name: String, key: Range<usize>, value: &Spanned<DeValue<'_>>) {
        match value.get_ref() {
            DeValue::Table(table) => self.enter_table(&name, table),
            DeValue::Array(array) => {
                for (index, item) in array.iter().enumerate() {
                    self.enter_value(join(&name, &index.to_string()), item.span(), item);
                }
            }
            _ => {}
        }
        self.places.insert(name, Place { key, value: value.span() });
    }
}

pub(super) fn join(parent: &str, key: &str) -> String {
    if parent.is_empty() { key.to_string() } else { format!("{parent}.{key}") }
}
