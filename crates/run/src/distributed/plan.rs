//! A plan on disk: what all processes of a sweep have to agree on.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::DistributedError;
use super::names::{CASES, JOBS, PLAN};
use crate::sweep::Overrides;
use files::{FileError, Replacement, open_file, read_text, replace_file};
use judge::record::Key;
use scene::{Scene, Source};

/// A scene as planned.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PlannedScene {
    pub name: String,
    /// Hash of its text, including its mesh file.
    pub hash: String,
    /// The file it was read from; if it exists, it must not have changed.
    pub file: PathBuf,
    /// Its text: a machine that runs a job needs no folder of scenes.
    pub text: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
}

/// A sweep to be run in many processes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepPlan {
    pub version: String,
    #[serde(flatten)]
    pub overrides: Overrides,
    /// Predicted CPU seconds that a job of several cases may have.
    pub bundle_seconds: f64,
    pub cases: usize,
    /// Number of jobs, named 0, 1, …
    pub jobs: usize,
    /// In the order of their verdicts.
    pub scenes: Vec<PlannedScene>,
}

/// A row of `plan.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseRow {
    /// `SCENE:nN:NSTEPS`, `SCENE:NSTEPS` without a mesh.
    pub id: String,
    pub scene: String,
    /// Empty for abstract scenes.
    pub n: Option<u32>,
    pub steps: u32,
    /// Predicted CPU seconds in a separate process, without a reference run.
    pub seconds: f64,
    /// Predicted peak memory of that process.
    pub bytes: f64,
    pub job: usize,
}

/// A row of `jobs.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRow {
    pub job: usize,
    /// Number of cases.
    pub cases: usize,
    /// Predicted CPU seconds, including reference runs.
    pub seconds: f64,
    pub bytes: f64,
    /// Memory to request, in MB of 2^20 bytes.
    pub mem_mb: u64,
    /// Time to request, in minutes.
    pub runtime: u64,
}

impl CaseRow {
    /// Its key in records.
    pub fn key(&self) -> Key {
        Key { scene: self.scene.clone(), n: self.n, steps: self.steps }
    }
}

/// The id of a case. Names of scenes contain no colon.
pub fn id(key: &Key) -> String {
    match key.n {
        Some(n) => format!("{}:n{n}:N{}", key.scene, key.steps),
        None => format!("{}:N{}", key.scene, key.steps),
    }
}

impl PlannedScene {
    /// The scene with its file, as it is now.
    pub(crate) fn new(scene: &Scene) -> Self {
        let Source { path, text, hash, mesh, .. } = &scene.source;
        Self {
            name: scene.name.clone(),
            hash: hash.clone(),
            file: fs::canonicalize(path).unwrap_or_else(|_| path.clone()),
            text: text.clone(),
            mesh: mesh.clone(),
        }
    }

    /// The planned scene, from its text; `dir` is the plan's directory.
    ///
    /// # Errors
    /// [`DistributedError::Scene`], [`DistributedError::Malformed`] if text and hash do not match.
    pub(crate) fn scene(&self, dir: &Path) -> Result<Scene, DistributedError> {
        let path = dir.join(PLAN);
        let mut source =
            Source::from_text(format!("{} ({})", path.display(), self.name), &*self.text);
        if let Some(mesh) = &self.mesh {
            source = source.with_mesh(mesh.clone());
        }
        let scene = Scene::from_source(source).map_err(Box::new)?;
        if scene.name != self.name || scene.source.hash != self.hash {
            let reason = format!("the text of `{}` is not the one that was planned", self.name);
            return Err(DistributedError::Malformed { path, reason });
        }
        Ok(scene)
    }

    /// Refuses a scene whose file has changed since. A missing file is accepted.
    ///
    /// # Errors
    /// [`DistributedError::Changed`].
    pub(crate) fn unchanged(&self) -> Result<(), DistributedError> {
        if !self.file.is_file() {
            return Ok(());
        }
        let found = Scene::read(&self.file).map_err(|_| "one with errors".to_owned());
        let found = found.map_or_else(|error| error, |scene| scene.source.hash);
        if found == self.hash {
            return Ok(());
        }
        let (path, scene, planned) = (self.file.clone(), self.name.clone(), self.hash.clone());
        Err(DistributedError::Changed { path, scene, planned, found })
    }
}

impl SweepPlan {
    /// Reads the plan in `dir`.
    ///
    /// # Errors
    /// [`DistributedError`]; a plan of another version is refused.
    pub fn read(dir: &Path) -> Result<Self, DistributedError> {
        let path = dir.join(PLAN);
        let text = read_text(&path)?;
        let plan: Self = serde_json::from_str(&text).map_err(malformed(&path))?;
        let running = env!("CARGO_PKG_VERSION");
        if plan.version != running {
            let (found, running) = (plan.version, running.to_owned());
            return Err(DistributedError::Version { path, found, running });
        }
        Ok(plan)
    }

    /// Writes the plan with its tables into `dir`, plan.json last: without it there is no plan.
    pub(crate) fn write(
        &self,
        dir: &Path,
        cases: &[CaseRow],
        jobs: &[JobRow],
    ) -> Result<(), DistributedError> {
        table(&dir.join(CASES), cases)?;
        table(&dir.join(JOBS), jobs)?;
        let path = dir.join(PLAN);
        let text = serde_json::to_vec_pretty(self).map_err(malformed(&path))?;
        Ok(replace_file(&path, &text)?)
    }

    pub(crate) fn planned(&self, name: &str) -> Option<&PlannedScene> {
        self.scenes.iter().find(|scene| scene.name == name)
    }

    /// The rows of `plan.csv` with one of these ids, or of one of these jobs.
    ///
    /// # Errors
    /// [`DistributedError::Unknown`] if one of them is missing.
    pub fn rows(
        &self,
        dir: &Path,
        ids: &[String],
        jobs: &[usize],
    ) -> Result<Vec<CaseRow>, DistributedError> {
        let path = dir.join(CASES);
        let file = open_file(&path).map_err(FileError::at(&path))?;
        let mut ids: BTreeSet<&str> = ids.iter().map(String::as_str).collect();
        let mut left: BTreeSet<usize> = jobs.iter().copied().collect();
        let mut found = Vec::new();
        for row in csv::Reader::from_reader(BufReader::new(file)).into_deserialize() {
            let row: CaseRow = row.map_err(malformed(&path))?;
            let asked = ids.remove(row.id.as_str());
            if asked || jobs.contains(&row.job) {
                left.remove(&row.job);
                found.push(row);
            }
        }
        let unknown = match (ids.first(), left.first()) {
            (Some(id), _) => format!("no case {id}"),
            (None, Some(job)) => format!("no job {job}"),
            (None, None) => return Ok(found),
        };
        Err(DistributedError::Unknown { path, what: unknown, cases: self.cases })
    }
}

fn malformed<E: std::fmt::Display>(path: &Path) -> impl Fn(E) -> DistributedError {
    move |error| DistributedError::Malformed { path: path.to_owned(), reason: error.to_string() }
}

/// Writes a table atomically, row by row.
fn table<R: Serialize>(path: &Path, rows: &[R]) -> Result<(), DistributedError> {
    let write = || -> io::Result<()> {
        let mut table = csv::Writer::from_writer(Replacement::create(path)?);
        for row in rows {
            table.serialize(row)?;
        }
        table.into_inner().map_err(|error| error.into_error())?.finish()
    };
    Ok(write().map_err(FileError::at(path))?)
}
