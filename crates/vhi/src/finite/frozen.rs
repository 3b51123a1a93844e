//! The derivative of Λ in ℝ^m, as a matrix in the coordinates w.

use nalgebra::{DMatrix, DVector};

use super::FiniteEvolution;
use crate::{FrozenDerivative, OpenInequality, StepInequality, StepState};
use algebra::linalg::FactorError;

impl FrozenDerivative for FiniteEvolution<'_> {
    fn set_step(&mut self, k: f64) {
        self.set_last_slot(k);
    }

    /// DΛ = -J⁻¹ Cᵀ ∂N/∂y (last slot) C, J the tangent of the frozen level with its pieces kept.
    fn differentiate(&mut self, eta: &[f64], state: &StepState) -> Result<(), FactorError> {
        self.freeze(Some(eta));
        let m = self.dofs();
        let mut force = vec![0.0; m];
        self.residual(&state.u, &mut force);
        let (slopes, prescribed) = self.graph().pieces(state);
        self.linearize(&slopes, &prescribed)?;
        let mut derivative = -self.force_by_history();
        let mut column = vec![0.0; m];
        for mut target in derivative.column_iter_mut() {
            column.copy_from_slice(target.as_slice());
            self.solve(&mut column, 0.0)?;
            target.copy_from_slice(&column);
        }
        let cholesky = self.inner_product.clone().cholesky();
        let adjoint = cholesky
            .ok_or(FactorError::NotPositiveDefinite { dof: 0 })?
            .solve(&derivative.tr_mul(&self.inner_product));
        self.frozen = Some([derivative, adjoint]);
        Ok(())
    }

    fn derivative(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        apply(self.frozen.as_ref().map(|[derivative, _]| derivative), x, out);
        Ok(())
    }

    /// G⁻¹ (DΛ)ᵀ G x.
    fn adjoint(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError> {
        apply(self.frozen.as_ref().map(|[_, adjoint]| adjoint), x, out);
        Ok(())
    }

    fn gram(&mut self, x: &[f64], out: &mut [f64]) {
        let product = &self.inner_product * DVector::from_column_slice(x);
        out.copy_from_slice(product.as_slice());
    }
}

/// `out` ← matrix · x; zero before the matrix was prepared.
fn apply(matrix: Option<&DMatrix<f64>>, x: &[f64], out: &mut [f64]) {
    match matrix {
        Some(matrix) => out.copy_from_slice((matrix * DVector::from_column_slice(x)).as_slice()),
        None => out.fill(0.0),
    }
}
