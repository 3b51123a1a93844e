//! Stiffness matrices of tensors with their factors: each is made once a mesh, for all that solve with it.
//!
//! The matrix of a march without projection whose memory is a multiple of the elasticity is 𝒜's on every grid in time;
//! bounds, floors and duals ask for those of 𝒜, 𝒜 + μ and the identity again and again.

use std::sync::{Arc, MutexGuard, PoisonError};
use std::time::Instant;

use super::{Discretization, Work};
use algebra::linalg::{Analysis, Factor, FactorError, Front};
use vhi::law::TensorField;

/// The order of the unknowns of the contact problem in a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// That of [`Discretization::analysis`].
    Usual,
    /// Γ3 last: such a factor condenses onto Γ3. In the plane it has some 8 % more fill.
    ContactLast,
}

/// The stiffness matrix of a tensor and its factor.
#[derive(Debug)]
pub(super) struct StiffnessFactor {
    tensor: TensorField,
    order: Order,
    /// The lower triangle.
    pub(super) values: Arc<Vec<f64>>,
    /// L.
    pub(super) factor: Arc<Factor>,
}

/// The factors that a mesh holds.
#[derive(Debug, Default)]
pub(super) struct StiffnessFactors {
    held: Vec<Arc<StiffnessFactor>>,
    made: u32,
}

/// Factors held at a time: those of 𝒜 and of 𝒜 + μ.
const HELD: usize = 2;

impl Discretization {
    fn factors(&self) -> MutexGuard<'_, StiffnessFactors> {
        self.factors.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The stiffness matrix of `tensor` with its factor: the one that this mesh holds, or a new one, which it holds from
    /// then on if it is to `keep` it. What it takes is added to `work`, the factorization also where it was made before:
    /// what a run needs does not depend on what ran before it.
    ///
    /// # Errors
    /// A matrix that is not positive definite, or an order of unknowns that cannot be analysed.
    pub(super) fn stiffness_factor(
        &self,
        (tensor, order): (&TensorField, Order),
        keep: bool,
        work: &mut Work,
    ) -> Result<Arc<StiffnessFactor>, FactorError> {
        work.linear.factorizations += 1;
        // Locked while a factor is made that others may need: they wait for it.
        let mut factors = self.factors();
        let is_it = |held: &&Arc<StiffnessFactor>| held.order == order && held.tensor == *tensor;
        if let Some(held) = factors.held.iter().find(is_it) {
            return Ok(held.clone());
        }
        factors.made += 1;
        if !keep {
            drop(factors);
            return self.new_factor(tensor, order, work).map(Arc::new);
        }
        let new = Arc::new(self.new_factor(tensor, order, work)?);
        if factors.held.len() == HELD {
            factors.held.remove(0);
        }
        factors.held.push(new.clone());
        Ok(new)
    }

    fn new_factor(
        &self,
        tensor: &TensorField,
        order: Order,
        work: &mut Work,
    ) -> Result<StiffnessFactor, FactorError> {
        let start = Instant::now();
        let analysis = self.analysis_in(order)?;
        let values = self.stiffness_of_unknowns(tensor);
        work.seconds_assemble += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&self.pattern, &values, &mut factor, &mut workspace)?;
        work.linear.seconds_factor += start.elapsed().as_secs_f64();
        let (values, factor) = (Arc::new(values), Arc::new(factor));
        Ok(StiffnessFactor { tensor: tensor.clone(), order, values, factor })
    }

    /// How many factors of stiffness matrices were made on this mesh.
    pub fn stiffness_factors_made(&self) -> u32 {
        self.factors().made
    }

    /// Lets the factors go that this mesh holds, where only its geometry is needed from now on.
    pub fn forget_factors(&self) {
        self.factors().held.clear();
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
    /// The inverse for `tensor` by the factor that `space` holds, or by a new one; whether `space` is to `keep` that for
    /// other runs, or it is for one use.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub fn new(
        space: &'a Discretization,
        tensor: &TensorField,
        keep: bool,
    ) -> Result<Self, FactorError> {
        let kept = space.stiffness_factor((tensor, Order::Usual), keep, &mut Work::default())?;
        Ok(Self { space, analysis: space.analysis()?, kept, front: Front::default() })
    }

    /// K⁻¹b in place, over the free nodes: the displacements in V^h that a Cartesian force moves.
    pub fn solve(&mut self, b: &mut [f64]) {
        self.space.frames.force_on_unknowns(b);
        self.analysis.solve(&self.kept.factor, b, &mut self.front);
        self.space.frames.to_cartesian(b);
    }

    /// Kx for displacements in V^h, as a force that does no work outside V^h.
    pub fn multiply(&self, x: &[f64], out: &mut [f64]) {
        let mut w = x.to_vec();
        self.space.frames.to_unknowns(&mut w);
        self.space.pattern.multiply(&self.kept.values, &w, out);
        self.space.frames.force_on_cartesian(out);
    }
}
