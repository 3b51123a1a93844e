//! Cholesky factorization of small dense matrices (faer) in reused memory.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::cholesky::llt::factor::LltError;
use faer::{MatMut, MatRef, Par};

use super::FactorError;

/// A symmetric positive definite matrix, overwritten by its factor.
pub struct DenseCholesky {
    order: usize,
    values: Vec<f64>,
    memory: MemBuffer,
}

impl DenseCholesky {
    /// Room for matrices of this order.
    pub fn new(order: usize) -> Self {
        let scratch =
            llt::factor::cholesky_in_place_scratch::<f64>(order, Par::Seq, Default::default());
        Self { order, values: vec![0.0; order * order], memory: MemBuffer::new(scratch) }
    }

    /// Factorizes the matrix whose lower triangle `fill` writes, by columns.
    ///
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] names the row whose pivot failed.
    pub fn factorize(&mut self, fill: impl FnOnce(&mut [f64])) -> Result<(), FactorError> {
        fill(&mut self.values);
        let finite = self.values.iter().all(|value| value.is_finite());
        let matrix = MatMut::from_column_major_slice_mut(&mut self.values, self.order, self.order);
        let outcome = llt::factor::cholesky_in_place(
            matrix,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        match outcome {
            Ok(_) => Ok(()),
            Err(_) if !finite => Err(FactorError::NotFinite),
            Err(LltError::NonPositivePivot { index }) => {
                Err(FactorError::NotPositiveDefinite { dof: index })
            }
        }
    }

    /// Solves with the factor in place.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        llt::solve::solve_in_place(
            MatRef::from_column_major_slice(&self.values, self.order, self.order),
            MatMut::from_column_major_slice_mut(rhs, self.order, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
