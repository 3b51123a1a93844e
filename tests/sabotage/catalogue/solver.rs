//! Solvers that stop early, forget, or round; and one that only takes longer. What is committed wrongly is wrong in ζ and in
//! the memory, as a wrong time rule is.

use fem::contact::{CaseError, CaseInfo, Observer};
use scene::setup::{MeshData, Setup};
use vhi::{Newton, OpenInequality, Scratch, StepError, StepInfo, StepSolver, StepState};

use super::levels::{Commit, march};
use super::{Defect, Term, marched};

/// Newton's method with a hand in start value and result.
struct Handled {
    newton: Newton,
    before: fn(&mut StepState),
    after: fn(&mut StepState),
    /// Whether running out of iterations counts as a result.
    content: bool,
}

impl StepSolver for Handled {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        (self.before)(state);
        let info = match self.newton.solve(problem, state, scratch) {
            Err(StepError::NotConverged { iterations, residual, tolerance }) if self.content => {
                StepInfo { iterations, residual, tolerance, ..StepInfo::default() }
            }
            other => other?,
        };
        (self.after)(state);
        Ok(info)
    }
}

impl Default for Handled {
    fn default() -> Self {
        Self { newton: Newton::default(), before: |_| (), after: |_| (), content: false }
    }
}

fn loose() -> Handled {
    // 1e11 units of rounding: a residual of 2e-5 of the forces.
    Handled { newton: Newton { rounding_units: 1e11, ..Newton::default() }, ..Handled::default() }
}

fn hasty(iterations: usize) -> Handled {
    let newton = Newton { max_iterations: iterations, ..Newton::default() };
    Handled { newton, content: true, ..Handled::default() }
}

fn single(values: &mut [f64]) {
    values.iter_mut().for_each(|value| *value = f64::from(*value as f32));
}

const SOUND: Commit = |_, solution, _, _| solution.clone();

macro_rules! solved {
    ($name:literal, $solver:expr) => {
        Defect::of(Term::Solver, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                data.march(setup, steps, &$solver, observe)
            })
        })
    };
}

macro_rules! levelled {
    ($term:expr, $name:literal, $solver:expr, $commit:expr, $checked:literal) => {
        Defect::of($term, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                march(setup, data, steps, observe, &$solver, $commit, $checked)
            })
        })
    };
}

/// The loop of the defects without a defect, for the test that the loop itself is sound.
pub fn sound_loop(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    march(setup, data, steps, observe, &Newton::default(), SOUND, true)
}

pub fn defects() -> Vec<Defect> {
    vec![
        solved!("loose Newton, residual 2e-5", loose()),
        levelled!(Term::Solver, "loose Newton, KKT system not checked", loose(), SOUND, false),
        solved!("one Newton iteration, taken for converged", hasty(1)),
        levelled!(
            Term::Solver,
            "one Newton iteration, KKT system not checked",
            hasty(1),
            SOUND,
            false
        ),
        solved!(
            "solution through f32",
            Handled { after: |state| single(&mut state.u), ..Handled::default() }
        ),
        levelled!(
            Term::Solver,
            "solution through f32, KKT system not checked",
            Handled { after: |state| single(&mut state.u), ..Handled::default() },
            SOUND,
            false
        ),
        solved!(
            "multiplier with the other sign",
            Handled {
                after: |state| state.pressure.iter_mut().for_each(|c| *c = -*c),
                ..Handled::default()
            }
        ),
        levelled!(
            Term::Memory,
            "history keeps f32",
            Newton::default(),
            |_, solution, _, _| {
                let mut kept = solution.clone();
                single(&mut kept.u);
                kept
            },
            true
        ),
        levelled!(
            Term::TimeRule,
            "history keeps the start value of Newton's method",
            Newton::default(),
            |_, solution, start, _| match start.u.is_empty() {
                true => solution.clone(),
                false => StepState { u: start.u.clone(), ..solution.clone() },
            },
            true
        ),
        levelled!(
            Term::TimeRule,
            "stale history: u_{n-1} committed for u_n",
            Newton::default(),
            |_, solution, _, last| match last.u.is_empty() {
                true => solution.clone(),
                false => last.clone(),
            },
            true
        ),
        levelled!(
            Term::TimeRule,
            "history loses u_4 (zero committed)",
            Newton::default(),
            |n, solution, _, _| match n == 4 {
                true => StepState { u: vec![0.0; solution.u.len()], ..solution.clone() },
                false => solution.clone(),
            },
            true
        ),
        solved!(
            "start value zero at every level",
            Handled {
                before: |state| {
                    state.u.fill(0.0);
                    state.pressure.fill(0.0);
                },
                ..Handled::default()
            }
        ),
    ]
}
