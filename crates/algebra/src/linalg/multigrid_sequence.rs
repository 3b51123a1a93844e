//! Solves with Jacobians K + a bᵀ by conjugate gradients with a multigrid cycle for K, and the Sherman–Morrison
//! formula. Only the coarsest matrix is factorized.

use std::time::Instant;

use super::cholesky::FactorError;
use super::conjugate_gradient::{Directions, conjugate_gradients};
use super::gmres::Preconditioned;
use super::jacobian::{Jacobian, RankOne};
use super::multigrid::{Levels, Multigrid, Symmetric};
use super::pattern::BlockPattern;
use super::tangent_solver::{LinearWork, TangentSolver};
use super::{axpy, dot, norm};

/// Iterations after which a solve is given up: 5 are usual for four digits, and 58 with λ/μ_L = 1000.
const LIMIT: u32 = 600;
/// Restarts from the true residual: the recursive residual of conjugate gradients departs from it by rounding, and the
/// target may be close to that.
const ROUNDS: usize = 4;
/// First relative residual of K⁻¹a: enough for the sign of 1 + bᵀK⁻¹a.
const ROUGHLY: f64 = 1e-2;
/// Residual of [`TangentSolver::solve_with_last_factor`], whose result is multiplied by safety factors.
const ESTIMATE: f64 = 1e-3;

/// Solver for a sequence of Jacobians.
pub struct MultigridSequence<'a> {
    cycle: Multigrid<'a>,
    pattern: &'a BlockPattern,
    /// Whether the cycle is built for the present K.
    ready: bool,
    /// K⁻¹a of the last solve, the start value of the next.
    response: Vec<f64>,
    /// Scratch: a solution, its residual, its correction.
    solution: Vec<f64>,
    residual: Vec<f64>,
    correction: Vec<f64>,
    vectors: Directions,
    /// Counters and times; a factorization is that of the coarsest matrix.
    pub work: LinearWork,
}

struct Matrix<'s, 'a> {
    pattern: &'a BlockPattern,
    values: &'s [f64],
    cycle: &'s mut Multigrid<'a>,
}

impl Preconditioned for Matrix<'_, '_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.pattern.multiply(self.values, x, out);
    }

    fn precondition(&mut self, x: &mut [f64]) {
        self.cycle.cycle(x);
    }
}

impl<'a> MultigridSequence<'a> {
    /// A solver without a Jacobian yet.
    pub fn new(levels: &'a Levels, pattern: &'a BlockPattern) -> Self {
        Self {
            cycle: Multigrid::new(Symmetric, levels, pattern),
            pattern,
            ready: false,
            response: Vec::new(),
            solution: Vec::new(),
            residual: Vec::new(),
            correction: Vec::new(),
            vectors: Directions::default(),
            work: LinearWork::default(),
        }
    }

    /// x = K⁻¹r - c y with y = K⁻¹a, c = bᵀK⁻¹r/(1 + bᵀy): the residual is that of the first solve minus c times that
    /// of the second.
    fn solve_with(
        &mut self,
        jacobian: &Jacobian,
        rank_one: &RankOne,
        rhs: &mut [f64],
        target: f64,
    ) -> Result<(), FactorError> {
        let size = norm(&rank_one.a);
        if size == 0.0 {
            // No cell yields: a = 0, and there is nothing to correct.
            return self.solve_matrix(jacobian, rhs, target);
        }
        self.solve_matrix(jacobian, rhs, 0.5 * target)?;
        let along = dot(&rank_one.b, rhs);
        let mut response = std::mem::take(&mut self.response);
        response.resize(rhs.len(), 0.0);
        jacobian.held.iter().for_each(|&dof| response[dof] = 0.0);
        let mut wanted = (0.5 * target / along.abs()).min(ROUGHLY * size);
        let factor = loop {
            self.improve(jacobian, &rank_one.a, &mut response, wanted)?;
            let denominator = 1.0 + dot(&rank_one.b, &response);
            // K⁻¹ and K + a bᵀ share their sign as long as the step has one solution (bound (3.4)).
            if denominator.is_nan() || denominator <= 0.0 {
                return Err(FactorError::SingularInZeta { denominator });
            }
            let factor = along / denominator;
            if factor.abs() * wanted <= 0.5 * target {
                break factor;
            }
            wanted = 0.4 * target / factor.abs();
        };
        axpy(-factor, &response, rhs);
        self.response = response;
        Ok(())
    }

    /// K⁻¹ r in place to a residual of at most `target`. Equations of held unknowns are decoupled.
    fn solve_matrix(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        target: f64,
    ) -> Result<(), FactorError> {
        let mut x = std::mem::take(&mut self.solution);
        x.clear();
        x.resize(rhs.len(), 0.0);
        for &dof in &jacobian.held {
            x[dof] = rhs[dof] / jacobian.values[self.pattern.diagonal(dof)];
        }
        let outcome = self.improve(jacobian, rhs, &mut x, target);
        if outcome.is_ok() {
            rhs.copy_from_slice(&x);
        }
        self.solution = x;
        outcome
    }

    /// Improves x until the residual r - Kx is at most `target`.
    fn improve(
        &mut self,
        jacobian: &Jacobian,
        rhs: &[f64],
        x: &mut [f64],
        target: f64,
    ) -> Result<(), FactorError> {
        let Self { cycle, pattern, vectors, work, residual, correction, .. } = self;
        let Jacobian { values, held, .. } = jacobian;
        let mut matrix = Matrix { pattern, values, cycle };
        residual.resize(rhs.len(), 0.0);
        correction.resize(rhs.len(), 0.0);
        let mut last = f64::INFINITY;
        for round in 0..ROUNDS {
            matrix.apply(x, residual);
            residual.iter_mut().zip(rhs).for_each(|(entry, r)| *entry = r - *entry);
            held.iter().for_each(|&dof| residual[dof] = 0.0);
            let size = norm(residual);
            // Also stops where rounding prevents progress; the level then judges by its residual.
            if size <= target || (round > 0 && size > 0.5 * last) {
                break;
            }
            last = size;
            // Keeps products of residual and correction in range for any unit of force.
            let unit = 2f64.powi(size.log2().floor() as i32);
            residual.iter_mut().for_each(|r| *r /= unit);
            correction.fill(0.0);
            work.iterations += conjugate_gradients(
                &mut matrix,
                residual,
                correction,
                target / unit,
                LIMIT,
                vectors,
            )?;
            axpy(unit, correction, x);
            work.solves += 1;
        }
        Ok(())
    }
}

impl TangentSolver for MultigridSequence<'_> {
    fn prepare(&mut self, jacobian: &Jacobian, unchanged: bool) -> Result<(), FactorError> {
        if unchanged && self.ready {
            return Ok(());
        }
        let start = Instant::now();
        self.ready = false;
        let outcome = self.cycle.set(&jacobian.values, &jacobian.held);
        self.work.factorizations += 1;
        self.work.seconds_factor += start.elapsed().as_secs_f64();
        self.ready = outcome.is_ok();
        outcome
    }

    fn solve(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        forcing: f64,
    ) -> Result<(), FactorError> {
        let start = Instant::now();
        let target = forcing * norm(rhs);
        let outcome = match &jacobian.rank_one {
            None => self.solve_matrix(jacobian, rhs, target),
            Some(rank_one) => self.solve_with(jacobian, rank_one, rhs, target),
        };
        self.work.seconds_solve += start.elapsed().as_secs_f64();
        outcome
    }

    fn solve_with_last_factor(&mut self, jacobian: &Jacobian, rhs: &mut [f64]) {
        if !self.ready {
            return;
        }
        let target = ESTIMATE * norm(rhs);
        if self.solve_matrix(jacobian, rhs, target).is_err() {
            rhs.fill(f64::NAN);
        }
    }

    fn work(&self) -> LinearWork {
        self.work
    }
}
