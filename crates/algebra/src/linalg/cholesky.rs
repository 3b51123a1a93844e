//! Sparse Cholesky factorization (faer, supernodal): one symbolic analysis per pattern. It runs on one thread, so that
//! results are bit-identical under any machine load.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SymbolicSupernodalCholesky};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use super::pattern::BlockPattern;

/// Why a factorization was not possible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FactorError {
    /// A pivot was not positive.
    #[error("the tangent matrix is not positive definite (first at unknown {dof})")]
    NotPositiveDefinite {
        /// The unknown of the pivot.
        dof: usize,
    },
    /// Nonsymmetric entries, which the factor lacks, are too large for the iteration.
    #[error(
        "friction that follows the normal law makes the tangent singular or nearly so: a residual of {relative:.1e} is left, wanted {forcing:.1e}"
    )]
    NotSolved {
        /// Norm of the residual relative to the right side.
        relative: f64,
        /// Requested relative residual.
        forcing: f64,
    },
    #[error("the tangent matrix has an entry that is not a finite number")]
    NotFinite,
    /// The rank-one part of the Jacobian, from ζ_n(u_n), makes it singular or turns its sign.
    #[error(
        "the implicit dependence on ζ makes the tangent singular (1 + bᵀK⁻¹a = {denominator:e})"
    )]
    SingularInZeta {
        /// 1 + bᵀK⁻¹a.
        denominator: f64,
    },
    /// The symbolic analysis ran out of memory or index range.
    #[error("the symbolic factorization of order {order} failed: {reason}")]
    Analysis { order: usize, reason: String },
}

/// Symbolic factorization of a pattern.
#[derive(Debug)]
pub struct Analysis {
    symbolic: SymbolicCholesky<u32>,
}

/// Values of a factorization L Lᵀ.
#[derive(Debug, Clone)]
pub struct Factor {
    values: Vec<f64>,
}

/// Scratch memory of solves with one factor after the other, made at the first.
#[derive(Default)]
pub struct Front {
    memory: Option<MemBuffer>,
}

/// Scratch memory of factorizations.
pub struct Workspace {
    memory: MemBuffer,
}

impl Analysis {
    /// Analyses `pattern` in the order `permutation` (position → dof).
    ///
    /// # Errors
    /// [`FactorError::Analysis`] if memory or the index range is exhausted.
    pub fn new(pattern: &BlockPattern, permutation: &[u32]) -> Result<Self, FactorError> {
        let order = pattern.order();
        let mut inverse = vec![0u32; order];
        for (position, &dof) in permutation.iter().enumerate() {
            inverse[dof as usize] = position as u32;
        }
        let symbolic = factorize_symbolic_cholesky(
            symbolic_matrix(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(permutation, &inverse, order)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|error| FactorError::Analysis { order, reason: format!("{error:?}") })?;
        Ok(Self { symbolic })
    }

    /// Numbers stored in a factor.
    pub fn factor_entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Cost of one factorization in solves with it (and a product each): 0.05 multiplications per entry fit the optimum
    /// on meshes of n = 64 and 128.
    pub fn solves_of_a_factor(&self) -> u32 {
        let entries = (self.factor_entries() as f64).max(1.0);
        (2.0 + 0.05 * self.multiplications() / entries) as u32
    }

    /// Multiplications of one factorization: Σ over columns of their length squared.
    pub fn multiplications(&self) -> f64 {
        let Some(raw) = self.supernodes() else { return 0.0 };
        let supernode = |s: usize| {
            let rows = raw.col_ptr_for_row_idx();
            let width = raw.supernode_end()[s] - raw.supernode_begin()[s];
            let height = width + rows[s + 1] - rows[s];
            (0..width).map(|j| f64::from(height - j).powi(2)).sum::<f64>()
        };
        (0..raw.n_supernodes()).map(supernode).sum()
    }

    /// An empty factor of this pattern.
    pub fn factor(&self) -> Factor {
        Factor { values: vec![0.0; self.symbolic.len_val()] }
    }

    /// Scratch memory for factorizations.
    pub fn workspace(&self) -> Workspace {
        let factorize =
            self.symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        Workspace { memory: MemBuffer::new(factorize) }
    }

    /// Computes L of the matrix with these lower-triangle `values`.
    ///
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] names the unknown whose pivot failed.
    pub fn factorize(
        &self,
        pattern: &BlockPattern,
        values: &[f64],
        factor: &mut Factor,
        workspace: &mut Workspace,
    ) -> Result<(), FactorError> {
        let matrix = SparseColMatRef::new(symbolic_matrix(pattern), values);
        let outcome = self.symbolic.factorize_numeric_llt(
            &mut factor.values,
            matrix,
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut workspace.memory),
            Default::default(),
        );
        match outcome {
            Ok(_) => Ok(()),
            Err(_) if values.iter().any(|v| !v.is_finite()) => Err(FactorError::NotFinite),
            Err(LltError::NonPositivePivot { index }) => {
                // The index is in the permuted order of the supernodal factorization.
                let dof = match self.symbolic.perm() {
                    Some(perm) => perm.arrays().0.get(index).map_or(index, |&d| d as usize),
                    None => index,
                };
                Err(FactorError::NotPositiveDefinite { dof })
            }
        }
    }

    /// Position → dof.
    pub fn order(&self) -> &[u32] {
        self.symbolic.perm().map_or(&[], |perm| perm.arrays().0)
    }

    /// Solves L Lᵀ x = b in place, x and b in the order of the unknowns, for each of the right sides that stand in `x` one
    /// after another: together they read the factor once.
    pub fn solve(&self, factor: &Factor, x: &mut [f64], front: &mut Front) {
        let sides = x.len() / self.order().len().max(1);
        self.solve_in(factor, x, MemStack::new(front.memory(self, sides)));
    }

    pub(super) fn solve_in(&self, factor: &Factor, x: &mut [f64], room: &mut MemStack) {
        LltRef::new(&self.symbolic, &factor.values).solve_in_place_with_conj(
            Conj::No,
            columns(x, self.order().len()),
            Par::Seq,
            room,
        );
    }

    pub(super) fn solve_scratch(&self, sides: usize) -> StackReq {
        self.symbolic.solve_in_place_scratch::<f64>(sides, Par::Seq)
    }

    /// Solves Lᵀ z = x in place; `x` is in the order of the factor.
    pub fn backward(&self, factor: &Factor, x: &mut [f64], front: &mut Front) {
        if let Some(raw) = self.supernodes() {
            let room = MemStack::new(front.memory(self, 1));
            SupernodalLltRef::new(raw, &factor.values).l_transpose_solve_with_conj(
                Conj::No,
                columns(x, self.order().len()),
                Par::Seq,
                room,
            );
        }
    }

    /// The triangle of L from row and column `first` on, dense by columns: the factor of the Schur complement on the last
    /// unknowns.
    pub fn last_triangle(&self, factor: &Factor, first: usize) -> Vec<f64> {
        let size = self.order().len() - first;
        let mut triangle = vec![0.0; size * size];
        let Some(raw) = self.supernodes() else { return triangle };
        let factor = SupernodalLltRef::new(raw, &factor.values);
        for s in 0..raw.n_supernodes() {
            let node = factor.supernode(s);
            let (start, values) = (node.start(), node.val());
            let row = |i: usize| match i < values.ncols() {
                true => start + i,
                false => node.pattern()[i - values.ncols()] as usize,
            };
            for j in first.saturating_sub(start)..values.ncols() {
                for i in j..values.nrows() {
                    triangle[size * (start + j - first) + row(i) - first] = values[(i, j)];
                }
            }
        }
        triangle
    }

    fn supernodes(&self) -> Option<&SymbolicSupernodalCholesky<u32>> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(raw) => Some(raw),
            // Chosen only for order 0, where there is nothing to solve.
            SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }
}

impl Front {
    fn memory(&mut self, analysis: &Analysis, sides: usize) -> &mut MemBuffer {
        let needed = analysis.solve_scratch(sides);
        if self.memory.as_ref().is_none_or(|memory| memory.len() < needed.size_bytes()) {
            self.memory = None;
        }
        self.memory.get_or_insert_with(|| MemBuffer::new(needed))
    }
}

fn columns(x: &mut [f64], rows: usize) -> MatMut<'_, f64> {
    let columns = x.len() / rows.max(1);
    MatMut::from_column_major_slice_mut(x, rows, columns)
}

fn symbolic_matrix(pattern: &BlockPattern) -> SymbolicSparseColMatRef<'_, u32> {
    let order = pattern.order();
    SymbolicSparseColMatRef::new_checked(order, order, &pattern.columns, None, &pattern.rows)
}
