//! How K⁻¹ is applied: passes over a factor, or conjugate gradients with multigrid.

use std::sync::Arc;

use super::Discretization;
use algebra::linalg::{
    Analysis, Factor, FactorError, Front, Jacobian, MultigridSequence, RightSides, SIDES,
    TangentSolver, Workspace, axpy, norm, root_of_squares,
};
use vhi::Newton;

pub(super) enum Way<'a> {
    /// A factor that the mesh holds is shared, and needs no workspace.
    Factor {
        analysis: &'a Analysis,
        factor: Arc<Factor>,
        workspace: Option<Workspace>,
        front: Front<f64>,
        sides: Front<RightSides>,
    },
    Multigrid {
        sequence: Box<MultigridSequence<'a>>,
        jacobian: Jacobian,
        room: [Vec<f64>; 4],
    },
}

/// Residual of one solve by multigrid over its right side: further digits come from solving for what is left.
const FORCING: f64 = 1e-8;
/// A correction that leaves more than this of the residual has met rounding.
const STANDSTILL: f64 = 0.5;

/// The residual with which Newton's method in the volume would accept a level with forces of this size.
pub(super) fn accepted_residual(size: f64) -> f64 {
    Newton::default().rounding_units * f64::EPSILON * size
}

impl Way<'_> {
    /// The factor of the Schur complement on the unknowns from `cut` on, see [`Analysis::last_triangle`].
    pub(super) fn last_triangle(&self, cut: usize) -> Vec<f64> {
        match self {
            Self::Factor { analysis, factor, .. } => analysis.last_triangle(factor, cut),
            Self::Multigrid { .. } => Vec::new(),
        }
    }

    /// The forward pass in the rows before `cut`, of `width` right sides; none without a factor.
    pub(super) fn forward(&mut self, cut: usize, width: usize, x: &mut [f64]) {
        if let Self::Factor { analysis, factor, front, sides, .. } = self {
            match width {
                SIDES => analysis.forward(factor, cut, x.as_chunks_mut().0, sides),
                _ => analysis.forward(factor, cut, x, front),
            }
        }
    }

    pub(super) fn backward(&mut self, cut: usize, width: usize, x: &mut [f64]) {
        if let Self::Factor { analysis, factor, front, sides, .. } = self {
            match width {
                SIDES => analysis.backward(factor, cut, x.as_chunks_mut().0, sides),
                _ => analysis.backward(factor, cut, x, front),
            }
        }
    }

    /// K⁻¹x in place to rounding, over the unknowns.
    ///
    /// # Errors
    /// The multigrid iteration does not converge.
    pub(super) fn solve(
        &mut self,
        space: &Discretization,
        x: &mut [f64],
    ) -> Result<(), FactorError> {
        match self {
            Self::Factor { analysis, factor, front, .. } => {
                analysis.solve(factor, x, front);
                Ok(())
            }
            Self::Multigrid { sequence, jacobian, room } => {
                solve_by(space, jacobian, sequence, room, x)
            }
        }
    }

    /// K⁻¹x in place without the last digits, for estimates; NaN where it fails.
    pub(super) fn estimate(&mut self, x: &mut [f64]) {
        match self {
            Self::Factor { analysis, factor, front, .. } => analysis.solve(factor, x, front),
            Self::Multigrid { sequence, jacobian, .. } => {
                sequence.solve_with_last_factor(jacobian, x)
            }
        }
    }
}

/// ‖diag(K)u‖.
pub(super) fn size_of_forces(space: &Discretization, matrix: &[f64], u: &[f64]) -> f64 {
    let force = |(dof, u): (usize, &f64)| matrix[space.pattern.diagonal(dof)] * u;
    root_of_squares(|scale| {
        u.iter().enumerate().map(force).map(|f| (scale * f) * (scale * f)).sum()
    })
}

/// A solve by multigrid as far as rounding lets it come.
fn solve_by(
    space: &Discretization,
    jacobian: &Jacobian,
    sequence: &mut MultigridSequence<'_>,
    [residual, image, correction, x]: &mut [Vec<f64>; 4],
    rhs: &mut [f64],
) -> Result<(), FactorError> {
    let size = norm(rhs);
    residual.copy_from_slice(rhs);
    x.fill(0.0);
    let mut last = f64::INFINITY;
    loop {
        let forces = size_of_forces(space, &jacobian.values, x);
        let left = norm(residual);
        // The tolerance of Newton's method; or as far as rounding lets a solve come.
        let small = accepted_residual(forces + size);
        if left <= small || left > STANDSTILL * last {
            break;
        }
        last = left;
        correction.copy_from_slice(residual);
        sequence.solve(jacobian, correction, (0.3 * small / left).max(FORCING))?;
        axpy(1.0, correction, x);
        space.pattern.multiply(&jacobian.values, x, image);
        for ((entry, b), f) in residual.iter_mut().zip(&*rhs).zip(&*image) {
            *entry = b - f;
        }
    }
    rhs.copy_from_slice(x);
    Ok(())
}
