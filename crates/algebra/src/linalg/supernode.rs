//! Columns of a factor with common rows, as the substitutions read them.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::cholesky::{Factor, Real};

pub(super) const COLUMNS: usize = 4;

/// A supernode: columns `start..start + width`, `below` the rows under its triangle, values by columns from `first` on
/// in the factor.
pub(super) struct Supernode<'a, T> {
    pub(super) start: usize,
    pub(super) width: usize,
    pub(super) below: &'a [u32],
    values: &'a [T],
    first: usize,
}

impl<T: Real> Supernode<'_, T> {
    #[inline(always)]
    pub(super) fn height(&self) -> usize {
        self.width + self.below.len()
    }

    #[inline(always)]
    fn begin(&self, j: usize) -> usize {
        self.first + self.height() * j
    }

    #[inline(always)]
    pub(super) fn column(&self, j: usize, from: usize) -> &[T] {
        &self.values[self.begin(j) + from..self.begin(j + 1)]
    }
}

#[inline(always)]
pub(super) fn supernode<'a, T>(
    symbolic: &'a SymbolicSupernodalCholesky<u32>,
    factor: &'a Factor<T>,
    s: usize,
) -> Supernode<'a, T> {
    let (start, end) =
        (symbolic.supernode_begin()[s] as usize, symbolic.supernode_end()[s] as usize);
    let rows = symbolic.col_ptr_for_row_idx()[s] as usize;
    let below = &symbolic.row_idx()[rows..rows + symbolic.nnz_per_super()[s] as usize];
    let first = symbolic.col_ptr_for_val()[s] as usize;
    Supernode { start, width: end - start, below, values: &factor.values, first }
}
