//! Prepares a scene of either kind for the study of its error in time.

use super::GronwallError;
use super::contact_scene::ContactInTime;
use super::finite_scene::FiniteInTime;
use super::in_time::InTime;
use scene::setup::Subject;

/// Prepares a scene for grids with these numbers of steps. A body needs `n`, cells per unit length; an
/// abstract scene has none.
///
/// # Errors
/// Constants, loads or a reference run that cannot be had.
pub fn prepare<'a>(
    subject: &'a Subject,
    n: Option<u32>,
    steps: &[u32],
) -> Result<Box<dyn InTime + 'a>, GronwallError> {
    match (subject, n) {
        (Subject::Contact(setup), Some(n)) => Ok(Box::new(ContactInTime::new(setup, n, steps)?)),
        (Subject::Abstract(setup), None) => Ok(Box::new(FiniteInTime::new(setup)?)),
        (Subject::Contact(_), None) => {
            Err(GronwallError::Mesh { reason: "a body needs a mesh: give --n" })
        }
        (Subject::Abstract(_), Some(_)) => {
            Err(GronwallError::Mesh { reason: "an abstract problem has no mesh: leave --n away" })
        }
    }
}
