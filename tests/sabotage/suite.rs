//! The scenes on which defects are judged: small grids, so chosen that every term acts in one of them and the sound
//! program passes all. Spaces, loads and moments of the truth are computed once and shared by all defects.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

use exact::{Exact, Truth};
use fem::contact::{Discretization, LoadError};
use fem::norms::{ContactSamples, Moments};
use judge::record::{CaseRecord, Key, NormError, Status};
use judge::verdict::{ComparedRun, ForeseenConstant, Verdict};
use nalgebra::DVector;
use run::sweep::{
    CasePlan, Overrides, ScenePlan, foresee, judge_scene, run_abstract_case, run_abstract_under,
    run_contact_case,
};
use scene::setup::{AbstractSetup, MeshData, NewtonMarch, Setup, Subject, reference_run};
use scene::{Scene, Source};
use vhi::finite::{FiniteError, FiniteLoad};

use crate::catalogue::{Defect, FiniteSeed, LoadSeed, MomentSeed, site, through};
use crate::shipped::{edited, text};

/// A scene with its grids and all that its runs share.
pub struct Trial {
    pub scene: Scene,
    pub cases: Vec<CasePlan>,
    pub keys: Vec<Key>,
    /// The constants that are known beforehand, from the exact side.
    foreseen: Vec<ForeseenConstant>,
    body: Body,
}

enum Body {
    Contact { sound: Box<Setup>, meshes: Vec<(u32, Arc<Discretization>, Arc<dyn Truth>)> },
    Abstract,
}

/// What a defective program made of a trial.
pub struct Outcome {
    pub records: Vec<CaseRecord>,
    /// By orders alone.
    pub verdicts: Vec<Verdict>,
    /// By orders and by the constants that are known beforehand.
    pub with_constants: Vec<Verdict>,
}

/// Name, edits (from, to), n, steps.
type Row = (&'static str, &'static [(&'static str, &'static str)], &'static [u32], &'static [u32]);

/// λ and μ_L differ, in 𝒜 and in ℬ: in the scenes of the main job they are equal.
const UNEVEN: &[(&str, &str)] = &[
    ("name = \"affine\"", "name = \"affine-uneven\""),
    ("lambda = 1.0\nmu_L = 1.0", "lambda = 1.7\nmu_L = 0.9"),
    ("lambda = 0.25\nmu = 0.25", "lambda = 0.35\nmu = 0.15"),
];
/// Beyond the last point of the law, and the law at u_ν - s: no scene of the main job goes there or tells s apart so well.
const BEYOND: &[(&str, &str)] = &[
    ("name = \"affine\"", "name = \"affine-beyond\""),
    ("gap = \"0.10\"", "gap = \"0.20\"\nshift = \"0.02\""),
    ("a = \"0.08*t*(2 - t)\"", "a = \"0.14*t*(2 - t)\""),
];
/// f0 and tractions in place of the weak form.
const STRONG: &[(&str, &str)] = &[
    ("name = \"viscoelastic\"", "name = \"viscoelastic-strong\""),
    ("[exact]", "[exact]\nform = \"strong\""),
];
/// V alone: on a mesh of eight the place of the zones in their cells makes the other errors scatter, down to 64 steps.
/// Space alone: the error in time of this scene needs a fine mesh.
const SPACE: &[(&str, &str)] = &[(
    "[[predicts]]\nnorm = \"V_time_max\"\nvariable = \"k\"\norder = 2.0\nwindow_n = [32, 32]                      # one mesh: each case there needs a run with 8 N steps beside it\nwhy = \"Theorem 7, (3.17), on the space V^h of a fixed mesh\"\n",
    "",
)];
/// The error in time beside that in space, on the coarsest mesh, where a finer run costs nothing.
const IN_TIME: &[(&str, &str)] = &[(
    "why = \"(5.26)\"",
    "why = \"(5.26)\"\n[[predicts]]\nnorm = \"V_time_max\"\nvariable = \"k\"\norder = 2.0\nwindow_n = [4, 4]\nwhy = \"Theorem 7, (3.17)\"",
)];
/// A prediction that is known to be wrong: the verdict must be fail.
const REFUTED: &[(&str, &str)] = &[
    ("name = \"broken-kernel\"", "name = \"broken-kernel-refuted\"\nexpect = \"fail\""),
    ("order = 1.5", "order = 2.0"),
];

/// Without the pressure: on the mesh of eight its floor is that of zones that cut cells.
const FINER: &[(&str, &str)] = &[(
    "[[predicts]]\nnorm = \"pressure_L2_max\"\nvariable = \"h\"\norder = 0.5\nat_least = true                          # a bound of the error from above\nwhy = \"balance of forces with test functions of V norm h^(-1/2): docs/THEORY.md section 5\"\n",
    "",
)];

/// Space alone, as above.
const FRONT_IN_SPACE: &[(&str, &str)] = &[(
    "[[predicts]]\nnorm = \"V_time_max\"\nvariable = \"k\"\norder = 2.0\nwindow_n = [16, 16]                      # one mesh: each case there needs a run with 8 N steps beside it\nwhy = \"Theorem 7, (3.17), on the space V^h of a fixed mesh\"\n",
    "",
)];

/// The error in time on the coarsest mesh.
const COARSE_IN_TIME: &[(&str, &str)] = &[("window_n = [16, 16]", "window_n = [4, 4]")];

const ROWS: [Row; 45] = [
    ("affine", &[], &[2], &[4, 8, 16, 32, 64]),
    ("affine", UNEVEN, &[2], &[4, 8, 16, 32, 64]),
    ("affine", BEYOND, &[2], &[4, 8, 16, 32, 64]),
    ("affine-locked", &[], &[2], &[4, 8, 16, 32, 64]),
    ("affine-graded", &[], &[2], &[16, 32, 64, 128]),
    ("graded-exponentials", &[], &[2], &[16, 32, 64, 128]),
    ("graded-beyond", &[], &[2], &[16, 32, 64, 128]),
    ("graded-contact", &[], &[2], &[16, 32, 64, 128]),
    ("graded-power", &[], &[2], &[8, 16, 32, 64, 128]),
    ("graded-end", &[], &[2], &[16, 32, 64, 128]),
    ("product-integrated-graded", &[], &[2], &[16, 32, 64, 128]),
    ("singular-contact", &[], &[2], &[16, 32, 64, 128]),
    ("moving-load", &[], &[4], &[8, 16, 32, 64]),
    ("strong-scaled", &[], &[4, 8, 16, 32], &[8]),
    ("strong-corner", &[], &[4, 8, 16, 32], &[4]),
    ("in-space", &[], &[8], &[8, 16, 32, 64]),
    ("long-growing", &[], &[2], &[8, 16, 32, 64]),
    ("steady", &[], &[8, 16, 32], &[1]),
    ("viscoelastic", IN_TIME, &[4, 8, 16, 32], &[8, 16, 32, 64]),
    ("compliance", &[], &[8, 16, 32], &[8]),
    ("viscoelastic", STRONG, &[4, 8, 16, 32], &[8]),
    ("law-exponential", &[], &[8, 16, 32], &[8]),
    ("oblique-trapezium", &[], &[8, 16, 32], &[1]),
    ("signorini", FINER, &[8, 16, 32], &[8]),
    ("pure-mild", SPACE, &[8, 16, 32], &[4]),
    ("pure-concave-gap", &[], &[4, 8, 16], &[4]),
    ("friction-time", &[], &[2], &[6, 12, 24, 48, 96]),
    ("friction-front", FRONT_IN_SPACE, &[4, 8, 16], &[8]),
    ("friction-box-time", &[], &[2], &[6, 12, 24, 48, 96]),
    ("friction-box-falling-time", &[], &[2], &[6, 12, 24, 48, 96]),
    ("friction-box-coulomb-time", &[], &[2], &[6, 12, 24, 48, 96]),
    ("friction-coulomb", COARSE_IN_TIME, &[4, 8, 16], &[8, 16, 32]),
    ("static-bilateral", &[], &[8, 16, 32], &[1]),
    ("quadratic-elastic", &[], &[4, 8, 16], &[4]),
    ("quadratic-compliance", &[], &[4, 8, 16], &[16]),
    ("left-rule", &[], &[2], &[32, 64, 128]),
    ("gregory-three", &[], &[2], &[16, 32, 64, 128]),
    ("gregory-four", &[], &[2], &[8, 16, 32, 64]),
    ("abstract-smooth", &[], &[], &[16, 32, 64, 128]),
    ("abstract-contact", &[], &[], &[16, 32, 64, 128]),
    ("broken-kernel", REFUTED, &[], &[64, 128, 256, 512]),
    ("nested-trapezoid", &[], &[], &[16, 32, 64, 128]),
    ("nested-left", &[], &[], &[32, 64, 128]),
    ("short-memory", &[], &[], &[32, 64, 128]),
    ("short-memory-time", &[], &[2], &[32, 64, 128]),
];

/// All trials.
pub fn trials() -> Vec<Trial> {
    ROWS.iter().map(Trial::new).collect()
}

/// The trials of these scenes alone.
pub fn some(names: &[&str]) -> Vec<Trial> {
    ROWS.iter().filter(|row| names.contains(&row.0)).map(Trial::new).collect()
}

impl Trial {
    fn new((name, edits, ns, steps): &Row) -> Self {
        let text = edits.iter().fold(text(name), |text, (from, to)| edited(&text, from, to));
        let scene = Scene::from_source(Source::from_text("manufactured/edited.toml", text));
        let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}"));
        let subject = Subject::new(scene.clone()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let overrides = Overrides { n: Some(ns.to_vec()), steps: Some(steps.to_vec()) };
        let mut plan = ScenePlan::new(subject, &overrides);
        if ns.len() > 1 {
            // Space at one number of steps, time on one mesh.
            plan.cases.retain(|case| case.n == Some(ns[0]) || case.steps == steps[0]);
        }
        let (keys, cases) = (plan.keys(), plan.cases);
        let body = match plan.subject {
            Subject::Contact(sound) => {
                let reference = plan.reference.map(|reference| {
                    let (n, steps) = (reference.n, reference.steps);
                    let run = reference_run(&sound, n, steps, 1);
                    Arc::new(run.unwrap_or_else(|e| panic!("{e}")))
                });
                let meshes = ns.iter().map(|&n| {
                    let data = MeshData::new(&sound, n, reference.clone());
                    let data = data.unwrap_or_else(|e| panic!("{e}"));
                    (n, data.space, data.truth)
                });
                let meshes = meshes.collect();
                Body::Contact { sound, meshes }
            }
            Subject::Abstract(_) => Body::Abstract,
        };
        let mut trial = Self { scene, cases, keys, foreseen: Vec::new(), body };
        let subject = Subject::new(trial.scene.clone()).unwrap_or_else(|error| panic!("{error}"));
        trial.foreseen = foresee(&subject, &trial.run(&Defect::SOUND).records);
        trial
    }

    /// What a run of the trial is to a baseline.
    pub fn as_run(&self) -> ComparedRun {
        let (scene, planned) = (self.scene.name.clone(), self.keys.clone());
        ComparedRun { scene, hash: String::new(), planned, own_grids: true }
    }

    /// Whether it is a body, not an abstract problem.
    pub fn is_body(&self) -> bool {
        matches!(self.body, Body::Contact { .. })
    }

    /// Runs and judges the trial with a defect.
    pub fn run(&self, defect: &Defect) -> Outcome {
        let run = AssertUnwindSafe(|| match &self.body {
            Body::Contact { sound, meshes } => {
                let program = through(&defect.measured, through(&defect.program, fresh(sound)));
                let mut records = Vec::new();
                for (n, space, truth) in meshes {
                    let data = data(defect, &program, sound, space, truth);
                    let on_mesh = self.cases.iter().filter(|case| case.n == Some(*n));
                    records.extend(on_mesh.map(|case| {
                        let mut record = run_contact_case(&program, &data, case);
                        if record.converged() {
                            (defect.case)(&program, &data, case, &mut record);
                        }
                        record
                    }));
                }
                records
            }
            Body::Abstract => {
                let sound = AbstractSetup::new(self.scene.clone());
                let setup =
                    through(&defect.abstract_program, sound.unwrap_or_else(|e| panic!("{e}")));
                let one = |case: &CasePlan| match defect.finite_load {
                    None => run_abstract_case(&setup, case),
                    Some(load) => run_abstract_under(&mut Finite(&setup, load), &setup, case),
                };
                self.cases.iter().map(one).collect()
            }
        });
        // As a sweep does: a panic is a failed case.
        let records = catch_unwind(run).unwrap_or_else(|_| self.failed());
        self.judge(defect, through(&defect.records, records))
    }

    /// The verdicts on these records by the judge of a defect.
    pub fn judge(&self, defect: &Defect, mut records: Vec<CaseRecord>) -> Outcome {
        records.sort_by_key(CaseRecord::key);
        let (read, keys) = through(&defect.before, (records.clone(), self.keys.clone()));
        let judged = |foreseen: &[ForeseenConstant]| {
            let verdicts = judge_scene(&self.scene, &read, &keys, foreseen);
            let after = verdicts.into_iter().map(|verdict| through(&defect.after, verdict));
            through(&defect.all, after.collect())
        };
        Outcome { verdicts: judged(&[]), with_constants: judged(&self.foreseen), records }
    }

    fn failed(&self) -> Vec<CaseRecord> {
        let failed = |case: &CasePlan| CaseRecord {
            status: Status::Failed { reason: "internal error".into() },
            errors: case
                .norms
                .iter()
                .map(|norm| NormError { norm: norm.name().into(), error: None, floor: None })
                .collect(),
            ..CaseRecord::without_work(
                &self.scene.name,
                case.n,
                case.steps,
                self.scene.time.horizon / f64::from(case.steps),
            )
        };
        self.cases.iter().map(failed).collect()
    }
}

/// A setup with the sound model and scheme and the exact side of `sound`.
pub fn fresh(sound: &Setup) -> Setup {
    Setup {
        scene: sound.scene.clone(),
        body: sound.body.clone(),
        model: sound.scene_model(),
        exact: sound.exact.clone(),
        scheme: Arc::new(NewtonMarch),
        kappa: sound.kappa,
    }
}

/// Whether a defect replaced the exact side.
pub fn other_exact<'a>(program: &'a Setup, sound: &Setup) -> Option<&'a Arc<Exact>> {
    let replaced = program.exact.as_ref()?;
    sound.exact.as_ref().is_none_or(|sound| !Arc::ptr_eq(replaced, sound)).then_some(replaced)
}

/// The mesh data that a defective program works with; what is sound is shared.
pub fn data(
    defect: &Defect,
    program: &Setup,
    sound: &Setup,
    space: &Arc<Discretization>,
    truth: &Arc<dyn Truth>,
) -> MeshData {
    if other_exact(program, sound).is_some() {
        return MeshData::new(program, space.mesh.n, None).unwrap_or_else(|e| panic!("{e}"));
    }
    let seeded = Seeded {
        setup: fresh(sound),
        space: space.clone(),
        sound: truth.clone(),
        load: defect.load.clone(),
        moments: defect.moments.clone(),
        loads: Mutex::default(),
    };
    MeshData::with_truth(space.clone(), Arc::new(seeded))
}

/// The load of a defect in an abstract problem.
struct Finite<'a>(&'a AbstractSetup, FiniteSeed);

impl FiniteLoad for Finite<'_> {
    fn at(&mut self, t: f64) -> Result<DVector<f64>, FiniteError> {
        Ok((self.1)(self.0, t))
    }
}

/// The shared truth with what a defect puts in its place.
struct Seeded {
    setup: Setup,
    space: Arc<Discretization>,
    sound: Arc<dyn Truth>,
    load: Option<LoadSeed>,
    moments: Option<MomentSeed>,
    loads: Mutex<HashMap<u64, Arc<Vec<f64>>>>,
}

impl Truth for Seeded {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        let Some(load) = &self.load else { return self.sound.load(t) };
        let mut loads = self.loads.lock().expect("loads");
        if let Some(known) = loads.get(&t.to_bits()) {
            return Ok(known.clone());
        }
        let value = Arc::new(load(&site(&self.setup, &self.space, &*self.sound), t)?);
        loads.insert(t.to_bits(), value.clone());
        Ok(value)
    }

    fn contact_samples(&self, t: f64) -> Result<Option<ContactSamples>, LoadError> {
        self.sound.contact_samples(t)
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        match &self.moments {
            None => self.sound.moments(t),
            Some(seed) => seed(&site(&self.setup, &self.space, &*self.sound), t).map(Arc::new),
        }
    }
}
