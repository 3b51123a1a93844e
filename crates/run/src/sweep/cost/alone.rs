//! What one run takes without measuring its error.

use super::truth::{load_bytes, truth};
use super::{PROGRAM, march};
use fem::contact::Discretization;
use scene::setup::Setup;

/// What one run takes without measuring its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunCost {
    /// Peak memory of a process that does this run alone.
    pub memory_bytes: f64,
    /// What the march has of it: factor, matrices, vectors and history.
    pub march_bytes: f64,
    /// What the history has of that.
    pub history_bytes: f64,
    /// What loads keep beside it.
    pub load_bytes: f64,
}

/// The memory of one run, mesh, loads and march, as `sweep solve` does it.
pub fn run_cost(setup: &Setup, space: &Discretization, n: u32, steps: u32) -> RunCost {
    let run = march(setup, space, n, steps);
    let load_bytes = load_bytes(setup, space);
    RunCost {
        memory_bytes: PROGRAM + run.memory_bytes + load_bytes,
        march_bytes: run.memory_bytes,
        history_bytes: (setup.history_vectors(steps) * space.dofs() * 8) as f64,
        load_bytes,
    }
}

/// The CPU seconds of one run for loads and march, without mesh and analysis.
pub fn run_seconds(setup: &Setup, space: &Discretization, n: u32, steps: u32) -> f64 {
    let own = truth(setup, None, space);
    let loads = own.parts_seconds + own.load * (f64::from(steps) + 1.0);
    march(setup, space, n, steps).seconds + loads
}

/// The memory of one march alone.
pub(crate) fn march_bytes(setup: &Setup, space: &Discretization, n: u32, steps: u32) -> f64 {
    march(setup, space, n, steps).memory_bytes
}

/// Vectors of an iteration for an eigenvalue, which keeps all of its iterates and their images: as many as it is given on a
/// long domain, where many eigenvalues lie close to the largest.
const ITERATES: f64 = 1200.0;

/// The memory of a process that computes a constant of the trace on a mesh: its stiffness matrix with a factor in double
/// precision, and the iterates.
pub(crate) fn eigenvalue_bytes(space: &Discretization) -> f64 {
    let (entries, factor) =
        (space.pattern.entries() as f64, space.analysis.factor_entries() as f64);
    PROGRAM + 12.0 * factor + 40.0 * entries + 8.0 * ITERATES * space.dofs() as f64
}
