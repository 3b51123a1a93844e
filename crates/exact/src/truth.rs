//! The reference solution of a case, with its values cached by time.

use std::collections::HashMap;
use std::convert::Infallible;
use std::sync::{Arc, Mutex, PoisonError};

use super::densities::Densities;
use fem::contact::LoadError;
use fem::norms::{ContactSamples, Moments};

/// What a case is measured against and driven by.
pub trait Truth: Send + Sync {
    /// The load vector F(t), over the unknowns.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError>;

    /// The loads of the strong form as functions, [`Self::load`] before it is assembled; None of other loads.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn densities(&self, _t: f64) -> Result<Option<Densities>, LoadError> {
        Ok(None)
    }

    /// The moments of the solution at t.
    ///
    /// # Errors
    /// A formula that is not finite somewhere, a time that a reference run lacks.
    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError>;

    /// Announces that the moments at these times will be requested, so that work shared with the loads is done once.
    ///
    /// # Errors
    /// As [`Self::moments`].
    fn expect(&self, _times: &[f64]) -> Result<(), LoadError> {
        Ok(())
    }

    /// The solution on Γ3 with the contact state of each point, if given by formulas; not cached, since few scenes need
    /// it.
    ///
    /// # Errors
    /// A formula that is not finite somewhere.
    fn contact_samples(&self, _t: f64) -> Result<Option<ContactSamples>, LoadError> {
        Ok(None)
    }
}

/// Values by time, computed once: who asks for one that another thread computes waits for it.
pub struct ByTime<T> {
    values: Mutex<HashMap<u64, Slot<T>>>,
}

type Slot<T> = Arc<Mutex<Option<Arc<T>>>>;

impl<T> Default for ByTime<T> {
    fn default() -> Self {
        Self { values: Mutex::new(HashMap::new()) }
    }
}

impl<T> ByTime<T> {
    fn slot(&self, t: f64) -> Slot<T> {
        let mut values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        values.entry(t.to_bits()).or_default().clone()
    }

    /// The value at t, if it was computed.
    pub(super) fn known(&self, t: f64) -> Option<Arc<T>> {
        let values = self.values.lock().unwrap_or_else(PoisonError::into_inner);
        let slot = values.get(&t.to_bits())?.clone();
        drop(values);
        let value = slot.lock().unwrap_or_else(PoisonError::into_inner);
        value.clone()
    }

    /// The value at t, computed if necessary.
    ///
    /// # Errors
    /// Those of `compute`.
    pub fn get_or<E>(&self, t: f64, compute: impl FnOnce() -> Result<T, E>) -> Result<Arc<T>, E> {
        let slot = self.slot(t);
        let mut value = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(value) = &*value {
            return Ok(value.clone());
        }
        Ok(value.insert(Arc::new(compute()?)).clone())
    }

    /// The value at t, computed if necessary; for infallible computations.
    pub fn always(&self, t: f64, compute: impl FnOnce() -> T) -> Arc<T> {
        let Ok(value) = self.get_or(t, || Ok::<T, Infallible>(compute()));
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_question_leaves_nothing_behind() {
        let values = ByTime::<f64>::default();
        assert!(values.known(0.5).is_none() && values.values.lock().unwrap().is_empty());
        values.always(0.5, || 2.0);
        assert_eq!(values.known(0.5).as_deref(), Some(&2.0));
    }
}
