//! Source: the discrete inequality (4.3) as a system of force balance and graphs.
//! Goal: the separate evaluation after each step refuses what is no solution, with and without a mesh: a solver that
//!   hands back a wrong state ends in an error and not in a result.
//! Mesh: 8 × 8 squares for `punch`; none for `abstract-contact`.

use crate::shipped::{abstract_of, text};
use crate::wrong::solver;
use vhi::finite::FiniteError;
use vhi::{Newton, OpenInequality, StepSolver, StepState};

/// Newton's method, with a hand in its result.
fn tampered(tamper: fn(&mut StepState)) -> impl StepSolver {
    solver(move |problem: &mut dyn OpenInequality, state: &mut _, scratch: &mut _| {
        let info = Newton::default().solve(problem, state, scratch)?;
        tamper(state);
        Ok(info)
    })
}

#[test]
fn wrong_states_are_refused_without_a_mesh() {
    let setup = abstract_of(text("abstract-contact"));
    let run = |tamper: fn(&mut StepState)| setup.run(64, &tampered(tamper)).map(|run| run.error);
    assert!(run(|_| ()).is_ok());
    // Forces off by 1e-10 of their size; a pressure beyond the law between the bounds, and one missing on a bound.
    let wrong: [fn(&mut StepState); 3] = [
        |state| state.u[0] += 1e-10,
        |state| state.pressure[0] += 1e-10,
        |state| state.pressure[0] = state.pressure[0].min(0.05),
    ];
    for tamper in wrong {
        let outcome = run(tamper);
        assert!(matches!(outcome, Err(FiniteError::Kkt { .. })), "{outcome:?}");
    }
}
