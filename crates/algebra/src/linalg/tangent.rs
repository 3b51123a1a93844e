//! Solves with a sequence of nearby Jacobians K + a bᵀ + C, K sparse, symmetric and positive definite, C a few single
//! entries: a lagged factor of K preconditions BiCGStab for several of them. What that does not reach is solved directly:
//! by a new factor and the Sherman–Morrison formula for a bᵀ, with C by a sparse LU factorization.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Instant;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::matrix_free::bicgstab::{BicgParams, bicgstab, bicgstab_scratch};
use faer::matrix_free::{IdentityPrecond, LinOp, Precond};
use faer::prelude::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{MatMut, MatRef, Par};

use super::cholesky::{Analysis, Factor, FactorError, Front, Workspace};
use super::jacobian::Jacobian;
use super::pattern::BlockPattern;
use super::{axpy, dot, norm};

/// Counters and times.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinearWork {
    /// Numerical factorizations.
    pub factorizations: u32,
    /// Solves with a factor.
    pub solves: u32,
    pub seconds_factor: f64,
    pub seconds_solve: f64,
}

impl LinearWork {
    /// Both together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            factorizations: self.factorizations + other.factorizations,
            solves: self.solves + other.solves,
            seconds_factor: self.seconds_factor + other.seconds_factor,
            seconds_solve: self.seconds_solve + other.seconds_solve,
        }
    }
}

/// Solves that an iteration takes, with the best of lagged factors as well.
const LEAST: u32 = 2;
/// Iterations, of two solves with the factor each, after which a lagged factor is given up at once.
const LIMIT: usize = 12;

/// Solver for a sequence of nearby Jacobians.
pub struct TangentSolver<'a> {
    analysis: &'a Analysis,
    pattern: &'a BlockPattern,
    workspace: Workspace,
    factor: Option<Factor>,
    front: Front,
    /// The factor is that of the present Jacobian.
    exact: bool,
    /// Solves with the factor beyond [`LEAST`] each, since it was made, and those that a factorization costs.
    extra: u32,
    worth: u32,
    /// K⁻¹a/(1 + bᵀK⁻¹a) and b of the factorized Jacobian.
    correction: Option<(Vec<f64>, Vec<f64>)>,
    memory: Option<MemBuffer>,
    right: Vec<f64>,
    work: LinearWork,
}

impl<'a> TangentSolver<'a> {
    /// A solver without a Jacobian yet.
    pub fn new(analysis: &'a Analysis, pattern: &'a BlockPattern) -> Self {
        Self {
            analysis,
            pattern,
            workspace: analysis.workspace(),
            factor: None,
            front: Front::default(),
            exact: false,
            extra: 0,
            worth: analysis.solves_of_a_factor(),
            correction: None,
            memory: None,
            right: Vec::new(),
            work: LinearWork::default(),
        }
    }

    /// Takes the Jacobian of the next solves. `unchanged` says that K is that of the last one, without a rank-one part.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn prepare(&mut self, jacobian: &Jacobian, unchanged: bool) -> Result<(), FactorError> {
        if unchanged && self.factor.is_some() {
            return Ok(());
        }
        self.exact = false;
        // A lagged factor is used until its extra solves cost as much as a new one, so at most twice the optimal cost is
        // spent.
        if self.factor.is_some() && self.extra < self.worth {
            return Ok(());
        }
        self.factorize(jacobian)
    }

    /// Solves with the Jacobian of [`Self::prepare`] in place, to a residual of at most `forcing` times the right side.
    ///
    /// # Errors
    /// As [`Self::prepare`]; a rank-one part or single entries that make the Jacobian singular.
    pub fn solve(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        forcing: f64,
    ) -> Result<(), FactorError> {
        let direct = jacobian.couplings.is_empty();
        if self.exact && direct {
            self.apply_inverse(rhs);
            return Ok(());
        }
        if self.iterate(jacobian, rhs, forcing) {
            return Ok(());
        }
        if !self.exact {
            self.factorize(jacobian)?;
            if direct {
                self.apply_inverse(rhs);
                return Ok(());
            }
        }
        self.solve_by_lu(jacobian, rhs, forcing)
    }

    /// K⁻¹ r with the last factor, whatever Jacobian it belongs to; no operation before the first one.
    pub fn solve_with_last_factor(&mut self, rhs: &mut [f64]) {
        let start = Instant::now();
        if let Some(factor) = &self.factor {
            self.analysis.solve(factor, rhs, &mut self.front);
        }
        self.work.solves += 1;
        self.work.seconds_solve += start.elapsed().as_secs_f64();
    }

    /// Counters and times.
    pub fn work(&self) -> LinearWork {
        self.work
    }

    fn factorize(&mut self, jacobian: &Jacobian) -> Result<(), FactorError> {
        let start = Instant::now();
        let room = self.correction.take().unwrap_or_default();
        let mut factor = self.factor.take().unwrap_or_else(|| self.analysis.factor());
        self.work.factorizations += 1;
        self.analysis.factorize(
            self.pattern,
            &jacobian.values,
            &mut factor,
            &mut self.workspace,
        )?;
        self.work.seconds_factor += start.elapsed().as_secs_f64();
        (self.factor, self.exact, self.extra) = (Some(factor), true, 0);
        let Some(rank_one) = &jacobian.rank_one else { return Ok(()) };
        let (mut y, mut b) = room;
        y.clone_from(&rank_one.a);
        b.clone_from(&rank_one.b);
        self.solve_with_last_factor(&mut y);
        let denominator = 1.0 + dot(&b, &y);
        // K⁻¹ and K + a bᵀ share their sign as long as the step has one solution (bound (3.4)).
        if denominator.is_nan() || denominator <= 0.0 {
            return Err(FactorError::SingularInZeta { denominator });
        }
        y.iter_mut().for_each(|value| *value /= denominator);
        self.correction = Some((y, b));
        Ok(())
    }

    /// x ← (factorized K + a bᵀ)⁻¹ x.
    fn apply_inverse(&mut self, x: &mut [f64]) {
        self.solve_with_last_factor(x);
        if let Some((scaled, b)) = &self.correction {
            axpy(-dot(b, x), scaled, x);
        }
    }

    /// BiCGStab with the factor that is there; `rhs` is left as it was where it does not converge.
    fn iterate(&mut self, jacobian: &Jacobian, rhs: &mut [f64], forcing: f64) -> bool {
        let start = Instant::now();
        let Some(factor) = self.factor.as_ref().filter(|_| forcing > 0.0) else { return false };
        let (order, size) = (rhs.len(), norm(rhs));
        if size == 0.0 || !size.is_finite() {
            return size == 0.0;
        }
        let operator = Operator { jacobian, pattern: self.pattern };
        let (analysis, correction) = (self.analysis, self.correction.as_ref());
        let lagged = Lagged { analysis, factor, correction, solves: AtomicU32::new(0) };
        let identity = IdentityPrecond { dim: order };
        let params =
            BicgParams { rel_tolerance: forcing, max_iters: LIMIT, ..BicgParams::default() };
        let needed = || bicgstab_scratch::<f64>(identity, &lagged, &operator, 1, Par::Seq);
        let memory = self.memory.get_or_insert_with(|| MemBuffer::new(needed()));
        // Scaled, so that no scalar product leaves the range of doubles, whatever the units.
        self.right.clear();
        self.right.extend(rhs.iter().map(|value| value / size));
        // The start value; told that it is zero, the library would begin with a residual that it has not set.
        rhs.fill(0.0);
        let outcome = bicgstab(
            MatMut::from_column_major_slice_mut(rhs, order, 1),
            identity,
            &lagged,
            &operator,
            MatRef::from_column_major_slice(&self.right, order, 1),
            params,
            |_| {},
            Par::Seq,
            MemStack::new(memory),
        );
        let solves = lagged.solves.into_inner();
        self.extra += solves.saturating_sub(LEAST);
        self.work.solves += solves;
        self.work.seconds_solve += start.elapsed().as_secs_f64();
        if outcome.is_err() {
            rhs.copy_from_slice(&self.right);
        }
        rhs.iter_mut().for_each(|value| *value *= size);
        outcome.is_ok()
    }

    fn solve_by_lu(
        &mut self,
        jacobian: &Jacobian,
        rhs: &mut [f64],
        forcing: f64,
    ) -> Result<(), FactorError> {
        let start = Instant::now();
        self.work.factorizations += 1;
        let singular = |relative: f64| FactorError::NotSolved { relative, forcing };
        let order = rhs.len();
        let lower = self.pattern.iter(&jacobian.values);
        let mut entries: Vec<Triplet<usize, usize, f64>> = Vec::new();
        for (i, j, value) in lower {
            entries.push(Triplet::new(i, j, value));
            if i != j {
                entries.push(Triplet::new(j, i, value));
            }
        }
        let single = jacobian.couplings.iter();
        entries.extend(single.map(|entry| Triplet::new(entry.row, entry.column, entry.value)));
        let matrix = SparseColMat::try_new_from_triplets(order, order, &entries);
        let factor = matrix.ok().and_then(|matrix| matrix.sp_lu().ok());
        let factor = factor.ok_or_else(|| singular(f64::NAN))?;
        let solve = |x: &mut [f64]| {
            factor.solve_in_place(MatMut::from_column_major_slice_mut(x, order, 1));
        };
        let right = rhs.to_vec();
        solve(rhs);
        if let Some(rank_one) = &jacobian.rank_one {
            let mut y = rank_one.a.clone();
            solve(&mut y);
            axpy(-dot(&rank_one.b, rhs) / (1.0 + dot(&rank_one.b, &y)), &y, rhs);
        }
        let mut left = vec![0.0; order];
        jacobian.multiply(self.pattern, rhs, &mut left);
        axpy(-1.0, &right, &mut left);
        let relative = norm(&left) / norm(&right);
        self.work.solves += 1;
        self.work.seconds_factor += start.elapsed().as_secs_f64();
        // A right side of zero has the solution zero.
        if relative <= forcing.max(DIRECT) || norm(&right) == 0.0 {
            return Ok(());
        }
        Err(singular(relative))
    }
}

/// Relative residual up to which a direct solve counts: rounding times a condition number of 10⁵, and nothing that an
/// iteration of Newton's method would notice. A matrix that is singular to rounding leaves one or more.
const DIRECT: f64 = 1e-10;

#[derive(Debug)]
struct Operator<'a> {
    jacobian: &'a Jacobian,
    pattern: &'a BlockPattern,
}

/// The inverse of a Jacobian that is near.
#[derive(Debug)]
struct Lagged<'a> {
    analysis: &'a Analysis,
    factor: &'a Factor,
    correction: Option<&'a (Vec<f64>, Vec<f64>)>,
    solves: AtomicU32,
}

/// A vector that BiCGStab hands over; all of them are contiguous.
fn slice<'v>(vector: MatRef<'v, f64>) -> &'v [f64] {
    vector.col(0).try_as_col_major().map_or(&[], |column| column.as_slice())
}

fn slice_mut<'v>(vector: MatMut<'v, f64>) -> &'v mut [f64] {
    vector.col_mut(0).try_as_col_major_mut().map_or(&mut [], |column| column.as_slice_mut())
}

impl LinOp<f64> for Operator<'_> {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.pattern.order()
    }

    fn ncols(&self) -> usize {
        self.pattern.order()
    }

    fn apply(&self, out: MatMut<'_, f64>, x: MatRef<'_, f64>, _: Par, _: &mut MemStack) {
        self.jacobian.multiply(self.pattern, slice(x), slice_mut(out));
    }

    fn conj_apply(&self, out: MatMut<'_, f64>, x: MatRef<'_, f64>, par: Par, room: &mut MemStack) {
        self.apply(out, x, par, room);
    }
}

impl LinOp<f64> for Lagged<'_> {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        self.analysis.solve_scratch(1)
    }

    fn nrows(&self) -> usize {
        self.analysis.order().len()
    }

    fn ncols(&self) -> usize {
        self.analysis.order().len()
    }

    fn apply(&self, mut out: MatMut<'_, f64>, x: MatRef<'_, f64>, _: Par, room: &mut MemStack) {
        self.solves.fetch_add(1, Ordering::Relaxed);
        out.copy_from(x);
        let out = slice_mut(out);
        self.analysis.solve_in(self.factor, out, room);
        if let Some((scaled, b)) = self.correction {
            axpy(-dot(b, out), scaled, out);
        }
    }

    fn conj_apply(&self, out: MatMut<'_, f64>, x: MatRef<'_, f64>, par: Par, room: &mut MemStack) {
        self.apply(out, x, par, room);
    }
}

impl Precond<f64> for Lagged<'_> {}
