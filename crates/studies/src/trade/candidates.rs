//! The whole numbers n and N that a scene has, for searches.

use std::cell::RefCell;
use std::collections::HashMap;

use super::target::{Answer, AtSteps, Choices, NoAnswer, cheapest};
use run::sweep::scene_reference;
use scene::setup::{Setup, SetupError, Subject, check_step_sizes};

/// No larger n or N is proposed: `sweep solve` takes no larger n, and N beyond it is a separate campaign.
pub(crate) const MOST: [u32; 2] = [4096, 100_000];

/// Finest n and N whose errors show: half of those of the scene's reference run, which has no error against itself.
pub(super) fn finest(setup: &Setup) -> Option<[u32; 2]> {
    scene_reference(setup).map(|r| [r.n as u32 / 2, r.steps as u32 / 2])
}

/// The whole numbers n and N that suit a scene.
pub(crate) struct Candidates<'a> {
    setup: &'a Setup,
    subject: Subject,
    /// Whether n and N must divide those of the scene's reference run.
    beside_reference: bool,
    /// Whether N steps satisfy (3.4) and solvability, and the largest step: worked out once for each N.
    safe: RefCell<HashMap<u32, bool>>,
    largest: RefCell<HashMap<u32, f64>>,
}

impl<'a> Candidates<'a> {
    /// The candidates of a scene; `beside_reference`: errors are to be measured against its reference run.
    ///
    /// # Errors
    /// The scene cannot be set up.
    pub(crate) fn new(setup: &'a Setup, beside_reference: bool) -> Result<Self, SetupError> {
        let subject = Subject::new(setup.scene.clone())?;
        let (safe, largest) = Default::default();
        Ok(Self { setup, subject, beside_reference, safe, largest })
    }

    /// h of n.
    pub(crate) fn h(&self, n: u32) -> f64 {
        self.setup.body.domain.h(n)
    }

    /// The largest time step of N.
    pub(crate) fn k(&self, steps: u32) -> f64 {
        let largest = || self.setup.grid(steps).largest_step();
        *self.largest.borrow_mut().entry(steps).or_insert_with(largest)
    }

    /// Whether n suits the domain.
    pub(crate) fn cells(&self, n: u32) -> bool {
        let scene = &self.setup.scene;
        match self.beside_reference {
            true => scene.check_cases(&[n], &[]).is_ok(),
            false => scene.check_cells(n).is_ok(),
        }
    }

    /// Whether N steps are small enough.
    pub(crate) fn steps(&self, steps: u32) -> bool {
        let divides = !self.beside_reference || self.setup.scene.check_cases(&[], &[steps]).is_ok();
        let safe = || check_step_sizes(&self.subject, &[steps]).is_ok();
        divides && *self.safe.borrow_mut().entry(steps).or_insert_with(safe)
    }

    /// [`cheapest`] of the n and N from `least` to `most`.
    ///
    /// # Errors
    /// [`NoAnswer`].
    pub(crate) fn cheapest(
        &self,
        error: &AtSteps<'_>,
        seconds: &AtSteps<'_>,
        target: f64,
        [least, most]: [[u32; 2]; 2],
    ) -> Result<Answer, NoAnswer> {
        let choices = Choices {
            least,
            most,
            h: &|n| self.h(n),
            k: &|steps| self.k(steps),
            cells: &|n| self.cells(n),
            steps: &|steps| self.steps(steps),
        };
        cheapest(error, seconds, target, &choices)
    }
}
