//! Factors of stiffness matrices that a mesh holds.

use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use algebra::linalg::{Factor, FactorError};
use vhi::law::TensorField;

/// The unknowns of a factor, and their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknowns {
    /// Cartesian components, in the order of [`super::Discretization::analysis`].
    Displacements,
    /// The unknowns of the contact problem, Γ3 last, in the order of `Discretization::condensing`.
    ContactLast,
}

/// The stiffness matrix of a tensor and its factor.
#[derive(Debug)]
pub struct StiffnessFactor {
    pub(super) tensor: TensorField,
    /// What the factor is of.
    pub(super) unknowns: Unknowns,
    /// The lower triangle.
    pub values: Arc<Vec<f64>>,
    /// L.
    pub factor: Arc<Factor>,
}

/// The factors that a mesh holds.
#[derive(Debug, Default)]
pub(super) struct StiffnessFactors {
    held: Mutex<Vec<Arc<StiffnessFactor>>>,
    made: AtomicU32,
}

/// Factors held at a time: those of 𝒜 and of 𝒜 + μ.
const HELD: usize = 2;

impl StiffnessFactors {
    /// The factor of `tensor` that is held, or the one that `make` gives, which is held from then on.
    ///
    /// # Errors
    /// `make` fails.
    pub(super) fn find_or_hold(
        &self,
        tensor: &TensorField,
        unknowns: Unknowns,
        make: impl FnOnce() -> Result<StiffnessFactor, FactorError>,
    ) -> Result<Arc<StiffnessFactor>, FactorError> {
        // Locked while the factor is made: another run that needs it waits for it.
        let mut held = self.lock();
        if let Some(found) = find(&held, tensor, unknowns) {
            return Ok(found);
        }
        let new = Arc::new(make()?);
        if held.len() == HELD {
            held.remove(0);
        }
        held.push(new.clone());
        Ok(new)
    }

    /// The factor of `tensor`, if it is held.
    pub(super) fn find(
        &self,
        tensor: &TensorField,
        unknowns: Unknowns,
    ) -> Option<Arc<StiffnessFactor>> {
        find(&self.lock(), tensor, unknowns)
    }

    /// Counts a factor that was made on this mesh.
    pub(super) fn count(&self) {
        self.made.fetch_add(1, Ordering::Relaxed);
    }

    /// How many were made on this mesh.
    pub(super) fn made(&self) -> u32 {
        self.made.load(Ordering::Relaxed)
    }

    /// Lets them go.
    pub(super) fn clear(&self) {
        self.lock().clear();
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Arc<StiffnessFactor>>> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn find(
    held: &[Arc<StiffnessFactor>],
    tensor: &TensorField,
    unknowns: Unknowns,
) -> Option<Arc<StiffnessFactor>> {
    held.iter().find(|kept| kept.unknowns == unknowns && kept.tensor == *tensor).cloned()
}
