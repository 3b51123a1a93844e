//! The recorded baseline: errors and work of every case as they once were, the second line behind predictions.
//!
//! A factor in an error that no theorem predicts moves no order; against its recorded value it shows.

mod compare;
mod owed;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use compare::{Comparison, Deviation, DeviationKind, Run, compare_with_baseline};
pub use owed::{Owed, Owing, compare_owed};

use crate::record::{CaseRecord, Key, NormError};
use files::{read_at_most, write_named};

/// The longest baseline that is read, in bytes (256 MiB): a case takes a few hundred.
const LARGEST: u64 = 256 << 20;

/// An error below this many of its floors may be rounding, and is not recorded. It takes 20 to carry an
/// order; but what quadrature and reference add is the same in every run, so fewer do here.
const FLOORS_COUNTED: f64 = 4.0;
/// Norms whose value jumps by a sample where two numbers tie: no baseline holds across machines.
const JUMPING: [&str; 2] = [crate::record::CONTACT_SET_MAX, crate::record::CONTACT_MEASURE_MAX];

/// Why a baseline could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum BaselineError {
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Not a baseline.
    #[error("{}: {source}; `sweep baseline` writes it anew", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What the parser said.
        source: serde_json::Error,
    },
}

/// Errors and work of cases, by scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Baseline {
    /// The scenes by name.
    pub scenes: BTreeMap<String, Recorded>,
}

/// One scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recorded {
    /// Hash of the scene file that was run.
    pub hash: String,
    /// The verdicts that a run on its own grids has to judge; none where a baseline does not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owes: Option<Vec<Owed>>,
    /// Its cases, by n and steps.
    pub cases: Vec<RecordedCase>,
}

/// One case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedCase {
    /// Mesh cells per unit length; none without a mesh.
    pub n: Option<u32>,
    /// Number of time steps.
    pub steps: u32,
    /// Newton iterations over all steps.
    pub newton_iterations: u64,
    /// Factorizations over all steps.
    pub factorizations: u64,
    /// Changes of the active set over all steps; none where a baseline does not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub active_set_changes: Option<u64>,
    /// Largest bytes of the history, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub history_bytes: Option<u64>,
    /// The error in each norm, to nine digits.
    pub errors: BTreeMap<String, f64>,
    /// Relative deviations allowed beyond the general one, of errors near their floors.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub allowed: BTreeMap<String, f64>,
}

impl Baseline {
    /// The baseline of a run: `hashes` are the scenes with the hashes of their files. [`Baseline::owing`] adds what they
    /// owe.
    pub fn of(records: &[CaseRecord], hashes: &[(&str, &str)]) -> Self {
        let cases = |scene: &str| -> Vec<RecordedCase> {
            let mut own: Vec<&CaseRecord> =
                records.iter().filter(|r| r.scene == scene && r.converged()).collect();
            own.sort_by_key(|record| record.key());
            own.into_iter().map(RecordedCase::of).collect()
        };
        let scenes = hashes.iter().map(|&(name, hash)| {
            (name.to_owned(), Recorded { hash: hash.to_owned(), owes: None, cases: cases(name) })
        });
        Self { scenes: scenes.collect() }
    }

    /// The baseline without cases that were not to be run.
    #[must_use]
    pub fn without(mut self, held: &[Key]) -> Self {
        for (scene, recorded) in &mut self.scenes {
            let is_held = |case: &RecordedCase| {
                let own = |key: &&Key| (key.n, key.steps) == (case.n, case.steps);
                held.iter().filter(own).any(|key| key.scene == *scene)
            };
            recorded.cases.retain(|case| !is_held(case));
        }
        self
    }

    /// Reads a baseline; none if there is no file.
    ///
    /// # Errors
    /// [`BaselineError`].
    pub fn read(path: &Path) -> Result<Option<Self>, BaselineError> {
        let bytes = match read_at_most(path, LARGEST) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(BaselineError::Io { path: path.to_owned(), source }),
        };
        Self::parse(path, &bytes).map(Some)
    }

    /// The baseline of a text; `path` stands for it in messages.
    ///
    /// # Errors
    /// [`BaselineError::Json`].
    pub fn parse(path: &Path, text: &[u8]) -> Result<Self, BaselineError> {
        serde_json::from_slice(text)
            .map_err(|source| BaselineError::Json { path: path.to_owned(), source })
    }

    /// Writes it in one piece, a line per case, in the order of scenes, n and steps.
    ///
    /// # Errors
    /// [`BaselineError`].
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
        write_named(path, text.as_bytes())
            .map_err(|source| BaselineError::Io { path: path.to_owned(), source })
    }

    /// What a new baseline changes in this one, a line each; nothing if nothing.
    pub fn changes(&self, new: &Baseline) -> Vec<String> {
        let mut lines = Vec::new();
        for name in self.scenes.keys().filter(|name| !new.scenes.contains_key(*name)) {
            lines.push(format!("{name}: removed"));
        }
        for (name, recorded) in &new.scenes {
            match self.scenes.get(name) {
                None => lines.push(format!("{name}: new, {} cases", recorded.cases.len())),
                Some(old) => lines.extend(changes_of_scene(name, old, recorded)),
            }
        }
        lines
    }
}

impl RecordedCase {
    fn of(record: &CaseRecord) -> Self {
        let kept = |entry: &&NormError| {
            let (error, floor) = (entry.error.unwrap_or(f64::NAN), entry.floor.unwrap_or(0.0));
            let counts = error.is_finite() && error > 0.0 && error >= FLOORS_COUNTED * floor;
            counts && !JUMPING.contains(&entry.norm.as_str())
        };
        let kept: Vec<&NormError> = record.errors.iter().filter(kept).collect();
        let errors = kept.iter().filter_map(|entry| Some((entry.norm.clone(), nine(entry.error?))));
        let allowed = kept.iter().filter_map(|entry| {
            let allowed = compare::allowed(entry.error?, entry.floor?);
            (allowed > compare::REPEATED_WITHIN).then(|| (entry.norm.clone(), nine(allowed)))
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

    /// The case as messages name it.
    fn name(&self) -> String {
        compare::case_name(self.n, self.steps)
    }
}

/// Nine digits: three more than a comparison uses, so that the last ones of another machine do not
/// change the file.
fn nine(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

fn changes_of_scene(name: &str, old: &Recorded, new: &Recorded) -> Vec<String> {
    let mut lines = Vec::new();
    if old.hash != new.hash {
        lines.push(format!("{name}: the scene file changed"));
    }
    lines.extend(owed::changes_of_owed(name, old, new));
    let find = |cases: &[RecordedCase], like: &RecordedCase| {
        cases.iter().find(|case| (case.n, case.steps) == (like.n, like.steps)).cloned()
    };
    for case in &old.cases {
        if find(&new.cases, case).is_none() {
            lines.push(format!("{name}, {}: removed", case.name()));
        }
    }
    for case in &new.cases {
        let Some(before) = find(&old.cases, case) else {
            lines.push(format!("{name}, {}: new", case.name()));
            continue;
        };
        let norms = before
            .errors
            .keys()
            .chain(case.errors.keys().filter(|norm| !before.errors.contains_key(*norm)));
        for norm in norms {
            let (was, is) = (before.errors.get(norm), case.errors.get(norm));
            if was != is {
                let shown =
                    |value: Option<&f64>| value.map_or("none".into(), |v| format!("{v:.6e}"));
                let percent = was.zip(is).map_or(String::new(), |(was, is)| {
                    format!(" ({})", compare::in_percent(is / was - 1.0))
                });
                let (was, is) = (shown(was), shown(is));
                lines.push(format!("{name}, {}: {norm} {was} -> {is}{percent}", case.name()));
            }
        }
        for (what, was, is) in [
            ("Newton iterations", Some(before.newton_iterations), Some(case.newton_iterations)),
            ("factorizations", Some(before.factorizations), Some(case.factorizations)),
            ("changes of the active set", before.active_set_changes, case.active_set_changes),
            ("bytes of history", before.history_bytes, case.history_bytes),
        ] {
            // What an older baseline does not say has not changed.
            if let (Some(was), Some(is)) = (was, is)
                && was != is
            {
                lines.push(format!("{name}, {}: {what} {was} -> {is}", case.name()));
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests;
