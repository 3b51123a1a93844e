//! Solvers that stop early, forget, or round; and one that only takes longer. What is committed wrongly is wrong in ζ and in
//! the memory, as a wrong time rule is.

use scene::setup::Setup;
use vhi::{Newton, StepError, StepInfo, StepSolver, StepState};

use super::Term::{self, Solver};
use super::levels::{Commit, SOUND, march, unchecked};
use super::{Defect, marched};
use crate::wrong::solver;

/// Newton's method with a hand in its result.
fn handled(after: fn(&mut StepState)) -> impl StepSolver {
    solver(move |problem, state, scratch| {
        let info = Newton::default().solve(problem, state, scratch)?;
        after(state);
        Ok(info)
    })
}

fn rounded() -> impl StepSolver {
    handled(|state| single(&mut state.u))
}

/// In the volume, where the condensed problem would be solved to rounding all the same.
fn loose() -> impl StepSolver {
    // 1e11 units of rounding: a residual of 2e-5 of the forces.
    let newton = Newton { rounding_units: 1e11, ..Newton::default() };
    solver(move |problem, state, scratch| newton.solve(problem, state, scratch))
}

/// One iteration, whose result counts.
fn hasty() -> impl StepSolver {
    solver(|problem, state, scratch| {
        let newton = Newton { max_iterations: 1, ..Newton::default() };
        match newton.solve(problem, state, scratch) {
            Err(StepError::NotConverged { iterations, residual, tolerance }) => {
                Ok(StepInfo { iterations, residual, tolerance, ..StepInfo::default() })
            }
            other => other,
        }
    })
}

fn single(values: &mut [f64]) {
    values.iter_mut().for_each(|value| *value = f64::from(*value as f32));
}

/// Other states are committed; the KKT system is checked.
fn committed(term: Term, name: &'static str, commit: Commit) -> Defect {
    term.run(name, move |run| march(run, &Newton::default(), commit, true))
}

/// The loop of the defects without a defect, for the test that the loop itself is sound.
pub fn sound_loop(setup: &mut Setup) {
    marched(|run| march(run, &Newton::default(), SOUND, true))(setup);
}

pub fn defects() -> Vec<Defect> {
    let history = |name, commit| committed(Term::TimeRule, name, commit);
    vec![
        Solver.run("loose Newton, residual 2e-5", |run| run.by(&loose())),
        Solver.run("loose Newton, KKT system not checked", |run| unchecked(run, &loose())),
        Solver.run("one Newton iteration, taken for converged", |run| run.by(&hasty())),
        Solver.run("one Newton iteration, KKT system not checked", |run| unchecked(run, &hasty())),
        Solver.run("solution through f32", |run| run.by(&rounded())),
        Solver
            .run("solution through f32, KKT system not checked", |run| unchecked(run, &rounded())),
        Solver.run("multiplier with the other sign", |run| {
            run.by(&handled(|state| state.pressure.iter_mut().for_each(|c| *c = -*c)))
        }),
        committed(Term::Memory, "history keeps f32", |_, solution, _, _| {
            let mut kept = solution.clone();
            single(&mut kept.u);
            kept
        }),
        history("history keeps the start value of Newton's method", |_, solution, start, _| {
            let u = if start.u.is_empty() { &solution.u } else { &start.u };
            StepState { u: u.clone(), ..solution.clone() }
        }),
        history("stale history: u_{n-1} committed for u_n", |_, solution, _, last| {
            if last.u.is_empty() { solution.clone() } else { last.clone() }
        }),
        history("history loses u_4 (zero committed)", |n, solution, _, _| match n == 4 {
            true => StepState { u: vec![0.0; solution.u.len()], ..solution.clone() },
            false => solution.clone(),
        }),
        Solver.run("start value zero at every level", |run| {
            run.by(&solver(|problem, state, scratch| {
                state.u.fill(0.0);
                state.pressure.fill(0.0);
                Newton::default().solve(problem, state, scratch)
            }))
        }),
    ]
}
