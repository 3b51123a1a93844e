//! A scene with one thing different: a setting, a term removed, a unit, a parameter.

use std::fmt;
use std::sync::Arc;

use crate::{Result, Scene};

type Apply = dyn Fn(Scene) -> Result<Scene> + Send + Sync;

/// What is different in a scene, in words, and how to make it so. Changes with equal words are equal.
#[derive(Clone)]
pub struct Change {
    words: String,
    apply: Arc<Apply>,
}

impl Change {
    /// A change that `apply` makes, in a few words: they name it in tables, files and messages.
    pub fn new(
        words: impl Into<String>,
        apply: impl Fn(Scene) -> Result<Scene> + Send + Sync + 'static,
    ) -> Self {
        Self { words: words.into(), apply: Arc::new(apply) }
    }

    /// No change.
    pub fn none() -> Self {
        Self::new("as written", Ok)
    }

    pub fn words(&self) -> &str {
        &self.words
    }

    /// The scene that way.
    ///
    /// # Errors
    /// What the scene cannot have, at the key that would say it.
    pub fn of(&self, scene: &Scene) -> Result<Scene> {
        (self.apply)(scene.clone())
    }
}

impl PartialEq for Change {
    fn eq(&self, other: &Self) -> bool {
        self.words == other.words
    }
}

impl fmt::Debug for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words)
    }
}

impl serde::Serialize for Change {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.words)
    }
}
