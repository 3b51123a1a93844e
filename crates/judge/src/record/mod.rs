//! Results of single cases, the interface between computing and judging.
//!
//! A case is one solve of a scene on one mesh (`n`) with one time grid (`steps`). It has one error per norm, and in
//! `cases.csv` one row per error.

mod columns;
mod journal;
mod norm;
mod row;

use std::path::PathBuf;

use files::{FileError, counted};
use fit::is_magnitude;
use serde::{Deserialize, Serialize};

pub use columns::COLUMNS;
pub use journal::{CaseTable, Journal, read, read_finished, read_table, write_sorted};
pub use norm::{
    CONTACT_MEASURE_MAX, CONTACT_SET_MAX, L2_MAX, NORMS, Norm, PRESSURE_L2_MAX, STRESS_L2_MAX,
    TRACE_L2_MAX, V_MAX, V_PROJECTION_MAX, V_TIME_MAX, is_by_state, norm_label, norm_label_in_time,
    norm_rank, norm_symbol,
};

/// What identifies a case. `n` is absent for abstract scenes, which have no mesh.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Key {
    pub scene: String,
    /// Mesh cells per unit length, or level of red refinement of an imported mesh.
    pub n: Option<u32>,
    pub steps: u32,
}

impl std::fmt::Display for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.n {
            Some(n) => write!(f, "n = {n}, steps = {}", self.steps),
            None => write!(f, "steps = {}", self.steps),
        }
    }
}

impl Key {
    /// As one word: `SCENE:nN:NSTEPS`, `SCENE:NSTEPS` without a mesh.
    pub fn word(&self) -> String {
        let Self { scene, n, steps } = self;
        n.map_or_else(|| format!("{scene}:N{steps}"), |n| format!("{scene}:n{n}:N{steps}"))
    }
}

/// A word that is no key of a case.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no case; pure-mild:n16:N4 and, without a mesh, abstract-smooth:N64 are")]
pub struct NoKey(String);

impl std::str::FromStr for Key {
    type Err = NoKey;

    fn from_str(word: &str) -> Result<Self, NoKey> {
        let number = |part: &str, letter| part.strip_prefix(letter)?.parse::<u32>().ok();
        let key = || {
            let (before, steps) = word.rsplit_once(':')?;
            let steps = number(steps, 'N')?;
            let (scene, n) = match before.rsplit_once(':') {
                Some((scene, n)) => (scene, Some(number(n, 'n')?)),
                None => (before, None),
            };
            (!scene.is_empty()).then(|| Self { scene: scene.to_owned(), n, steps })
        };
        key().ok_or_else(|| NoKey(word.to_owned()))
    }
}

/// How a case ended; only a converged case has errors.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Status {
    Converged,
    /// The solver gave up. `cases.csv` keeps the status, `verdict.json` the reason; read from the table, `reason` is
    /// empty.
    Failed {
        reason: String,
    },
    #[default]
    Skipped,
}

/// Error of one case in one norm, with the floor below which it means nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct NormError {
    /// One of [`NORMS`], or a name of the caller's.
    pub norm: String,
    /// The error; absent if it could not be measured.
    pub error: Option<f64>,
    /// Estimated upper bound of the part that is not discretisation: solver, rounding, quadrature, reference.
    pub floor: Option<f64>,
}

/// Results of one case. Only `seconds_*` may differ between two runs.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CaseRecord {
    pub scene: String,
    /// Space dimension; 0 for abstract scenes.
    pub dimension: u32,
    /// Mesh cells per unit length; see [`Key::n`].
    pub n: Option<u32>,
    pub steps: u32,
    /// Mesh size, 1/n or the longest edge.
    pub h: Option<f64>,
    /// Time step T/N, or the largest step of a non-uniform grid.
    pub k: f64,
    pub dofs: u64,
    pub elements: u64,
    pub status: Status,
    /// Newton iterations over all steps.
    pub newton_iterations: u64,
    /// Changes of the active set over all steps.
    pub active_set_changes: u64,
    pub factorizations: u64,
    /// Loads during the march, without what they share with the moments of the exact solution.
    pub seconds_load: f64,
    pub seconds_assemble: f64,
    pub seconds_factor: f64,
    pub seconds_solve: f64,
    pub seconds_total: f64,
    /// Largest storage of the history term, in bytes.
    pub peak_history_bytes: u64,
    pub errors: Vec<NormError>,
}

impl CaseRecord {
    /// A case without any work: skipped, no errors, dimension 0.
    pub fn without_work(scene: &str, n: Option<u32>, steps: u32, k: f64) -> Self {
        Self {
            scene: scene.into(),
            n,
            steps,
            h: n.map(|n| 1.0 / f64::from(n)),
            k,
            ..Self::default()
        }
    }

    /// The key of this case.
    pub fn key(&self) -> Key {
        Key { scene: self.scene.clone(), n: self.n, steps: self.steps }
    }

    /// The entry of a norm, if the case has one.
    pub fn norm(&self, norm: &str) -> Option<&NormError> {
        self.errors.iter().find(|entry| entry.norm == norm)
    }

    /// Norms present, in table order. An interrupted write may have lost the last ones: compare with what the scene
    /// asks for.
    pub fn norms(&self) -> impl Iterator<Item = &str> {
        self.errors.iter().map(|entry| entry.norm.as_str())
    }

    /// An entry no measurement gives: an error or a floor that is none, an error without a floor.
    pub fn unsound(&self) -> Option<&NormError> {
        let sound = |entry: &&NormError| {
            let (error, floor) = (entry.error.unwrap_or(0.0), entry.floor.unwrap_or(0.0));
            [error, floor].into_iter().all(is_magnitude)
                && (entry.error.is_none() || entry.floor.is_some())
        };
        self.errors.iter().find(|entry| !sound(entry))
    }

    /// Whether the case converged.
    pub fn converged(&self) -> bool {
        self.status == Status::Converged
    }
}

/// Why records could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    #[error(transparent)]
    Io(#[from] FileError),
    /// The file exists and is something else; it is left untouched.
    #[error("{}: not a table of cases (its header is {found:?})", path.display())]
    Header {
        path: PathBuf,
        /// Beginning of its first line.
        found: String,
    },
    /// A finished table ends within a line.
    #[error("{}: the last line is cut off", path.display())]
    Torn { path: PathBuf },
    /// A row fails its checksum.
    #[error("{}:{line}: the row was changed after it was written (its checksum is another); `sweep run --resume` runs its case again", path.display())]
    Changed { path: PathBuf, line: u64 },
    /// The table is no longer at its path.
    #[error("{}: the table was removed or replaced while the sweep wrote it: its records are lost; run the sweep again", path.display())]
    Gone { path: PathBuf },
    /// A line in the middle has the wrong number of fields.
    #[error("{}:{line}: {}, a row has {}", path.display(), counted(*found, "field"), COLUMNS.len())]
    Fields { path: PathBuf, line: u64, found: usize },
    /// A field does not parse as its column's type.
    #[error("{}:{line}: {value:?} is no value of the column {column}", path.display())]
    Value { path: PathBuf, line: u64, column: &'static str, value: String },
    /// A line break in a name would break the table.
    #[error("the name {name:?} cannot stand in a table: it has a line break")]
    Name { name: String },
}
