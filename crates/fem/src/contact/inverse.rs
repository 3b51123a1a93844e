//! K⁻¹ of one positive definite matrix, to rounding.

use std::time::Instant;

use super::{Discretization, LinearSolver, StiffnessInverse, Work};
use algebra::linalg::{FactorError, MultigridSequence, norm};
use vhi::Newton;
use vhi::law::TensorField;

/// By a factor in double precision, or without.
pub(super) enum Inverse<'a> {
    Direct {
        inverse: StiffnessInverse<'a>,
        work: Work,
    },
    Multigrid {
        space: &'a Discretization,
        values: Vec<f64>,
        sequence: Box<MultigridSequence<'a>>,
        seconds_assemble: f64,
    },
}

/// Residual of one solve over its right side: further digits come from solving for what is left.
const FORCING: f64 = 1e-8;
/// A correction that leaves more than this of the residual has met rounding.
const STANDSTILL: f64 = 0.5;

impl<'a> Inverse<'a> {
    /// Of the stiffness matrix of `tensor`.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub(super) fn new(
        space: &'a Discretization,
        solver: LinearSolver,
        tensor: &TensorField,
    ) -> Result<Self, FactorError> {
        if let Some(levels) = solver.levels(space) {
            let start = Instant::now();
            let values = space.stiffness(tensor);
            let seconds_assemble = start.elapsed().as_secs_f64();
            let mut sequence = Box::new(MultigridSequence::new(levels, &space.pattern));
            sequence.prepare(values.clone(), None, false)?;
            return Ok(Self::Multigrid { space, values, sequence, seconds_assemble });
        }
        let mut work = Work::default();
        let inverse = StiffnessInverse::held(space, tensor, &mut work)?;
        Ok(Self::Direct { inverse, work })
    }

    /// K⁻¹ b in place.
    ///
    /// # Errors
    /// Those of the iteration.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) -> Result<(), FactorError> {
        match self {
            Self::Direct { inverse, work } => {
                let start = Instant::now();
                inverse.solve(rhs);
                work.linear.solves += 1;
                work.linear.seconds_solve += start.elapsed().as_secs_f64();
            }
            Self::Multigrid { space, values, sequence, .. } => {
                let diagonal = |dof: usize, x: f64| values[space.pattern.diagonal(dof)] * x;
                let size = norm(rhs);
                let mut residual = rhs.to_vec();
                let (mut image, mut last) = (vec![0.0; rhs.len()], f64::INFINITY);
                let mut correction = residual.clone();
                let mut x = vec![0.0; rhs.len()];
                loop {
                    let forces = x.iter().enumerate().map(|(dof, x)| diagonal(dof, *x));
                    let scale = norm(&forces.collect::<Vec<f64>>()) + size;
                    let left = norm(&residual);
                    // The tolerance of Newton's method; or as far as rounding lets a solve come.
                    let small = Newton::default().rounding_units * f64::EPSILON * scale;
                    if left <= small || left > STANDSTILL * last {
                        break;
                    }
                    last = left;
                    correction.copy_from_slice(&residual);
                    sequence.solve(&mut correction, (0.3 * small / left).max(FORCING))?;
                    x.iter_mut().zip(&correction).for_each(|(x, by)| *x += by);
                    space.pattern.multiply(values, &x, &mut image);
                    for ((own, b), f) in residual.iter_mut().zip(&*rhs).zip(&image) {
                        *own = b - f;
                    }
                }
                rhs.copy_from_slice(&x);
            }
        }
        Ok(())
    }

    /// The same without the last digits, for estimates; not a number where it fails.
    pub(super) fn estimate(&mut self, rhs: &mut [f64]) {
        match self {
            Self::Direct { inverse, .. } => inverse.solve(rhs),
            Self::Multigrid { sequence, .. } => sequence.solve_again(rhs),
        }
    }

    /// The lower-triangle values of the matrix.
    pub(super) fn values(&self) -> &[f64] {
        match self {
            Self::Direct { inverse, .. } => inverse.values(),
            Self::Multigrid { values, .. } => values,
        }
    }

    /// Counters and times.
    pub(super) fn work(&self) -> Work {
        match self {
            Self::Direct { work, .. } => *work,
            Self::Multigrid { sequence, seconds_assemble, .. } => Work {
                seconds_assemble: *seconds_assemble,
                linear: sequence.work,
                ..Work::default()
            },
        }
    }
}
