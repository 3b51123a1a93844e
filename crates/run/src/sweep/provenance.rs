//! Provenance of records: program, machine, and scenes with their texts and hashes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{AddedCase, Block, Circumstances, Machine, ScenePlan, blocks};
use files::{read_text, replace_file};
use scene::{Scene, SceneError, Source};

/// Provenance of a directory of records. No dates: equal runs give equal files.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    pub version: String,
    /// Operating system and processor architecture.
    pub platform: String,
    /// Hash of each scene's text, including its mesh file.
    pub scenes: BTreeMap<String, String>,
    /// Each scene's text, so that records can be judged without its file.
    #[serde(default)]
    pub texts: BTreeMap<String, String>,
    /// The text of each mesh file, likewise.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub meshes: BTreeMap<String, String>,
    /// Remarks on step sizes that (3.4) does not cover.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub step_sizes: BTreeMap<String, String>,
    /// Cases beyond the grid of a scene, with the verdicts that asked for them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub added_cases: BTreeMap<String, Vec<AddedCase>>,
    /// Requested cases of scenes that are not on their default grid.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cases: BTreeMap<String, Vec<Block>>,
    /// The only key that may differ between runs with equal records.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub run: Option<Circumstances>,
}

/// Name of the file in the output directory.
pub const FILE: &str = "provenance.json";

impl Provenance {
    /// The provenance of records of these scenes.
    pub fn new<'a>(scenes: impl Iterator<Item = &'a Scene>) -> Self {
        let named = scenes.map(|scene| (scene.name.clone(), &scene.source));
        let sources: BTreeMap<String, &Source> = named.collect();
        let mesh = |(name, source): (&String, &&Source)| Some((name.clone(), source.mesh.clone()?));
        let meshes = sources.iter().filter_map(mesh).collect();
        let each = |value: fn(&Source) -> &String| {
            sources.iter().map(|(name, source)| (name.clone(), value(source).clone())).collect()
        };
        Self {
            version: env!("CARGO_PKG_VERSION").to_string(),
            platform: format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
            scenes: each(|source| &source.hash),
            texts: each(|source| &source.text),
            meshes,
            step_sizes: BTreeMap::new(),
            added_cases: BTreeMap::new(),
            cases: BTreeMap::new(),
            run: None,
        }
    }

    /// The provenance of a run of `plans`, with remarks on their step sizes by (3.4).
    pub fn of_run(plans: &[ScenePlan], machine: &Machine) -> Self {
        let remark = |plan: &ScenePlan| {
            let remark = plan.step_remark().ok().flatten()?;
            Some((plan.scene().name.clone(), remark.text))
        };
        let step_sizes = plans.iter().filter_map(remark).collect();
        let extended = plans.iter().filter(|plan| !plan.added.is_empty());
        let added_cases =
            extended.map(|plan| (plan.scene().name.clone(), plan.added.clone())).collect();
        let asked = |plan: &ScenePlan| Some((plan.scene().name.clone(), blocks(plan)?));
        let cases = plans.iter().filter_map(asked).collect();
        let run = Some(Circumstances::new(&machine.build, machine.jobs, &machine.options));
        Self {
            step_sizes,
            added_cases,
            cases,
            run,
            ..Self::new(plans.iter().map(ScenePlan::scene))
        }
    }

    /// The scene of the records in `dir`; None if its text is not kept there.
    ///
    /// # Errors
    /// The text is invalid, or does not match its hash.
    pub fn scene(&self, dir: &Path, name: &str) -> Result<Option<Scene>, SceneError> {
        let Some(text) = self.texts.get(name) else {
            return Ok(None);
        };
        let path = format!("{} ({name})", dir.join(FILE).display());
        let mut source = Source::from_text(path, text.as_str());
        if let Some(mesh) = self.meshes.get(name) {
            source = source.with_mesh(mesh.clone());
        }
        let scene = Scene::from_source(source)?;
        if scene.name != name || self.scenes.get(name) != Some(&scene.source.hash) {
            let message = "the text kept here is not the one that the records were made with";
            let hint = "run the scene again, or name the folder of its text with --scenes";
            return Err(scene.error("scene.name", message, hint));
        }
        Ok(Some(scene))
    }

    /// As JSON without the texts, for `verdict.json`.
    pub fn json(&self) -> serde_json::Value {
        let mut document = serde_json::json!({
            "program": "gronwall",
            "version": self.version,
            "platform": self.platform,
            "scenes": self.scenes,
        });
        if !self.step_sizes.is_empty() {
            document["step_sizes"] = serde_json::json!(self.step_sizes);
        }
        if !self.added_cases.is_empty() {
            document["added_cases"] = serde_json::json!(self.added_cases);
        }
        if let Some(run) = &self.run {
            document["run"] = serde_json::json!(run);
        }
        document
    }

    /// Reads the provenance of a directory; None if it has none.
    ///
    /// # Errors
    /// Those of the file system, or an invalid file.
    pub fn read(dir: &Path) -> Result<Option<Self>, (PathBuf, String)> {
        let path = dir.join(FILE);
        match read_text(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err((path, error.to_string())),
            Ok(text) => {
                serde_json::from_str(&text).map(Some).map_err(|error| (path, error.to_string()))
            }
        }
    }

    /// Writes the provenance into a directory.
    pub fn write(&self, dir: &Path) -> Result<(), (PathBuf, String)> {
        let path = dir.join(FILE);
        let text = serde_json::to_string_pretty(self).map_err(|e| (path.clone(), e.to_string()))?;
        replace_file(&path, text.as_bytes()).map_err(|error| (path, error.to_string()))
    }
}
