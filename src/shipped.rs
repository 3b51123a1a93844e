//! The scenes that the program comes with and their baseline, inside it: it needs no folder beside it.

use judge::verdict::{Baseline, BaselineError};
use scene::{Inside, Registry};

/// Scenes and meshes by file name, as they stood in `manufactured/` when the program was built.
const TEXTS: Inside = include!(concat!(env!("OUT_DIR"), "/shipped.rs"));

/// Their recorded errors and work.
const RECORDED: &str = include_str!("../reports/baseline.json");

/// The scenes.
pub fn scenes() -> Registry {
    Registry::inside(TEXTS)
}

/// What `sweep baseline` recorded of them.
///
/// # Errors
/// The text is no baseline: a build from a damaged package.
pub fn baseline() -> Result<Baseline, BaselineError> {
    Baseline::parse("<sweep>/baseline.json".as_ref(), RECORDED.as_bytes())
}
