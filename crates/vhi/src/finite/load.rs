use nalgebra::DVector;

use super::FiniteError;

/// f(t).
pub trait FiniteLoad: Send {
    /// f(t) as a vector of ℝ^m.
    ///
    /// # Errors
    /// [`FiniteError::Load`] if it is not finite.
    fn at(&mut self, t: f64) -> Result<DVector<f64>, FiniteError>;
}
