//! Provenance of records: program, machine, and scenes with their texts and hashes.

use super::plan::{CasePlan, Overrides, ScenePlan, norms, scene_cases};
use super::{Machine, SweepError};
use files::{FileError, if_there, make_directory, read_text, replace_file};
use judge::record::{CaseRecord, CaseTable, Key, Status, read_table};
use scene::{Norm, Scene, SceneError, Source};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::{fs, io};

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
    pub cases: BTreeMap<String, Vec<Planned>>,
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
        if plan.cases != scene_cases(plan.scene(), &Overrides::default()) {
            let one = |case: &CasePlan| {
                let names = || case.norms.iter().map(|norm| norm.name().to_owned()).collect();
                let usual = case.norms == norms(plan.scene(), case.n);
                Planned { n: case.n, steps: case.steps, norms: (!usual).then(names) }
            };
            self.cases.insert(name(), plan.cases.iter().map(one).collect());
        }
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

// Circumstances of a set of records, beside program version and scenes; no record depends on them.

/// Build of a program, passed to the library.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Build {
    /// The commit, "unknown" outside of a clone, "development build" without release optimisation.
    pub commit: Cow<'static, str>,
    pub compiler: Cow<'static, str>,
    pub target: Cow<'static, str>,
    pub optimisation: Cow<'static, str>,
}

impl Build {
    /// The build of a program that does not state it.
    pub(crate) fn unknown() -> Self {
        let [commit, compiler, target, optimisation] = [const { Cow::Borrowed("unknown") }; 4];
        Self { commit, compiler, target, optimisation }
    }
}

/// Commit, compiler, processor, threads and options of a run. Paths are omitted, since they mean nothing elsewhere.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Circumstances {
    #[serde(flatten)]
    pub build: Build,
    /// "unknown" if the system does not tell.
    pub processor: String,
    /// Cases in parallel.
    pub threads: usize,
    /// Non-default options of the command, without paths.
    pub options: String,
}

impl Circumstances {
    /// The circumstances of a program on this machine.
    pub fn new(build: &Build, threads: usize, options: &str) -> Self {
        let processor = std::fs::read_to_string("/proc/cpuinfo");
        Self {
            build: build.clone(),
            processor: processor.ok().and_then(|text| model(&text)).unwrap_or("unknown".into()),
            threads,
            options: options.to_owned(),
        }
    }
}

/// The first processor of Linux' list.
fn model(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

// Resuming an interrupted sweep: complete cases are kept, all others run again.

/// What is kept of earlier records.
#[derive(Debug, Default)]
pub struct Resumed {
    pub records: Vec<CaseRecord>,
    /// Why other records are discarded, if they are not only incomplete.
    pub doubts: Vec<String>,
}

/// Lines named before the rest is counted.
const NAMED: usize = 10;

/// The complete cases in `dir` that belong to `plans`; none for an empty or missing directory. Rows that fail their
/// checksum, or hold impossible values, are dropped.
///
/// # Errors
/// Records of another version or of another text of a scene, unreadable files.
pub fn resume(dir: &Path, plans: &[ScenePlan]) -> Result<Resumed, SweepError> {
    let path = dir.join("cases.csv");
    if !path.exists() {
        return Ok(Resumed::default());
    }
    let different = |what: String| SweepError::Different { dir: dir.to_owned(), what };
    let known = Provenance::read(dir)?
        .ok_or_else(|| different("records without provenance.json".into()))?;
    let current = Provenance::new(plans.iter().map(|plan| plan.scene()));
    if let Some(other) = known.other_version() {
        return Err(different(other));
    }
    for (scene, hash) in &current.scenes {
        if known.scenes.get(scene).is_some_and(|other| other != hash) {
            return Err(different(format!("the scene `{scene}` has changed since")));
        }
    }
    let case_of = |record: &CaseRecord| {
        let plan = plans.iter().find(|plan| plan.scene().name == record.scene)?;
        plan.cases.iter().find(|case| case.n == record.n && case.steps == record.steps)
    };
    let table = read_table(&path)?;
    let mut resumed = Resumed { doubts: doubts(&path, &table), ..Resumed::default() };
    // Rows without a checksum cannot be trusted.
    let cases = if table.checked { table.cases } else { Vec::new() };
    for record in cases {
        // The table is rewritten from the returned records: a case outside the plan would be lost.
        let Some(case) = case_of(&record) else {
            let key = record.key();
            return Err(different(format!("`{}` {key} is no case of this sweep", key.scene)));
        };
        if let Some(entry) = record.unsound() {
            let (error, floor) = (entry.error, entry.floor);
            resumed.doubts.push(format!(
                "{}: `{}` {}: error {error:?} and floor {floor:?} in {} are no measurement: the case is run again",
                path.display(), record.scene, record.key(), entry.norm
            ));
        } else if record.converged() && is_complete(&record, &case.norms) {
            resumed.records.push(record);
        }
    }
    Ok(resumed)
}

fn doubts(path: &Path, table: &CaseTable) -> Vec<String> {
    let lines = first_named(table.changed.iter().map(u64::to_string), NAMED);
    let path = path.display();
    let changed = format!(
        "{path}: line {lines}: changed after it was written (its checksum differs), so the case is run again"
    );
    let unchecked =
        format!("{path}: all cases are run again, because rows without checksums are not trusted");
    let found = [(!table.changed.is_empty(), changed), (!table.checked, unchecked)];
    found.into_iter().filter(|(found, _)| *found).map(|(_, doubt)| doubt).collect()
}

/// The first names of a list, and how many more there are.
pub(crate) fn first_named(all: impl ExactSizeIterator<Item = String>, most: usize) -> String {
    let more = all.len().saturating_sub(most);
    let named = all.take(most).collect::<Vec<_>>().join(", ");
    if more == 0 { named } else { format!("{named} and {more} more") }
}

// The directory of a sweep, locked by one process.

/// Why a directory cannot be written to.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    #[error("{0}; choose another directory with --out")]
    Io(#[from] FileError),
    #[error(
        "{}: {holder} is writing here; wait until it has finished, or choose another directory with --out",
        path.display()
    )]
    Held { path: PathBuf, holder: String },
}

/// A locked directory. The system releases the lock when the process ends, however it ends.
#[derive(Debug)]
pub struct OutputDirectory {
    path: PathBuf,
    _lock: File,
}

/// The locked file; it contains the process number, for the message of another process.
const LOCK: &str = ".lock";

impl OutputDirectory {
    /// Creates the directory if necessary, and locks it.
    ///
    /// # Errors
    /// [`OutputError`]. A file system without locks is accepted.
    pub fn take(path: &Path) -> Result<Self, OutputError> {
        let refused = FileError::at(path);
        make_directory(path)?;
        let file = path.join(LOCK);
        // The target of a link is not ours.
        if fs::symlink_metadata(&file).is_ok_and(|known| known.is_symlink()) {
            fs::remove_file(&file).map_err(&refused)?;
        }
        let open =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(file);
        let mut lock = open.map_err(&refused)?;
        match lock.try_lock() {
            Ok(()) => {
                let number = format!("process {}", std::process::id());
                let written = lock.set_len(0).and_then(|()| lock.write_all(number.as_bytes()));
                written.map_err(&refused)?;
            }
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                if lock.read_to_string(&mut holder).is_err() || holder.is_empty() {
                    holder = "another sweep".into();
                }
                return Err(OutputError::Held { path: path.to_owned(), holder });
            }
            Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(refused(error).into()),
        }
        Ok(Self { path: path.to_owned(), _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

// The planned cases of a directory of records, by its provenance.

/// A case of a scene that is off its default grid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Planned {
    /// Cells per unit length; none in an abstract scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub n: Option<u32>,
    pub steps: u32,
    /// Names of the norms, unless they are those of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub norms: Option<Vec<String>>,
}

/// The cases of a scene by its provenance: its default grid or those stored.
pub fn planned(scene: &Scene, known: &Provenance) -> Vec<CasePlan> {
    let Some(stored) = known.cases.get(&scene.name) else {
        return scene_cases(scene, &Overrides::default());
    };
    let one = |Planned { n, steps, norms: named }: &Planned| {
        let listed = |names: &Vec<String>| {
            Norm::all().filter(|norm| names.iter().any(|name| name == norm.name())).collect()
        };
        let norms = named.as_ref().map_or_else(|| norms(scene, *n), listed);
        CasePlan { n: *n, steps: *steps, norms }
    };
    stored.iter().map(one).collect()
}

/// Whether a record is complete: the case was run (possibly failed), and no row is lost.
pub(crate) fn is_complete(record: &CaseRecord, norms: &[Norm]) -> bool {
    record.status != Status::Skipped && norms.iter().all(|norm| record.norm(norm.name()).is_some())
}

/// The planned cases of a scene without a complete record.
pub fn missing_cases(scene: &str, planned: &[CasePlan], records: &[CaseRecord]) -> Vec<Key> {
    let of_scene = records.iter().filter(|record| record.scene == scene);
    let known: BTreeMap<(Option<u32>, u32), &CaseRecord> =
        of_scene.map(|record| ((record.n, record.steps), record)).collect();
    let open = |case: &&CasePlan| {
        let record = known.get(&(case.n, case.steps));
        !record.is_some_and(|record| is_complete(record, &case.norms))
    };
    planned.iter().filter(open).map(|case| case.place().key(scene)).collect()
}

#[cfg(test)]
mod tests {
    mod circumstances {
        use super::super::*;

        #[test]
        fn the_processor_is_named_by_its_line() {
            let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nflags\t: a b\n";
            assert_eq!(model(text).as_deref(), Some("Some CPU @ 2 GHz"));
            assert_eq!(model("processor\t: 0\nHardware\t: board\n"), None);
        }
    }

    mod output {
        use super::super::*;

        #[test]
        fn a_directory_is_held_once_and_given_back() {
            let path = std::env::temp_dir().join(format!("gronwall-output-{}", std::process::id()));
            let held = OutputDirectory::take(&path).unwrap();
            let second = OutputDirectory::take(&path).unwrap_err().to_string();
            assert!(second.contains(&format!("process {}", std::process::id())), "{second}");
            assert!(second.contains("--out"), "{second}");
            drop(held);
            drop(OutputDirectory::take(&path).unwrap());
            // A file in its place.
            let file = path.join("file");
            fs::write(&file, "").unwrap();
            assert!(matches!(OutputDirectory::take(&file), Err(OutputError::Io(_))));
            fs::remove_dir_all(&path).unwrap();
        }
    }
}
