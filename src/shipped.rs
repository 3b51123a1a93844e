//! The scenes inside the program and their baseline.

use judge::verdict::{Baseline, BaselineError};
use scene::{Inside, Registry};

/// Scenes and meshes by file name, from `manufactured/` at build time.
const TEXTS: Inside = include!(concat!(env!("OUT_DIR"), "/shipped.rs"));

const RECORDED: &str = include_str!("../reports/baseline.json");

/// The scenes.
pub fn scenes() -> Registry {
    Registry::inside(TEXTS)
}

/// The recorded baseline of these scenes.
///
/// # Errors
/// An invalid baseline: a build from a damaged package.
pub fn baseline() -> Result<Baseline, BaselineError> {
    Baseline::parse("<sweep>/baseline.json".as_ref(), RECORDED.as_bytes())
}
