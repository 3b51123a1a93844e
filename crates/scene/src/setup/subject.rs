//! A computable scene of either kind.

use super::{AbstractSetup, Result, Setup};
use crate::Scene;
use vhi::history::TimeGrid;

/// A scene made computable.
pub enum Subject {
    /// Problem 12, a body in contact.
    Contact(Box<Setup>),
    /// Problem 1 in ℝ^m.
    Abstract(Box<AbstractSetup>),
}

impl Subject {
    /// Sets a scene up and checks what needs its model.
    ///
    /// # Errors
    /// The first violated condition, at its key in the scene.
    pub fn new(scene: Scene) -> Result<Self> {
        match scene.as_contact() {
            Some(_) => Ok(Self::Contact(Box::new(Setup::new(scene)?))),
            None => Ok(Self::Abstract(Box::new(AbstractSetup::new(scene)?))),
        }
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        match self {
            Self::Contact(setup) => &setup.scene,
            Self::Abstract(setup) => &setup.scene,
        }
    }

    /// The grid with the given number of steps.
    pub fn grid(&self, steps: u32) -> TimeGrid {
        match self {
            Self::Contact(setup) => setup.grid(steps),
            Self::Abstract(setup) => setup.grid(steps),
        }
    }

    /// Whether the exact solution is known; otherwise a reference run is needed.
    pub fn has_exact(&self) -> bool {
        match self {
            Self::Contact(setup) => setup.exact.is_some(),
            Self::Abstract(_) => true,
        }
    }
}
