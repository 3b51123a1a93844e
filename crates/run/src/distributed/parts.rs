//! The directories of a merge, and whether they belong together.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::error::DistributedError;
use super::plan::SweepPlan;
use crate::sweep::{AddedCase, Provenance};
use judge::record::{CaseStream, Key};
use judge::verdict::read_failures;
use scene::Scene;

/// Directories with records of one version, and of one text of each scene.
#[derive(Debug)]
pub struct Parts {
    pub dirs: Vec<PathBuf>,
    /// The platform that made all of them.
    pub platform: Option<String>,
    pub reasons: BTreeMap<Key, String>,
    /// Cases beyond the grids of scenes.
    pub added: BTreeMap<String, Vec<AddedCase>>,
    /// Hash of each scene, and the first part that has it.
    scenes: BTreeMap<String, (String, usize)>,
}

impl Parts {
    /// The parts below `given`: a directory with records, or else its subdirectories with records.
    ///
    /// # Errors
    /// No records below a directory; parts that do not belong together, or not to the plan.
    pub fn open(given: &[PathBuf], plan: Option<&SweepPlan>) -> Result<Self, DistributedError> {
        let mut dirs = Vec::new();
        for dir in given {
            dirs.extend(with_records(dir)?);
        }
        let mut parts = Self {
            dirs: Vec::with_capacity(dirs.len()),
            platform: None,
            reasons: BTreeMap::new(),
            added: BTreeMap::new(),
            scenes: BTreeMap::new(),
        };
        dirs.into_iter().try_for_each(|dir| parts.take(dir, plan))?;
        Ok(parts)
    }

    fn take(&mut self, dir: PathBuf, plan: Option<&SweepPlan>) -> Result<(), DistributedError> {
        let different = |what: String| DistributedError::Different { dir: dir.clone(), what };
        let known = Provenance::read(&dir)
            .map_err(DistributedError::of_file)?
            .ok_or_else(|| different("records without provenance.json".into()))?;
        let version = env!("CARGO_PKG_VERSION");
        if known.version != version {
            return Err(different(format!(
                "the records are of version {}, this is {version}",
                known.version
            )));
        }
        match &self.platform {
            Some(platform) if *platform != known.platform => {
                return Err(different(format!(
                    "the records were made on {}, those of {} on {platform}, which rounds differently",
                    known.platform,
                    self.dirs[0].display()
                )));
            }
            _ => self.platform = Some(known.platform),
        }
        for (scene, hash) in known.scenes {
            let planned = plan
                .map(|plan| plan.planned(&scene).map(|planned_scene| planned_scene.hash.clone()));
            let (wanted, of) = match (planned, self.scenes.get(&scene)) {
                (Some(None), _) => {
                    return Err(different(format!("the scene `{scene}` is not in the plan")));
                }
                (Some(Some(planned)), _) => (planned, "the plan".to_owned()),
                (None, Some((first, part))) => {
                    (first.clone(), self.dirs[*part].display().to_string())
                }
                (None, None) => (hash.clone(), String::new()),
            };
            if hash != wanted {
                return Err(different(format!(
                    "the scene `{scene}` is another one ({hash}) than in {of} ({wanted})"
                )));
            }
            self.scenes.entry(scene).or_insert((hash, self.dirs.len()));
        }
        for (scene, added) in known.added_cases {
            self.added.entry(scene).or_default().extend(added);
        }
        let document = dir.join("verdict.json");
        if document.exists() {
            let failures = read_failures(&document)
                .map_err(|error| DistributedError::Other(error.to_string()))?;
            let reason = |f: judge::verdict::Failure| {
                (Key { scene: f.scene, n: f.n, steps: f.steps }, f.reason)
            };
            self.reasons.extend(failures.into_iter().map(reason));
        }
        self.dirs.push(dir);
        Ok(())
    }

    pub(crate) fn tables(&self) -> Vec<PathBuf> {
        self.dirs.iter().map(|dir| dir.join("cases.csv")).collect()
    }

    pub(crate) fn scenes(&self) -> impl Iterator<Item = &String> {
        self.scenes.keys()
    }

    /// A scene, from the text in its first part.
    ///
    /// # Errors
    /// The text is missing or invalid.
    pub(crate) fn scene(&self, name: &str) -> Result<Scene, DistributedError> {
        let nothing = |path: &Path| DistributedError::File {
            path: path.to_owned(),
            reason: format!("no text of the scene `{name}`; give the plan with --plan"),
        };
        let Some((_, part)) = self.scenes.get(name) else {
            return Err(nothing(Path::new("the directories")));
        };
        let dir = &self.dirs[*part];
        let known = Provenance::read(dir).map_err(DistributedError::of_file)?;
        let scene = known.map(|known| known.scene(dir, name)).transpose();
        let scene = scene.map_err(|error| DistributedError::Scene(Box::new(error)))?;
        scene.flatten().ok_or_else(|| nothing(&dir.join("provenance.json")))
    }

    /// The parts that hold a case; reads every table, for messages only.
    pub(crate) fn holders(&self, key: &Key) -> Vec<PathBuf> {
        let holds = |dir: &&PathBuf| {
            CaseStream::open(&dir.join("cases.csv"))
                .is_ok_and(|mut cases| cases.any(|case| case.is_ok_and(|case| case.key() == *key)))
        };
        self.dirs.iter().filter(holds).cloned().collect()
    }
}

/// The parts of a given directory.
fn with_records(dir: &Path) -> Result<Vec<PathBuf>, DistributedError> {
    let is_part = |dir: &Path| dir.join("cases.csv").is_file();
    if is_part(dir) {
        return Ok(vec![dir.to_owned()]);
    }
    let unreadable = DistributedError::at(dir);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(&unreadable)? {
        let entry = entry.map_err(&unreadable)?;
        // Unpublished records of a killed process.
        if !entry.file_name().to_string_lossy().starts_with('.') && is_part(&entry.path()) {
            found.push(entry.path());
        }
    }
    if found.is_empty() {
        let reason = "no cases.csv in it, nor in a directory of it".to_owned();
        return Err(DistributedError::File { path: dir.to_owned(), reason });
    }
    found.sort();
    Ok(found)
}
