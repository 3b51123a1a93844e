//! The work of whole runs is no more than it once was: a ratchet, not a truth. Errors of the same runs are judged elsewhere.

use fem::contact::{CaseInfo, march};
use scene::setup::TruthLoad;
use vhi::Newton;

use super::shipped::{on_mesh, setup};

/// Newton iterations, factorizations, solves with factors and residuals in the volume.
fn counters(info: &CaseInfo) -> [u32; 4] {
    let linear = info.work.linear;
    [info.newton_iterations, linear.factorizations, linear.solves, info.work.residuals]
}

fn run(name: &str, n: u32, steps: u32, newton: &Newton) -> [u32; 4] {
    let setup = setup(name);
    let data = on_mesh(&setup, n);
    let (mut load, grid) = (TruthLoad(&*data.truth), setup.grid(steps));
    let info = march(&data.space, &setup.model, &grid, &mut load, newton, &mut |_| Ok(()));
    counters(&info.unwrap_or_else(|error| panic!("{name}: {error}")))
}

/// Iterations at rounding end one earlier or later on another processor: a tenth more, and one.
fn within(now: [u32; 4], recorded: [u32; 4]) -> bool {
    now.iter().zip(recorded).all(|(&now, recorded)| now <= recorded + recorded / 10 + 1)
}

/// Recorded on 28 November 2026: a level of `punch` takes about two iterations, twelve solves with a factor that serves
/// one level, and three residuals; condensed or linear levels take one solve and no residual.
const RECORDED: [(&str, u32, u32, [u32; 4]); 4] = [
    ("linear-punch", 32, 32, [33, 1, 33, 0]),
    ("elastic-punch", 32, 32, [49, 1, 33, 0]),
    ("punch", 32, 32, [104, 30, 391, 137]),
    ("punch", 48, 16, [69, 23, 274, 86]),
];

#[test]
fn whole_runs_take_no_more_work_than_recorded() {
    for (name, n, steps, recorded) in RECORDED {
        let now = run(name, n, steps, &Newton::default());
        println!("{name} {n} {steps}: {now:?}, recorded {recorded:?}");
        assert!(within(now, recorded), "{name} n = {n}, N = {steps}: {now:?}, {recorded:?}");
    }
}

/// Strict linear solves are more passes, loose ones more iterations: the ratchet sees either.
#[test]
fn a_dearer_solver_is_seen() {
    let (name, n, steps, recorded) = RECORDED[2];
    for linear_tolerance in [1e-12, 0.3] {
        let dear = Newton { linear_tolerance, ..Newton::default() };
        let now = run(name, n, steps, &dear);
        assert!(!within(now, recorded), "{linear_tolerance}: {now:?}");
    }
}
