//! Where records come from: program, machine, scenes with the hashes of their texts.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::ScenePlan;
use crate::record::replace_file;

/// What a directory of records was made with. No dates: equal runs give equal files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of this program.
    pub version: String,
    /// Operating system and processor architecture.
    pub platform: String,
    /// Hash of each scene's text.
    pub scenes: BTreeMap<String, String>,
}

/// Name of the file in the output directory.
pub const FILE: &str = "provenance.json";

impl Provenance {
    /// The provenance of a run of `plans`.
    pub fn new(plans: &[ScenePlan]) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_string(),
            platform: format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
            scenes: plans
                .iter()
                .map(|plan| {
                    let scene = plan.scene();
                    (scene.name.clone(), scene.source.hash.clone())
                })
                .collect(),
        }
    }

    /// As JSON, for `verdict.json`.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "program": "gronwall",
            "version": self.version,
            "platform": self.platform,
            "scenes": self.scenes,
        })
    }

    /// Reads the provenance of a directory; `None` if it has none.
    ///
    /// # Errors
    /// The file system's, or a file that is no provenance.
    pub fn read(dir: &Path) -> Result<Option<Self>, (PathBuf, String)> {
        let path = dir.join(FILE);
        match std::fs::read_to_string(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err((path, error.to_string())),
            Ok(text) => {
                serde_json::from_str(&text).map(Some).map_err(|error| (path, error.to_string()))
            }
        }
    }

    /// Writes the provenance into a directory.
    ///
    /// # Errors
    /// The file system's.
    pub fn write(&self, dir: &Path) -> Result<(), (PathBuf, String)> {
        let path = dir.join(FILE);
        let text = serde_json::to_string_pretty(self).map_err(|e| (path.clone(), e.to_string()))?;
        replace_file(&path, text.as_bytes()).map_err(|error| (path, error.to_string()))
    }
}
