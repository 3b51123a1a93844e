//! A computable scene of either kind.

use super::constants::{Constants, Smallness, needed, step_bounds};
use super::{AbstractSetup, MeshData, Result, Setup, SetupError};
use crate::{Hypothesis, Scene};
use fem::contact::{CaseError, CaseInfo, Observer};
use files::digits;
use vhi::history::TimeGrid;
use vhi::{Newton, StepBounds, StepPlace};

/// A scene made computable.
pub enum Subject {
    /// Problem 12, a body in contact.
    Contact(Box<Setup>),
    /// Problem 1 in ℝ^m.
    Abstract(Box<AbstractSetup>),
}

impl Subject {
    /// Sets a scene up and checks what needs its model.
    ///
    /// # Errors
    /// The first violated condition, at its key in the scene.
    pub fn new(scene: Scene) -> Result<Self> {
        match scene.as_contact() {
            Some(_) => Ok(Self::Contact(Box::new(Setup::new(scene)?))),
            None => Ok(Self::Abstract(Box::new(AbstractSetup::new(scene)?))),
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        match self {
            Self::Contact(setup) => &setup.scene,
            Self::Abstract(setup) => &setup.scene,
        }
    }

    /// The grid with the given number of steps.
    pub fn grid(&self, steps: u32) -> TimeGrid {
        match self {
            Self::Contact(setup) => setup.grid(steps),
            Self::Abstract(setup) => setup.grid(steps),
        }
    }

    /// Whether the exact solution is known; otherwise a reference run is needed.
    pub fn has_exact(&self) -> bool {
        !matches!(self, Self::Contact(setup) if setup.exact.is_none())
    }
}

// The solver under test: marches a scene through the levels of a time grid.

/// A solver of Problem 14 on a given mesh and time grid. A sweep measures and judges what it shows.
pub trait Scheme: Send + Sync {
    /// Solves the scene with `steps` steps on its time grid and shows every level, n = 0 first, to `observe`.
    ///
    /// # Errors
    /// A level that has no solution or was not found; errors of `observe` are passed on.
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError>;
}

/// P1 elements, the time rule of the scene, semismooth Newton: [`fem::contact::march`].
#[derive(Debug, Clone, Copy, Default)]
pub struct NewtonMarch;

impl Scheme for NewtonMarch {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        data.march(setup, steps, &Newton::default(), observe)
    }
}

// Step sizes against (3.4): refusals and remarks.

/// Largest number of steps that a hint proposes.
const MOST_STEPS: u32 = 1 << 20;

/// A remark on the step sizes of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct StepRemark {
    /// Warning or note.
    pub warning: bool,
    /// One sentence, used in reports.
    pub text: String,
}

/// The constants of a scene for its step size.
///
/// # Errors
/// As [`step_bounds`].
pub fn subject_bounds(subject: &Subject) -> Result<StepBounds> {
    match subject {
        Subject::Contact(setup) => step_bounds(setup),
        Subject::Abstract(setup) => Ok(setup.constants.step_bounds(setup.model.time_rule.as_ref())),
    }
}

/// Compares the grids with these numbers of steps with (3.4) and with the bound below which each step is strongly
/// monotone.
///
/// # Errors
/// A step size at or beyond the latter, unless the scene says `violates = ["3.4"]`, or violates (2.9) or
/// (5.1), without which there is no bound.
pub fn check_step_sizes(subject: &Subject, steps: &[u32]) -> Result<Option<StepRemark>> {
    let scene = subject.scene();
    scene.check_steps(steps)?;
    let violates = |hypothesis| scene.violates.contains(&hypothesis);
    if violates(Hypothesis::Smallness) || violates(Hypothesis::LipschitzKappa) {
        return Ok(None);
    }
    let bounds = match subject {
        Subject::Contact(setup) => {
            let constants = needed(setup)?;
            if constants.smallness() == Smallness::Unknown {
                return Ok(Some(StepRemark { warning: true, text: unknown(&constants) }));
            }
            // Without a history the steps are problems of their own, of any size.
            let remembers = !setup.model.memory.is_empty() || constants.lipschitz_kappa > 0.0;
            if !remembers && !violates(Hypothesis::StepSize) {
                return Ok(None);
            }
            constants.step_bounds(setup.model.time_rule.as_ref())
        }
        Subject::Abstract(_) => subject_bounds(subject)?,
    };
    let size = |steps: u32| subject.grid(steps).largest_step();
    let Some(coarsest) = steps.iter().copied().max_by(|&a, &b| size(a).total_cmp(&size(b))) else {
        return Ok(None);
    };
    let (k, declared) = (size(coarsest), violates(Hypothesis::StepSize));
    let (limit, solvable) = (bounds.limit(), below(bounds.solvable_limit()));
    let (step, bound) = (digits(k, 5), digits(limit, 5));
    let place = bounds.place(k);
    let text = match place {
        StepPlace::WithinTheorem if declared => format!(
            "violates = [\"3.4\"] is not needed: k = {step} is below the bound (3.4), {bound}"
        ),
        StepPlace::WithinTheorem => return Ok(None),
        StepPlace::Solvable => format!(
            "k = {step} (N = {coarsest}) is above the bound k < {bound} of (3.4), but strong monotonicity still guarantees one solution per step{solvable}"
        ),
        StepPlace::Unguaranteed if declared => format!(
            "k = {step} (N = {coarsest}) violates (3.4) on purpose: one solution per step is guaranteed only{solvable}"
        ),
        StepPlace::Unguaranteed => return Err(refusal(subject, coarsest, k, &bounds)),
    };
    Ok(Some(StepRemark { warning: place != StepPlace::WithinTheorem, text }))
}

fn unknown(constants: &Constants) -> String {
    let [low, high] = constants.m0_range.map(|value| digits(value, 7));
    let [least, most] = constants.c_nu_range.map(|value| digits(value, 7));
    format!(
        "it is not known whether (2.9) holds: m0 lies between {low} and {high}, because c_j^2 is only known to lie between {least} and {most}, so no bound on the step size follows"
    )
}

fn below(limit: f64) -> String {
    if limit.is_finite() { format!(" for k < {}", digits(limit, 5)) } else { " for every k".into() }
}

fn refusal(subject: &Subject, steps: u32, k: f64, bounds: &StepBounds) -> SetupError {
    let limit = bounds.solvable_limit();
    let message = format!(
        "N = {steps} makes k = {}, but one solution per step is guaranteed only for k < {} (and by (3.4) itself for k < {})",
        digits(k, 5),
        digits(limit, 5),
        digits(bounds.limit(), 5)
    );
    let enough = sufficient(subject, limit)
        .map_or(String::new(), |steps| format!("take N = {steps} steps or more, or "));
    let hint = format!("{enough}say violates = [\"3.4\"] in [scene] to run it all the same");
    subject.scene().error("time", message, hint).into()
}

/// The smallest number of steps that brings k below `limit`.
fn sufficient(subject: &Subject, limit: f64) -> Option<u32> {
    let time = subject.scene().time;
    let size = |steps: u32| time.grid(steps).map_or(f64::INFINITY, |grid| grid.largest_step());
    let doubled = std::iter::successors(Some(1), |steps| Some(2 * steps));
    let enough = doubled.take_while(|&steps| steps <= MOST_STEPS).find(|&n| size(n) < limit)?;
    // The least lies above its half.
    let steps: Vec<u32> = (enough / 2..=enough).collect();
    Some(steps[steps.partition_point(|&steps| size(steps.max(1)) >= limit)])
}
