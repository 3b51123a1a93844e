//! Runs with their errors and CPU seconds, a row each.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use algebra::linalg::larger;
use cpu_time::ThreadTime;
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::table;
use fem::contact::{CaseError, CaseInfo, Observer, strain_distance, strain_norm};
use fem::norms::{ReferenceRun, Trajectory, step_errors, strain_error};
use files::{FileError, replace_file};
use run::sweep::{as_floors, floor_in, run_cost, scene_reference};
use scene::setup::{MeshData, Setup, SetupError, reference_run};
use scene::{Change, Norm};

/// One run, or the extrapolation of two.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// What is different from the scene as written.
    pub change: String,
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
    /// A change that moves neither time nor error: the run as written stands for it.
    pub tie: bool,
    /// No other run is as good in time and error, and better in one beyond a tie.
    pub front: bool,
    /// The run, or why there is none.
    #[serde(flatten, serialize_with = "ended")]
    pub outcome: Result<Outcome, String>,
}

/// A run that came to its end.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// Error in the norm of the trade.
    pub error: f64,
    /// What solver and rounding have of it.
    pub floor: f64,
    /// CPU seconds of the thread: mesh, analysis, loads and march.
    #[serde(rename = "cpu_seconds")]
    pub seconds: f64,
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
    /// Where half the steps were run before: max ‖ε(u_k - u_2k)‖ at the times of both.
    #[serde(skip)]
    pub apart: Option<f64>,
    /// ‖ε(u(T))‖ of the run and of the truth.
    #[serde(skip)]
    pub strain: [f64; 2],
}

/// Richardson's extrapolation in k for order 2, (4 u_k - u_2k)/3 at the times of 2k, of two runs.
pub(crate) const EXTRAPOLATED: &str = "Richardson in k";

impl Trial {
    /// The run, if it came to its end.
    pub(crate) fn done(&self) -> Option<&Outcome> {
        self.outcome.as_ref().ok()
    }
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

/// A mesh with its loads, and the CPU seconds that it took.
pub(super) struct Meshed {
    pub n: u32,
    pub data: MeshData,
    seconds: f64,
}

impl Meshed {
    pub(super) fn new(setup: &Setup, n: u32) -> Result<Self, SetupError> {
        let clock = ThreadTime::now();
        let data = MeshData::new(setup, n, None)?;
        Ok(Self { n, data, seconds: clock.elapsed().as_secs_f64() })
    }

    /// A march that shows its levels to `keep`, and the CPU seconds of mesh and march without those of `keep`.
    pub(super) fn march(
        &self,
        setup: &Setup,
        steps: u32,
        keep: &mut Observer<'_>,
    ) -> Result<(CaseInfo, f64), CaseError> {
        let (clock, mut keeping) = (ThreadTime::now(), Duration::ZERO);
        let info = setup.scheme.march(setup, &self.data, steps, &mut |view| {
            let clock = ThreadTime::now();
            let outcome = keep(view);
            keeping += clock.elapsed();
            outcome
        })?;
        let march = clock.elapsed().saturating_sub(keeping);
        Ok((info, self.seconds + march.as_secs_f64()))
    }
}

/// Runs one scene.
pub struct Bench {
    /// The scene as written.
    pub setup: Setup,
    /// The norm of the errors.
    pub norm: Norm,
    reference: Option<Arc<ReferenceRun>>,
    /// Largest ‖ε(u)‖ of the truth that was met.
    pub size: f64,
}

impl Bench {
    /// Makes the reference run of a scene without exact solution.
    ///
    /// # Errors
    /// A reference run that fails.
    pub fn new(setup: Setup, norm: Norm) -> Result<Self, SetupError> {
        let reference =
            scene_reference(&setup).map(|wanted| reference_run(&setup, wanted.n, wanted.steps, 1));
        let reference = reference.transpose()?.map(Arc::new);
        Ok(Self { setup, norm, reference, size: 0.0 })
    }

    /// Runs the scene with a change on one mesh, from few steps to many, and shows each row to `keep`: with half the steps
    /// before it, of the scene as written in the V norm, also the extrapolation of both. What fails is a row without numbers.
    ///
    /// # Errors
    /// Those of `keep`.
    pub fn runs<E>(
        &mut self,
        change: &Change,
        n: u32,
        steps: &[u32],
        keep: &mut dyn FnMut(Trial) -> Result<(), E>,
    ) -> Result<(), E> {
        let judged = self.judge(change, n).map_err(|error| error.to_string());
        let row = |change: &str, k: f64, steps, outcome| Trial {
            change: change.into(),
            n,
            steps,
            h: self.setup.body.domain.h(n),
            k,
            dofs: judged.as_ref().map_or(0, |(_, judge)| judge.space.dofs()),
            tie: false,
            front: false,
            outcome,
        };
        let written = self.norm == Norm::VMax && *change == Change::none();
        let mut size = self.size;
        let mut known: Vec<(u32, Outcome, Trajectory)> = Vec::new();
        for &steps in steps {
            let k = self.setup.grid(steps).largest_step();
            let half = known.iter().find(|(coarse, ..)| 2 * coarse == steps);
            let run = |(setup, judge): &(Setup, MeshData)| {
                let half = half.map(|(.., levels)| levels);
                self.run(setup, judge, [n, steps], half, &mut size).map_err(|e| e.to_string())
            };
            let found = judged.as_ref().map_err(Clone::clone).and_then(run);
            let outcome = found.as_ref().map(|(run, ..)| run.clone()).map_err(Clone::clone);
            keep(row(change.words(), k, steps, outcome))?;
            let Ok((run, better, levels)) = found else { continue };
            if let Some((error, (_, half, _))) = better.filter(|_| written).zip(half) {
                let both = Outcome {
                    error,
                    seconds: run.seconds + half.seconds,
                    bytes: run.bytes.max(half.bytes),
                    newton_iterations: run.newton_iterations + half.newton_iterations,
                    factorizations: run.factorizations + half.factorizations,
                    ..run.clone()
                };
                keep(row(EXTRAPOLATED, k, steps, Ok(both)))?;
            }
            known.push((steps, run, levels));
        }
        self.size = size;
        Ok(())
    }

    /// The scene with a change, and the truth on a mesh by the rules of the scene as written, with the element of the change.
    fn judge(&self, change: &Change, n: u32) -> Result<(Setup, MeshData), SetupError> {
        let setup = Setup::new(change.of(&self.setup.scene)?)?;
        let other = setup.body.element != self.setup.body.element;
        let by = if other { &setup } else { &self.setup };
        let judge = MeshData::new(by, n, self.reference.clone())?;
        Ok((setup, judge))
    }

    /// One run from nothing; with `half`, the levels of half the steps, also the error of the extrapolation in the V norm
    /// where its times are those of both.
    fn run(
        &self,
        setup: &Setup,
        judge: &MeshData,
        [n, steps]: [u32; 2],
        half: Option<&Trajectory>,
        size: &mut f64,
    ) -> Result<(Outcome, Option<f64>, Trajectory), SetupError> {
        let (space, still) = (&judge.space, vec![0.0; judge.space.nodes.len()]);
        let (mut error, mut apart, mut better, mut met) = (0.0, 0.0, 0.0, 0);
        let (mut strain, mut levels) = ([0.0; 2], Trajectory::default());
        let mesh = Meshed::new(setup, n)?;
        let (info, seconds) = mesh.march(setup, steps, &mut |view| {
            let truth = judge.truth.moments(view.t)?;
            let errors = as_floors(&step_errors(space, &setup.model, view, &truth));
            error = larger(error, floor_in(&errors, self.norm));
            strain = [strain_norm(space, view.u), strain_error(space, &still, &truth)];
            *size = size.max(strain[1]);
            if let Some(coarse) = half.and_then(|half| half.at(view.t)) {
                let pairs = view.u.iter().zip(coarse);
                let sum: Vec<f64> =
                    pairs.map(|(fine, coarse)| fine + (fine - coarse) / 3.0).collect();
                apart = larger(apart, strain_distance(space, coarse, view.u));
                better = larger(better, strain_error(space, &sum, &truth));
                met += 1;
            }
            levels.times.push(view.t);
            levels.displacements.push(view.u.to_vec());
            Ok(())
        })?;
        let nested = half.is_some_and(|half| half.times.len() == met);
        let by = if setup.body.element == self.setup.body.element { &self.setup } else { setup };
        let cost = run_cost(by, space, steps);
        let outcome = Outcome {
            error,
            floor: floor_in(&info.floors, self.norm),
            seconds,
            load_share: (info.seconds_load / seconds).min(1.0),
            // The history is counted.
            bytes: cost.memory_bytes + info.peak_history_bytes as f64 - cost.history_bytes,
            history_bytes: info.peak_history_bytes,
            newton_iterations: info.newton_iterations,
            factorizations: info.work.linear.factorizations,
            apart: nested.then_some(apart),
            strain,
        };
        let better = nested.then_some(better);
        Ok((outcome, better, levels))
    }
}

/// The table of a trade on disk: a row is there as soon as its run ended.
pub struct Table {
    path: PathBuf,
    scene: String,
    norm: Norm,
}

const COLUMNS: [&str; 18] = [
    "scene",
    "change",
    "n",
    "steps",
    "h",
    "k",
    "dofs",
    "norm",
    "error",
    "floor",
    "cpu_seconds",
    "load_share",
    "predicted_bytes",
    "history_bytes",
    "newton_iterations",
    "factorizations",
    "status",
    "reason",
];

impl Table {
    /// An empty table in place of an old one.
    ///
    /// # Errors
    /// The file system's.
    pub fn create(path: PathBuf, scene: &str, norm: Norm) -> Result<Self, FileError> {
        let table = Self { path, scene: scene.into(), norm };
        table.write(&[])?;
        Ok(table)
    }

    /// Writes all rows.
    ///
    /// # Errors
    /// The file system's.
    pub(crate) fn write(&self, trials: &[Trial]) -> Result<(), FileError> {
        let row = |trial: &Trial| {
            let mut value = serde_json::to_value(trial).unwrap_or_default();
            value["scene"] = self.scene.as_str().into();
            value["norm"] = self.norm.name().into();
            COLUMNS.map(|name| match &value[name] {
                Value::String(text) => (name, text.clone()),
                Value::Null => (name, String::new()),
                number => (name, number.to_string()),
            })
        };
        let bytes = table::csv(trials.iter().map(row)).map_err(io::Error::from);
        replace_file(&self.path, &bytes.map_err(FileError::at(&self.path))?)
    }
}

#[cfg(test)]
mod tests {
    use super::super::study::row;
    use super::*;

    #[test]
    fn rows_are_there_at_once_and_failures_are_rows() {
        let path = std::env::temp_dir().join(format!("trade-{}.csv", std::process::id()));
        let table = Table::create(path.clone(), "block", Norm::VMax).expect("a table");
        let reason = "no convergence, \"60\" iterations";
        let failed =
            Trial { outcome: Err(reason.into()), ..row("contact exact", [4, 2], 0.0, 0.0) };
        table.write(&[row("as written", [4, 2], 0.5, 2.0), failed]).expect("rows");
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
            (2, "0.5".into(), "2.0".into())
        );
        assert_eq!((at(0, "status"), at(1, "status")), ("converged".into(), "failed".into()));
        assert_eq!((at(0, "scene"), at(1, "norm")), ("block".into(), "V_max".into()));
        // A failed run carries no error and no time.
        assert_eq!((at(1, "error"), at(1, "cpu_seconds")), (String::new(), String::new()));
        assert_eq!(at(1, "reason"), reason);
    }
}
