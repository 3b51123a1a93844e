//! What the linear systems of a march cost, with factors or with multigrid.

use super::Kind;
use fem::contact::{Discretization, LinearSolver};

/// Seconds an entry of the matrix: of an iteration of conjugate gradients with its cycle, and of all coarse matrices.
const CYCLE: f64 = 8e-9;
const COARSE_MATRICES: f64 = 20e-9;
/// Bytes an entry of the matrix in its levels: all in single precision, coarse ones in double precision with index.
const MULTIGRID_BYTES: f64 = 8.0;
/// Seconds of a factorization an entry of the factor and a multiplication.
const FACTOR: [f64; 2] = [2.8e-9, 1.5e-11];
/// From this order on factors are kept in single precision, see `linalg`.
const SINGLE_FROM: usize = 4000;

/// Seconds in the linear systems of a march with so many iterations and factorizations, and bytes.
pub(super) fn linear(
    kind: Kind,
    solver: LinearSolver,
    space: &Discretization,
    [iterations, factorizations]: [f64; 2],
) -> (f64, f64) {
    let newton = matches!(kind, Kind::Contact | Kind::Projection);
    match solver {
        LinearSolver::Direct => {
            let entries = space.analysis.factor_entries() as f64;
            let factor = FACTOR[0] * entries + FACTOR[1] * space.analysis.multiplications();
            let single = space.dofs() >= SINGLE_FROM && newton;
            // The factor and scratch of half its size.
            let bytes = 1.5 * entries * if single { 4.0 } else { 8.0 };
            (iterations * kind.solve() * entries + factorizations * factor, bytes)
        }
        LinearSolver::Multigrid => {
            let entries = space.pattern.entries() as f64;
            let seconds = entries * iterations * (CYCLE * kind.cycles() + COARSE_MATRICES);
            (seconds, MULTIGRID_BYTES * entries)
        }
    }
}
