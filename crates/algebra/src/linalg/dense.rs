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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_matrix_is_solved_and_an_indefinite_one_refused() {
        // A = 4 I + v vᵀ with v = (1, …, 5).
        let entry =
            |i: usize, j: usize| (if i == j { 4.0 } else { 0.0 }) + (i + 1) as f64 * (j + 1) as f64;
        let fill = |values: &mut [f64], shift: f64| {
            for j in 0..5 {
                for i in j..5 {
                    values[5 * j + i] = entry(i, j) + if i == j && i == 3 { shift } else { 0.0 };
                }
            }
        };
        let mut dense = DenseCholesky::new(5);
        dense.factorize(|values| fill(values, 0.0)).unwrap();
        let exact = [1.0, -2.0, 0.5, 3.0, -1.0];
        let mut x: [f64; 5] = std::array::from_fn(|i| (0..5).map(|j| entry(i, j) * exact[j]).sum());
        dense.solve(&mut x);
        assert!(x.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-13));
        let refused = dense.factorize(|values| fill(values, -30.0));
        assert_eq!(refused, Err(FactorError::NotPositiveDefinite { dof: 3 }));
        let refused = dense.factorize(|values| fill(values, f64::NAN));
        assert_eq!(refused, Err(FactorError::NotFinite));
    }
}
