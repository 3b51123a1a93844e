//! The dual norm of V^h.

use algebra::linalg::{FactorError, dot};
use fem::contact::{Discretization, StiffnessInverse};
use vhi::law::TensorField;

/// ‖F‖_* = sup F(v)/‖ε(v)‖ over V^h, by one solve with the strain stiffness.
pub(crate) struct DualNorm<'a> {
    gram: StiffnessInverse<'a>,
}

impl<'a> DualNorm<'a> {
    /// Factorizes (ε(u), ε(v)).
    ///
    /// # Errors
    /// The factorization's.
    pub(crate) fn new(space: &'a Discretization) -> Result<Self, FactorError> {
        let gram = StiffnessInverse::passing(space, &TensorField::identity())?;
        Ok(Self { gram })
    }

    /// ‖F‖_* of a vector over the unknowns.
    pub(crate) fn of(&mut self, load: &[f64]) -> f64 {
        let mut riesz = load.to_vec();
        self.gram.solve(&mut riesz);
        dot(load, &riesz).max(0.0).sqrt()
    }
}
