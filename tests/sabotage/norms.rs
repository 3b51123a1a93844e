//! The norms of a record against a second integral of the errors of the levels that the scheme shows; a run that serves
//! as truth against the truth itself.

use std::sync::Arc;

use exact::Truth;
use fem::contact::{Discretization, LoadError};
use fem::norms::{Moments, ReferenceRun, Refinement, StepErrors, step_errors};
use run::sweep::{CasePlan, run_contact_case};
use scene::Norm;
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup};

use crate::again::{Errors, Kept, errors, strain_norm};
use crate::catalogue::{Defect, Site, through};
use crate::shipped::setup;
use crate::suite::{data, fresh};

/// Scenes, meshes and steps: a multiplier and a moving zone; a multiplier, and every norm but one without space error.
/// A zone that the coarse mesh does not have: one of the contact sets is empty.
const MEASURED: [(&str, u32, u32); 3] =
    [("signorini", 4, 4), ("affine-locked", 2, 4), ("zone-appears", 4, 8)];
/// Fronts that cut coarse cells leave a rule 1 % of strain and stress; u and its trace are smooth there.
const SHARE: [f64; 2] = [0.03, 0.005];
/// A scene with every norm, its mesh, the mesh of the run that serves as truth, and steps.
const REFERENCED: (&str, [u32; 2], u32) = ("pure-mild", [4, 32], 4);
/// Squares settle to this. Against 1e-8 it moves strain and stress of `signorini` by 5e-4 at most, u by 6e-6: both far below
/// [`SHARE`], and four times as fast.
const SETTLED: f64 = 1e-4;
/// Below this an error is rounding.
const ROUNDING: f64 = 1e-12;

struct Stage {
    sound: Setup,
    space: Arc<Discretization>,
    truth: Arc<dyn Truth>,
    steps: u32,
}

/// The sound side.
pub struct Norms(Vec<Stage>, Referenced);

impl Norms {
    pub fn new() -> Self {
        let stage = |(name, n, steps)| {
            let sound = setup(name);
            let data = MeshData::new(&sound, n, None).unwrap_or_else(|error| panic!("{error}"));
            Stage { space: data.space, truth: data.truth, sound, steps }
        };
        Self(MEASURED.map(stage).into(), Referenced::new())
    }

    /// What is said of a sound run that serves as truth.
    pub fn of_a_sound_run(&self) -> Option<String> {
        self.1.sound()
    }

    /// The first norm of a record that is not the one of the second integral.
    pub fn hear(&self, defect: &Defect) -> Option<String> {
        self.0.iter().find_map(|stage| stage.hear(defect)).or_else(|| self.1.hear(defect))
    }
}

impl Stage {
    fn hear(&self, defect: &Defect) -> Option<String> {
        let program = through(&defect.program, fresh(&self.sound));
        let data = data(defect, &program, &self.sound, &self.space, &self.truth);
        let exact = program.exact.clone()?;
        let (mut levels, mut again) = (Vec::new(), Errors::default());
        let run = program.scheme.march(&program, &data, self.steps, &mut |view| {
            levels.push(Kept::of(view));
            again = again.max(errors(&exact, &data, &levels, SETTLED));
            Ok(())
        });
        // A run without result is not this witness's finding.
        run.ok()?;
        let integrated = [
            (Norm::VMax, again.v),
            (Norm::L2Max, again.l2),
            (Norm::StressL2Max, again.stress),
            (Norm::TraceL2Max, again.trace),
            (Norm::PressureL2Max, again.pressure),
            (Norm::ContactSetMax, again.contact_set),
            (Norm::ContactMeasureMax, again.difference),
        ];
        let in_time = self.in_time(&program, &data, &levels).map(|again| (Norm::VTimeMax, again));
        let (n, steps) = (Some(self.space.mesh.n), self.steps);
        let program = through(&defect.measured, program);
        // A measurement of the time error that fails leaves the other norms.
        let records = [integrated.to_vec(), in_time.into_iter().collect()].map(|pairs| {
            let norms = pairs.iter().map(|(norm, _)| *norm).collect();
            let case = CasePlan { n, steps, norms };
            let mut record = run_contact_case(&program, &data, &case);
            (defect.case)(&program, &data, &case, &mut record);
            (pairs, through(&defect.records, vec![record]))
        });
        let mut pairs = records.iter().flat_map(|(pairs, records)| {
            pairs.iter().filter_map(|pair| Some((*pair, records.first()?)))
        });
        pairs.find_map(|((norm, again), record)| {
            let written = record.norm(norm.name())?.error?;
            // A sample of a contact set is an eighth of an edge.
            let allowed = match norm {
                Norm::ContactSetMax => 0.125 * self.space.mesh.h() + ROUNDING,
                // Either end of a zone in a part of an eighth.
                Norm::ContactMeasureMax => 0.25 * self.space.mesh.h() + ROUNDING,
                // The same two runs.
                Norm::VTimeMax => 1e-9 * again + ROUNDING,
                Norm::VMax | Norm::StressL2Max => SHARE[0] * again + ROUNDING,
                _ => SHARE[1] * again + ROUNDING,
            };
            let wrong = written.is_nan() || (written - again).abs() > allowed;
            let scene = &self.sound.scene.name;
            wrong.then(|| format!("{} {written:.3e}, again {again:.3e} on {scene}", norm.name()))
        })
    }
}

impl Stage {
    /// The largest ‖ε(u_n - v_8n)‖ over the levels, v those of a run with eight times as many steps.
    fn in_time(&self, program: &Setup, data: &MeshData, levels: &[Kept]) -> Option<f64> {
        let (mut finer, steps) = (Vec::new(), 8 * self.steps);
        let run = program.scheme.march(program, data, steps, &mut |view| {
            finer.push(view.u.to_vec());
            Ok(())
        });
        run.ok()?;
        let apart = levels.iter().zip(finer.iter().step_by(8)).map(|(level, v)| {
            let difference: Vec<f64> = level.u.iter().zip(v).map(|(u, v)| u - v).collect();
            strain_norm(data, &difference)
        });
        Some(apart.fold(0.0, f64::max))
    }
}

/// A run on a finer mesh as the truth of a coarser one, beside the truth that both have. Errors against the two differ by no
/// more than the error of the run: the triangle inequality, in every norm that a run has.
struct Referenced {
    setup: Setup,
    coarse: MeshData,
    truth: OfRun,
    steps: u32,
    /// The error of the run, by level.
    own: Vec<StepErrors>,
}

/// The moments of a run.
struct OfRun {
    run: ReferenceRun,
    refinement: Refinement,
    space: Arc<Discretization>,
    sound: Arc<dyn Truth>,
}

impl Truth for OfRun {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        self.sound.load(t)
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        let moments = self.run.moments(&self.refinement, &self.space, t);
        moments.map(Arc::new).map_err(|error| LoadError::Reference { reason: error.to_string() })
    }
}

impl Referenced {
    fn new() -> Self {
        let (name, [n, fine], steps) = REFERENCED;
        let setup = setup(name);
        let on = |n| MeshData::new(&setup, n, None).unwrap_or_else(|error| panic!("{error}"));
        let (coarse, fine) = (on(n), on(fine));
        let (mut run, mut own) = (ReferenceRun::new(fine.space.clone()), Vec::new());
        let march = NewtonMarch.march(&setup, &fine, steps, &mut |view| {
            run.keep(&setup.model, view);
            let moments = fine.truth.moments(view.t)?;
            own.push(step_errors(&fine.space, &setup.model, view, &moments));
            Ok(())
        });
        march.unwrap_or_else(|error| panic!("{error}"));
        let refinement = run.refinement(&coarse.space).unwrap_or_else(|error| panic!("{error}"));
        let (space, sound) = (coarse.space.clone(), coarse.truth.clone());
        let truth = OfRun { run, refinement, space, sound };
        Self { setup, coarse, truth, steps, own }
    }

    fn hear(&self, defect: &Defect) -> Option<String> {
        let seed = defect.moments.as_ref()?;
        let (space, sound) = (&*self.coarse.space, &self.truth as &dyn Truth);
        let site = Site { exact: None, interpolated: false, space, sound };
        let mut said = None;
        let run = NewtonMarch.march(&self.setup, &self.coarse, self.steps, &mut |view| {
            let errors = |moments: &Moments| {
                let e = step_errors(space, &self.setup.model, view, moments);
                [e.v, e.l2, e.stress, e.trace, e.pressure]
            };
            let by_truth = errors(&*self.coarse.truth.moments(view.t)?);
            let by_run = errors(&seed(&site, view.t)?);
            let StepErrors { v, l2, stress, trace, pressure, .. } = self.own[view.n];
            let names = ["V", "L2", "stress", "trace", "pressure"];
            let pairs = by_truth.into_iter().zip(by_run).zip([v, l2, stress, trace, pressure]);
            for (name, ((truth, run), own)) in names.into_iter().zip(pairs) {
                // Fronts that cut cells leave the quadrature of the truth a share, as above.
                let apart = (truth - run).abs();
                if apart.is_nan() || apart > own + SHARE[0] * truth + ROUNDING {
                    said.get_or_insert(format!(
                        "{name} {run:.3e} by a run, {truth:.3e} by the truth, {own:.1e} between them"
                    ));
                }
            }
            Ok(())
        });
        run.err().map(|error| error.to_string()).or(said)
    }

    /// What is said of the sound run.
    fn sound(&self) -> Option<String> {
        self.hear(&Defect {
            moments: Some(Arc::new(|site, t| Ok((*site.sound.moments(t)?).clone()))),
            ..Defect::SOUND
        })
    }
}
