//! A value written plainly, or as a table with a kind.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IntoDeserializer, MapAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer};

/// `rule = "left"` or `rule = { kind = "corrected-end", exponent = 0.5 }`.
#[derive(Debug, Clone)]
pub(crate) enum OrTable<P, T> {
    /// A text or a number.
    Plain(P),
    Table(T),
}

/// What may stand in place of a table.
pub trait Plain {
    /// Its description, for messages.
    const IS: &'static str;
}

impl<'de, P: Plain + Deserialize<'de>, T: Deserialize<'de>> Deserialize<'de> for OrTable<P, T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PlainOrTable(PhantomData))
    }
}

struct PlainOrTable<P, T>(PhantomData<(P, T)>);

impl<'de, P: Plain + Deserialize<'de>, T: Deserialize<'de>> Visitor<'de> for PlainOrTable<P, T> {
    type Value = OrTable<P, T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, or a table with a kind", P::IS)
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        P::deserialize(text.into_deserializer()).map(OrTable::Plain)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        let refused = |_: E| E::invalid_type(Unexpected::Float(value), &self);
        P::deserialize(value.into_deserializer()).map(OrTable::Plain).map_err(refused)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        let refused = |_: E| E::invalid_type(Unexpected::Signed(value), &self);
        P::deserialize(value.into_deserializer()).map(OrTable::Plain).map_err(refused)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(OrTable::Table)
    }
}
