//! Errors of a computed step against a truth that has been reduced to moments on the mesh.

mod contact_state;
mod errors;
mod moments;
mod nested;
mod projection;
mod reference;
mod refinement;

pub use contact_state::{ContactSamples, ContactState, StateErrors, state_errors, state_rule};
pub use errors::{StepErrors, is_locked, step_errors, strain_error};
pub use moments::{AtPoints, Moments, Piecewise, facet_samples, hausdorff};
pub use projection::ElasticProjection;
pub use reference::{ReferenceRun, Trajectory};
pub use refinement::{ReferenceError, Refinement};
