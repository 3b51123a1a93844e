//! `[contact.friction]` as it is written.

use std::fmt;

use serde::{Deserialize, Deserializer, de};

use super::written::{Formula, FormulaVisitor};

/// `[contact.friction]`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    pub bound: Bound,
}

/// The bound of the friction stress: a formula in x, y, t, or a table.
#[derive(Debug, Clone)]
pub enum Bound {
    Formula(Formula),
    Table(BoundTable),
}

/// `bound = { kind = "slip", points = [[0.0, 0.3], [0.1, 0.28]] }`
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoundTable {
    pub kind: String,
    pub points: Option<Vec<Vec<f64>>>,
}

impl<'de> Deserialize<'de> for Bound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Bound, D::Error> {
        deserializer.deserialize_any(BoundVisitor)
    }
}

struct BoundVisitor;

impl<'de> de::Visitor<'de> for BoundVisitor {
    type Value = Bound;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        FormulaVisitor.expecting(f)?;
        f.write_str(", or a table with a kind")
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Bound, E> {
        FormulaVisitor.visit_str(text).map(Bound::Formula)
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Bound, E> {
        FormulaVisitor.visit_f64(value).map(Bound::Formula)
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Bound, E> {
        FormulaVisitor.visit_i64(value).map(Bound::Formula)
    }

    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<Bound, A::Error> {
        let table = de::value::MapAccessDeserializer::new(map);
        BoundTable::deserialize(table).map(Bound::Table)
    }
}
