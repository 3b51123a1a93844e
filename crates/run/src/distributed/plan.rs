//! A plan on disk: what every process that runs a part of the sweep has to agree on.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::sweep::Overrides;
use files::{Replacement, counted, open_file, read_text, replace_file};
use judge::record::Key;
use scene::{Scene, SceneError, Source};

/// Scenes, arguments and version of the plan, below its directory.
pub const PLAN: &str = "plan.json";
/// One row per case: what it takes and which job runs it.
pub const CASES: &str = "plan.csv";
/// One row per job: what it takes and what it asks for.
pub const JOBS: &str = "jobs.csv";

/// Why a plan cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    /// No file of this program.
    #[error("{}: {reason}; make the plan again with `sweep plan`", path.display())]
    Malformed { path: PathBuf, reason: String },
    /// Made by another version.
    #[error(
        "{}: the plan is of version {found}, this is {own}: records of both would not be of one sweep; run its cases with version {found}, or plan again", path.display()
    )]
    Version { path: PathBuf, found: String, own: String },
    /// The scene is not the one that was planned.
    #[error(
        "{}: the scene `{scene}` has changed since the plan was made ({planned} planned, {found} found); plan again into another directory, or restore the file (its text is kept in {PLAN} of the plan)", path.display()
    )]
    Changed { path: PathBuf, scene: String, planned: String, found: String },
    /// The text in the plan is at fault.
    #[error("{0}")]
    Scene(#[from] Box<SceneError>),
    /// The plan has no such case or job.
    #[error("{}: {what} in this plan; its {} are in {CASES}", path.display(), counted(*cases, "case"))]
    Unknown { path: PathBuf, what: String, cases: usize },
}

/// A scene as it was when the plan was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlannedScene {
    /// Its name.
    pub name: String,
    /// Hash of its text, its mesh file included.
    pub hash: String,
    /// The file it was read from: where that is there, it must not have changed.
    pub file: PathBuf,
    /// Its text: a machine that runs a job needs no folder of scenes.
    pub text: String,
    /// The text of its mesh file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<String>,
}

/// A sweep that is to run in many processes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of the program.
    pub version: String,
    /// Cells per unit length in place of those of the scenes.
    pub n: Option<Vec<u32>>,
    /// Numbers of steps in place of those of the scenes.
    pub steps: Option<Vec<u32>>,
    /// Predicted CPU seconds that a job of several cases may have.
    pub bundle_seconds: f64,
    /// Number of cases.
    pub cases: usize,
    /// Number of jobs, which are called 0, 1, …
    pub jobs: usize,
    /// The scenes, in the order of their verdicts.
    pub scenes: Vec<PlannedScene>,
}

/// A row of `plan.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseRow {
    /// `SCENE:nN:NSTEPS`, `SCENE:NSTEPS` without a mesh.
    pub id: String,
    /// Name of the scene.
    pub scene: String,
    /// Cells per unit length; empty in an abstract scene.
    pub n: Option<u32>,
    /// Number of steps.
    pub steps: u32,
    /// Predicted CPU seconds in a separate process, without a reference run.
    pub seconds: f64,
    /// Predicted peak memory of that process.
    pub bytes: f64,
    /// The job that runs it.
    pub job: usize,
}

/// A row of `jobs.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JobRow {
    /// Its number.
    pub job: usize,
    /// How many cases it runs.
    pub cases: usize,
    /// Predicted CPU seconds, reference runs included.
    pub seconds: f64,
    /// Predicted peak memory.
    pub bytes: f64,
    /// Memory to ask for, in MB of 2^20 bytes.
    pub mem_mb: u64,
    /// Time to ask for, in minutes.
    pub runtime: u64,
}

impl CaseRow {
    /// Its key in records.
    pub fn key(&self) -> Key {
        Key { scene: self.scene.clone(), n: self.n, steps: self.steps }
    }
}

/// The id of a case. A colon stands in no name of a scene.
pub fn id(key: &Key) -> String {
    match key.n {
        Some(n) => format!("{}:n{n}:N{}", key.scene, key.steps),
        None => format!("{}:N{}", key.scene, key.steps),
    }
}

impl PlannedScene {
    /// The scene with the file that it stands in, as it is now.
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

    /// The scene that was planned, from its text; `dir` is the plan's directory.
    ///
    /// # Errors
    /// [`PlanError::Scene`], [`PlanError::Malformed`] if text and hash do not belong together.
    pub(crate) fn scene(&self, dir: &Path) -> Result<Scene, PlanError> {
        let path = dir.join(PLAN);
        let mut source =
            Source::from_text(format!("{} ({})", path.display(), self.name), &*self.text);
        if let Some(mesh) = &self.mesh {
            source = source.with_mesh(mesh.clone());
        }
        let scene = Scene::from_source(source).map_err(Box::new)?;
        if scene.name != self.name || scene.source.hash != self.hash {
            let reason = format!("the text of `{}` is not the one that was planned", self.name);
            return Err(PlanError::Malformed { path, reason });
        }
        Ok(scene)
    }

    /// Refuses a scene whose file says something else than the plan. A file that is not on this machine says nothing.
    ///
    /// # Errors
    /// [`PlanError::Changed`].
    pub(crate) fn unchanged(&self) -> Result<(), PlanError> {
        if !self.file.is_file() {
            return Ok(());
        }
        let found = Scene::read(&self.file).map_err(|_| "one with errors".to_owned());
        let found = found.map_or_else(|error| error, |scene| scene.source.hash);
        if found == self.hash {
            return Ok(());
        }
        let (path, scene, planned) = (self.file.clone(), self.name.clone(), self.hash.clone());
        Err(PlanError::Changed { path, scene, planned, found })
    }
}

impl Plan {
    /// Reads the plan in `dir`.
    ///
    /// # Errors
    /// [`PlanError`]; a plan of another version is refused.
    pub fn read(dir: &Path) -> Result<Self, PlanError> {
        let path = dir.join(PLAN);
        let text =
            read_text(&path).map_err(|source| PlanError::Io { path: path.clone(), source })?;
        let plan: Self = serde_json::from_str(&text).map_err(|error| PlanError::Malformed {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        let own = env!("CARGO_PKG_VERSION");
        if plan.version != own {
            return Err(PlanError::Version { path, found: plan.version, own: own.to_owned() });
        }
        Ok(plan)
    }

    /// Writes the plan with its tables into `dir`, plan.json last: without it there is no plan.
    ///
    /// # Errors
    /// [`PlanError::Io`].
    pub(crate) fn write(
        &self,
        dir: &Path,
        cases: impl Iterator<Item = CaseRow>,
        jobs: impl Iterator<Item = JobRow>,
    ) -> Result<(), PlanError> {
        table(&dir.join(CASES), cases)?;
        table(&dir.join(JOBS), jobs)?;
        let path = dir.join(PLAN);
        let text = serde_json::to_vec_pretty(self).map_err(|error| PlanError::Malformed {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        replace_file(&path, &text).map_err(|source| PlanError::Io { path, source })
    }

    /// Grids in place of the scenes' own.
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides { n: self.n.clone(), steps: self.steps.clone() }
    }

    /// A scene of the plan by its name.
    pub(crate) fn planned(&self, name: &str) -> Option<&PlannedScene> {
        self.scenes.iter().find(|scene| scene.name == name)
    }

    /// The rows of `plan.csv` with one of these ids, or of one of these jobs.
    ///
    /// # Errors
    /// [`PlanError::Unknown`] if one of them is not there.
    pub fn rows(
        &self,
        dir: &Path,
        ids: &[String],
        jobs: &[usize],
    ) -> Result<Vec<CaseRow>, PlanError> {
        let path = dir.join(CASES);
        let mut ids: BTreeSet<&str> = ids.iter().map(String::as_str).collect();
        let mut left: BTreeSet<usize> = jobs.iter().copied().collect();
        // Jobs stand one after the other.
        let last = jobs.iter().max().filter(|_| ids.is_empty()).copied();
        let mut found = Vec::new();
        for row in rows(&path)? {
            let row = row?;
            if last.is_some_and(|last| row.job > last) {
                break;
            }
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
        Err(PlanError::Unknown { path, what: unknown, cases: self.cases })
    }
}

/// The rows of a `plan.csv`, one after the other.
///
/// # Errors
/// [`PlanError::Io`]; a malformed row is the error of its item.
pub(crate) fn rows(
    path: &Path,
) -> Result<impl Iterator<Item = Result<CaseRow, PlanError>> + use<>, PlanError> {
    let path = path.to_owned();
    let file = open_file(&path).map_err(|source| PlanError::Io { path: path.clone(), source })?;
    let table = csv::Reader::from_reader(BufReader::new(file));
    let malformed = move |error: csv::Error| PlanError::Malformed {
        path: path.clone(),
        reason: error.to_string(),
    };
    Ok(table.into_deserialize().map(move |row| row.map_err(&malformed)))
}

/// Writes a table in one piece, row by row.
fn table<R: Serialize>(path: &Path, rows: impl Iterator<Item = R>) -> Result<(), PlanError> {
    let write = || -> io::Result<()> {
        let mut table = csv::Writer::from_writer(Replacement::create(path)?);
        for row in rows {
            table.serialize(row)?;
        }
        table.into_inner().map_err(|error| error.into_error())?.finish()
    };
    write().map_err(|source| PlanError::Io { path: path.to_owned(), source })
}
