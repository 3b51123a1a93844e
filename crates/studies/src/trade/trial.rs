//! One row of the trade: a knob, a mesh, a number of steps, and what came of it.

use std::io;
use std::path::PathBuf;

use serde::{Serialize, Serializer};

use super::pareto::{TIE, front};
use super::{Knob, Price};
use crate::table;
use files::{FileError, replace_file};

/// What one run cost and how wrong it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// The knob that is turned.
    pub knob: Knob,
    /// Cells per unit length.
    pub n: u32,
    /// Number N of time steps.
    pub steps: u32,
    /// Mesh size.
    pub h: f64,
    /// Largest time step.
    pub k: f64,
    /// Unknowns of a level.
    pub dofs: usize,
    /// A knob that changes neither time nor error: the run as written stands for it.
    pub tie: bool,
    /// No other run is as good in time and error, and better in one beyond a tie.
    pub front: bool,
    /// No other run is as good in time, error and memory, and better in one beyond a tie.
    pub front_memory: bool,
    /// The run, or why there is none.
    #[serde(flatten, serialize_with = "ended")]
    pub outcome: Result<Outcome, String>,
}

/// A run that came to its end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// Error in the norm of the trade.
    pub error: f64,
    /// What solver and rounding have of it.
    pub floor: f64,
    /// CPU seconds of the thread, the least of all repeats: mesh, analysis, loads and march.
    #[serde(rename = "cpu_seconds")]
    pub seconds: f64,
    /// The most of all repeats.
    #[serde(rename = "cpu_slowest")]
    pub slowest: f64,
    /// How often it was run.
    pub repeats: u32,
    /// The part of it that went into loads.
    pub load_share: f64,
    /// Peak memory of a process that does this run alone, predicted.
    #[serde(rename = "predicted_bytes")]
    pub bytes: f64,
    /// Bytes that the history took, counted.
    pub history_bytes: usize,
    /// Newton iterations of all levels.
    pub newton_iterations: u32,
    /// Factorizations of all levels.
    pub factorizations: u32,
}

impl Trial {
    /// The run, if it came to its end.
    pub(crate) fn done(&self) -> Option<&Outcome> {
        self.outcome.as_ref().ok()
    }
}

/// Marks the knobs that are ties, and the runs that no other beats in error and time, and in error, time and memory.
pub(super) fn mark_fronts(trials: &mut [Trial], prices: &[Price]) {
    for trial in &mut *trials {
        let of_trial = |price: &&Price| {
            price.what == trial.knob.name() && [price.n, price.steps] == [trial.n, trial.steps]
        };
        trial.tie = prices.iter().find(of_trial).is_some_and(Price::is_tie);
    }
    let place = |trial: &Trial| match trial.done().filter(|_| !trial.tie) {
        Some(run) => [run.seconds, run.bytes, run.error],
        None => [f64::NAN; 3],
    };
    let places: Vec<[f64; 3]> = trials.iter().map(place).collect();
    let flat: Vec<[f64; 2]> = places.iter().map(|&[seconds, _, error]| [seconds, error]).collect();
    front(&flat, TIE).into_iter().for_each(|i| trials[i].front = true);
    // What is on the front in two is not beaten in three.
    front(&places, TIE).into_iter().for_each(|i| trials[i].front_memory = true);
    trials.iter_mut().for_each(|trial| trial.front_memory |= trial.front);
}

/// A run with its status, or why there is none.
fn ended<S: Serializer>(
    outcome: &Result<Outcome, String>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    #[serde(tag = "status", rename_all = "lowercase")]
    enum Ended<'a> {
        Converged(&'a Outcome),
        Failed { reason: &'a str },
    }
    match outcome {
        Ok(run) => Ended::Converged(run).serialize(serializer),
        Err(reason) => Ended::Failed { reason }.serialize(serializer),
    }
}

/// The table of a trade on disk: a row is there as soon as its run ended.
pub struct Table {
    path: PathBuf,
    scene: String,
    norm: String,
}

impl Table {
    /// An empty table in place of an old one.
    ///
    /// # Errors
    /// The file system's.
    pub fn create(path: PathBuf, scene: &str, norm: &str) -> Result<Self, FileError> {
        let table = Self { path, scene: scene.into(), norm: norm.into() };
        table.write(&[])?;
        Ok(table)
    }

    /// Writes all rows anew: runs as written are timed again beside the knobs, after their rows were written.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn write(&self, trials: &[Trial]) -> Result<(), FileError> {
        let rows = trials.iter().map(|trial| row(&self.scene, &self.norm, trial));
        let bytes = table::csv(rows).map_err(io::Error::from).map_err(FileError::at(&self.path));
        replace_file(&self.path, &bytes?)
    }
}

fn row(scene: &str, norm: &str, trial: &Trial) -> [(&'static str, String); 20] {
    let done = |cell: fn(&Outcome) -> String| trial.done().map_or_else(String::new, cell);
    let reason = trial.outcome.as_ref().err();
    [
        ("scene", scene.into()),
        ("knob", trial.knob.name()),
        ("n", trial.n.to_string()),
        ("steps", trial.steps.to_string()),
        ("h", trial.h.to_string()),
        ("k", trial.k.to_string()),
        ("dofs", trial.dofs.to_string()),
        ("norm", norm.into()),
        ("error", done(|run| run.error.to_string())),
        ("floor", done(|run| run.floor.to_string())),
        ("cpu_seconds", done(|run| run.seconds.to_string())),
        ("cpu_slowest", done(|run| run.slowest.to_string())),
        ("repeats", done(|run| run.repeats.to_string())),
        ("load_share", done(|run| run.load_share.to_string())),
        ("predicted_bytes", done(|run| run.bytes.to_string())),
        ("history_bytes", done(|run| run.history_bytes.to_string())),
        ("newton_iterations", done(|run| run.newton_iterations.to_string())),
        ("factorizations", done(|run| run.factorizations.to_string())),
        ("status", if reason.is_none() { "converged" } else { "failed" }.into()),
        ("reason", reason.cloned().unwrap_or_default()),
    ]
}

#[cfg(test)]
pub(super) fn trial(knob: Knob, [n, steps]: [u32; 2], error: f64, seconds: f64) -> Trial {
    let outcome = Outcome {
        error,
        floor: 0.0,
        seconds,
        slowest: seconds,
        repeats: 1,
        load_share: 0.0,
        bytes: 0.0,
        history_bytes: 0,
        newton_iterations: 0,
        factorizations: 0,
    };
    Trial {
        knob,
        n,
        steps,
        h: 1.0 / f64::from(n),
        k: 1.0 / f64::from(steps),
        dofs: 0,
        tie: false,
        front: false,
        front_memory: false,
        outcome: Ok(outcome),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_there_at_once_and_failures_are_rows() {
        let path = std::env::temp_dir().join(format!("trade-{}.csv", std::process::id()));
        let table = Table::create(path.clone(), "block", "V_max").expect("a table");
        let failed = Trial {
            outcome: Err("no convergence, \"60\" iterations".into()),
            ..trial(Knob::Tolerance(1e-8), [4, 2], 0.0, 0.0)
        };
        let mut rows = Vec::new();
        for row in [trial(Knob::AsWritten, [4, 2], 0.5, 2.0), failed] {
            rows.push(row);
            table.write(&rows).expect("rows");
        }
        // What a killed program leaves.
        let mut reader = csv::Reader::from_path(&path).expect("a table");
        let head = reader.headers().expect("a head").clone();
        let rows: Vec<csv::StringRecord> =
            reader.records().map(|row| row.expect("a row")).collect();
        std::fs::remove_file(&path).expect("no file left");
        let at = |row: usize, name: &str| {
            rows[row][head.iter().position(|column| column == name).expect("a column")].to_owned()
        };
        assert_eq!(
            (rows.len(), at(0, "error"), at(0, "cpu_seconds")),
            (2, "0.5".into(), "2".into())
        );
        assert_eq!((at(0, "status"), at(1, "status")), ("converged".into(), "failed".into()));
        // A failed run carries no error and no time.
        assert_eq!((at(1, "error"), at(1, "cpu_seconds")), (String::new(), String::new()));
        assert_eq!(at(1, "reason"), "no convergence, \"60\" iterations");
    }
}
