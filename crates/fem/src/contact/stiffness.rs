//! Stiffness matrices of tensors with their factors: each is made once a mesh, for all that solve with it.
//!
//! The matrix of a march without projection whose memory is a multiple of the elasticity is 𝒜's on every grid in time;
//! bounds, floors and duals ask for those of 𝒜, 𝒜 + μ and the identity again and again.

use std::sync::Arc;
use std::time::Instant;

use super::held_factors::{StiffnessFactor, Unknowns};
use super::{Discretization, Work};
use algebra::linalg::{Analysis, FactorError, Front};
use vhi::law::TensorField;

impl StiffnessFactor {
    fn new(
        space: &Discretization,
        tensor: &TensorField,
        unknowns: Unknowns,
        work: &mut Work,
    ) -> Result<Self, FactorError> {
        let start = Instant::now();
        let analysis = space.analysis_of(unknowns)?;
        let values = space.stiffness_of(unknowns, tensor);
        work.seconds_assemble += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&space.pattern, &values, &mut factor, &mut workspace)?;
        space.factors.count();
        work.linear.seconds_factor += start.elapsed().as_secs_f64();
        let (values, factor) = (Arc::new(values), Arc::new(factor));
        Ok(Self { tensor: tensor.clone(), unknowns, values, factor })
    }
}

impl Discretization {
    pub(super) fn analysis_of(&self, unknowns: Unknowns) -> Result<&Analysis, FactorError> {
        match unknowns {
            Unknowns::Displacements => self.analysis(),
            Unknowns::ContactLast => self.condensing(),
        }
    }

    /// Lower-triangle values of the stiffness matrix of `tensor`.
    pub(super) fn stiffness_of(&self, unknowns: Unknowns, tensor: &TensorField) -> Vec<f64> {
        match unknowns {
            // Where unknowns are held, only theirs has an inverse.
            Unknowns::Displacements if !self.frames.hold_any() => self.stiffness(tensor),
            Unknowns::Displacements => self.stiffness_of_unknowns(tensor),
            Unknowns::ContactLast => self.stiffness_of_unknowns(tensor),
        }
    }

    /// The stiffness matrix of `tensor` with its factor, which this mesh holds from then on. What it takes is added to
    /// `work`, the factorization also where it was made before: what a run needs does not depend on what ran before it.
    ///
    /// # Errors
    /// A matrix that is not positive definite, or an order of unknowns that cannot be analysed.
    pub(crate) fn stiffness_factor(
        &self,
        tensor: &TensorField,
        unknowns: Unknowns,
        work: &mut Work,
    ) -> Result<Arc<StiffnessFactor>, FactorError> {
        work.linear.factorizations += 1;
        let make = || StiffnessFactor::new(self, tensor, unknowns, work);
        self.factors.find_or_hold(tensor, unknowns, make)
    }

    /// The factor of `tensor` in the order of displacements: the one that the mesh holds, or a new one that it does not
    /// keep.
    fn passing_factor(&self, tensor: &TensorField) -> Result<Arc<StiffnessFactor>, FactorError> {
        let unknowns = Unknowns::Displacements;
        // Nobody waits for a factor that is not held.
        let new = || StiffnessFactor::new(self, tensor, unknowns, &mut Work::default());
        self.factors.find(tensor, unknowns).map_or_else(|| new().map(Arc::new), Ok)
    }

    /// How many factors of stiffness matrices were made on this mesh.
    pub fn stiffness_factors_made(&self) -> u32 {
        self.factors.made()
    }

    /// Lets the factors go that this mesh holds, where only its geometry is needed from now on.
    pub fn forget_factors(&self) {
        self.factors.clear();
    }
}

/// K⁻¹ of a tensor over Cartesian displacements, by its factor.
pub struct StiffnessInverse<'a> {
    space: &'a Discretization,
    analysis: &'a Analysis,
    kept: Arc<StiffnessFactor>,
    front: Front,
}

impl<'a> StiffnessInverse<'a> {
    /// The inverse for `tensor` on `space`, which keeps the factor for other runs.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub(crate) fn held(
        space: &'a Discretization,
        tensor: &TensorField,
    ) -> Result<Self, FactorError> {
        let work = &mut Work::default();
        let kept = space.stiffness_factor(tensor, Unknowns::Displacements, work)?;
        Ok(Self { space, analysis: space.analysis()?, kept, front: Front::default() })
    }

    /// The inverse for one use: by the factor that the mesh holds, or by a new one that is dropped with it.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn passing(space: &'a Discretization, tensor: &TensorField) -> Result<Self, FactorError> {
        let kept = space.passing_factor(tensor)?;
        Ok(Self { space, analysis: space.analysis()?, kept, front: Front::default() })
    }

    /// K⁻¹b in place, over the free nodes: the displacements in V^h that a Cartesian force moves.
    pub fn solve(&mut self, b: &mut [f64]) {
        let held = self.space.frames.hold_any();
        if held {
            self.space.frames.force_on_unknowns(b);
        }
        self.analysis.solve(&self.kept.factor, b, &mut self.front);
        if held {
            self.space.frames.to_cartesian(b);
        }
    }

    /// Kx for displacements in V^h, as a force that does no work outside V^h.
    pub fn multiply(&self, x: &[f64], out: &mut [f64]) {
        let (pattern, values) = (&self.space.pattern, &self.kept.values);
        if !self.space.frames.hold_any() {
            return pattern.multiply(values, x, out);
        }
        let mut w = x.to_vec();
        self.space.frames.to_unknowns(&mut w);
        pattern.multiply(values, &w, out);
        self.space.frames.force_on_cartesian(out);
    }

    /// The lower triangle of K.
    pub fn values(&self) -> &[f64] {
        &self.kept.values
    }
}
