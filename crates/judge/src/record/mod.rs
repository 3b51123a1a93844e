//! What one case produced: the waist between computing and judging.
//!
//! A case is one solve of one scene on one mesh (`n`) with one time grid (`steps`). It yields
//! one error for each norm, and in `cases.csv` one row for each of them.

mod journal;
mod norm;
mod row;
mod stream;

use std::io;
use std::path::PathBuf;

use files::counted;

pub use journal::{Journal, Table, read, read_table, write_sorted};
pub use norm::{
    CONTACT_MEASURE_MAX, CONTACT_SET_MAX, L2_MAX, NORMS, PRESSURE_L2_MAX, STRESS_L2_MAX,
    TRACE_L2_MAX, V_MAX, V_PROJECTION_MAX, V_TIME_MAX, is_by_state, norm_label, norm_label_in_time,
    norm_rank,
};
pub use row::COLUMNS;
pub use stream::{CaseStream, TableWriter};

/// What identifies a case. `n` is absent for abstract scenes, which have no mesh.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key {
    /// Name of the scene.
    pub scene: String,
    /// Mesh cells per unit length, or level of red refinement of an imported mesh.
    pub n: Option<u32>,
    /// Number N of time steps.
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

/// How a case ended. Only a converged case carries errors.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Status {
    /// All time steps were solved.
    Converged,
    /// The solver gave up. `cases.csv` keeps the status, `verdict.json` the reason:
    /// read back from the table alone, `reason` is empty.
    Failed {
        /// What the solver said.
        reason: String,
    },
    /// Planned, but not run.
    Skipped,
}

/// Error of one case in one norm, with the floor below which it means nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct NormError {
    /// One of [`NORMS`], or a name of the caller's.
    pub norm: String,
    /// The error; absent if it could not be measured.
    pub error: Option<f64>,
    /// An upper estimate of what in the error is not the discretisation: solver, rounding,
    /// quadrature, reference; absent if there is none.
    pub floor: Option<f64>,
}

/// Everything one case produced. Only the `seconds_*` may differ between two runs.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseRecord {
    /// Name of the scene.
    pub scene: String,
    /// Space dimension; 0 for abstract scenes.
    pub dimension: u32,
    /// Mesh cells per unit length; see [`Key::n`].
    pub n: Option<u32>,
    /// Number N of time steps.
    pub steps: u32,
    /// Mesh size, 1/n or the longest edge; absent without a mesh.
    pub h: Option<f64>,
    /// Time step T/N, or the largest step of a non-uniform grid.
    pub k: f64,
    /// Unknowns of one time step.
    pub dofs: u64,
    /// Elements of the mesh.
    pub elements: u64,
    /// How the case ended.
    pub status: Status,
    /// Newton iterations over all steps.
    pub newton_iterations: u64,
    /// Changes of the active set over all steps.
    pub active_set_changes: u64,
    /// Factorizations over all steps.
    pub factorizations: u64,
    /// Seconds spent on loads during the march; not what they share with the moments of the truth.
    pub seconds_load: f64,
    /// Seconds spent on assembly.
    pub seconds_assemble: f64,
    /// Seconds spent on factorizations.
    pub seconds_factor: f64,
    /// Seconds spent on solves.
    pub seconds_solve: f64,
    /// Seconds of the whole case.
    pub seconds_total: f64,
    /// Largest storage of the history term, in bytes.
    pub peak_history_bytes: u64,
    /// One entry per norm.
    pub errors: Vec<NormError>,
}

impl CaseRecord {
    /// A case on which no work was done: skipped, without errors, of dimension 0.
    pub fn without_work(scene: &str, n: Option<u32>, steps: u32, k: f64) -> Self {
        Self {
            scene: scene.into(),
            dimension: 0,
            n,
            steps,
            h: n.map(|n| 1.0 / f64::from(n)),
            k,
            dofs: 0,
            elements: 0,
            status: Status::Skipped,
            newton_iterations: 0,
            active_set_changes: 0,
            factorizations: 0,
            seconds_load: 0.0,
            seconds_assemble: 0.0,
            seconds_factor: 0.0,
            seconds_solve: 0.0,
            seconds_total: 0.0,
            peak_history_bytes: 0,
            errors: Vec::new(),
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

    /// Names of the norms present, in their order in the table. An interrupted write may have
    /// lost the last ones: compare with the norms the scene asks for before trusting a case.
    pub fn norms(&self) -> impl Iterator<Item = &str> {
        self.errors.iter().map(|entry| entry.norm.as_str())
    }

    /// An entry that no measurement gives: an error that is negative or not finite, a floor that is negative or NaN.
    pub fn unsound(&self) -> Option<&NormError> {
        let sound = |entry: &&NormError| {
            entry.error.is_none_or(|error| error.is_finite() && error >= 0.0)
                && entry.floor.is_none_or(|floor| floor >= 0.0)
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
    /// The file system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The file exists, and is something else: it is left as it is.
    #[error("{}: not a table of cases (its header is {found:?})", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// The beginning of its first line.
        found: String,
    },
    /// A table that should be whole ends within a line.
    #[error("{}: the last line is cut off", path.display())]
    Torn {
        /// The file.
        path: PathBuf,
    },
    /// A row is not the one that was written.
    #[error("{}:{line}: the row was changed after it was written (its checksum is another); `sweep run --resume` runs its case again", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
    },
    /// The table is no longer where it was begun.
    #[error("{}: the table was removed or replaced while the sweep wrote it: its records are lost; run the sweep again", path.display())]
    Gone {
        /// The file.
        path: PathBuf,
    },
    /// A line in the middle of the file has the wrong number of fields.
    #[error("{}:{line}: {}, a row has {}", path.display(), counted(*found, "field"), COLUMNS.len())]
    Fields {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// Number of fields found.
        found: usize,
    },
    /// A field does not read as what its column holds.
    #[error("{}:{line}: {value:?} is no value of the column {column}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Line number, from 1.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// The text found.
        value: String,
    },
    /// A name with a line break in it would tear the table.
    #[error("the name {name:?} cannot stand in a table: it has a line break")]
    Name {
        /// The scene or norm.
        name: String,
    },
}
