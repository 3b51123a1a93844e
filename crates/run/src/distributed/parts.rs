//! The directories of a merge: whether they belong together, and their records.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

use super::error::DistributedError;
use super::plan::{SweepPlan, id};
use crate::sweep::{AddedCase, Provenance};
use files::FileError;
use judge::record::{CaseRecord, Key, Status, read_finished};
use judge::verdict::{read_earlier, restore_reasons};
use scene::Scene;

/// Directories with records of one version, and of one text of each scene.
pub struct Parts {
    /// In the order in which they were read.
    pub dirs: Vec<PathBuf>,
    /// The scenes of all parts with their texts and added cases.
    known: Provenance,
    /// The first part of each scene.
    first: BTreeMap<String, PathBuf>,
    /// Each case with the place of its part, the first if it is in several.
    cases: BTreeMap<Key, (CaseRecord, usize)>,
}

impl Parts {
    /// The parts below `given`: a directory with records, or else its subdirectories with records.
    ///
    /// # Errors
    /// No records below a directory; parts that do not belong together, or not to the plan; two records of one case that
    /// differ.
    pub fn open(given: &[PathBuf], plan: Option<&SweepPlan>) -> Result<Self, DistributedError> {
        let mut parts = Self {
            dirs: Vec::new(),
            known: Provenance::default(),
            first: BTreeMap::new(),
            cases: BTreeMap::new(),
        };
        for dir in given {
            with_records(dir)?.into_iter().try_for_each(|dir| parts.take(dir, plan))?;
        }
        Ok(parts)
    }

    fn take(&mut self, dir: PathBuf, plan: Option<&SweepPlan>) -> Result<(), DistributedError> {
        let different = |what: String| DistributedError::Different { dir: dir.clone(), what };
        let part = Provenance::read(&dir)?
            .ok_or_else(|| different("records without provenance.json".into()))?;
        self.fits(&part, plan).map_err(different)?;
        for record in records(&dir)? {
            let key = record.key();
            if !part.scenes.contains_key(&key.scene) {
                let unnamed = "which its provenance.json does not name";
                return Err(different(format!("records of the scene `{}`, {unnamed}", key.scene)));
            }
            match self.cases.entry(key) {
                Entry::Vacant(new) => {
                    new.insert((record, self.dirs.len()));
                }
                Entry::Occupied(known) => {
                    let (first, part) = known.get();
                    if !agree(first, &record) {
                        let part = self.dirs.get(*part).unwrap_or(&dir).clone();
                        let parts = [part, dir];
                        return Err(DistributedError::Disagree { id: id(known.key()), parts });
                    }
                }
            }
        }
        for scene in part.scenes.keys() {
            self.first.entry(scene.clone()).or_insert_with(|| dir.clone());
        }
        for (scene, added) in part.added_cases {
            self.known.added_cases.entry(scene).or_default().extend(added);
        }
        self.known.platform = part.platform;
        self.known.scenes.extend(part.scenes);
        self.known.texts.extend(part.texts);
        self.known.meshes.extend(part.meshes);
        self.dirs.push(dir);
        Ok(())
    }

    /// What makes a part one of other records than those that are known.
    fn fits(&self, part: &Provenance, plan: Option<&SweepPlan>) -> Result<(), String> {
        if let Some(other) = part.other_version() {
            return Err(other);
        }
        if let Some(first) = self.dirs.first().filter(|_| part.platform != self.known.platform) {
            return Err(format!(
                "the records were made on {}, those of {} on {}, which rounds differently",
                part.platform,
                first.display(),
                self.known.platform
            ));
        }
        for (scene, hash) in &part.scenes {
            let (wanted, of) = match (plan.map(|plan| plan.planned(scene)), self.first.get(scene)) {
                (Some(None), _) => return Err(format!("the scene `{scene}` is not in the plan")),
                (Some(Some(planned)), _) => (&planned.hash, "the plan".to_owned()),
                (None, Some(first)) => (&self.known.scenes[scene], first.display().to_string()),
                (None, None) => continue,
            };
            if hash != wanted {
                return Err(format!(
                    "the scene `{scene}` is another one ({hash}) than in {of} ({wanted})"
                ));
            }
        }
        Ok(())
    }

    /// The platform that made all of them.
    pub(super) fn platform(&self) -> String {
        self.known.platform.clone()
    }

    pub(super) fn scenes(&self) -> impl Iterator<Item = &String> {
        self.known.scenes.keys()
    }

    /// Cases of a scene beyond its grid.
    pub(super) fn added(&self, scene: &str) -> &[AddedCase] {
        self.known.added_cases.get(scene).map_or(&[], Vec::as_slice)
    }

    /// A scene, from the text in its first part.
    ///
    /// # Errors
    /// The text is missing or invalid.
    pub(super) fn scene(&self, name: &str) -> Result<Scene, DistributedError> {
        let dir = &self.first[name];
        let scene = self.known.scene(dir, name).map_err(Box::new)?;
        scene.ok_or_else(|| {
            let reason = format!("no text of the scene `{name}`; give the plan with --plan");
            DistributedError::File { path: dir.join("provenance.json"), reason }
        })
    }

    pub(super) fn of_scene(&self, scene: &str) -> impl Iterator<Item = &CaseRecord> {
        let from = Key { scene: scene.to_owned(), n: None, steps: 0 };
        let of_scene = self.cases.range(from..).take_while(move |(key, _)| key.scene == scene);
        of_scene.map(|(_, (record, _))| record)
    }

    /// The part of a recorded case.
    pub(super) fn holder(&self, key: &Key) -> &Path {
        &self.dirs[self.cases[key].1]
    }
}

/// The records of a part, with the reasons of failed cases.
fn records(dir: &Path) -> Result<Vec<CaseRecord>, DistributedError> {
    let mut records = read_finished(&dir.join("cases.csv"))?;
    restore_reasons(&mut records, &read_earlier(&dir.join("verdict.json"))?.failures);
    Ok(records)
}

/// Whether two records of one case agree in every column but `seconds_*`.
fn agree(a: &CaseRecord, b: &CaseRecord) -> bool {
    let lasting = |case: &CaseRecord| {
        let mut case = CaseRecord {
            seconds_load: 0.0,
            seconds_assemble: 0.0,
            seconds_factor: 0.0,
            seconds_solve: 0.0,
            seconds_total: 0.0,
            ..case.clone()
        };
        if let Status::Failed { reason } = &mut case.status {
            reason.clear();
        }
        case.errors.sort_by(|a, b| a.norm.cmp(&b.norm));
        // As text: NaN agrees with NaN, and 0 not with -0.
        format!("{case:?}")
    };
    lasting(a) == lasting(b)
}

/// The parts of a given directory.
fn with_records(dir: &Path) -> Result<Vec<PathBuf>, DistributedError> {
    let is_part = |dir: &Path| dir.join("cases.csv").is_file();
    if is_part(dir) {
        return Ok(vec![dir.to_owned()]);
    }
    let unreadable = FileError::at(dir);
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

#[cfg(test)]
mod tests {
    use super::*;
    use judge::record::NormError;

    fn case(error: f64) -> CaseRecord {
        CaseRecord {
            status: Status::Converged,
            errors: vec![NormError { norm: "V_max".into(), error: Some(error), floor: Some(0.0) }],
            ..CaseRecord::without_work("block", Some(4), 4, 0.25)
        }
    }

    #[test]
    fn records_agree_but_for_seconds() {
        let one = CaseRecord { seconds_total: 1.0, ..case(0.1) };
        let other = CaseRecord { seconds_total: 2.0, ..one.clone() };
        assert!(agree(&one, &other));
        assert!(!agree(&one, &case(0.1 + 1e-17 * 2.0)));
        assert!(!agree(&one, &CaseRecord { newton_iterations: 1, ..one.clone() }));
        assert!(agree(&case(f64::NAN), &case(f64::NAN)));
    }
}
