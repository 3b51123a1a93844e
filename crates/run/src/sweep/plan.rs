//! The cases of a scene: every n with every number of steps, and the norms of each.

use super::admission::least_bytes_of_mesh;
use super::cost::{PlanCost, abstract_costs, contact_costs};
use super::floors::{FloorRow, abstract_floors, contact_floors, direct_history};
use judge::record::{CaseRecord, Key, NormError, Status};
use judge::verdict::{ComparedRun, MeshAndSteps};
use leading_error::TIME_REFERENCE;
use scene::setup::{Setup, SetupError, StepRemark, Subject, check_step_sizes};
use scene::{Body, Norm, Prediction, Reference, Scene, SceneError};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Grids given on the command line in place of the scene's.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overrides {
    pub n: Option<Vec<u32>>,
    pub steps: Option<Vec<u32>>,
}

impl Overrides {
    /// Refuses numbers that the scene cannot have.
    ///
    /// # Errors
    /// The first of them, at its key in the scene.
    pub fn check(&self, scene: &Scene) -> Result<(), SceneError> {
        let [n, steps] = [&self.n, &self.steps].map(|list| list.as_deref().unwrap_or_default());
        scene.check_grid(n, steps)
    }
}

/// One case.
#[derive(Debug, Clone, PartialEq)]
pub struct CasePlan {
    /// Cells per unit length; none in an abstract scene.
    pub n: Option<u32>,
    pub steps: u32,
    pub norms: Vec<Norm>,
}

impl CasePlan {
    /// The case within its scene.
    pub(crate) fn place(&self) -> MeshAndSteps {
        MeshAndSteps { n: self.n, steps: self.steps }
    }
}

/// The cases of one scene.
pub struct ScenePlan {
    pub subject: Subject,
    /// By n and steps.
    pub cases: Vec<CasePlan>,
    /// The finer run used as reference, if the scene has no exact solution.
    pub reference: Option<Reference>,
}

impl ScenePlan {
    /// The plan of a scene; `overrides` replace its grids.
    pub fn new(subject: Subject, overrides: &Overrides) -> Self {
        let cases = scene_cases(subject.scene(), overrides);
        let reference = subject.scene().sweep.as_ref().and_then(|sweep| sweep.reference);
        let reference = reference.filter(|_| !subject.has_exact());
        Self { cases, reference, subject }
    }

    /// The record of a case: that of `run`, or of a failed case with the reason. A panic of a solver is a failed case
    /// and does not end the others.
    pub fn record(
        &self,
        case: &CasePlan,
        run: impl FnOnce() -> Result<CaseRecord, String>,
    ) -> CaseRecord {
        let reason = match without_panic(run) {
            Ok(record) => return record,
            Err(reason) => reason,
        };
        CaseRecord { status: Status::Failed { reason }, ..self.unmeasured(case) }
    }

    /// The record of a case that did no work and has no error in any norm.
    pub(crate) fn unmeasured(&self, case: &CasePlan) -> CaseRecord {
        let CasePlan { n, steps, ref norms } = *case;
        let (scene, k) = (self.scene(), self.subject.grid(steps).largest_step());
        let nothing =
            |norm: &Norm| NormError { norm: norm.name().into(), error: None, floor: None };
        CaseRecord {
            dimension: scene.dimension as u32,
            h: n.zip(scene.as_contact()).map(|(n, body)| body.domain.h(n)),
            errors: norms.iter().map(nothing).collect(),
            ..CaseRecord::without_work(&scene.name, n, steps, k)
        }
    }

    /// Puts cases of the scene in the place of those of its grid.
    pub fn take<'a>(&mut self, keys: impl Iterator<Item = &'a Key>) {
        let scene = self.subject.scene();
        let case = |key: &Key| CasePlan { n: key.n, steps: key.steps, norms: norms(scene, key.n) };
        self.cases = keys.map(case).collect();
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        self.subject.scene()
    }

    /// The keys of all cases.
    pub fn keys(&self) -> Vec<Key> {
        let scene = &self.scene().name;
        self.cases.iter().map(|case| case.place().key(scene)).collect()
    }

    /// What a baseline has to know of a run of this plan; `own_grids`: on the default grids of the scene's file.
    pub fn compared(&self, own_grids: bool) -> ComparedRun {
        let Scene { name, source, .. } = self.scene();
        let (scene, hash) = (name.clone(), source.hash.clone());
        ComparedRun { scene, hash, planned: self.keys(), own_grids }
    }

    /// The remark of (3.4) on the step sizes of the cases.
    ///
    /// # Errors
    /// A step size that is refused.
    pub fn step_remark(&self) -> Result<Option<StepRemark>, SetupError> {
        let steps: Vec<u32> = self.cases.iter().map(|case| case.steps).collect();
        check_step_sizes(&self.subject, &steps)
    }

    /// n and steps of all runs on the meshes of the cases, including references for time errors.
    pub fn runs(&self) -> Vec<(u32, u32)> {
        let of = |case: &CasePlan| {
            let finer = case.norms.contains(&Norm::VTimeMax).then_some(TIME_REFERENCE * case.steps);
            let steps = std::iter::once(case.steps).chain(finer);
            let runs = case.n.map(|n| steps.map(move |steps| (n, steps)));
            runs.into_iter().flatten().collect::<Vec<_>>()
        };
        self.cases.iter().flat_map(of).collect()
    }

    /// Predicted costs of the cases and the reference run; meshes are made and analysed, nothing is solved.
    ///
    /// # Errors
    /// A cell that the boundary of a region cuts.
    pub fn costs(&self) -> Result<PlanCost, SetupError> {
        self.costs_of(&self.cases)
    }

    /// Costs of any cases of the scene.
    pub(super) fn costs_of(&self, cases: &[CasePlan]) -> Result<PlanCost, SetupError> {
        match &self.subject {
            Subject::Contact(setup) => {
                contact_costs(setup, cases, self.reference, self.kept_steps())
            }
            Subject::Abstract(setup) => Ok(abstract_costs(setup, cases)),
        }
    }

    /// A lower bound for the bytes of a run, before its mesh is made.
    pub(super) fn least_bytes(&self, n: Option<u32>, steps: u32) -> f64 {
        match &self.subject {
            Subject::Contact(setup) => least_bytes_of_mesh(setup, n.unwrap_or_default(), steps),
            Subject::Abstract(_) => 0.0,
        }
    }

    /// Measures every part of the floor of a case: four to six marches, more if a reference has to be repeated.
    ///
    /// # Errors
    /// A run that fails.
    pub fn floors(&self, case: &CasePlan) -> Result<Vec<FloorRow>, SetupError> {
        match &self.subject {
            Subject::Contact(setup) => {
                let direct = direct_history(Setup::new(setup.scene.clone())?);
                let (n, steps) = (case.n.unwrap_or_default(), case.steps);
                contact_floors(setup, direct.as_ref(), n, steps, &case.norms)
            }
            Subject::Abstract(setup) => Ok(abstract_floors(setup, case.steps)?),
        }
    }

    /// Interval of kept reference levels at which all cases find theirs.
    pub(crate) fn kept_steps(&self) -> u32 {
        self.cases.iter().map(|case| case.steps).fold(1, lowest_common_multiple)
    }
}

/// The cases of a scene; `overrides` replace its grids.
pub(super) fn scene_cases(scene: &Scene, overrides: &Overrides) -> Vec<CasePlan> {
    let own = scene.sweep.clone().unwrap_or_default();
    let ns = overrides.n.clone().unwrap_or(own.n);
    let steps = overrides.steps.clone().unwrap_or(own.steps);
    let ns: Vec<Option<u32>> = match scene.as_contact() {
        Some(_) => ns.into_iter().map(Some).collect(),
        None => vec![None],
    };
    let path = own.pairs.filter(|_| *overrides == Overrides::default());
    let places: Vec<(Option<u32>, u32)> = match &path {
        Some(pairs) => pairs.iter().map(|&[n, steps]| (Some(n), steps)).collect(),
        None => ns.iter().flat_map(|&n| steps.iter().map(move |&steps| (n, steps))).collect(),
    };
    let case = |(n, steps)| CasePlan { n, steps, norms: norms(scene, n) };
    places.into_iter().map(case).collect()
}

/// Runs `run`; a panic becomes an error with its message.
pub fn without_panic<T>(run: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
        Err(format!("internal error: {}", text.unwrap_or("unknown")))
    })
}

/// The fewest steps of a grid with the times of both; `u32::MAX` on overflow.
pub fn lowest_common_multiple(a: u32, b: u32) -> u32 {
    let (mut x, mut y) = (a, b);
    while y > 0 {
        (x, y) = (y, x % y);
    }
    (a / x.max(1)).saturating_mul(b)
}

/// The norms of a case on mesh n: all cheap ones, and those of the scene's list or predictions (the time error needs
/// further runs, so it is measured inside its window only); those by contact state if the scene asks for them.
pub(super) fn norms(scene: &Scene, n: Option<u32>) -> Vec<Norm> {
    let listed = scene.sweep.as_ref().and_then(|sweep| sweep.norms.as_ref());
    let by_state = scene.sweep.as_ref().is_some_and(|sweep| sweep.by_state);
    // Whether a prediction uses mesh n.
    let serves = |prediction: &Prediction| {
        let window = prediction.window_n.or(scene.window_n);
        window.zip(n).is_none_or(|([first, last], n)| (first..=last).contains(&n))
    };
    let asked = |norm: Norm| {
        listed.is_some_and(|list| list.contains(&norm))
            || scene.predicts.iter().any(|p| p.norm == norm && serves(p))
    };
    let body = match &scene.body {
        Body::Contact(body) => body,
        Body::Abstract(problem) => {
            let mut norms = vec![Norm::VMax];
            norms.extend((!problem.traces.is_empty()).then_some(Norm::PressureL2Max));
            norms.extend(asked(Norm::DisplacementMax).then_some(Norm::DisplacementMax));
            return norms;
        }
    };
    let on_contact = body.has_gap() || body.laws().next().is_some();
    Norm::all()
        .filter(|&norm| match norm {
            Norm::VTimeMax | Norm::VProjectionMax | Norm::DisplacementMax => asked(norm),
            _ if norm.needs_contact() && !on_contact => false,
            _ if norm.by_state() => asked(norm) || by_state,
            _ => listed.is_none() || asked(norm),
        })
        .collect()
}
