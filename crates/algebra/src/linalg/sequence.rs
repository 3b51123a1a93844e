//! Solves with a sequence of nearby Jacobians K + a bᵀ + C, K sparse, symmetric and positive definite, C a few single
//! entries: one factorization of K preconditions GMRES for several of them.
//!
//! Large systems keep the factor in single precision, which halves time and memory traffic; GMRES on the
//! double-precision Jacobian restores the digits. Where it fails, a double-precision factor of the present Jacobian is
//! used.

use std::time::Instant;

use super::cholesky::{Analysis, Factor, FactorError, Workspace};
use super::gmres::{Krylov, KrylovInfo, Preconditioned, gmres};
use super::jacobian::Jacobian;
use super::pattern::BlockPattern;
use super::substitution::Front;
use super::tangent_solver::{LinearWork, TangentSolver};
use super::{axpy, dot};

/// Number type of factors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Half the memory, seven digits.
    Single,
    Double,
}

/// Order from which the factor is in single precision. Smaller factors (some 0.1 MB at n = 16) stay in cache, where a
/// direct solve beats two iterations.
const SINGLE_FROM: usize = 4000;
/// Iterations that even a current factor needs in single precision.
const LEAST: u32 = 2;
/// Iterations after which a factor is given up at once.
const LIMIT: usize = 24;
/// Iterations beyond the rank of C, for rounding.
const MARGIN: usize = 4;
/// Relative residual with the factor of K itself that is as good as a direct solve: some tens of units of rounding.
const OWN_FACTOR: f64 = 1e-13;

/// A factor in its precision. Single precision holds that of K/`scale`, so that any unit of force stays in range;
/// `narrow` is scratch for the matrix.
enum Stored {
    Double { factor: Factor<f64>, front: Front<f64> },
    Single { factor: Factor<f32>, scale: f64, narrow: Vec<f32>, front: Front<f32> },
}

/// Solver for a sequence of nearby Jacobians.
pub struct SequenceSolver<'a> {
    analysis: &'a Analysis,
    pattern: &'a BlockPattern,
    workspace: Workspace,
    stored: Option<Stored>,
    /// None: chosen by the order of the matrix.
    precision: Option<Precision>,
    /// The stored factor is the double-precision one of the present Jacobian.
    exact: bool,
    /// Iterations beyond [`LEAST`] of all solves since the factorization.
    extra: u32,
    /// Iterations that a factorization costs.
    worth: u32,
    /// K⁻¹a/(1 + bᵀK⁻¹a) and b of the factorized Jacobian.
    correction: Option<(Vec<f64>, Vec<f64>)>,
    krylov: Krylov,
    saved: Vec<f64>,
    pub work: LinearWork,
}

impl<'a> SequenceSolver<'a> {
    /// A solver without a Jacobian yet.
    pub fn new(analysis: &'a Analysis, pattern: &'a BlockPattern) -> Self {
        Self {
            analysis,
            pattern,
            workspace: analysis.workspace(),
            stored: None,
            precision: None,
            exact: false,
            extra: 0,
            worth: analysis.passes_of_a_factor(),
            correction: None,
            krylov: Krylov::default(),
            saved: Vec::new(),
            work: LinearWork::default(),
        }
    }

    /// Sets the precision of factors; None chooses by the order of the matrix.
    #[must_use]
    pub fn in_precision(self, precision: Option<Precision>) -> Self {
        Self { precision, ..self }
    }

    fn factorize(&mut self, jacobian: &Jacobian, single: bool) -> Result<(), FactorError> {
        let start = Instant::now();
        self.exact = false;
        let room = self.correction.take().unwrap_or_default();
        let outcome = match single {
            true => self.factorize_single(&jacobian.values),
            false => self.factorize_double(&jacobian.values),
        };
        self.work.factorizations += 1;
        self.work.seconds_factor += start.elapsed().as_secs_f64();
        match outcome {
            Ok(()) => {
                self.extra = 0;
                self.correct(jacobian, room)
            }
            // Single precision may find a barely definite matrix indefinite.
            Err(FactorError::NotPositiveDefinite { .. } | FactorError::NotFinite) if single => {
                self.factorize(jacobian, false)
            }
            Err(error) => {
                self.stored = None;
                Err(error)
            }
        }
    }

    fn factorize_double(&mut self, values: &[f64]) -> Result<(), FactorError> {
        let (mut factor, front) = match self.stored.take() {
            Some(Stored::Double { factor, front }) => (factor, front),
            _ => (self.analysis.factor(), Front::default()),
        };
        self.analysis.factorize(self.pattern, values, &mut factor, &mut self.workspace)?;
        self.stored = Some(Stored::Double { factor, front });
        self.exact = true;
        Ok(())
    }

    fn factorize_single(&mut self, values: &[f64]) -> Result<(), FactorError> {
        let (mut factor, mut narrow, front) = match self.stored.take() {
            Some(Stored::Single { factor, narrow, front, .. }) => (factor, narrow, front),
            _ => (self.analysis.factor(), Vec::new(), Front::default()),
        };
        let diagonal = |dof: usize| values[self.pattern.diagonal(dof)].abs();
        let scale = (0..self.pattern.order()).map(diagonal).fold(f64::MIN_POSITIVE, f64::max);
        narrow.clear();
        narrow.extend(values.iter().map(|value| (value / scale) as f32));
        self.analysis.factorize(self.pattern, &narrow, &mut factor, &mut self.workspace)?;
        self.stored = Some(Stored::Single { factor, scale, narrow, front });
        Ok(())
    }

    /// Prepares the Sherman–Morrison correction for the factorized Jacobian.
    fn correct(
        &mut self,
        jacobian: &Jacobian,
        (mut y, mut b): (Vec<f64>, Vec<f64>),
    ) -> Result<(), FactorError> {
        let Some(rank_one) = &jacobian.rank_one else { return Ok(()) };
        y.clone_from(&rank_one.a);
        b.clone_from(&rank_one.b);
        self.apply_factor(&mut y);
        let denominator = 1.0 + dot(&b, &y);
        // K⁻¹ and K + a bᵀ share their sign as long as the step has one solution (bound (3.4)).
        if denominator.is_nan() || denominator <= 0.0 {
            return Err(FactorError::SingularInZeta { denominator });
        }
        y.iter_mut().for_each(|value| *value /= denominator);
        self.correction = Some((y, b));
        Ok(())
    }

    fn apply_factor(&mut self, x: &mut [f64]) {
        let start = Instant::now();
        let analysis = self.analysis;
        match &mut self.stored {
            None => {}
            Some(Stored::Double { factor, front }) => analysis.solve(factor, x, front),
            Some(Stored::Single { factor, scale, front, .. }) => {
                // The right side is scaled to one: only its direction has to fit single precision.
                let size = x.iter().fold(0.0f64, |size, value| size.max(value.abs()));
                if size > 0.0 && size.is_finite() {
                    let into = |value| (value / size) as f32;
                    let back = |value| f64::from(value) * (size / *scale);
                    analysis.solve_in(factor, x, front, into, back);
                }
            }
        }
        self.work.solves += 1;
        self.work.seconds_solve += start.elapsed().as_secs_f64();
    }

    /// x ← (factorized K + a bᵀ)⁻¹ x.
    fn apply_inverse(&mut self, x: &mut [f64]) {
        self.apply_factor(x);
        if let Some((scaled, b)) = &self.correction {
            axpy(-dot(b, x), scaled, x);
        }
    }

    /// GMRES with the stored factor.
    fn iterate(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        tolerance: f64,
        limit: usize,
    ) -> KrylovInfo {
        let mut krylov = std::mem::take(&mut self.krylov);
        let mut operator = Factorized { jacobian, solver: self };
        let info = gmres(&mut operator, rhs, tolerance, limit, &mut krylov);
        self.krylov = krylov;
        info
    }
}

impl TangentSolver for SequenceSolver<'_> {
    fn prepare(&mut self, jacobian: &Jacobian, unchanged: bool) -> Result<(), FactorError> {
        if unchanged && self.stored.is_some() {
            return Ok(());
        }
        self.exact = false;
        // An old factor is used until its extra iterations cost as much as a new one, so at most twice the optimal cost
        // is spent.
        if self.stored.is_some() && self.extra < self.worth {
            return Ok(());
        }
        let by_order = match self.pattern.order() {
            SINGLE_FROM.. => Precision::Single,
            _ => Precision::Double,
        };
        self.factorize(jacobian, self.precision.unwrap_or(by_order) == Precision::Single)
    }

    fn solve(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        forcing: f64,
    ) -> Result<(), FactorError> {
        if self.exact && jacobian.couplings.is_empty() {
            self.apply_inverse(rhs);
            return Ok(());
        }
        self.saved.clear();
        self.saved.extend_from_slice(rhs);
        let info = self.iterate(jacobian, rhs, forcing, LIMIT);
        self.extra += info.iterations.saturating_sub(LEAST);
        if info.relative_residual <= forcing {
            return Ok(());
        }
        rhs.copy_from_slice(&self.saved);
        if !self.exact {
            self.factorize(jacobian, false)?;
        }
        if jacobian.couplings.is_empty() {
            self.apply_inverse(rhs);
            return Ok(());
        }
        // The rank of C bounds the iterations with the factor of K itself.
        let wanted = forcing.max(OWN_FACTOR);
        let info = self.iterate(jacobian, rhs, wanted, jacobian.couplings.len() + MARGIN);
        match info.relative_residual <= wanted {
            true => Ok(()),
            false => Err(FactorError::NotSolved { relative: info.relative_residual, forcing }),
        }
    }

    fn solve_with_last_factor(&mut self, _: &Jacobian, rhs: &mut [f64]) {
        self.apply_factor(rhs);
    }

    fn work(&self) -> LinearWork {
        self.work
    }
}

/// A Jacobian with the factor of one that is near.
struct Factorized<'s, 'a> {
    jacobian: &'s Jacobian,
    solver: &'s mut SequenceSolver<'a>,
}

impl Preconditioned for Factorized<'_, '_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.jacobian.multiply(self.solver.pattern, x, out);
    }

    fn precondition(&mut self, x: &mut [f64]) {
        self.solver.apply_inverse(x);
    }
}

#[cfg(test)]
mod tests;
