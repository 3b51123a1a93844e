//! Solves with a sequence of nearby Jacobians K + a bᵀ + C, K sparse, symmetric and positive definite, C a few single
//! entries: one factorization of K preconditions GMRES for several of them.
//!
//! Large systems keep the factor in single precision, which halves time and memory traffic; GMRES on the
//! double-precision Jacobian restores the digits. Where it fails, a double-precision factor of the present Jacobian is
//! used.

use std::time::Instant;

use super::cholesky::{Analysis, Factor, FactorError, Workspace};
use super::gmres::{Krylov, Preconditioned, gmres};
use super::pattern::BlockPattern;
use super::substitution::Front;
use super::{axpy, dot};

/// The rank-one part a bᵀ.
#[derive(Debug, Clone, Default)]
pub struct RankOne {
    pub a: Vec<f64>,
    pub b: Vec<f64>,
}

/// A nonsymmetric entry of the Jacobian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NonsymmetricEntry {
    pub row: usize,
    pub column: usize,
    pub value: f64,
}

/// Counters and times.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinearWork {
    /// Numerical factorizations, in either precision.
    pub factorizations: u32,
    /// Passes over a factor, or solves without one.
    pub solves: u32,
    /// Iterations of solves without a factor.
    pub iterations: u32,
    pub seconds_factor: f64,
    pub seconds_solve: f64,
}

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
    values: Vec<f64>,
    rank_one: Option<RankOne>,
    couplings: Vec<NonsymmetricEntry>,
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
            values: Vec::new(),
            rank_one: None,
            couplings: Vec::new(),
            work: LinearWork::default(),
        }
    }

    /// Sets the precision of factors; None chooses by the order of the matrix.
    #[must_use]
    pub fn in_precision(self, precision: Option<Precision>) -> Self {
        Self { precision, ..self }
    }

    /// Takes lower-triangle values of K out, to be refilled for [`Self::prepare`].
    pub(crate) fn take_values(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.values)
    }

    /// Takes the rank-one part out, to be refilled likewise.
    pub(crate) fn take_rank_one(&mut self) -> RankOne {
        self.rank_one.take().unwrap_or_default()
    }

    /// Sets C of the next Jacobians.
    pub(crate) fn couple(&mut self, couplings: impl Iterator<Item = NonsymmetricEntry>) {
        self.couplings.clear();
        self.couplings.extend(couplings);
    }

    pub(crate) fn transpose_couplings(&mut self) {
        for coupling in &mut self.couplings {
            (coupling.row, coupling.column) = (coupling.column, coupling.row);
        }
    }

    /// The Jacobian K + a bᵀ + C for the next solves. `unchanged` says that K is the factorized one and there is no
    /// rank-one part.
    ///
    /// # Errors
    /// The factorization fails.
    pub(crate) fn prepare(
        &mut self,
        values: Vec<f64>,
        rank_one: Option<RankOne>,
        unchanged: bool,
    ) -> Result<(), FactorError> {
        self.values = values;
        self.rank_one = rank_one;
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
        self.factorize(self.precision.unwrap_or(by_order) == Precision::Single)
    }

    fn factorize(&mut self, single: bool) -> Result<(), FactorError> {
        let start = Instant::now();
        self.exact = false;
        let room = self.correction.take().unwrap_or_default();
        let outcome = if single { self.factorize_single() } else { self.factorize_double() };
        self.work.factorizations += 1;
        self.work.seconds_factor += start.elapsed().as_secs_f64();
        match outcome {
            Ok(()) => {
                self.extra = 0;
                self.correct(room)
            }
            // Single precision may find a barely definite matrix indefinite.
            Err(FactorError::NotPositiveDefinite { .. } | FactorError::NotFinite) if single => {
                self.factorize(false)
            }
            Err(error) => {
                self.stored = None;
                Err(error)
            }
        }
    }

    fn factorize_double(&mut self) -> Result<(), FactorError> {
        let (mut factor, front) = match self.stored.take() {
            Some(Stored::Double { factor, front }) => (factor, front),
            _ => (self.analysis.factor(), Front::default()),
        };
        self.analysis.factorize(self.pattern, &self.values, &mut factor, &mut self.workspace)?;
        self.stored = Some(Stored::Double { factor, front });
        self.exact = true;
        Ok(())
    }

    fn factorize_single(&mut self) -> Result<(), FactorError> {
        let (mut factor, mut narrow, front) = match self.stored.take() {
            Some(Stored::Single { factor, narrow, front, .. }) => (factor, narrow, front),
            _ => (self.analysis.factor(), Vec::new(), Front::default()),
        };
        let diagonal = |dof: usize| self.values[self.pattern.diagonal(dof)].abs();
        let scale = (0..self.pattern.order()).map(diagonal).fold(f64::MIN_POSITIVE, f64::max);
        narrow.clear();
        narrow.extend(self.values.iter().map(|value| (value / scale) as f32));
        self.analysis.factorize(self.pattern, &narrow, &mut factor, &mut self.workspace)?;
        self.stored = Some(Stored::Single { factor, scale, narrow, front });
        Ok(())
    }

    /// Prepares the Sherman–Morrison correction for the factorized Jacobian.
    fn correct(&mut self, (mut y, mut b): (Vec<f64>, Vec<f64>)) -> Result<(), FactorError> {
        let Some(rank_one) = &self.rank_one else { return Ok(()) };
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

    /// Solves with the present Jacobian in place, to a residual of at most `forcing` times the right side.
    ///
    /// # Errors
    /// A new factorization was needed and failed.
    pub(crate) fn solve(&mut self, rhs: &mut [f64], forcing: f64) -> Result<(), FactorError> {
        if self.exact && self.couplings.is_empty() {
            self.apply_inverse(rhs);
            return Ok(());
        }
        let mut krylov = std::mem::take(&mut self.krylov);
        self.saved.clear();
        self.saved.extend_from_slice(rhs);
        let info = gmres(self, rhs, forcing, LIMIT, &mut krylov);
        self.krylov = krylov;
        self.extra += info.iterations.saturating_sub(LEAST);
        if info.relative_residual <= forcing {
            return Ok(());
        }
        rhs.copy_from_slice(&self.saved);
        if !self.exact {
            self.factorize(false)?;
        }
        if self.couplings.is_empty() {
            self.apply_inverse(rhs);
            return Ok(());
        }
        // The rank of C bounds the iterations with the factor of K itself.
        let most = self.couplings.len() + MARGIN;
        let mut krylov = std::mem::take(&mut self.krylov);
        let wanted = forcing.max(OWN_FACTOR);
        let info = gmres(self, rhs, wanted, most, &mut krylov);
        self.krylov = krylov;
        match info.relative_residual <= wanted {
            true => Ok(()),
            false => Err(FactorError::NotSolved { relative: info.relative_residual, forcing }),
        }
    }

    pub(crate) fn diagonal(&self, dof: usize) -> f64 {
        self.values[self.pattern.diagonal(dof)]
    }

    /// Applies the stored factor, whatever Jacobian it belongs to; no operation before the first.
    pub(crate) fn solve_with_last_factor(&mut self, rhs: &mut [f64]) {
        self.apply_factor(rhs);
    }
}

impl Preconditioned for SequenceSolver<'_> {
    fn apply(&mut self, x: &[f64], out: &mut [f64]) {
        self.pattern.multiply(&self.values, x, out);
        if let Some(rank_one) = &self.rank_one {
            axpy(dot(&rank_one.b, x), &rank_one.a, out);
        }
        for coupling in &self.couplings {
            out[coupling.row] += coupling.value * x[coupling.column];
        }
    }

    fn precondition(&mut self, x: &mut [f64]) {
        self.apply_inverse(x);
    }
}

#[cfg(test)]
mod tests;
