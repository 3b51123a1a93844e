//! Runs for the clock and runs for the error. The clock sees mesh, analysis, loads and march, each time from nothing;
//! what the error is measured with (moments of the truth) is no part of it.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use cpu_time::ThreadTime;

use super::knob::{Knob, Variant};
use super::rounds::Rounds;
use super::trial::{Outcome, Trial};
use fem::contact::{CaseError, CaseInfo, Discretization, LoadError, strain_distance};
use fem::norms::{ReferenceRun, Trajectory, step_errors, strain_error};
use fem::space::Element;
use run::sweep::{as_floors, floor_in, run_cost, scene_reference};
use scene::Norm;
use scene::setup::{MeshData, Setup, SetupError, reference_run};

/// Measures runs of one scene.
pub struct Bench {
    /// The scene as written.
    pub plain: Variant,
    /// The norm of the errors.
    pub norm: Norm,
    /// How often each run is timed.
    pub repeats: u32,
    reference: Option<Arc<ReferenceRun>>,
    /// By element and n, the truth by the rules of the scene with that element.
    judges: HashMap<(Element, u32), MeshData>,
    /// Displacements of the runs as written, and of those with another element alone, by element, n and N.
    trajectories: HashMap<(Element, u32, u32), Trajectory>,
    /// Largest ‖ε(u)‖ of the truth that was met.
    pub size: f64,
}

/// A scene with a knob turned, n and N.
pub(super) type Case<'a> = (&'a Variant, u32, u32);

/// One run for the clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timed {
    /// CPU seconds of the thread.
    pub(super) seconds: f64,
    /// The part of it that went into loads.
    load_share: f64,
}

impl Bench {
    /// Makes the reference run of a scene without exact solution.
    ///
    /// # Errors
    /// A reference run that fails.
    pub fn new(plain: Variant, norm: Norm, repeats: u32) -> Result<Self, SetupError> {
        let setup = &plain.setup;
        let reference =
            scene_reference(setup).map(|wanted| reference_run(setup, wanted.n, wanted.steps, 1));
        let reference = reference.transpose()?.map(Arc::new);
        let (judges, trajectories) = (HashMap::new(), HashMap::new());
        Ok(Self { plain, norm, repeats, reference, judges, trajectories, size: 0.0 })
    }

    /// The scene by whose rules a run is judged: as written, or with the element of the variant.
    pub(super) fn judging<'a>(&'a self, variant: &'a Variant) -> &'a Setup {
        if variant.is_element() { &variant.setup } else { &self.plain.setup }
    }

    /// Times all cases in rounds, to compare them with the first; for each its times, or why it failed.
    pub(super) fn rounds(&self, cases: &[Case<'_>]) -> (Rounds, Vec<Result<Vec<Timed>, String>>) {
        let mut all: Vec<Result<Vec<Timed>, String>> = vec![Ok(Vec::new()); cases.len()];
        let rounds = Rounds::run(cases.len(), self.repeats.max(1) as usize, |run| {
            let (variant, n, steps) = cases[run];
            let timed = self.timed(variant, n, steps);
            let seconds = timed.as_ref().ok().map(|timed| timed.seconds);
            match (timed, &mut all[run]) {
                (Ok(timed), Ok(times)) => times.push(timed),
                (Err(reason), times) => *times = Err(reason),
                (Ok(_), Err(_)) => {}
            }
            seconds
        });
        (rounds, all)
    }

    /// The row of a case that was run in rounds; its error is measured in a separate run.
    pub(super) fn after_rounds(
        &mut self,
        (variant, n, steps): Case<'_>,
        times: Result<Vec<Timed>, String>,
    ) -> Trial {
        let outcome =
            self.judge(variant, n).and_then(|()| self.judged(variant, (n, steps), &times?));
        self.row(variant.knob, variant.element(), (n, steps), outcome)
    }

    /// A run with a knob turned, n cells per unit length and `steps` steps. What fails is a row without numbers.
    pub fn trial(&mut self, variant: &Variant, n: u32, steps: u32) -> Trial {
        let times = (0..self.repeats.max(1)).map(|_| self.timed(variant, n, steps)).collect();
        self.after_rounds((variant, n, steps), times)
    }

    /// The row of a run; it has no unknowns where there is no mesh to judge it on.
    fn row(
        &self,
        knob: Knob,
        element: Element,
        (n, steps): (u32, u32),
        outcome: Result<Outcome, String>,
    ) -> Trial {
        let setup = &self.plain.setup;
        Trial {
            knob,
            n,
            steps,
            h: setup.body.domain.h(n),
            k: setup.grid(steps).largest_step(),
            dofs: self.judges.get(&(element, n)).map_or(0, |data| data.space.dofs()),
            tie: false,
            front: false,
            front_memory: false,
            outcome,
        }
    }

    /// The truth on the mesh of n, by the rules of the scene with the element of the variant.
    fn judge(&mut self, variant: &Variant, n: u32) -> Result<(), String> {
        let key = (variant.element(), n);
        if !self.judges.contains_key(&key) {
            let data = MeshData::new(self.judging(variant), n, self.reference.clone());
            self.judges.insert(key, data.map_err(|error| error.to_string())?);
        }
        Ok(())
    }

    /// One run for the clock, from nothing.
    fn timed(&self, variant: &Variant, n: u32, steps: u32) -> Result<Timed, String> {
        let (clock, wall) = (ThreadTime::now(), Instant::now());
        let data = variant.on_mesh(n).map_err(|error| error.to_string())?;
        let info = variant.march(&data, steps, &mut |_| Ok(())).map_err(|e| e.to_string())?;
        let seconds = clock.elapsed().as_secs_f64();
        // The share is one of wall time, since the thread may have waited in between.
        let load_share = info.seconds_load / wall.elapsed().as_secs_f64();
        Ok(Timed { seconds, load_share })
    }

    /// The cost of a run, by `times`, with the error of a run that is not timed.
    fn judged(
        &mut self,
        variant: &Variant,
        (n, steps): (u32, u32),
        times: &[Timed],
    ) -> Result<Outcome, String> {
        let data = variant.on_mesh(n).map_err(|error| error.to_string())?;
        let least = times.iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let Timed { seconds, load_share } = *least.ok_or("no run")?;
        let (info, error) =
            self.error(variant, &data, (n, steps)).map_err(|error| error.to_string())?;
        let cost = run_cost(self.judging(variant), &data.space, steps);
        // The prediction is that of the scene with this element; the history is counted.
        let bytes = cost.memory_bytes + info.peak_history_bytes as f64 - cost.history_bytes;
        Ok(Outcome {
            error,
            floor: floor_in(&info.floors, self.norm),
            seconds,
            slowest: times.iter().map(|timed| timed.seconds).fold(0.0, f64::max),
            repeats: times.len() as u32,
            load_share,
            bytes,
            history_bytes: info.peak_history_bytes,
            newton_iterations: info.newton_iterations,
            factorizations: info.work.linear.factorizations,
        })
    }

    /// The error of a run, on mesh and loads of the clock, against the truth by the rules of the scene.
    fn error(
        &mut self,
        variant: &Variant,
        data: &MeshData,
        (n, steps): (u32, u32),
    ) -> Result<(CaseInfo, f64), CaseError> {
        let element = variant.element();
        let judge = &self.judges[&(element, n)];
        let still = vec![0.0; judge.space.nodes.len()];
        let (mut error, mut size) = (0f64, self.size);
        let mut trajectory = Trajectory::default();
        let info = variant.march(data, steps, &mut |view| {
            let truth = judge.truth.moments(view.t)?;
            let errors = step_errors(&judge.space, &variant.setup.model, view, &truth);
            let in_norm = floor_in(&as_floors(&errors), self.norm);
            error = if error.is_nan() || in_norm <= error { error } else { in_norm };
            size = size.max(strain_error(&judge.space, &still, &truth));
            trajectory.times.push(view.t);
            trajectory.displacements.push(view.u.to_vec());
            Ok(())
        })?;
        if variant.knob == Knob::AsWritten || variant.is_element() {
            self.trajectories.insert((element, n, steps), trajectory);
        }
        self.size = size;
        Ok((info, error))
    }

    /// The displacements of a run that was made, and the truth on its mesh.
    fn run(&self, element: Element, n: u32, steps: u32) -> Option<(&MeshData, &Trajectory)> {
        self.judges.get(&(element, n)).zip(self.trajectories.get(&(element, n, steps)))
    }

    /// (4 u_k - u_2k)/3 of two runs that were made, `coarse` with 2k; its error in the V norm at the times of both, and
    /// the CPU time of both. None where one of them has no row.
    pub(crate) fn extrapolated(&self, fine: &Trial, coarse: &Trial) -> Option<Trial> {
        let (cheap, dear) = (coarse.done()?, fine.done()?);
        let element = self.plain.element();
        let (_, rough) = self.run(element, coarse.n, coarse.steps)?;
        let (judge, exact) = self.run(element, fine.n, fine.steps)?;
        let levels = || -> Result<f64, LoadError> {
            let mut worst = 0f64;
            for (t, u) in rough.times.iter().zip(&rough.displacements) {
                let Some(finer) = exact.at(*t) else {
                    let reason = format!("the run with half the step has no level at t = {t}");
                    return Err(LoadError::Reference { reason });
                };
                let pairs = finer.iter().zip(u);
                let sum: Vec<f64> =
                    pairs.map(|(fine, coarse)| fine + (fine - coarse) / 3.0).collect();
                worst = worst.max(strain_error(&judge.space, &sum, &*judge.truth.moments(*t)?));
            }
            Ok(worst)
        };
        let outcome = levels().map_err(|error| error.to_string()).map(|error| Outcome {
            error,
            seconds: cheap.seconds + dear.seconds,
            slowest: cheap.slowest + dear.slowest,
            bytes: dear.bytes.max(cheap.bytes),
            newton_iterations: cheap.newton_iterations + dear.newton_iterations,
            factorizations: cheap.factorizations + dear.factorizations,
            ..dear.clone()
        });
        Some(self.row(Knob::Extrapolated, element, (fine.n, fine.steps), outcome))
    }

    /// The last level of a run as written, and ‖ε(u(T))‖ of the truth.
    pub(super) fn last_level(&self, n: u32, steps: u32) -> Option<(&Discretization, &[f64], f64)> {
        let (judge, trajectory) = self.run(self.plain.element(), n, steps)?;
        let (t, u) = trajectory.times.last().zip(trajectory.displacements.last())?;
        let still = vec![0.0; judge.space.nodes.len()];
        let truth = judge.truth.moments(*t).ok()?;
        Some((&*judge.space, u, strain_error(&judge.space, &still, &truth)))
    }

    /// max ‖ε(u_k - u_k')‖ of two runs with an element on one mesh, at the times of the coarser one.
    pub(crate) fn apart_in_time(
        &self,
        element: Element,
        n: u32,
        [coarse, fine]: [u32; 2],
    ) -> Option<f64> {
        let (judge, rough) = self.run(element, n, coarse)?;
        let (_, exact) = self.run(element, n, fine)?;
        let mut worst = 0f64;
        for (t, u) in rough.times.iter().zip(&rough.displacements) {
            worst = worst.max(strain_distance(&judge.space, u, exact.at(*t)?));
        }
        Some(worst)
    }
}
