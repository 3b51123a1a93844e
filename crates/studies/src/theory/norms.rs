//! The dual norm of V^h, and that of the stresses which the rule in time remembers.

use algebra::in_dimension;
use algebra::linalg::{FactorError, dot};
use algebra::tensor::{Symmetric, contract};
use fem::contact::{Discretization, MemoryTerm, StiffnessInverse};
use fem::space::StrainPoint;
use vhi::law::TensorField;

/// ‖F‖_* = sup F(v)/‖ε(v)‖ over V^h, by one solve with the strain stiffness.
pub struct DualNorm<'a> {
    gram: StiffnessInverse<'a>,
}

impl<'a> DualNorm<'a> {
    /// Factorizes (ε(u), ε(v)).
    ///
    /// # Errors
    /// The factorization's.
    pub fn new(space: &'a Discretization) -> Result<Self, FactorError> {
        let gram = StiffnessInverse::new(space, &TensorField::identity(), false)?;
        Ok(Self { gram })
    }

    /// ‖F‖_* of a vector over the unknowns.
    pub fn of(&mut self, load: &[f64]) -> f64 {
        let mut riesz = load.to_vec();
        self.gram.solve(&mut riesz);
        dot(load, &riesz).max(0.0).sqrt()
    }
}

/// Σ ℬ_i ε_i at a point, ε_i by the number of the term.
pub(super) fn remembered<const S: usize>(
    space: &Discretization,
    terms: &[MemoryTerm],
    at: &StrainPoint<'_>,
    strain: impl Fn(usize) -> Symmetric<S>,
) -> Symmetric<S> {
    let mut stress = [0.0; S];
    for (i, term) in terms.iter().enumerate() {
        let part = term.tensor.on(space.region(at.cell)).apply(&strain(i));
        stress.iter_mut().zip(part).for_each(|(sum, value)| *sum += value);
    }
    stress
}

/// ‖Σ ℬ_i ε(v_i)‖_ℋ of nodal vectors, one per term of the memory.
pub fn stress_norm(space: &Discretization, terms: &[MemoryTerm], v: &[Vec<f64>]) -> f64 {
    let square: f64 = in_dimension!(space.mesh.dimension, D, S => {
        let square = |at: StrainPoint<'_>| {
            let stress = remembered::<S>(space, terms, &at, |i| at.strain(&v[i]));
            at.weight * contract(&stress, &stress)
        };
        space.points().map(square).sum()
    });
    square.sqrt()
}
