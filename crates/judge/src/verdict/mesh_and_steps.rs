//! A case within its scene.

use serde::{Deserialize, Serialize};

use crate::record::Key;

/// A case of a scene; `n` is absent for abstract scenes. Kept small, since there may be a million.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MeshAndSteps {
    /// Mesh cells per unit length, or level of refinement.
    pub n: Option<u32>,
    pub steps: u32,
}

impl MeshAndSteps {
    /// Its key among the cases of all scenes.
    pub fn key(self, scene: &str) -> Key {
        Key { scene: scene.to_owned(), n: self.n, steps: self.steps }
    }
}

impl std::fmt::Display for MeshAndSteps {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.key("").fmt(f)
    }
}
