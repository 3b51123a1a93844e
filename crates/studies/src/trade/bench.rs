//! Runs with their errors and CPU seconds.

use std::sync::Arc;
use std::time::Duration;

use cpu_time::ThreadTime;
use serde_json::{Value, json};

use algebra::linalg::larger;
use fem::contact::{CaseError, CaseInfo, Observer, strain_distance};
use fem::norms::{ReferenceRun, Trajectory, step_errors, strain_error};
use judge::record::{CaseRecord, NormError, Status};
use run::sweep::{as_floors, floor_in, run_cost, scene_reference};
use scene::setup::{MeshData, Setup, SetupError, reference_run};
use scene::{Change, Norm};

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Trial {
    pub change: Change,
    /// Its error in the norm of the trade, if it came to its end. Seconds are CPU seconds of the thread: mesh, analysis,
    /// loads and march.
    pub record: CaseRecord,
    /// Peak memory of a process that does this run alone, predicted.
    pub bytes: f64,
    /// Where half the steps were run before: max ‖ε(u_k - u_2k)‖ at the times of both.
    pub apart: Option<f64>,
    /// A change that moves neither time nor error: the run as written stands for it.
    pub tie: bool,
    /// No other run is as good in time and error, and better in one beyond a tie.
    pub front: bool,
}

impl Trial {
    pub(super) fn new(change: &Change, record: CaseRecord) -> Self {
        let (change, bytes) = (change.clone(), f64::NAN);
        Self { change, record, bytes, apart: None, tie: false, front: false }
    }

    /// n and N.
    pub(super) fn place(&self) -> [u32; 2] {
        [self.record.n.unwrap_or(0), self.record.steps]
    }

    pub(super) fn steps(&self) -> [f64; 2] {
        [self.record.h.unwrap_or(f64::NAN), self.record.k]
    }

    /// NaN of a run that failed, as all its numbers.
    pub(super) fn error(&self) -> f64 {
        self.record.errors.first().and_then(|entry| entry.error).unwrap_or(f64::NAN)
    }

    pub(super) fn floor(&self) -> f64 {
        self.record.errors.first().and_then(|entry| entry.floor).unwrap_or(f64::NAN)
    }

    pub(super) fn seconds(&self) -> f64 {
        if self.record.converged() { self.record.seconds_total } else { f64::NAN }
    }

    /// Why there is no error.
    pub(super) fn failure(&self) -> Option<&str> {
        match &self.record.status {
            Status::Failed { reason } => Some(reason),
            _ => None,
        }
    }

    /// What files have of it.
    pub(super) fn json(&self) -> Value {
        let CaseRecord { scene, steps, k, newton_iterations, factorizations, .. } = &self.record;
        json!({
            "scene": scene,
            "change": self.change,
            "n": self.record.n,
            "steps": steps,
            "h": self.record.h,
            "k": k,
            "dofs": self.record.dofs,
            "norm": self.record.errors.first().map(|entry| &entry.norm),
            "error": self.error(),
            "floor": self.floor(),
            "cpu_seconds": self.seconds(),
            "load_share": (self.record.seconds_load / self.seconds()).clamp(0.0, 1.0),
            "predicted_bytes": self.bytes,
            "history_bytes": self.record.peak_history_bytes,
            "newton_iterations": newton_iterations,
            "factorizations": factorizations,
            "tie": self.tie,
            "front": self.front,
            "status": if self.record.converged() { "converged" } else { "failed" },
            "reason": self.failure(),
        })
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
pub(super) struct Bench<'a> {
    /// The scene as written.
    pub setup: &'a Setup,
    /// The norm of the errors.
    pub norm: Norm,
    reference: Option<Arc<ReferenceRun>>,
    /// Largest ‖ε(u)‖ of the truth that was met.
    pub size: f64,
    /// What was run, in this order.
    pub trials: Vec<Trial>,
}

impl<'a> Bench<'a> {
    /// Makes the reference run of a scene without exact solution.
    pub(super) fn new(setup: &'a Setup, norm: Norm) -> Result<Self, SetupError> {
        let reference =
            scene_reference(setup).map(|wanted| reference_run(setup, wanted.n, wanted.steps, 1));
        let reference = reference.transpose()?.map(Arc::new);
        Ok(Self { setup, norm, reference, size: 0.0, trials: Vec::new() })
    }

    /// Runs the scene with a change on one mesh, from few steps to many, and says what came of it.
    pub(super) fn runs(&mut self, change: &Change, n: u32, steps: &[u32], heard: &dyn Fn(&str)) {
        let judged = self.judge(change, n).map_err(|error| error.to_string());
        let mut known: Vec<(u32, Trajectory)> = Vec::new();
        for &steps in steps {
            let half = known.iter().find(|(coarse, _)| 2 * coarse == steps);
            let found = judged.as_ref().map_err(Clone::clone).and_then(|(setup, judge)| {
                let run =
                    self.run(change, setup, judge, [n, steps], half.map(|(_, levels)| levels));
                run.map_err(|error| error.to_string())
            });
            let place = format!("{} n={n} N={steps}", change.words());
            match found {
                Ok((trial, levels)) => {
                    let [error, seconds] = [trial.error(), trial.seconds()];
                    heard(&format!("{place} error {error:.4e} in {seconds:.4} s"));
                    known.push((steps, levels));
                    self.trials.push(trial);
                }
                Err(reason) => {
                    heard(&format!("{place} failed: {reason}"));
                    let record = CaseRecord {
                        status: Status::Failed { reason },
                        ..self.without_work([n, steps])
                    };
                    self.trials.push(Trial::new(change, record));
                }
            }
        }
    }

    fn without_work(&self, [n, steps]: [u32; 2]) -> CaseRecord {
        let (scene, k) = (&self.setup.scene.name, self.setup.grid(steps).largest_step());
        let h = Some(self.setup.body.domain.h(n));
        CaseRecord { h, ..CaseRecord::without_work(scene, Some(n), steps, k) }
    }

    /// The scene with a change, and the truth on a mesh by the rules of the scene as written, with the element of the change.
    fn judge(&self, change: &Change, n: u32) -> Result<(Setup, MeshData), SetupError> {
        let setup = Setup::new(change.of(&self.setup.scene)?)?;
        let other = setup.body.element != self.setup.body.element;
        let by = if other { &setup } else { self.setup };
        let judge = MeshData::new(by, n, self.reference.clone())?;
        Ok((setup, judge))
    }

    /// One run from nothing, and its levels; `half` are those of half the steps.
    fn run(
        &mut self,
        change: &Change,
        setup: &Setup,
        judge: &MeshData,
        [n, steps]: [u32; 2],
        half: Option<&Trajectory>,
    ) -> Result<(Trial, Trajectory), SetupError> {
        let (space, still) = (&judge.space, vec![0.0; judge.space.nodes.len()]);
        let [mut error, mut apart] = [0.0f64; 2];
        let (mut met, mut levels) = (0, Trajectory::default());
        let (info, seconds) = Meshed::new(setup, n)?.march(setup, steps, &mut |view| {
            let truth = judge.truth.moments(view.t)?;
            let errors = as_floors(&step_errors(space, &setup.model, view, &truth));
            error = larger(error, floor_in(&errors, self.norm));
            self.size = self.size.max(strain_error(space, &still, &truth));
            if let Some(coarse) = half.and_then(|half| half.at(view.t)) {
                apart = larger(apart, strain_distance(space, coarse, view.u));
                met += 1;
            }
            levels.times.push(view.t);
            levels.displacements.push(view.u.to_vec());
            Ok(())
        })?;
        let by = if setup.body.element == self.setup.body.element { self.setup } else { setup };
        let cost = run_cost(by, space, steps);
        let floor = floor_in(&info.floors, self.norm);
        let norm = self.norm.name().into();
        let record = CaseRecord {
            dofs: space.dofs() as u64,
            status: Status::Converged,
            newton_iterations: info.newton_iterations.into(),
            factorizations: info.work.linear.factorizations.into(),
            peak_history_bytes: info.peak_history_bytes as u64,
            seconds_load: info.seconds_load,
            seconds_total: seconds,
            errors: vec![NormError { norm, error: Some(error), floor: Some(floor) }],
            ..self.without_work([n, steps])
        };
        let trial = Trial {
            // The history is counted.
            bytes: cost.memory_bytes + info.peak_history_bytes as f64 - cost.history_bytes,
            apart: half.filter(|half| half.times.len() == met).map(|_| apart),
            ..Trial::new(change, record)
        };
        Ok((trial, levels))
    }
}
