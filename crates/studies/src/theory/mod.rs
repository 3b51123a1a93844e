//! The theory, executable: every constant, bound and inequality of the paper as something that runs.

pub mod audit;
pub mod bound;
pub mod corner;
pub mod estimators;
pub mod gronwall;
pub mod norms;

use crate::study::Study;

/// The studies of one scene that are commands.
pub const STUDIES: [&Study; 4] =
    [&audit::STUDY, &bound::STUDY, &gronwall::STUDY, &estimators::STUDY];
