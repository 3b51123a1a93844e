//! Recorded baseline of errors and work, a second check after the predictions: a constant factor in an error changes no
//! order, but differs from its recorded value.

mod changes;
mod compare;
mod left_owing;
mod owed;
mod tolerance;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use compare::{ComparedRun, Comparison, Deviation, DeviationKind};
pub use owed::{Owed, Owing};

use super::MeshAndSteps;
use crate::record::{CaseRecord, NormError};
use files::{FileError, if_there, read_at_most, write_named};

/// Size limit of a baseline, 256 MiB; a case takes a few hundred bytes.
const LARGEST: u64 = 256 << 20;

/// Errors below this many floors may be rounding and are not recorded. An order needs 20, but quadrature and reference
/// errors repeat exactly.
const FLOORS_COUNTED: f64 = 4.0;
/// Norms that jump by a sample on ties.
const JUMPING: [&str; 2] = [crate::record::CONTACT_SET_MAX, crate::record::CONTACT_MEASURE_MAX];

/// Why a baseline could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    #[error(transparent)]
    Io(#[from] FileError),
    #[error("{}: {source}; `sweep baseline` writes it anew", path.display())]
    Json { path: PathBuf, source: serde_json::Error },
}

/// Errors and work of cases, by scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    pub scenes: BTreeMap<String, Recorded>,
}

/// One scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Hash of the scene file that was run.
    pub hash: String,
    /// Verdicts owed on the scene's default grids; absent in older baselines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owes: Option<Vec<Owed>>,
    pub cases: Vec<RecordedCase>,
}

/// One case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedCase {
    /// Mesh cells per unit length; none without a mesh.
    pub n: Option<u32>,
    pub steps: u32,
    /// Newton iterations over all steps.
    pub newton_iterations: u64,
    pub factorizations: u64,
    /// Absent in older baselines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub active_set_changes: Option<u64>,
    /// Largest bytes of the history; absent in older baselines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub history_bytes: Option<u64>,
    /// Error per norm, to nine digits.
    pub errors: BTreeMap<String, f64>,
    /// Relative deviations allowed beyond the general one, for errors near their floors.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub allowed: BTreeMap<String, f64>,
}

impl Baseline {
    /// The baseline of a run; `hashes` pairs scenes with the hashes of their files. [`Baseline::owing`] adds what they
    /// owe.
    pub fn of(records: &[CaseRecord], hashes: &[(&str, &str)]) -> Self {
        let cases = |scene: &str| -> Vec<RecordedCase> {
            let mut of_scene: Vec<&CaseRecord> =
                records.iter().filter(|r| r.scene == scene && r.converged()).collect();
            of_scene.sort_by_key(|record| record.key());
            let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
            for entry in of_scene.iter().flat_map(|record| &record.errors) {
                let most = largest.entry(&entry.norm).or_default();
                *most = most.max(entry.error.unwrap_or(0.0));
            }
            of_scene.iter().map(|record| RecordedCase::of(record, &largest)).collect()
        };
        let scenes = hashes.iter().map(|&(name, hash)| {
            (name.to_owned(), Recorded { hash: hash.to_owned(), owes: None, cases: cases(name) })
        });
        Self { scenes: scenes.collect() }
    }

    /// Reads a baseline; none if there is no file.
    pub fn read(path: &Path) -> Result<Option<Self>, BaselineError> {
        let bytes = if_there(read_at_most(path, LARGEST))?;
        bytes.map(|bytes| Self::parse(path, &bytes)).transpose()
    }

    /// Parses a baseline; `path` is for messages.
    ///
    /// # Errors
    /// [`BaselineError::Json`].
    pub fn parse(path: &Path, text: &[u8]) -> Result<Self, BaselineError> {
        serde_json::from_slice(text)
            .map_err(|source| BaselineError::Json { path: path.to_owned(), source })
    }

    /// Writes atomically, a line per case, ordered by scene, n and steps.
    pub fn write(&self, path: &Path) -> Result<(), BaselineError> {
        let json = |source| BaselineError::Json { path: path.to_owned(), source };
        let mut scenes = Vec::new();
        for (name, recorded) in &self.scenes {
            let lines: Result<Vec<String>, _> =
                recorded.cases.iter().map(serde_json::to_string).collect();
            let lines = lines.map_err(json)?.join(",\n");
            let name = serde_json::to_string(name).map_err(json)?;
            let hash = serde_json::to_string(&recorded.hash).map_err(json)?;
            let owes = match &recorded.owes {
                None => String::new(),
                Some(owes) => {
                    format!("\"owes\": {}, ", serde_json::to_string(owes).map_err(json)?)
                }
            };
            let heading = format!("{name}: {{\"hash\": {hash}, {owes}\"cases\": [");
            scenes.push(format!("{heading}\n{lines}\n]}}"));
        }
        let text = format!("{{\"scenes\": {{\n{}\n}}}}\n", scenes.join(",\n"));
        Ok(write_named(path, text.as_bytes())?)
    }
}

impl RecordedCase {
    /// `largest` are the largest errors of the scene by norm.
    fn of(record: &CaseRecord, largest: &BTreeMap<&str, f64>) -> Self {
        let kept = |entry: &&NormError| {
            let (error, floor) = (entry.error.unwrap_or(f64::NAN), entry.floor.unwrap_or(0.0));
            error.is_finite() && error > 0.0 && error >= FLOORS_COUNTED * floor
        };
        let kept: Vec<&NormError> = record.errors.iter().filter(kept).collect();
        let errors = kept.iter().filter_map(|entry| Some((entry.norm.clone(), nine(entry.error?))));
        let allowed = kept.iter().filter_map(|entry| {
            let (norm, error) = (entry.norm.as_str(), entry.error?);
            let allowed = match record.h.filter(|_| JUMPING.contains(&norm)) {
                Some(h) => tolerance::of_sets(error, h, record.dimension),
                None => tolerance::allowed(error, entry.floor?, largest.get(norm).copied()?),
            };
            (allowed > tolerance::REPEATED_WITHIN).then(|| (entry.norm.clone(), nine(allowed)))
        });
        Self {
            n: record.n,
            steps: record.steps,
            newton_iterations: record.newton_iterations,
            factorizations: record.factorizations,
            active_set_changes: Some(record.active_set_changes),
            history_bytes: Some(record.peak_history_bytes),
            errors: errors.collect(),
            allowed: allowed.collect(),
        }
    }

    /// Work with its names in records and in words; None where an older baseline has none.
    fn work(&self) -> [(&'static str, &'static str, Option<u64>); 4] {
        [
            ("newton_iterations", "Newton iterations", Some(self.newton_iterations)),
            ("factorizations", "factorizations", Some(self.factorizations)),
            ("active_set_changes", "changes of the active set", self.active_set_changes),
            ("peak_history_bytes", "bytes of history", self.history_bytes),
        ]
    }

    fn is_case(&self, n: Option<u32>, steps: u32) -> bool {
        (self.n, self.steps) == (n, steps)
    }

    /// `n = 8, steps = 16`.
    fn name(&self) -> String {
        MeshAndSteps { n: self.n, steps: self.steps }.to_string()
    }
}

/// Rounds to nine digits: three more than a comparison uses, so that the file is the same on other machines.
fn nine(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests;
