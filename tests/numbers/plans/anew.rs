//! Newton's method with the factor of every Jacobian, without iterations for linear systems: through
//! the seam of step solvers, which sees a level as a matrix to be linearized and solved.

use std::cell::Cell;

use crate::wrong::as_level;
use algebra::linalg::FactorError;
use vhi::{
    Newton, OpenInequality, Scratch, StepError, StepInequality, StepInfo, StepSolver, StepState,
};

/// A residual below nothing is reached by no iteration with a lagged factor, so that a factor of the present
/// Jacobian is made.
const UNREACHABLE: f64 = -1.0;

/// Newton's method with a new factor for every Jacobian.
#[derive(Default)]
pub struct Anew {
    pub newton: Newton,
    /// Lagged factors serve as they do without this solver.
    pub old: bool,
    /// Forces are those of displacements that are so much too large, relative: a defect that a test may seed.
    pub off: f64,
    /// Solves that were asked for.
    pub solves: Cell<u32>,
}

/// A defect that passes the separate evaluation of the balance, which allows 1e-9 of the largest force.
pub const OFF: f64 = 4e-10;

/// Newton's method as it is but for the defect.
pub fn defective() -> Anew {
    Anew { old: true, off: OFF, ..Anew::default() }
}

impl StepSolver for Anew {
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        self.newton.solve(&mut Level { problem, solver: self }, state, scratch)
    }
}

struct Level<'p> {
    problem: &'p mut dyn OpenInequality,
    solver: &'p Anew,
}

impl StepInequality for Level<'_> {
    as_level!(problem: dofs graph linearize force_scale);

    fn descent(&self, i: usize) -> f64 {
        self.problem.descent(i)
    }

    fn residual(&mut self, u: &[f64], out: &mut [f64]) {
        if self.solver.off == 0.0 {
            return self.problem.residual(u, out);
        }
        let wrong: Vec<f64> = u.iter().map(|u| u * (1.0 + self.solver.off)).collect();
        self.problem.residual(&wrong, out);
    }

    fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        self.solver.solves.set(self.solver.solves.get() + 1);
        self.problem.solve(rhs, if self.solver.old { forcing } else { UNREACHABLE })
    }
}
