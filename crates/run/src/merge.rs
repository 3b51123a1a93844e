//! A sweep in many processes: the records of their directories as one table, judged scene by scene like that of one.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::sweep::{Overrides, Provenance, ScenePlan, first_named, judge_plan, missing_cases};
use files::{FileError, counted, read_text};
use judge::record::{CaseRecord, Key, RecordError, Status, read_finished};
use judge::verdict::{Baseline, Comparison, DocumentError, Verdict, read_earlier, restore_reasons};
use scene::SceneError;
use scene::setup::{SetupError, Subject};

/// Missing cases that are named before the rest is counted.
const NAMED: usize = 10;

/// Why nothing was merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    #[error("{}: {reason}", path.display())]
    File { path: PathBuf, reason: String },
    /// A part does not belong to the others.
    #[error("{}: {what}; leave the directory out, or run its cases again", dir.display())]
    Different { dir: PathBuf, what: String },
    #[error(
        "{}: the records in {} and {} differ in more than their seconds; remove the wrong one, or run the case again",
        key.word(), parts[0].display(), parts[1].display()
    )]
    Disagree { key: Key, parts: [PathBuf; 2] },
    #[error("{}: {} is no case of the list; leave the directory out", dir.display(), key.word())]
    Unlisted { key: Key, dir: PathBuf },
    #[error("{0}")]
    Missing(String),
    #[error("{0}")]
    Scene(#[from] Box<SceneError>),
    #[error("{0}")]
    Setup(#[from] Box<SetupError>),
    #[error(transparent)]
    Io(#[from] FileError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error(transparent)]
    Document(#[from] DocumentError),
}

/// What a merge came to.
pub struct Merged {
    /// Of all parts, sorted by key.
    pub records: Vec<CaseRecord>,
    /// As of one process, scene by scene.
    pub verdicts: Vec<Verdict>,
    /// Number of missing cases, and their names.
    pub missing: Option<(usize, String)>,
    /// With the baseline, where one was given.
    pub comparison: Option<Comparison>,
    /// Scenes with texts and remarks, without the machine of the merge.
    pub provenance: Provenance,
}

/// The keys of a file as `sweep run --list-cases` prints them, one a line.
///
/// # Errors
/// A line that is no key, with its number; a file without any.
pub fn read_keys(path: &Path) -> Result<Vec<Key>, MergeError> {
    let refused = |reason: String| MergeError::File { path: path.to_owned(), reason };
    let mut keys = Vec::new();
    for (number, line) in read_text(path)?.lines().enumerate() {
        let line = line.trim();
        if !line.is_empty() {
            let key =
                line.parse().map_err(|error| refused(format!("line {}: {error}", number + 1)));
            keys.push(key?);
        }
    }
    match keys.is_empty() {
        true => Err(refused("no case in it; `sweep run --list-cases` prints them".into())),
        false => Ok(keys),
    }
}

/// Directories with records of one version, and of one text of each scene.
#[derive(Default)]
pub struct Parts {
    /// In the order in which they were read.
    pub dirs: Vec<PathBuf>,
    /// The scenes of all parts with their texts.
    known: Provenance,
    /// The first part of each scene.
    first: BTreeMap<String, PathBuf>,
    /// Each case with the number of its part, the first if it is in several.
    cases: BTreeMap<Key, (CaseRecord, usize)>,
}

impl Parts {
    /// The parts below `given`: a directory with records, or else its subdirectories with records.
    ///
    /// # Errors
    /// No records below a directory; parts that do not belong together; two records of one case that differ.
    pub fn open(given: &[PathBuf]) -> Result<Self, MergeError> {
        let mut parts = Self::default();
        for dir in given {
            with_records(dir)?.into_iter().try_for_each(|dir| parts.take(dir))?;
        }
        Ok(parts)
    }

    fn take(&mut self, dir: PathBuf) -> Result<(), MergeError> {
        let different = |what: String| MergeError::Different { dir: dir.clone(), what };
        let part = Provenance::read(&dir)?
            .ok_or_else(|| different("records without provenance.json".into()))?;
        self.fits(&part).map_err(different)?;
        let mut records = read_finished(&dir.join("cases.csv"))?;
        restore_reasons(&mut records, &read_earlier(&dir.join("verdict.json"))?.failures);
        for record in records {
            let key = record.key();
            if !part.scenes.contains_key(&key.scene) {
                let unnamed = "which its provenance.json does not name";
                return Err(different(format!("records of the scene `{}`, {unnamed}", key.scene)));
            }
            match self.cases.entry(key) {
                Entry::Vacant(new) => _ = new.insert((record, self.dirs.len())),
                Entry::Occupied(known) => {
                    let (first, part) = known.get();
                    if !agree(first, &record) {
                        let part = self.dirs.get(*part).unwrap_or(&dir).clone();
                        let key = known.key().clone();
                        return Err(MergeError::Disagree { key, parts: [part, dir] });
                    }
                }
            }
        }
        for scene in part.scenes.keys() {
            self.first.entry(scene.clone()).or_insert_with(|| dir.clone());
        }
        self.known.platform = part.platform;
        self.known.scenes.extend(part.scenes);
        self.known.texts.extend(part.texts);
        self.known.meshes.extend(part.meshes);
        self.dirs.push(dir);
        Ok(())
    }

    /// What makes a part one of other records than those that are known.
    fn fits(&self, part: &Provenance) -> Result<(), String> {
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
            let Some(first) = self.first.get(scene) else { continue };
            let wanted = &self.known.scenes[scene];
            if hash != wanted {
                let first = first.display();
                return Err(format!(
                    "the scene `{scene}` is another one ({hash}) than in {first} ({wanted})"
                ));
            }
        }
        Ok(())
    }

    /// Merges and judges. The cases that have to be there are those `wanted`, or else the grids of the scenes' files. With
    /// `incomplete`, missing cases of a scene that is there are recorded as skipped. Cases that `baseline` has are compared.
    ///
    /// # Errors
    /// [`MergeError`]; missing cases if not `incomplete`.
    pub fn merge(
        self,
        wanted: Option<&[Key]>,
        incomplete: bool,
        baseline: Option<&Baseline>,
    ) -> Result<Merged, MergeError> {
        let platform = self.known.platform.clone();
        let mut provenance = Provenance { platform, ..Provenance::new([]) };
        let (mut records, mut verdicts, mut runs) = (Vec::new(), Vec::new(), Vec::new());
        let mut missing: Vec<Key> = Vec::new();
        // In the order of the list, as one process would judge.
        let mut names: Vec<&String> = match wanted {
            Some(keys) => keys.iter().map(|key| &key.scene).collect(),
            None => self.first.keys().collect(),
        };
        let mut seen = BTreeSet::new();
        names.retain(|name| seen.insert(*name));
        let listed = wanted.map(|keys| keys.iter().collect::<BTreeSet<&Key>>());
        if let Some(listed) = &listed {
            let stray = self.cases.iter().find(|(key, _)| !listed.contains(key));
            if let Some((key, (_, part))) = stray {
                let dir = self.dirs[*part].clone();
                return Err(MergeError::Unlisted { key: key.clone(), dir });
            }
        }
        for name in names {
            let of_scene = wanted.into_iter().flatten().filter(|key| key.scene == *name);
            if !self.first.contains_key(name) {
                missing.extend(of_scene.cloned());
                continue;
            }
            // From the text in its first part.
            let dir = &self.first[name];
            let scene = self.known.scene(dir, name).map_err(Box::new)?.ok_or_else(|| {
                let reason = format!("no text of the scene `{name}`");
                MergeError::File { path: dir.join("provenance.json"), reason }
            })?;
            let subject = Subject::new(scene).map_err(Box::new)?;
            let mut plan = ScenePlan::new(subject, &Overrides::default());
            let own_grids = wanted.is_none() || plan.keys().iter().eq(of_scene.clone());
            if !own_grids {
                plan.take(of_scene);
            }
            provenance.add_plan(&plan);
            let from = Key { scene: name.clone(), n: None, steps: 0 };
            let found = self.cases.range(from..).take_while(|(key, _)| key.scene == *name);
            let mut found: Vec<CaseRecord> = found.map(|(_, (record, _))| record.clone()).collect();
            let lost = missing_cases(name, &plan.cases, &found);
            found.retain(|record| !lost.contains(&record.key()));
            let skipped = plan.cases.iter().filter(|case| lost.contains(&case.place().key(name)));
            found.extend(skipped.map(|case| plan.unmeasured(case)));
            verdicts.extend(judge_plan(&plan, &found, true));
            runs.push(plan.compared(own_grids));
            records.extend(found);
            missing.extend(lost);
        }
        missing.sort();
        let missing = (!missing.is_empty()).then(|| {
            let way = match wanted {
                None => "they are on the grids of the scenes' files: name the cases that were run with --cases",
                Some(_) => "run them with `sweep run --only`",
            };
            let way = format!("{way}, or merge with --incomplete: their verdicts fail then");
            (missing.len(), in_words(&missing, &way))
        });
        if let Some((_, words)) = missing.as_ref().filter(|_| !incomplete) {
            return Err(MergeError::Missing(words.clone()));
        }
        records.sort_by_key(CaseRecord::key);
        let comparison = baseline.map(|baseline| baseline.compare(&runs, &records, &verdicts));
        Ok(Merged { records, verdicts, missing, comparison, provenance })
    }
}

/// Cases that an unfinished sweep still owes.
pub fn unfinished_in_words(missing: &[Key]) -> String {
    in_words(missing, "run the command that made these records again, `sweep run` with --resume")
}

fn in_words(missing: &[Key], way: &str) -> String {
    let named = first_named(missing.iter().map(Key::word), NAMED);
    format!("{} missing: {named}; {way}", counted(missing.len(), "case"))
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
fn with_records(dir: &Path) -> Result<Vec<PathBuf>, MergeError> {
    let is_part = |dir: &Path| dir.join("cases.csv").is_file();
    if is_part(dir) {
        return Ok(vec![dir.to_owned()]);
    }
    let unreadable = FileError::at(dir);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(&unreadable)? {
        let path = entry.map_err(&unreadable)?.path();
        found.extend(is_part(&path).then_some(path));
    }
    if found.is_empty() {
        let reason = "no cases.csv in it, nor in a directory of it".to_owned();
        return Err(MergeError::File { path: dir.to_owned(), reason });
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use judge::record::NormError;

    #[test]
    fn records_agree_but_for_seconds() {
        let case = |error: f64| CaseRecord {
            status: Status::Converged,
            errors: vec![NormError { norm: "V_max".into(), error: Some(error), floor: Some(0.0) }],
            ..CaseRecord::without_work("block", Some(4), 4, 0.25)
        };
        let one = CaseRecord { seconds_total: 1.0, ..case(0.1) };
        let other = CaseRecord { seconds_total: 2.0, ..one.clone() };
        assert!(agree(&one, &other));
        assert!(!agree(&one, &case(0.1 + 1e-17 * 2.0)));
        assert!(!agree(&one, &CaseRecord { newton_iterations: 1, ..one.clone() }));
        assert!(agree(&case(f64::NAN), &case(f64::NAN)));
    }
}
