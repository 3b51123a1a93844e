//! Stiffness matrices of tensors with their factors: each is made once a mesh, for all that solve with it.
//!
//! The matrix of a march without projection whose memory is a multiple of the elasticity is 𝒜's on every grid in time;
//! bounds, floors and duals ask for those of 𝒜, 𝒜 + μ and the identity again and again.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::{Discretization, Work};
use algebra::linalg::{Analysis, Factor, FactorError, Front};
use vhi::law::TensorField;

/// The unknowns of a factor, and their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknowns {
    /// Cartesian components, in the order of [`Discretization::analysis`].
    Displacements,
    /// The unknowns of the contact problem, Γ3 last, in the order of `Discretization::condensing`.
    ContactLast,
}

/// The stiffness matrix of a tensor and its factor.
#[derive(Debug)]
pub struct StiffnessFactor {
    tensor: TensorField,
    unknowns: Unknowns,
    /// The lower triangle.
    pub values: Arc<Vec<f64>>,
    /// L.
    pub factor: Arc<Factor>,
}

impl StiffnessFactor {
    fn new(
        space: &Discretization,
        tensor: &TensorField,
        unknowns: Unknowns,
        work: &mut Work,
    ) -> Result<Self, FactorError> {
        let start = Instant::now();
        let analysis = match unknowns {
            Unknowns::Displacements => space.analysis()?,
            Unknowns::ContactLast => space.condensing()?,
        };
        let values = space.stiffness_of(unknowns, tensor);
        work.seconds_assemble += start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
        analysis.factorize(&space.pattern, &values, &mut factor, &mut workspace)?;
        space.factors.made.fetch_add(1, Ordering::Relaxed);
        work.linear.seconds_factor += start.elapsed().as_secs_f64();
        let (values, factor) = (Arc::new(values), Arc::new(factor));
        Ok(Self { tensor: tensor.clone(), unknowns, values, factor })
    }
}

/// The one of `tensor`, if it is held.
fn find(
    held: &[Arc<StiffnessFactor>],
    tensor: &TensorField,
    unknowns: Unknowns,
) -> Option<Arc<StiffnessFactor>> {
    held.iter().find(|own| own.unknowns == unknowns && own.tensor == *tensor).cloned()
}

/// The factors that a mesh holds.
#[derive(Debug, Default)]
pub(super) struct StiffnessFactors {
    held: Mutex<Vec<Arc<StiffnessFactor>>>,
    made: AtomicU32,
}

/// Factors held at a time: those of 𝒜 and of 𝒜 + μ.
const HELD: usize = 2;

impl Discretization {
    /// Lower-triangle values of the stiffness matrix of `tensor`.
    pub(super) fn stiffness_of(&self, unknowns: Unknowns, tensor: &TensorField) -> Vec<f64> {
        match unknowns {
            Unknowns::Displacements => self.stiffness(tensor),
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
        // Locked while the factor is made: another run that needs it waits for it.
        let mut held = self.factors.held.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = find(&held, tensor, unknowns) {
            return Ok(found);
        }
        let new = Arc::new(StiffnessFactor::new(self, tensor, unknowns, work)?);
        if held.len() == HELD {
            held.remove(0);
        }
        held.push(new.clone());
        Ok(new)
    }

    /// The factor of `tensor` in the order of displacements: the held one, or one that is not held afterwards.
    fn passing_factor(&self, tensor: &TensorField) -> Result<Arc<StiffnessFactor>, FactorError> {
        let unknowns = Unknowns::Displacements;
        let held = self.factors.held.lock().unwrap_or_else(PoisonError::into_inner);
        let found = find(&held, tensor, unknowns);
        // Nobody waits for a factor that is not held.
        drop(held);
        let own = || StiffnessFactor::new(self, tensor, unknowns, &mut Work::default());
        found.map_or_else(|| own().map(Arc::new), Ok)
    }

    /// How many factors of stiffness matrices were made on this mesh.
    pub fn stiffness_factors_made(&self) -> u32 {
        self.factors.made.load(Ordering::Relaxed)
    }

    /// Lets the factors go that this mesh holds, where only its geometry is needed from now on.
    pub fn forget_factors(&self) {
        self.factors.held.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

/// K⁻¹ of a tensor over Cartesian displacements, by its factor.
pub struct StiffnessInverse<'a> {
    space: &'a Discretization,
    analysis: &'a Analysis,
    kept: Arc<StiffnessFactor>,
    front: Front<f64>,
}

impl<'a> StiffnessInverse<'a> {
    /// Of `tensor` on `space`, which holds the factor from then on for other runs.
    ///
    /// # Errors
    /// A matrix that is not positive definite.
    pub(crate) fn held(
        space: &'a Discretization,
        tensor: &TensorField,
        work: &mut Work,
    ) -> Result<Self, FactorError> {
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

    /// K⁻¹b in place, over the unknowns.
    pub fn solve(&mut self, b: &mut [f64]) {
        self.analysis.solve(&self.kept.factor, b, &mut self.front);
    }

    /// Kx.
    pub fn multiply(&self, x: &[f64], out: &mut [f64]) {
        self.space.pattern.multiply(&self.kept.values, x, out);
    }

    /// The lower triangle of K.
    pub fn values(&self) -> &[f64] {
        &self.kept.values
    }
}
