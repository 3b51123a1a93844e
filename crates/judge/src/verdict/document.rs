//! `verdict.json`: verdicts, provenance and reasons of failed cases.

use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{Comparison, Foreseen, ForeseenConstant, Variable, Verdict};
use crate::record::{CaseRecord, Key, Status};
use files::{read_file, replace_file};

/// A case that did not converge, with the solver's reason, for which `cases.csv` has no column.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    pub scene: String,
    pub n: Option<u32>,
    pub steps: u32,
    pub reason: String,
}

/// Why verdicts could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: io::Error },
    #[error("{}: {source}", path.display())]
    Json { path: PathBuf, source: serde_json::Error },
}

#[derive(Serialize)]
struct Document<'a> {
    provenance: &'a serde_json::Value,
    verdicts: &'a [Verdict],
    failures: Vec<Failure>,
    #[serde(skip_serializing_if = "Option::is_none")]
    baseline: Option<&'a Comparison>,
}

#[derive(Deserialize)]
struct Failures {
    #[serde(default)]
    failures: Vec<Failure>,
}

#[derive(Deserialize)]
struct Judged {
    scene: String,
    norm: String,
    variable: Variable,
    #[serde(default)]
    foreseen: Option<Foreseen>,
}

#[derive(Deserialize)]
struct Verdicts {
    #[serde(default)]
    verdicts: Vec<Judged>,
}

/// Failed cases, sorted by key.
pub fn failures(records: &[CaseRecord]) -> Vec<Failure> {
    let reason = |record: &CaseRecord| match &record.status {
        Status::Failed { reason } => Some(reason.clone()),
        _ => None,
    };
    let mut failed: Vec<(Key, String)> =
        records.iter().filter_map(|record| Some((record.key(), reason(record)?))).collect();
    failed.sort();
    let plain = |(Key { scene, n, steps }, reason)| Failure { scene, n, steps, reason };
    failed.into_iter().map(plain).collect()
}

/// The content of `verdict.json`. Non-finite numbers become null.
pub fn document(
    provenance: &serde_json::Value,
    verdicts: &[Verdict],
    records: &[CaseRecord],
    baseline: Option<&Comparison>,
) -> serde_json::Value {
    let document = Document { provenance, verdicts, failures: failures(records), baseline };
    serde_json::json!(document)
}

/// Writes `verdict.json` atomically. Non-finite numbers become null.
///
/// # Errors
/// [`DocumentError::Io`]; [`DocumentError::Json`] cannot occur for these types.
pub fn write_json(
    path: &Path,
    provenance: &serde_json::Value,
    verdicts: &[Verdict],
    records: &[CaseRecord],
    baseline: Option<&Comparison>,
) -> Result<(), DocumentError> {
    let document = Document { provenance, verdicts, failures: failures(records), baseline };
    let mut bytes = serde_json::to_vec_pretty(&document)
        .map_err(|source| DocumentError::Json { path: path.to_owned(), source })?;
    bytes.push(b'\n');
    replace_file(path, &bytes).map_err(|source| DocumentError::Io { path: path.to_owned(), source })
}

/// Reads the failures of an earlier `verdict.json`.
pub fn read_failures(path: &Path) -> Result<Vec<Failure>, DocumentError> {
    read::<Failures>(path).map(|read| read.failures)
}

/// Reads the predicted constants of an earlier `verdict.json`, to judge records again without the scenes' exact
/// solutions.
pub fn read_foreseen(path: &Path) -> Result<Vec<ForeseenConstant>, DocumentError> {
    let with = |judged: Judged| {
        let Judged { scene, norm, variable, foreseen } = judged;
        foreseen.map(|foreseen| ForeseenConstant { scene, norm, variable, foreseen })
    };
    read::<Verdicts>(path).map(|read| read.verdicts.into_iter().filter_map(with).collect())
}

fn read<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, DocumentError> {
    let bytes =
        read_file(path).map_err(|source| DocumentError::Io { path: path.to_owned(), source })?;
    serde_json::from_slice(&bytes)
        .map_err(|source| DocumentError::Json { path: path.to_owned(), source })
}

/// Restores the reasons of failed cases read from `cases.csv`.
pub fn restore_reasons(records: &mut [CaseRecord], failures: &[Failure]) {
    for record in records {
        let key = record.key();
        let same = |failure: &&Failure| {
            failure.scene == key.scene && failure.n == key.n && failure.steps == key.steps
        };
        if let Status::Failed { reason } = &mut record.status
            && reason.is_empty()
            && let Some(failure) = failures.iter().find(same)
        {
            reason.clone_from(&failure.reason);
        }
    }
}
