//! `verdict.json`: verdicts, provenance and reasons of failed cases.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{Comparison, Foreseen, ForeseenConstant, Variable, Verdict};
use crate::record::{CaseRecord, Key, Status};
use files::{FileError, if_there, read_file, replace_file};

/// A case that did not converge, with the solver's reason, for which `cases.csv` has no column.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Failure {
    #[serde(flatten)]
    pub key: Key,
    pub reason: String,
}

/// Why verdicts could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    #[error(transparent)]
    Io(#[from] FileError),
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
    #[serde(skip_serializing_if = "Option::is_none")]
    cause: Option<&'a Explanation>,
}

/// What an answer of a solver under test has wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// It solves the discrete equations of the scene.
    Nothing,
    /// Some levels are not solved.
    Levels,
    Elasticity,
    /// A plane of symmetry is held along itself.
    Symmetry,
    Loads,
    Memory,
    Projection,
    Contact,
    Friction,
    Pressures,
}

/// Why a solver under test is wrong, as its answers show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    pub cause: Cause,
    /// In a sentence.
    pub says: String,
    /// What it is concluded from.
    pub numbers: String,
    /// Whether the numbers fit it well.
    pub fits: bool,
}

impl Explanation {
    /// The sentence, with its doubt.
    pub fn in_words(&self) -> String {
        format!("{}{}", if self.fits { "" } else { "perhaps " }, self.says)
    }
}

#[derive(Deserialize)]
struct Judged {
    scene: String,
    norm: String,
    variable: Variable,
    #[serde(default)]
    foreseen: Option<Foreseen>,
    #[serde(default)]
    other_error: Option<f64>,
}

#[derive(Deserialize)]
struct Written {
    #[serde(default)]
    failures: Vec<Failure>,
    #[serde(default)]
    verdicts: Vec<Judged>,
    #[serde(default)]
    cause: Option<Explanation>,
}

/// What an earlier `verdict.json` knows beyond the records.
#[derive(Debug, Default)]
pub struct Earlier {
    pub failures: Vec<Failure>,
    /// Predicted constants, to judge records again without the scenes' exact solutions.
    pub foreseen: Vec<ForeseenConstant>,
    pub cause: Option<Explanation>,
}

/// Failed cases, sorted by key.
pub fn failures(records: &[CaseRecord]) -> Vec<Failure> {
    let failure = |record: &CaseRecord| match &record.status {
        Status::Failed { reason } => Some(Failure { key: record.key(), reason: reason.clone() }),
        _ => None,
    };
    let mut failed: Vec<Failure> = records.iter().filter_map(failure).collect();
    failed.sort();
    failed
}

/// The content of `verdict.json`. Non-finite numbers become null.
pub fn document(
    provenance: &serde_json::Value,
    verdicts: &[Verdict],
    records: &[CaseRecord],
    baseline: Option<&Comparison>,
    cause: Option<&Explanation>,
) -> serde_json::Value {
    let document = Document { provenance, verdicts, failures: failures(records), baseline, cause };
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
    cause: Option<&Explanation>,
) -> Result<(), DocumentError> {
    let document = document(provenance, verdicts, records, baseline, cause);
    let mut bytes = serde_json::to_vec_pretty(&document)
        .map_err(|source| DocumentError::Json { path: path.to_owned(), source })?;
    bytes.push(b'\n');
    Ok(replace_file(path, &bytes)?)
}

/// Reads an earlier `verdict.json`, if there is one.
pub fn read_earlier(path: &Path) -> Result<Earlier, DocumentError> {
    let Some(bytes) = if_there(read_file(path))? else { return Ok(Earlier::default()) };
    let Written { failures, verdicts, cause } = serde_json::from_slice(&bytes)
        .map_err(|source| DocumentError::Json { path: path.to_owned(), source })?;
    let with = |Judged { scene, norm, variable, foreseen, other_error }: Judged| {
        foreseen.map(|foreseen| ForeseenConstant { scene, norm, variable, foreseen, other_error })
    };
    let foreseen = verdicts.into_iter().filter_map(with).collect();
    Ok(Earlier { failures, foreseen, cause })
}

/// Restores the reasons of failed cases read from `cases.csv`.
pub fn restore_reasons(records: &mut [CaseRecord], failures: &[Failure]) {
    for record in records {
        let key = record.key();
        if let Status::Failed { reason } = &mut record.status
            && reason.is_empty()
            && let Some(failure) = failures.iter().find(|failure| failure.key == key)
        {
            reason.clone_from(&failure.reason);
        }
    }
}
