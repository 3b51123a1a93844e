//! Provenance of records: program, machine, and scenes with their texts and hashes.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Block, Circumstances, Machine, ScenePlan, blocks};
use files::{FileError, if_there, read_text, replace_file};
use scene::{Scene, SceneError, Source};

/// Provenance of a directory of records. No dates: equal runs give equal files.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
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
    pub fn new<'a>(scenes: impl IntoIterator<Item = &'a Scene>) -> Self {
        let mut provenance = Self {
            version: env!("CARGO_PKG_VERSION").to_string(),
            platform: format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
            ..Self::default()
        };
        scenes.into_iter().for_each(|scene| provenance.add_scene(scene));
        provenance
    }

    /// What is to be said of records of another version of the program, which may have measured something else.
    pub fn other_version(&self) -> Option<String> {
        let this = env!("CARGO_PKG_VERSION");
        let other = self.version != this;
        other.then(|| format!("the records are of version {}, this is {this}", self.version))
    }

    fn add_scene(&mut self, Scene { name, source, .. }: &Scene) {
        self.scenes.insert(name.clone(), source.hash.clone());
        self.texts.insert(name.clone(), source.text.clone());
        self.meshes.extend(source.mesh.clone().map(|mesh| (name.clone(), mesh)));
    }

    /// Adds a scene with its cases, and the remark on its step sizes by (3.4).
    pub(crate) fn add_plan(&mut self, plan: &ScenePlan) {
        self.add_scene(plan.scene());
        let name = || plan.scene().name.clone();
        let remark = plan.step_remark().ok().flatten();
        self.step_sizes.extend(remark.map(|remark| (name(), remark.text)));
        self.cases.extend(blocks(plan).map(|asked| (name(), asked)));
    }

    /// The provenance of a run of `plans`.
    pub fn of_run(plans: &[ScenePlan], machine: &Machine) -> Self {
        let mut provenance = Self::new([]);
        plans.iter().for_each(|plan| provenance.add_plan(plan));
        provenance.run = Some(Circumstances::new(&machine.build, machine.jobs, &machine.options));
        provenance
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
        let other = scene.name != name || self.scenes.get(name) != Some(&scene.source.hash);
        let message = "the text kept here differs from the one that the records were made with";
        let hint = "run the scene again, or name the folder of its text with --scenes";
        scene.refuse_if(other, "scene.name", message, hint).map(|()| Some(scene))
    }

    /// As JSON without the texts, for `verdict.json`.
    pub fn json(&self) -> serde_json::Value {
        let mut document = serde_json::json!(self);
        if let Some(entries) = document.as_object_mut() {
            entries.retain(|key, _| !["texts", "meshes", "cases"].contains(&&**key));
            entries.insert("program".into(), "gronwall".into());
        }
        document
    }

    /// Reads the provenance of a directory; None if it has none.
    ///
    /// # Errors
    /// Those of the file system, or an invalid file.
    pub fn read(dir: &Path) -> Result<Option<Self>, FileError> {
        let path = dir.join(FILE);
        let Some(text) = if_there(read_text(&path))? else { return Ok(None) };
        let known = serde_json::from_str(&text).map_err(io::Error::from);
        known.map(Some).map_err(FileError::at(&path))
    }

    /// Writes the provenance into a directory.
    pub fn write(&self, dir: &Path) -> Result<(), FileError> {
        let path = dir.join(FILE);
        let text = serde_json::to_string_pretty(self).map_err(io::Error::from);
        replace_file(&path, text.map_err(FileError::at(&path))?.as_bytes())
    }
}
