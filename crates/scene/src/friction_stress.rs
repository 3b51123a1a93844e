//! The friction stress of an exact solution, as written: one formula along the tangent in the plane, a vector in space.

use std::fmt;

use formula::{Node, Scope};
use serde::{Deserialize, Deserializer, de};

use super::diagnostic::SceneError;
use super::or_table::Plain;
use super::reading::Reading;
use super::written::Formula;

/// `friction = "0.1"` in the plane, `friction = ["0.1", "0", "0.05"]` in space.
#[derive(Debug, Clone)]
pub(crate) enum FrictionStress {
    /// Along the tangent.
    Along(Formula),
    /// By components.
    Vector(Vec<Formula>),
}

impl<'de> Deserialize<'de> for FrictionStress {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FrictionStressVisitor)
    }
}

struct FrictionStressVisitor;

impl<'de> de::Visitor<'de> for FrictionStressVisitor {
    type Value = FrictionStress;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, or a list of them", Formula::IS)
    }

    fn visit_str<E>(self, text: &str) -> Result<FrictionStress, E> {
        Ok(FrictionStress::Along(Formula(text.to_string())))
    }

    fn visit_f64<E>(self, value: f64) -> Result<FrictionStress, E> {
        Ok(FrictionStress::Along(Formula(value.to_string())))
    }

    fn visit_i64<E>(self, value: i64) -> Result<FrictionStress, E> {
        Ok(FrictionStress::Along(Formula(value.to_string())))
    }

    fn visit_seq<A: de::SeqAccess<'de>>(self, list: A) -> Result<FrictionStress, A::Error> {
        let list = de::value::SeqAccessDeserializer::new(list);
        Vec::deserialize(list).map(FrictionStress::Vector)
    }
}

impl FrictionStress {
    /// Its formulas: one in the plane, three in space.
    pub(super) fn nodes(
        &self,
        reading: &mut Reading,
        dimension: usize,
        scope: &Scope,
    ) -> Result<Vec<Node>, SceneError> {
        let key = "exact.friction";
        match (self, dimension) {
            (Self::Along(formula), 2) => Ok(vec![reading.formula(key, formula, scope)?]),
            (Self::Vector(formulas), 3) => reading.vector(key, formulas, 3, scope),
            (_, 2) => {
                let hint = "in the plane it is one formula, along the tangent: friction = \"0.1\"";
                Err(reading.error(key, "a friction stress of several components", hint))
            }
            _ => {
                let hint = "in space it is a vector: friction = [\"0.1\", \"0\", \"0\"]";
                Err(reading.error(key, "a friction stress of one component", hint))
            }
        }
    }
}
